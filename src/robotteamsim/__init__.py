"""Teams of mobile robots in search and rescue: the same mission headless and in ROS 1.

The names below are what most programs need: `import robotteamsim as rts`. Each is imported on its first use, so that
a node that needs few of them starts fast.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robotteamsim._core.plan import PlanningGrid
    from robotteamsim.control.driving.known_map import KnownMap
    from robotteamsim.control.driving.path_controller import PathController, Situation
    from robotteamsim.geometry import Pose, PoseReading, Twist
    from robotteamsim.interface import (
        EVERYBODY,
        OUTSIDE,
        Assistance,
        Controller,
        Decision,
        Discovery,
        Message,
        Observation,
        SwarmContext,
        Task,
    )
    from robotteamsim.propagation import FieldMap
    from robotteamsim.rng import stream
    from robotteamsim.scenario import Scenario, load
    from robotteamsim.scenario.building import MapSource
    from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN, Grid
    from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
    from robotteamsim.setup import Setup
    from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
    from robotteamsim.view.own_loop import LiveView

# In a catkin devel space, the C++ module is in another folder; processes that Python spawns see this one first.
__path__ = pkgutil.extend_path(__path__, __name__)

__version__ = "0.1.0"

__all__ = [
    "EVERYBODY",
    "FREE",
    "OCCUPIED",
    "OUTSIDE",
    "UNKNOWN",
    "Assistance",
    "Controller",
    "Decision",
    "Discovery",
    "FieldMap",
    "Grid",
    "KnownMap",
    "LiveView",
    "MapSource",
    "Message",
    "Observation",
    "Observer",
    "OdometryReading",
    "PathController",
    "PlanningGrid",
    "Pose",
    "PoseReading",
    "Result",
    "RobotReading",
    "Scenario",
    "Setup",
    "Simulation",
    "Situation",
    "StepRecord",
    "SwarmContext",
    "Task",
    "Twist",
    "VoiceReading",
    "load",
    "stream",
]

_MODULES = {
    "_core.plan": ("PlanningGrid",),
    "control.driving.known_map": ("KnownMap",),
    "control.driving.path_controller": ("PathController", "Situation"),
    "geometry": ("Pose", "PoseReading", "Twist"),
    "interface": (
        *("EVERYBODY", "OUTSIDE", "Assistance", "Controller", "Decision", "Discovery", "Message", "Observation"),
        *("SwarmContext", "Task"),
    ),
    "propagation": ("FieldMap",),
    "rng": ("stream",),
    "scenario": ("Scenario", "load"),
    "scenario.building": ("MapSource",),
    "scenario.plan": ("FREE", "OCCUPIED", "UNKNOWN", "Grid"),
    "sensing.readings": ("OdometryReading", "RobotReading", "VoiceReading"),
    "setup": ("Setup",),
    "simulation": ("Observer", "Result", "Simulation", "StepRecord"),
    "view.own_loop": ("LiveView",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


if not TYPE_CHECKING:  # type checkers would take any name for one of this package

    def __getattr__(name: str) -> Any:
        """Return a name of `__all__` from the package that defines it."""
        if name not in _MODULE_OF:
            raise AttributeError(f"module 'robotteamsim' has no attribute {name!r}")
        value = getattr(importlib.import_module(f"robotteamsim.{_MODULE_OF[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
