import math

import numpy as np
import pytest

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.scenario.sections import Odometry as OdometryModel
from robotteamsim.sensing.odometry import TeamOdometry
from robotteamsim.sensing.readings import OdometryReading

STEP_S = 0.1
EXACT = OdometryModel(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
MODEL = OdometryModel(alpha1=0.04, alpha2=0.01, alpha3=0.02, alpha4=0.03)


class Odometry:
    """That of a team of one."""

    def __init__(self, model: OdometryModel = MODEL, seed: int = 1) -> None:
        self._team = TeamOdometry([model], STEP_S, [np.random.default_rng(seed)])

    def step(self, motion: Pose, twist: Twist) -> OdometryReading:
        motions = np.array([[motion.x_m, motion.y_m, motion.yaw_rad]])
        twists = np.array([[twist.linear_x_mps, twist.linear_y_mps, twist.angular_z_radps]])
        row = self._team.step(motions, twists)[0].tolist()
        return OdometryReading(PoseReading(*row[:4]), Twist(*row[4:]))


def arc(speed_mps: float, turn_radps: float) -> tuple[Pose, Twist]:
    """Return way and twist of a step at constant speed."""
    half_rad = 0.5 * turn_radps * STEP_S
    chord_m = speed_mps * STEP_S * (math.sin(half_rad) / half_rad if half_rad else 1.0)
    way = Pose(chord_m * math.cos(half_rad), chord_m * math.sin(half_rad), 2.0 * half_rad)
    return way, Twist(speed_mps, 0.0, turn_radps)


def last_pose(motion: Pose, twist: Twist, steps: int, model: OdometryModel = MODEL, seed: int = 1) -> Pose:
    robot = Odometry(model, seed)
    for _ in range(steps):
        reading = robot.step(motion, twist)
    return reading.pose.pose


@pytest.mark.parametrize("speed_mps", [0.5, -0.5])
def test_odometry_without_noise_is_the_true_way(speed_mps):
    motion, twist = arc(speed_mps, 0.8)
    true = Pose(0.0, 0.0, 0.0)
    robot = Odometry(EXACT)
    for _ in range(200):
        true = true @ motion
        reading = robot.step(motion, twist)
        pose = reading.pose.pose
        assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((true.x_m, true.y_m, true.yaw_rad), abs=1e-9)
        assert reading.twist == twist


def test_odometry_without_noise_follows_a_robot_that_slides_sideways():
    robot = Odometry(EXACT)
    pose = robot.step(Pose(0.01, -0.03, 0.1), Twist(0.1, -0.3, 1.0)).pose.pose
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((0.01, -0.03, 0.1), abs=1e-12)


def test_odometry_of_a_robot_that_stands_still_stands_still():
    pose = last_pose(Pose(0.0, 0.0, 0.0), Twist(), steps=500)
    assert pose == Pose(0.0, 0.0, 0.0)


def test_drift_of_a_straight_step_has_the_models_variances():
    motion, twist = arc(0.5, 0.0)
    poses = [last_pose(motion, twist, steps=1, seed=seed) for seed in range(4000)]
    lengths_m = np.array([math.hypot(pose.x_m, pose.y_m) for pose in poses])
    yaws_rad = np.array([pose.yaw_rad for pose in poses])
    assert lengths_m.mean() == pytest.approx(0.05, abs=5e-4)
    assert lengths_m.var() == pytest.approx(0.02 * 0.05**2, rel=0.1)
    assert yaws_rad.mean() == pytest.approx(0.0, abs=5e-4)
    assert yaws_rad.var() == pytest.approx(2 * 0.01 * 0.05**2, rel=0.1)  # of both turns


def test_drift_of_a_turn_on_the_spot_has_the_models_variances():
    motion, twist = arc(0.0, 1.0)
    poses = [last_pose(motion, twist, steps=1, seed=seed) for seed in range(4000)]
    yaws_rad = np.array([pose.yaw_rad for pose in poses])
    assert yaws_rad.mean() == pytest.approx(0.1, abs=2e-3)
    assert yaws_rad.var() == pytest.approx(0.04 * 0.1**2, rel=0.1)
    assert np.array([pose.x_m for pose in poses]).var() == pytest.approx(0.03 * 0.1**2, rel=0.1)


def test_drift_has_no_bias_over_a_long_straight_way():
    motion, twist = arc(0.5, 0.0)
    model = OdometryModel(alpha1=0.0, alpha2=0.0, alpha3=0.02, alpha4=0.0)
    ends_m = np.array([last_pose(motion, twist, steps=100, model=model, seed=seed).x_m for seed in range(400)])
    spread_m = math.sqrt(100 * 0.02) * 0.05
    assert ends_m.mean() == pytest.approx(5.0, abs=4 * spread_m / math.sqrt(400))
    assert ends_m.std() == pytest.approx(spread_m, rel=0.15)


def test_robot_that_is_pushed_aside_turns_no_more_than_its_body():
    motion = Pose(0.0, 0.03, 0.0)
    yaws_rad = [last_pose(motion, Twist(0.0, 0.3, 0.0), steps=1, seed=seed).yaw_rad for seed in range(2000)]
    assert np.var(yaws_rad) == pytest.approx(2 * 0.01 * 0.03**2, rel=0.15)


def test_twist_carries_the_noise_of_the_pose():
    motion, twist = arc(0.5, 0.0)
    reading = Odometry().step(motion, twist)
    pose = reading.pose.pose
    assert reading.twist.linear_x_mps == pytest.approx(math.hypot(pose.x_m, pose.y_m) / STEP_S)
    assert reading.twist.angular_z_radps == pytest.approx(pose.yaw_rad / STEP_S)
    assert reading.twist != twist
