import math

import numpy as np
import pytest
import shapely

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Laser, MountedLaser
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

PLAN = FloorPlan(
    name="room",
    bounds=Bounds(max=(12.0, 9.0)),
    walls=(
        Wall(name="south", start=(0.0, 0.1), end=(12.0, 0.1)),
        Wall(name="north", start=(0.0, 8.9), end=(12.0, 8.9), thickness_m=0.1),
        Wall(name="slanted", start=(8.0, 2.0), end=(11.0, 7.0)),
    ),
    blocks=(Block(name="crate", polygon=((2.0, 6.0), (3.0, 6.2), (2.6, 7.1))),),
)
POSES = (Pose(5.0, 4.0, 0.4), Pose(6.1, 5.2, -2.0), Pose(3.3, 2.0, 3.0))
REAR = MountedLaser(name="rear", forward_m=-0.15, left_m=0.1, yaw_rad=2.5, beams=37, range_max_m=4.0, range_min_m=0.0)


def robots(**fields: object) -> list[PlacedRobot]:
    return [PlacedRobot(start_pose=(pose.x_m, pose.y_m, pose.yaw_rad), **fields) for pose in POSES]


def run(team: list[PlacedRobot], steps: int, seed: int = 1) -> list[list[RobotReading]]:
    world = World(PLAN, team, Run())
    sensors = RobotSensors(world, team, seed)
    record = []
    for _ in range(steps):
        world.step([Twist(0.2, 0.0, 0.5)] * len(team))
        record.append(list(sensors.read()))
    return record


def scene_of(readings: list[RobotReading], robot_id: int) -> shapely.Geometry:
    """Return the edges that the beams of a robot can meet."""
    places = [(reading.ground_truth.x_m, reading.ground_truth.y_m) for reading in readings]
    discs = [shapely.Point(place).buffer(0.2, quad_segs=512) for other, place in enumerate(places) if other != robot_id]
    return shapely.union_all([obstacles(PLAN), *discs]).boundary


def cast(scene: shapely.Geometry, mount: Pose, angle_rad: float, range_max_m: float) -> float:
    """Return how far a ray from a mount in `map` goes at an angle of its own, range_max where it meets nothing [m]."""
    end = mount @ Pose(0.0, 0.0, angle_rad) @ Pose(range_max_m, 0.0, 0.0)
    hit = shapely.LineString([(mount.x_m, mount.y_m), (end.x_m, end.y_m)]).intersection(scene)
    return range_max_m if hit.is_empty else hit.distance(shapely.Point(mount.x_m, mount.y_m))


def test_ranges_of_an_additional_laser_equal_those_of_shapely():
    readings = run(robots(sensors=(REAR,)), steps=15)[-1]
    seen = 0
    for robot_id, reading in enumerate(readings):
        mount = reading.ground_truth.pose @ Pose(REAR.forward_m, REAR.left_m, REAR.yaw_rad)
        scene = scene_of(readings, robot_id)
        angles_rad = np.linspace(REAR.angle_min_rad, REAR.angle_max_rad, REAR.beams)
        expected_m = [cast(scene, mount, angle_rad, 4.0) for angle_rad in angles_rad]
        ranges_m = reading.sensors["rear"]
        np.testing.assert_allclose(ranges_m, expected_m, atol=1e-4)
        seen += np.count_nonzero(ranges_m < 4.0)
    assert seen > 30


def test_additional_laser_where_the_first_one_is_sees_the_same():
    same = MountedLaser(name="twin", **Laser().model_dump())
    for reading in run(robots(sensors=(same,)), steps=3)[-1]:
        np.testing.assert_array_equal(reading.sensors["twin"], reading.ranges_m)


def test_laser_turned_right_round_sees_what_is_behind():
    view = {"beams": 3, "range_max_m": 15.0}
    ahead, behind = (MountedLaser(name=f"l{i}", forward_m=0.0, yaw_rad=i * math.pi, **view) for i in (0, 1))
    left_behind_right = MountedLaser(
        name="wide", forward_m=0.0, **view, angle_min_rad=math.pi / 2.0, angle_max_rad=3.0 * math.pi / 2.0
    )
    differences_m = []
    for reading in run(robots(sensors=(ahead, behind, left_behind_right)), steps=2)[-1]:
        first, second, wide = reading.sensors.values()
        np.testing.assert_allclose(second, wide, atol=1e-5)
        np.testing.assert_allclose(first[[0, 2]], second[[2, 0]], atol=1e-5)
        differences_m.append(abs(first[1] - second[1]))
    assert max(differences_m) > 1.0


def test_additional_lasers_leave_the_noise_of_others_alone():
    noisy = Laser(noise_m=0.02)
    a, b = (MountedLaser(name=name, noise_m=0.02, forward_m=0.1) for name in "ab")
    alone = run(robots(laser=noisy), steps=5)
    one = run(robots(laser=noisy, sensors=(b,)), steps=5)
    two = run(robots(laser=noisy, sensors=(a, b)), steps=5)
    for first, second, third in zip(alone, one, two, strict=True):
        for x, y, z in zip(first, second, third, strict=True):
            np.testing.assert_array_equal(x.ranges_m, y.ranges_m)
            np.testing.assert_array_equal(x.ranges_m, z.ranges_m)
            np.testing.assert_array_equal(y.sensors["b"], z.sensors["b"])
            assert (x.odometry, x.ground_truth) == (z.odometry, z.ground_truth)
            assert np.abs(z.sensors["a"] - z.sensors["b"]).max() > 0.01


def test_noise_of_an_additional_laser_has_its_deviation():
    (exact,), (noisy,) = (
        [np.array([r.sensors["rear"] for step in run(robots(sensors=(laser,)), steps=40) for r in step])]
        for laser in (REAR, REAR.model_copy(update={"noise_m": 0.03}))
    )
    inside = (exact > 0.2) & (exact < 3.8)
    errors_m = (noisy - exact)[inside]
    assert errors_m.size > 1000
    assert errors_m.mean() == pytest.approx(0.0, abs=5.0 * 0.03 / math.sqrt(errors_m.size))
    assert errors_m.std() == pytest.approx(0.03, rel=5.0 / math.sqrt(2.0 * errors_m.size))


def test_laser_scans_in_its_own_steps_only():
    laser = MountedLaser(name="slow", every_steps=4)
    record = run(robots(sensors=(laser,)), steps=9)
    assert [step for step, readings in enumerate(record, start=1) if "slow" in readings[0].sensors] == [4, 8]


def test_robots_without_additional_sensors_have_no_readings():
    mixed = robots()
    mixed[1] = mixed[1].model_copy(update={"sensors": (REAR,)})
    readings = run(mixed, steps=1)[0]
    assert [len(reading.sensors) for reading in readings] == [0, 1, 0]
    assert run(robots(), steps=1)[0][0].sensors == {}
