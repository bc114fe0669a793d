import math

import numpy as np
import pytest
import shapely

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Sonar
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

WALL = FloorPlan(
    name="wall", bounds=Bounds(max=(20.0, 10.0)), walls=(Wall(name="w", start=(10.1, 0.0), end=(10.1, 10.0)),)
)


def boxes(generator: np.random.Generator) -> FloorPlan:
    places = generator.uniform((0.5, 0.5), (18.0, 8.0), (20, 2)).tolist()
    blocks = tuple(
        Block(name=f"b{i}", polygon=((x, y), (x + 0.8, y + 0.2), (x + 0.6, y + 0.9))) for i, (x, y) in enumerate(places)
    )
    return FloorPlan(name="boxes", bounds=Bounds(max=(20.0, 10.0)), blocks=blocks)


def world_of(plan: FloorPlan, *poses: Pose) -> World:
    robots = [PlacedRobot(start_pose=(pose.x_m, pose.y_m, pose.yaw_rad)) for pose in poses]
    return World(plan, robots, Run())


def read(model: Sonar, world: World, robot_id: int = 0) -> float:
    robots = [PlacedRobot(start_pose=(0.0, 0.0, 0.0), sensors=(model,))] * world.num_robots
    return float(RobotSensors(world, robots, seed=1).read()[robot_id].sensors[model.name])


def test_sonar_that_looks_at_a_wall_askew_reads_its_nearest_edge():
    # The cone reaches from 0.6 - 0.25 to 0.6 + 0.25 off the normal.
    model = Sonar(name="s", opening_rad=0.5, yaw_rad=0.6)
    assert read(model, world_of(WALL, Pose(8.0, 5.0, 0.0))) == pytest.approx(2.0 / math.cos(0.35), abs=1e-6)
    narrow = model.model_copy(update={"opening_rad": 0.02})
    assert read(narrow, world_of(WALL, Pose(8.0, 5.0, 0.0))) == pytest.approx(2.0 / math.cos(0.59), abs=1e-6)


def test_sonar_reads_its_limits_beyond_them():
    model = Sonar(name="s", range_min_m=0.5, range_max_m=1.5)
    ranges_m = [read(model, world_of(WALL, Pose(10.0 - distance_m, 5.0, 0.0))) for distance_m in (0.3, 1.0, 1.6)]
    assert ranges_m == pytest.approx([0.5, 1.0, 1.5], abs=1e-6)


@pytest.mark.slow
def test_sonar_reads_the_nearest_point_of_its_cone_that_shapely_finds():
    generator = np.random.default_rng(4)
    plan = boxes(generator)
    solid = obstacles(plan)
    model = Sonar(name="s", forward_m=0.1, left_m=-0.1, yaw_rad=2.0, opening_rad=0.6, rays=400, range_max_m=4.0)
    checked = 0
    while checked < 60:
        x, y = generator.uniform((0.5, 0.5), (19.5, 9.5))
        pose = Pose(x, y, generator.uniform(-math.pi, math.pi))
        if solid.distance(shapely.Point(x, y)) < 0.25:
            continue
        mount = pose @ Pose(model.forward_m, model.left_m, model.yaw_rad)
        arc = [mount @ Pose(0.0, 0.0, angle) @ Pose(4.0, 0.0, 0.0) for angle in np.linspace(-0.3, 0.3, 2000)]
        cone = shapely.Polygon([(mount.x_m, mount.y_m), *((place.x_m, place.y_m) for place in arc)])
        seen = cone.intersection(solid)
        expected_m = 4.0 if seen.is_empty else seen.distance(shapely.Point(mount.x_m, mount.y_m))
        measured_m = read(model, world_of(plan, pose))
        # Rays are 1.5 mrad apart: a corner between two of them is met up to 6 mm beside its tip.
        assert expected_m - 1e-5 <= measured_m <= expected_m + 0.03
        checked += measured_m < 4.0


def test_sonar_sees_robots_but_not_its_own():
    world = world_of(WALL, Pose(5.0, 5.0, 0.0), Pose(6.5, 5.1, 0.0))
    expected_m = math.hypot(1.5, 0.1) - 0.2
    assert read(Sonar(name="s", rays=501), world) == pytest.approx(expected_m, abs=1e-4)


def test_noise_of_a_sonar_has_its_deviation_and_a_stream_of_its_own():
    ring = tuple(Sonar(name=f"s{i}", noise_m=0.02, yaw_rad=0.1 * i) for i in range(2))

    def run(*sonars: Sonar) -> np.ndarray:
        robots = [PlacedRobot(start_pose=(8.0, 5.0, 0.0), sensors=sonars)]
        world = World(WALL, robots, Run())
        sensors = RobotSensors(world, robots, seed=2)
        record = []
        for _ in range(2000):
            world.step([Twist()])
            record.append(list(sensors.read()[0].sensors.values()))
        return np.array(record)

    both = run(*ring)
    np.testing.assert_array_equal(run(ring[1])[:, 0], both[:, 1])
    assert both.std(axis=0) == pytest.approx(0.02, rel=5.0 / math.sqrt(2.0 * 2000))
    assert both.mean(axis=0) == pytest.approx(2.0, abs=5.0 * 0.02 / math.sqrt(2000))
    assert abs(np.corrcoef(both.T)[0, 1]) < 0.1
