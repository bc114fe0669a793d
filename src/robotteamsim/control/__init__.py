"""Controllers: from one robot's observation and inbox to its twist and outbox."""

from robotteamsim.control.runtime import foreign_code
from robotteamsim.control.runtime.guard import Guard
from robotteamsim.control.runtime.registry import algorithm_names, make_controller

__all__ = ["Guard", "algorithm_names", "foreign_code", "make_controller"]
