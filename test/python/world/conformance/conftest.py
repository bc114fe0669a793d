"""Worlds of each kind, for the tests of their contract."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest
from two_rooms import scenario_of

from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.world import make_world

KINDS = ("box2d", "mujoco")
"""Worlds of this process. test/ros and test/gazebo run a part of the tests against worlds behind ROS."""

WorldMaker = Callable[..., AnyWorld]
Readings = Callable[[AnyWorld, Sequence[PlacedRobot]], Sequence[RobotReading]]


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    """The kind of world."""
    return request.param


@pytest.fixture
def world_of(kind: str) -> WorldMaker:
    """Make the world of `scenario_of`."""

    def make(*robots: tuple[float, float, float] | PlacedRobot, **keys: object) -> AnyWorld:
        scenario = scenario_of(kind, *robots, **keys)
        return make_world(scenario, scenario.robots)

    return make


@pytest.fixture
def readings_of() -> Readings:
    """Return what the sensors of a world's robots measure."""
    return lambda world, robots: RobotSensors(world, robots, 1).read()
