"""The sensors that robots can carry besides `base_scan`: each kind of ours is a file, others are in users' packages."""

import contextlib
import logging
import re
import sys
from collections.abc import Mapping
from functools import reduce
from importlib.metadata import entry_points
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Tag

from robotteamsim.scenario.base import by_kind
from robotteamsim.scenario.sensors.base import Sensor, is_free_name
from robotteamsim.scenario.sensors.camera import Camera
from robotteamsim.scenario.sensors.gps import Fix, Gps
from robotteamsim.scenario.sensors.heat import HeatReading, HeatSensor
from robotteamsim.scenario.sensors.laser import Laser, MountedLaser
from robotteamsim.scenario.sensors.light import LightSensor
from robotteamsim.scenario.sensors.sonar import Sonar
from robotteamsim.wording import described

__all__ = [
    "KINDS",
    "AnySensor",
    "Camera",
    "Fix",
    "Gps",
    "HeatReading",
    "HeatSensor",
    "Laser",
    "LightSensor",
    "MountedLaser",
    "Sensor",
    "Sonar",
    "is_free_name",
]

ENTRY_POINTS = "robotteamsim.sensors"
"""The group of entry points with which other packages register kinds: `thermometer = my_package:Thermometer`."""


def _kinds() -> dict[str, type[Sensor]]:
    """Return the kinds, ours first. One that cannot be used is left out, with a warning."""
    kinds: dict[str, type[Sensor]] = {
        "laser": MountedLaser,
        "sonar": Sonar,
        "camera": Camera,
        "light": LightSensor,
        "gps": Gps,
        "heat": HeatSensor,
    }
    for point in sorted(entry_points(group=ENTRY_POINTS)):
        try:
            with contextlib.redirect_stdout(sys.stderr):  # what a module prints is no output of a command
                found = point.load()
            kinds |= {point.name: _checked(point.name, found, kinds)}
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # Any error in the user's module is reported in one line.
            logging.getLogger(__name__).warning("sensor %s of %s: %s", point.name, point.value, described(error))
    return kinds


def _checked(name: str, found: Any, known: dict[str, type[Sensor]]) -> type[Sensor]:
    """Raises: TypeError, ValueError: it is not the class of another kind of sensor."""
    if not (isinstance(found, type) and issubclass(found, Sensor)):
        raise TypeError(f"expected a class below robotteamsim.scenario.sensors.base.Sensor, not {found!r:.40}")
    if name in known:
        raise ValueError("there is another sensor of this kind")
    if (kind := found.model_fields["kind"].default) != name:
        raise ValueError(f"its key kind has the default {kind!r:.40}; expected '{name}'")
    if not isinstance(found.definitions, Mapping):
        raise TypeError(f"definitions {found.definitions!r:.40}; expected texts by the names of types")
    for type_name in (getattr(found, "type_name", None), *found.definitions):
        if not (isinstance(type_name, str) and re.fullmatch(r"\w+/\w+", type_name)):
            raise ValueError(f"type {type_name!r:.40}; expected a name such as 'sensor_msgs/Temperature'")
    return found


KINDS = _kinds()

if TYPE_CHECKING:
    AnySensor = Sensor
else:
    _members = (Annotated[sensor, Tag(f"<{kind}>")] for kind, sensor in KINDS.items())
    AnySensor = Annotated[reduce(or_, _members), by_kind()]
    """A sensor of any kind."""
