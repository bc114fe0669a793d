"""The sensors that robots can carry besides `base_scan`: each kind of ours is a file, others are in users' packages."""

import re
from collections.abc import Mapping
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Tag

from robotteamsim.own_parts import class_below, load_parts
from robotteamsim.scenario.base import by_kind
from robotteamsim.scenario.sensors.base import Sensor, is_free_name
from robotteamsim.scenario.sensors.camera import Camera
from robotteamsim.scenario.sensors.gps import Fix, Gps
from robotteamsim.scenario.sensors.heat import HeatReading, HeatSensor
from robotteamsim.scenario.sensors.laser import Laser, MountedLaser
from robotteamsim.scenario.sensors.light import LightSensor
from robotteamsim.scenario.sensors.sonar import Sonar

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


def _checked(name: str, found: Any) -> type[Sensor]:
    """Raises: TypeError, ValueError: it is not the class of another kind of sensor."""
    sensor: type[Sensor] = class_below(Sensor, found)
    if (kind := sensor.model_fields["kind"].default) != name:
        raise ValueError(f"its key kind has the default {kind!r:.40}; expected '{name}'")
    if not isinstance(sensor.definitions, Mapping):
        raise TypeError(f"definitions {sensor.definitions!r:.40}; expected texts by the names of types")
    for type_name in (getattr(sensor, "type_name", None), *sensor.definitions):
        if not (isinstance(type_name, str) and re.fullmatch(r"\w+/\w+", type_name)):
            raise ValueError(f"type {type_name!r:.40}; expected a name such as 'sensor_msgs/Temperature'")
    return sensor


_OURS: dict[str, type[Sensor]] = {
    "laser": MountedLaser,
    "sonar": Sonar,
    "camera": Camera,
    "light": LightSensor,
    "gps": Gps,
    "heat": HeatSensor,
}
KINDS = _OURS | load_parts(ENTRY_POINTS, _OURS, _checked)
"""The kinds of sensors by name, ours first."""

if TYPE_CHECKING:
    AnySensor = Sensor
else:
    _members = (Annotated[sensor, Tag(f"<{kind}>")] for kind, sensor in KINDS.items())
    AnySensor = Annotated[reduce(or_, _members), by_kind()]
    """A sensor of any kind."""
