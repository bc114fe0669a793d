"""Controllers: one robot's observation and messages in, twist and messages out."""

from robotteamsim.control.runtime import foreign_code
from robotteamsim.control.runtime.guard import Guard
from robotteamsim.control.runtime.registry import ALGORITHMS, algorithm_names, make_controller

__all__ = ["ALGORITHMS", "Guard", "algorithm_names", "foreign_code", "make_controller"]
