"""Controllers: one robot's observation and messages in, twist and messages out."""

from robotteamsim.control.controller import Controller, Decision, Task
from robotteamsim.control.guard import Guard
from robotteamsim.control.rdpso import RdpsoController
from robotteamsim.control.registry import ALGORITHMS, algorithm_names, make_controller

__all__ = [
    "ALGORITHMS",
    "Controller",
    "Decision",
    "Guard",
    "RdpsoController",
    "Task",
    "algorithm_names",
    "make_controller",
]
