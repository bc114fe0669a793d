"""Thermal cameras: the temperature at the robot, and the hot places in sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, point
from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.sensors.base import Carrier, Moment, Sensor, SensorName, expect_within
from robotteamsim.wording import counted

_FARTHEST_M = 1e6
_HOTTEST_C = 1e6


@dataclass(frozen=True, slots=True)
class HeatReading:
    """What a thermal camera measures.

    temperature_c: of the air at the robot [degC].
    hot_m:         centres of the hot places in sight, in `map` [m]: those of `fire.heat.block_c` and more.
    hot_c:         their temperatures [degC].
    """

    temperature_c: float
    hot_m: tuple[tuple[float, float], ...] = ()
    hot_c: tuple[float, ...] = ()


class HeatSensor(Sensor):
    """A thermal camera that looks around. It measures when fire and smoke advance; smoke does not hide heat."""

    type_name: ClassVar[str] = "robotteamsim/Heat"
    needs_fire: ClassVar[bool] = True

    name: SensorName = Field(default="heat", description="a name, for topic robot_<id>/<name>")
    kind: Literal["heat"] = Field(default="heat", description="heat")
    range_m: float = Field(default=5.0, ge=SMALLEST, le=100.0, description="farthest hot place that it sees [m]")

    def is_due(self, moment: Moment) -> bool:
        """See `Sensor`."""
        return moment.fire_advances

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> HeatReading:
        """See `Sensor`."""
        return HeatReading(carrier.air.temperature_c(), *carrier.air.hot_places(self.range_m))

    def message(self, time_ns: int, robot_id: int, reading: HeatReading) -> RosMessage:
        """See `Sensor`."""
        return {
            "header": header(time_ns, MAP_FRAME),
            "temperature_c": reading.temperature_c,
            "hot": [point(place) for place in reading.hot_m],
            "hot_c": reading.hot_c,
        }

    def text(self, reading: HeatReading) -> str:
        """See `Sensor`."""
        return f"{reading.temperature_c:.0f} degC, {counted(len(reading.hot_m), 'hot place')}"

    def reading(self, message: Any) -> HeatReading:
        """See `Sensor`."""
        places = tuple((place.x, place.y) for place in message.hot)
        for place in places:
            for coordinate_m in place:
                expect_within("hot", coordinate_m, -_FARTHEST_M, _FARTHEST_M)
        if len(message.hot_c) != len(places):
            raise ValueError(f"hot_c: {len(message.hot_c)} temperatures; expected {len(places)}, one for each place")
        temperatures_c = tuple(expect_within("hot_c", value_c, -_HOTTEST_C, _HOTTEST_C) for value_c in message.hot_c)
        own_c = expect_within("temperature_c", message.temperature_c, -_HOTTEST_C, _HOTTEST_C)
        return HeatReading(own_c, places, temperatures_c)
