"""Teams of mobile robots in search and rescue: the same mission headless and in ROS 1.

The names below are what most programs need: `import robotteamsim as rts`. Each is imported on its first use, so that
a node that needs few of them starts fast.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robotteamsim.geometry import Twist
    from robotteamsim.interface import EVERYBODY, Controller, Decision, Message, Observation, Task
    from robotteamsim.rng import stream
    from robotteamsim.scenario import Scenario, load
    from robotteamsim.simulation import Result, Simulation, StepRecord

__version__ = "0.1.0"

__all__ = [
    "EVERYBODY",
    "Controller",
    "Decision",
    "Message",
    "Observation",
    "Result",
    "Scenario",
    "Simulation",
    "StepRecord",
    "Task",
    "Twist",
    "load",
    "stream",
]

_MODULES = {
    "geometry": ("Twist",),
    "interface": ("EVERYBODY", "Controller", "Decision", "Message", "Observation", "Task"),
    "rng": ("stream",),
    "scenario": ("Scenario", "load"),
    "simulation": ("Result", "Simulation", "StepRecord"),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Return a name of `__all__` from the package that defines it."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'robotteamsim' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"robotteamsim.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
