#!/usr/bin/env python3
"""Compares a lockstep mission with a fire with the same mission without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions report the values

from __future__ import annotations

import numpy as np
import rostest
from compared import ComparedMission, Log, by_stamp
from geometry_msgs.msg import Point
from listening import Topic, call
from nav_msgs.msg import OccupancyGrid
from robotteamsim.msg import FloatMap, Heat
from robotteamsim.srv import Ignite

from robotteamsim.recording.topics.world import fire_cells
from robotteamsim.simulation import StepRecord


def maps_of(record: StepRecord) -> tuple[bytes, bytes, bytes] | None:
    field = record.hazards
    if field is None:
        return None
    return fire_cells(field).tobytes(), field.temperatures_c.tobytes(), field.soot_g_m3.tobytes()


def heat_of(record: StepRecord) -> tuple[float, list[tuple[float, float]], list[float]] | None:
    heat = record.readings[2].sensors.get("heat") if record.is_there(2) else None
    return None if heat is None else (heat.temperature_c, list(heat.hot_m), list(heat.hot_c))


class FireTest(ComparedMission):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.topics = [
            Topic("/fire/grid", OccupancyGrid),
            Topic("/fire/temperature", FloatMap),
            Topic("/smoke/soot", FloatMap),
        ]
        cls.heat = Topic("/robot_2/heat", Heat)
        cls.expected = Log("garage_fire", cls.settings, maps=maps_of, heat=heat_of)
        cls.first = cls.document_at_end()

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        self.assert_as_expected(self.first, self.expected)
        kinds = {event["kind"] for event in self.first["events"]}
        self.assertLessEqual({"robot_failed_by_heat", "victim_collapsed", "victim_dead"}, kinds)

    def test_maps_of_fire_and_smoke_have_the_bits_of_the_run_without_ros(self) -> None:
        grids, temperatures, soots = (by_stamp(topic.messages) for topic in self.topics)
        found = {
            stamp_ns: (
                np.array(grids[stamp_ns].data, dtype=np.int8).tobytes(),
                np.array(temperatures[stamp_ns].data, dtype=np.float32).tobytes(),
                np.array(soots[stamp_ns].data, dtype=np.float32).tobytes(),
            )
            for stamp_ns in grids.keys() & temperatures.keys() & soots.keys()
        }
        self.assert_values(found, self.expected.kept["maps"], 30)
        last_ns = max(found)
        self.assertEqual((temperatures[last_ns].unit, soots[last_ns].unit), ("degC", "g/m^3"))
        self.assertIn(100, grids[last_ns].data)

    def test_thermal_camera_measures_the_same_as_without_ros(self) -> None:
        found = {
            stamp_ns: (message.temperature_c, [(place.x, place.y) for place in message.hot], list(message.hot_c))
            for stamp_ns, message in by_stamp(self.heat.messages).items()
        }
        self.assert_values(found, self.expected.kept["heat"], 5)

    def test_y_service_ignites_only_where_there_is_fuel(self) -> None:
        answer = call("/simulation/ignite", Ignite, position=Point(50.0, 20.0, 0.0))
        self.assertFalse(answer.success)
        self.assertIn("there is no fuel", answer.message)

    def test_z_reset_repeats_the_fire(self) -> None:
        self.assert_as_expected(self.document_after("/simulation/reset"), self.expected)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "fire", FireTest)
