"""The shipped warehouse shows what it is for: objects that are pushed."""

from __future__ import annotations

import math

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation


def test_robots_push_crates_along_the_aisle_and_none_goes_through_a_wall():
    simulation = Simulation(load("warehouse_push", ["mission.time_limit_s=30"]))
    before = {name: (pose.x_m, pose.y_m) for name, pose in simulation.world.objects().items()}
    simulation.run()
    after = {name: (pose.x_m, pose.y_m) for name, pose in simulation.world.objects().items()}
    moved_m = {name: math.dist(before[name], after[name]) for name in before}
    assert max(moved_m.values()) > 1.0
    assert sum(distance_m > 0.1 for distance_m in moved_m.values()) >= 3
    assert all(0.2 < x_m < 27.8 and 0.2 < y_m < 13.8 for x_m, y_m in after.values())
