"""What lasers see, against exact intersections in the shipped garage and numbers worked by hand."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
import shapely
from lasers import LaserBeams

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import Bounds, FloorPlan, Wall, load
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Laser as LaserModel
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

WALL_AHEAD = FloorPlan(
    name="wall ahead", bounds=Bounds(max=(20.0, 20.0)), walls=(Wall(name="w", start=(6.0, 0.0), end=(6.0, 20.0)),)
)


@dataclass
class Scene:
    """What a laser can see: solids by shapely, other robots as circles by the quadratic formula."""

    solid: shapely.Geometry
    centers_m: np.ndarray
    radius_m: float

    def ranges_m(self, origin: Pose, angles_rad: np.ndarray, range_max_m: float) -> np.ndarray:
        at, ahead = np.array([origin.x_m, origin.y_m]), np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=1)
        beams = shapely.linestrings(np.stack([np.broadcast_to(at, ahead.shape), at + range_max_m * ahead], axis=1))
        to_solid_m = shapely.distance(shapely.intersection(self.solid, beams), shapely.Point(at))
        offsets_m = self.centers_m - at
        along_m = ahead @ offsets_m.T
        half_chord_m2 = self.radius_m**2 - (np.sum(offsets_m**2, axis=1) - along_m**2)
        met = (half_chord_m2 >= 0.0) & (along_m > 0.0)
        to_robots_m = np.where(met, along_m - np.sqrt(np.maximum(half_chord_m2, 0.0)), math.inf)
        nearest_m = np.fmin(to_solid_m, to_robots_m.min(axis=1, initial=math.inf))
        return np.where(nearest_m <= range_max_m, nearest_m, range_max_m)


@pytest.mark.slow
@pytest.mark.parametrize("stair_door_closed", [True, False])
@pytest.mark.parametrize(
    "model",
    [LaserModel(), LaserModel(beams=97, angle_min_rad=-3.1, angle_max_rad=3.1, range_max_m=30.0, forward_m=-0.15)],
    ids=["default", "all round and far"],
)
def test_ranges_in_the_garage_are_those_of_exact_intersections(scattered_robots, model, stair_door_closed):
    plan = load("garage_sar").plan
    generator = np.random.default_rng(21)
    world = World(plan, scattered_robots(plan, 25, generator, laser=model), Run())
    world.set_door("stair_door", stair_door_closed)
    closed = {name: door.closed for name, door in world.door_states().items()}
    laser, solid = LaserBeams(model, world), obstacles(plan, closed)
    returns = 0
    for robot_id, pose in enumerate(world.poses()):
        scene = Scene(solid, np.delete(world.positions_m(), robot_id, axis=0), 0.2)
        origin = pose @ Pose(model.forward_m, 0.0, 0.0)
        angles_rad = pose.yaw_rad + np.linspace(model.angle_min_rad, model.angle_max_rad, model.beams)
        # Just beside an edge ranges jump, so a beam may see either side of its angle.
        seen_m = [scene.ranges_m(origin, angles_rad + shift, model.range_max_m) for shift in (-1e-7, 0.0, 1e-7)]
        ranges_m = laser.scan([robot_id], [generator])[0]
        assert (ranges_m >= np.min(seen_m, axis=0) - 1e-4).all()
        assert (ranges_m <= np.max(seen_m, axis=0) + 1e-4).all()
        returns += np.count_nonzero(ranges_m < model.range_max_m)
    assert returns > 25 * model.beams / 10


def test_ranges_between_robots_equal_the_hand_calculation():
    # Face to face, 3 m apart: 3 m less a laser 0.1 m ahead of the middle and a radius of 0.2 m.
    robots = [PlacedRobot(start_pose=(1.0, 5.0, 0.0)), PlacedRobot(start_pose=(4.0, 5.0, math.pi))]
    world = World(WALL_AHEAD, robots, Run())
    laser, generator = LaserBeams(LaserModel(), world), np.random.default_rng(1)
    first, second = laser.scan([0, 1], [generator, generator])
    assert first[90] == second[90] == np.float32(2.7)
    np.testing.assert_allclose(first[87:94], second[87:94][::-1], atol=1e-5)
    # The disc spans asin(0.2 / 2.9) = 3.96 degrees to either side.
    assert np.flatnonzero(first < 3.0).tolist() == list(range(87, 94))


def test_wall_ahead_returns_its_distance_over_the_cosine_until_range_max():
    world = World(WALL_AHEAD, [PlacedRobot(start_pose=(3.3, 10.0, 0.0))], Run())
    ranges_m = LaserBeams(LaserModel(), world).scan([0], [np.random.default_rng(1)])[0]
    assert ranges_m[90] == np.float32(2.5)
    assert ranges_m[[30, 150]] == pytest.approx(5.0)  # 60 degrees
    assert ranges_m[135] == pytest.approx(2.5 * math.sqrt(2.0))
    assert (ranges_m[:30] == 5.0).all()
    assert (ranges_m[151:] == 5.0).all()


def test_moved_robot_senses_its_new_place():
    world = World(WALL_AHEAD, [PlacedRobot(start_pose=(3.3, 10.0, 0.0))], Run())
    laser, generator = LaserBeams(LaserModel(), world), np.random.default_rng(1)
    laser.scan([0], [generator])
    world.set_pose(0, Pose(4.3, 10.0, 0.0))
    assert laser.scan([0], [generator])[0, 90] == np.float32(1.5)


def test_scan_draws_one_number_per_beam_and_none_without_noise():
    world = World(WALL_AHEAD, [PlacedRobot(start_pose=(3.3, 10.0, 0.0))], Run())
    generator, expected = np.random.default_rng(3), np.random.default_rng(3)
    LaserBeams(LaserModel(), world).scan([0], [generator])
    assert generator.bit_generator.state == expected.bit_generator.state
    LaserBeams(LaserModel(beams=7, noise_m=0.1), world).scan([0], [generator])
    expected.normal(size=7)
    assert generator.bit_generator.state == expected.bit_generator.state


def test_noise_of_a_laser_is_its_own_and_does_not_depend_on_other_robots():
    def ranges_m(count: int) -> list[np.ndarray]:
        robots = [
            PlacedRobot(start_pose=(3.3, 2.0 + 7.0 * i, 0.0), laser=LaserModel(noise_m=0.1)) for i in range(count)
        ]
        world = World(WALL_AHEAD, robots, Run())
        world.step([Twist()] * count)
        return [reading.ranges_m for reading in RobotSensors(world, robots, seed=4).read()]

    two, three = ranges_m(2), ranges_m(3)
    assert np.array_equal(two[0], three[0])
    assert np.array_equal(two[1], three[1])
    # All look at the same long wall from the same distance.
    assert abs(three[0][60:120] - three[1][60:120]).min() > 0.0


def test_no_return_and_too_near_read_as_in_the_model():
    world = World(WALL_AHEAD, [PlacedRobot(start_pose=(5.7, 5.0, 0.0))], Run())
    view = {"beams": 2, "angle_min_rad": 0.0, "angle_max_rad": math.pi, "range_min_m": 0.15}
    as_stage = LaserBeams(LaserModel(**view), world).scan([0], ())[0]
    assert as_stage.dtype == np.float32
    np.testing.assert_array_equal(as_stage, np.float32([0.15, 5.0]))
    as_rep_117 = LaserBeams(LaserModel(**view, no_return="inf"), world).scan([0], ())[0]
    assert as_rep_117.tolist() == [-math.inf, math.inf]


def test_noise_has_its_standard_deviation_and_touches_only_returns():
    world = World(WALL_AHEAD, [PlacedRobot(start_pose=(3.9, 5.0, 0.0))], Run())
    model = LaserModel(beams=2, angle_min_rad=0.0, angle_max_rad=math.pi, forward_m=0.0, noise_m=0.05)
    laser, generator = LaserBeams(model, world), np.random.default_rng(1)
    scans = np.concatenate([laser.scan([0], [generator]) for _ in range(4000)])
    assert scans[:, 0].mean() == pytest.approx(2.0, abs=0.003)
    assert scans[:, 0].std() == pytest.approx(0.05, rel=0.05)
    assert (scans[:, 1] == 5.0).all()
