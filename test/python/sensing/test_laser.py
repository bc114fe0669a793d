import math

import numpy as np
import pytest
import shapely

from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Laser as LaserModel
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.sensing.beams import Laser
from robotteamsim.world import World


def random_plan(generator: np.random.Generator) -> FloorPlan:
    walls = []
    for i in range(25):
        x, y, angle = generator.uniform(1.0, 19.0), generator.uniform(1.0, 14.0), generator.uniform(0.0, math.tau)
        length = generator.uniform(0.5, 4.0)
        end = (x + length * math.cos(angle), y + length * math.sin(angle))
        walls.append(Wall(name=f"w{i}", start=(x, y), end=end, thickness_m=generator.uniform(0.05, 0.5)))
    blocks = (Block(name="b", polygon=((9.0, 6.0), (12.0, 6.0), (12.0, 7.0), (10.0, 7.0), (10.0, 9.0), (9.0, 9.0))),)
    doors = (
        Door(name="closed", start=(4.0, 4.0), end=(4.0, 5.0), closed=True),
        Door(name="open", start=(15.0, 4.0), end=(15.0, 5.0)),
    )
    return FloorPlan(
        name="random", bounds=Bounds(min=(-5.0, -5.0), max=(25.0, 20.0)), walls=walls, blocks=blocks, doors=doors
    )


def free_poses(plan: FloorPlan, generator: np.random.Generator, count: int) -> list[Pose]:
    solid, poses = obstacles(plan), []
    while len(poses) < count:
        x, y = generator.uniform(0.3, 19.7), generator.uniform(0.3, 14.7)
        taken = any(math.dist((x, y), (pose.x_m, pose.y_m)) < 0.45 for pose in poses)
        if not taken and solid.distance(shapely.Point(x, y)) > 0.25:
            poses.append(Pose(x, y, generator.uniform(-math.pi, math.pi)))
    return poses


def world_at(plan: FloorPlan, poses: list[Pose]) -> World:
    robots = [PlacedRobot(start_pose=(pose.x_m, pose.y_m, pose.yaw_rad)) for pose in poses]
    return World(plan, robots, Run())


def shapely_range(scene: shapely.Geometry, origin: Pose, angle_rad: float, range_max_m: float) -> float:
    end = (origin.x_m + range_max_m * math.cos(angle_rad), origin.y_m + range_max_m * math.sin(angle_rad))
    hit = shapely.LineString([(origin.x_m, origin.y_m), end]).intersection(scene)
    return range_max_m if hit.is_empty else hit.distance(shapely.Point(origin.x_m, origin.y_m))


@pytest.mark.slow
def test_ranges_are_those_that_shapely_finds():
    generator = np.random.default_rng(11)
    model = LaserModel(beams=61, angle_min_rad=-2.5, angle_max_rad=3.0, range_min_m=0.0, forward_m=0.1)
    for _ in range(5):
        plan = random_plan(generator)
        world = world_at(plan, free_poses(plan, generator, 12))
        scans = Laser(model, world).scan(range(world.num_robots), ())
        for robot_id, pose in enumerate(world.poses()):
            others = [
                shapely.Point(other.x_m, other.y_m).buffer(0.2, quad_segs=256)
                for other_id, other in enumerate(world.poses())
                if other_id != robot_id
            ]
            scene = shapely.union_all([obstacles(plan), *others]).boundary
            origin = pose @ Pose(model.forward_m, 0.0, 0.0)
            angles_rad = pose.yaw_rad + np.linspace(model.angle_min_rad, model.angle_max_rad, model.beams)
            expected_m = [shapely_range(scene, origin, angle_rad, model.range_max_m) for angle_rad in angles_rad]
            np.testing.assert_allclose(scans[robot_id], expected_m, atol=1e-4)


def test_no_return_and_too_near_read_as_in_the_model():
    plan = FloorPlan(
        name="wall", bounds=Bounds(max=(20.0, 10.0)), walls=(Wall(name="w", start=(4.1, 1.0), end=(4.1, 9.0)),)
    )
    world = world_at(plan, [Pose(3.8, 5.0, 0.0)])
    view = {"beams": 2, "angle_min_rad": 0.0, "angle_max_rad": math.pi, "range_min_m": 0.15}
    as_stage = Laser(LaserModel(**view), world).scan([0], ())[0]
    assert as_stage.dtype == np.float32
    np.testing.assert_array_equal(as_stage, np.float32([0.15, 5.0]))
    as_rep_117 = Laser(LaserModel(**view, no_return="inf"), world).scan([0], ())[0]
    assert as_rep_117.tolist() == [-math.inf, math.inf]


def test_door_returns_beams_only_while_closed():
    plan = FloorPlan(
        name="door", bounds=Bounds(max=(20.0, 10.0)), doors=(Door(name="d", start=(4.0, 1.0), end=(4.0, 9.0)),)
    )
    world = world_at(plan, [Pose(2.0, 5.0, 0.0)])
    laser = Laser(LaserModel(beams=1, angle_min_rad=0.0, angle_max_rad=1.0, forward_m=0.0), world)
    assert laser.scan([0], ())[0, 0] == 5.0
    world.set_door("d", True)
    assert laser.scan([0], ())[0, 0] == pytest.approx(1.97)


def test_noise_has_its_standard_deviation_and_touches_only_returns():
    plan = FloorPlan(
        name="wall", bounds=Bounds(max=(20.0, 10.0)), walls=(Wall(name="w", start=(4.1, 1.0), end=(4.1, 9.0)),)
    )
    world = world_at(plan, [Pose(2.0, 5.0, 0.0)])
    model = LaserModel(beams=2, angle_min_rad=0.0, angle_max_rad=math.pi, forward_m=0.0, noise_m=0.05)
    laser, generator = Laser(model, world), np.random.default_rng(1)
    scans = np.concatenate([laser.scan([0], [generator]) for _ in range(4000)])
    assert scans[:, 0].mean() == pytest.approx(2.0, abs=0.003)
    assert scans[:, 0].std() == pytest.approx(0.05, rel=0.05)
    assert (scans[:, 1] == 5.0).all()
