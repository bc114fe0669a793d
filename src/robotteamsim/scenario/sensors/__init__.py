"""The sensors that robots can carry besides `base_scan`. Each kind is a file; this is the list of kinds."""

from typing import Annotated

from pydantic import Tag

from robotteamsim.scenario.base import by_kind
from robotteamsim.scenario.sensors.base import Sensor, is_free_name
from robotteamsim.scenario.sensors.camera import Camera
from robotteamsim.scenario.sensors.gps import Fix, Gps
from robotteamsim.scenario.sensors.heat import HeatReading, HeatSensor
from robotteamsim.scenario.sensors.laser import Laser, MountedLaser
from robotteamsim.scenario.sensors.light import LightSensor
from robotteamsim.scenario.sensors.sonar import Sonar

__all__ = [
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

AnySensor = Annotated[
    Annotated[MountedLaser, Tag("<laser>")]
    | Annotated[Sonar, Tag("<sonar>")]
    | Annotated[Camera, Tag("<camera>")]
    | Annotated[LightSensor, Tag("<light>")]
    | Annotated[Gps, Tag("<gps>")]
    | Annotated[HeatSensor, Tag("<heat>")],
    by_kind(),
]
"""A sensor of any kind."""
