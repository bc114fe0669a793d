"""What no user should do to a world, and what it makes of it."""

import math

import numpy as np
import pytest

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.simulation.stages import ScheduleStage
from robotteamsim.world import World

SQUARE = ((-0.15, -0.15), (0.15, -0.15), (0.15, 0.15), (-0.15, 0.15))
SHEET = ((50.0, -5.0), (50.002, -5.0), (50.002, 5.0), (50.0, 5.0))
ROOM_M = 8.0


def room() -> FloorPlan:
    walls = (
        Wall(name="south", start=(-0.2, -0.1), end=(ROOM_M + 0.2, -0.1)),
        Wall(name="north", start=(-0.2, ROOM_M + 0.1), end=(ROOM_M + 0.2, ROOM_M + 0.1)),
        Wall(name="west", start=(-0.1, 0.0), end=(-0.1, ROOM_M)),
        Wall(name="east", start=(ROOM_M + 0.1, 0.0), end=(ROOM_M + 0.1, ROOM_M)),
    )
    return FloorPlan(name="room", bounds=Bounds(min=(-0.2, -0.2), max=(ROOM_M + 0.2, ROOM_M + 0.2)), walls=walls)


@pytest.mark.parametrize("footprint_m", [(), SQUARE], ids=["round", "square"])
@pytest.mark.parametrize("kind", ["differential", "omni"])
def test_body_at_a_hundred_metres_a_second_does_not_tunnel_through_a_thin_sheet(kind, footprint_m):
    drive = _core.world.Drive(
        kind=kind,
        max_speed_mps=100.0,
        max_acceleration_mps2=1e4,
        max_turn_radps=2.0,
        max_turn_acceleration_radps2=8.0,
    )
    robot = _core.world.Robot(
        radius_m=0.15, mass_kg=5.0, drive=drive, start=Pose(0.0, 0.0, 0.0), footprint_m=footprint_m
    )
    world = _core.world.World([_core.world.Solid(SHEET, [SHEET])], [], [robot], 0.1, 5)
    for _ in range(20):
        world.step(np.array([[100.0, 0.0, 0.0]]))
    assert world.poses()[0, 0] == pytest.approx(49.85, abs=0.01)


@pytest.mark.slow
def test_hundred_robots_in_one_spot_push_each_other_apart_without_a_crash():
    drive = _core.world.Drive(
        kind="differential",
        max_speed_mps=0.7,
        max_acceleration_mps2=2.0,
        max_turn_radps=2.0,
        max_turn_acceleration_radps2=8.0,
    )
    robots = [
        _core.world.Robot(radius_m=0.1, mass_kg=5.0, drive=drive, start=Pose(0.0, 0.0, math.tau * i / 100))
        for i in range(100)
    ]
    world = _core.world.World([], [], robots, 0.1, 2)
    for _ in range(5):
        world.step(np.full((100, 3), [0.7, 0.0, 0.0]))
    assert np.isfinite(world.poses()).all()
    assert np.hypot(*world.poses()[:, :2].T).max() > 1.0


def test_thousand_robots_in_a_small_room_stay_in_it_however_they_push():
    spots_m = (np.arange(32) + 0.5) * ROOM_M / 32
    poses = [(float(x), float(y), 0.0) for x in spots_m for y in spots_m][:1000]
    world = World(room(), [PlacedRobot(start_pose=pose, radius_m=0.1) for pose in poses], Run())
    generator = np.random.default_rng(1)
    for _ in range(10):
        world.step(generator.uniform((-0.7, 0.0, -2.0), (0.7, 0.0, 2.0), (1000, 3)))
    positions_m = world.positions_m()
    assert np.isfinite(positions_m).all()
    assert positions_m.min() > 0.1 - 0.05
    assert positions_m.max() < ROOM_M - 0.1 + 0.05
    assert sum(world.in_contact()) > 100


@pytest.mark.parametrize("step_s", [0.0, -0.1, math.nan, math.inf])
def test_invalid_step_time_is_rejected(step_s):
    with pytest.raises(ValueError, match="step and substeps must be > 0"):
        _core.world.World([], [], [], step_s, 5)


def test_fan_without_beams_is_rejected():
    fan = _core.world.Fan(beams=0, angle_min_rad=-1.0, angle_max_rad=1.0, forward_m=0.0, left_m=0.0, range_max_m=5.0)
    with pytest.raises(ValueError, match="beams must be >= 1, got 0"):
        _core.world.FanCaster(fan, [], [])


def test_thousand_robots_in_one_spot_are_rejected_by_the_names_of_two():
    robots = [PlacedRobot(start_pose=(4.0, 4.0, 0.0))] * 1000
    with pytest.raises(PlacementError, match=r"robot_1: start pose \(4.00, 4.00\) is inside robot_0 at \(4.00, 4.00\)"):
        World(room(), robots, Run())


@pytest.mark.slow
def test_of_a_thousand_robots_held_back_for_one_spot_one_comes():
    robots = [PlacedRobot(start_pose=(4.0, 4.0, 0.0), present=i == 0) for i in range(1000)]
    world = World(room(), robots, Run())
    schedule = ScheduleStage([ScheduledEvent(at_s=0.0, spawn=i) for i in range(1, 1000)])
    for _ in range(3):
        schedule.step(world.sim_time_ns, world)
        world.step(np.zeros((1000, 3)))
    assert sum(world.arrivals) == 1
