import math

import numpy as np
import pytest
from robotteamsim._core.sensing import Lasers, RangeLimits, TeamSensors
from robotteamsim._core.state import State
from robotteamsim._core.world import Fan

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.scenario.sections import Odometry as OdometryModel
from robotteamsim.sensing.readings import OdometryReading

STEP_S = 0.1
YAW_YAW = -1
"""The place of the yaw's variance in a covariance: the last one."""
EXACT = OdometryModel(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
MODEL = OdometryModel(alpha1=0.04, alpha2=0.01, alpha3=0.02, alpha4=0.03)
SMALL = OdometryModel(alpha1=0.004, alpha2=0.001, alpha3=0.002, alpha4=0.003)


def arc(speed_mps: float, turn_radps: float, step_s: float = STEP_S) -> tuple[Pose, Twist]:
    """Return way and twist of a step at constant speed."""
    half_rad = 0.5 * turn_radps * step_s
    chord_m = speed_mps * step_s * (math.sin(half_rad) / half_rad if half_rad else 1.0)
    way = Pose(chord_m * math.cos(half_rad), chord_m * math.sin(half_rad), 2.0 * half_rad)
    return way, Twist(speed_mps, 0.0, turn_radps)


class Team:
    """The odometry of robots whose motions a test gives."""

    def __init__(
        self, model: OdometryModel, generators: list[np.random.Generator], *, omni: bool = False, step_s: float = STEP_S
    ) -> None:
        robots, alphas = len(generators), (model.alpha1, model.alpha2, model.alpha3, model.alpha4)
        fan = Fan(beams=1, angle_min_rad=0.0, angle_max_rad=0.0, forward_m=0.0, left_m=0.0, range_max_m=1.0)
        limits = RangeLimits(range_min_m=0.0, range_max_m=1.0, too_near_m=0.0, no_return_m=1.0)
        lasers = [Lasers(fan, limits, range(robots))]
        self._sensors = TeamSensors(lasers, [alphas] * robots, step_s, [omni] * robots)
        self._generators, self._robots = generators, robots

    def step(self, motion: Pose, twist: Twist) -> State:
        """Let all robots make the same way."""
        state, poses, still = State(self._robots, 1), np.zeros((self._robots, 3)), np.zeros(self._robots, bool)
        motions = np.tile([motion.x_m, motion.y_m, motion.yaw_rad], (self._robots, 1))
        twists = np.tile([twist.linear_x_mps, twist.linear_y_mps, twist.angular_z_radps], (self._robots, 1))
        ranges_m = np.ones((self._robots, 1))
        self._sensors.add_noise(np.hstack([generator.standard_normal((1, 3)) for generator in self._generators]))
        self._sensors.read_motion(state, poses, twists, motions, still, {}, [ranges_m])
        return state


def drive(ways: list[tuple[Pose, Twist]], model: OdometryModel, robots: int = 1, *, omni: bool = False) -> State:
    """Return the last readings of robots that made the same ways."""
    team = Team(model, [np.random.default_rng([5, seed]) for seed in range(robots)], omni=omni)
    for motion, twist in ways:
        state = team.step(motion, twist)
    return state


def pose_of(readings: State) -> tuple[float, float, float]:
    """Return the pose of the first robot."""
    pose = readings[0].odometry.pose.pose
    return pose.x_m, pose.y_m, pose.yaw_rad


@pytest.mark.parametrize("turn_radps", [0.0, 0.8])
@pytest.mark.parametrize("step_s", [0.02, 0.05, 0.2])
def test_a_drive_drifts_alike_in_steps_of_any_length(step_s, turn_radps):
    # In 8 s, first forwards, then along an arc.
    covariances = []
    for length_s in (STEP_S, step_s):
        team = Team(SMALL, [np.random.default_rng(5)], step_s=length_s)
        for motion, twist in [arc(0.5, 0.0, length_s), arc(0.5, turn_radps, length_s)]:
            for _ in range(round(4.0 / length_s)):
                state = team.step(motion, twist)
        covariances.append(state[0].odometry.pose_covariance)
    assert covariances[0] == pytest.approx(covariances[1], rel=0.1, abs=2e-4)


@pytest.mark.parametrize("steps", [1, 7, 200])
@pytest.mark.parametrize("speed_mps", [0.5, -0.5])
def test_odometry_without_noise_is_the_true_path(speed_mps, steps):
    motion, twist = arc(speed_mps, 0.8)
    true = Pose(0.0, 0.0, 0.0)
    for _ in range(steps):
        true = true @ motion
    readings = drive([(motion, twist)] * steps, EXACT)
    assert pose_of(readings) == pytest.approx((true.x_m, true.y_m, true.yaw_rad), abs=1e-9)
    assert readings[0].odometry.twist == twist


def test_odometry_without_noise_follows_a_robot_that_slides_sideways():
    readings = drive([(Pose(0.01, -0.03, 0.1), Twist(0.1, -0.3, 1.0))], EXACT)
    assert pose_of(readings) == pytest.approx((0.01, -0.03, 0.1), abs=1e-12)


def test_odometry_of_a_robot_at_rest_does_not_move():
    assert pose_of(drive([(Pose(0.0, 0.0, 0.0), Twist())] * 500, MODEL)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("speed_mps", "turn_radps"),
    [(0.5, 0.0), (0.0, 1.0), (0.6, 1.2), (-0.6, 1.2)],
    ids=["straight", "turn on the spot", "forwards", "backwards"],
)
def test_drift_of_a_step_has_the_variances_of_the_formula(speed_mps, turn_radps):
    # An arc is a turn by half its angle, its chord, and the other half; a turn on the spot is a single turn.
    samples, model, (motion, twist) = 5000, SMALL, arc(speed_mps, turn_radps)
    ends = [reading.odometry.pose.pose for reading in drive([(motion, twist)], model, robots=samples)]
    chord_m, turns_rad = math.hypot(motion.x_m, motion.y_m), (0.5 * motion.yaw_rad,) * 2 if speed_mps else (0.1,)
    of_turns_rad2 = sum(model.alpha1 * turn_rad**2 + model.alpha2 * chord_m**2 for turn_rad in turns_rad)
    of_length_m2 = model.alpha3 * chord_m**2 + model.alpha4 * sum(turn_rad**2 for turn_rad in turns_rad)
    yaws_rad = np.array([end.yaw_rad for end in ends])
    along_m = np.array([math.copysign(math.hypot(end.x_m, end.y_m), end.x_m) for end in ends])
    # Five standard errors: that of a variance of normal numbers is sqrt(2 / samples) of it.
    within = 5.0 * math.sqrt(2.0 / samples)
    assert yaws_rad.var() == pytest.approx(of_turns_rad2, rel=within)
    assert yaws_rad.mean() == pytest.approx(motion.yaw_rad, abs=5.0 * math.sqrt(of_turns_rad2 / samples))
    assert along_m.var() == pytest.approx(of_length_m2, rel=within)
    assert along_m.mean() == pytest.approx(
        math.copysign(chord_m, speed_mps), abs=5.0 * math.sqrt(of_length_m2 / samples)
    )
    if speed_mps:
        sign = math.copysign(1.0, speed_mps)
        course_rad = np.array([math.atan2(sign * end.y_m, sign * end.x_m) for end in ends])
        assert course_rad.var() == pytest.approx(0.5 * of_turns_rad2, rel=within)


@pytest.mark.parametrize("omni", [False, True])
@pytest.mark.parametrize(("x_m", "y_m"), [(0.0, -0.0), (-0.0, 0.0), (-0.0, -0.0)])
def test_turn_on_the_spot_adds_noise_once_for_any_sign_of_zero(x_m, y_m, omni):
    # 100 turns of 0.05 rad: the yaw variance is 100 * alpha1 * 0.05^2 = 0.01 rad^2.
    turn = (Pose(x_m, y_m, 0.05), Twist(0.0, 0.0, 0.5))
    usual = (Pose(0.0, 0.0, 0.05), Twist(0.0, 0.0, 0.5))
    readings = drive([turn] * 100, MODEL, robots=3, omni=omni)
    assert [row[YAW_YAW] for row in readings.odometry_pose_covariance] == pytest.approx([0.01] * 3, rel=1e-12)
    usually = drive([usual] * 100, MODEL, robots=3, omni=omni)
    assert [reading.odometry for reading in readings] == [reading.odometry for reading in usually]


@pytest.mark.parametrize(("x_m", "y_m"), [(1e-5, 1e-5), (-1e-5, 1e-5), (7e-6, -1e-5)])
def test_turn_on_the_spot_is_charged_once_however_the_wheels_slip(x_m, y_m):
    readings = drive([(Pose(x_m, y_m, 0.05), Twist(0.0, 0.0, 0.5))] * 100, MODEL)
    assert readings.odometry_pose_covariance[0, YAW_YAW] == pytest.approx(0.01, rel=1e-4)


def test_drift_has_no_bias_over_a_long_straight_path():
    model = OdometryModel(alpha1=0.0, alpha2=0.0, alpha3=0.02, alpha4=0.0)
    ends_m = drive([arc(0.5, 0.0)] * 100, model, robots=400).odometry_pose[:, 0]
    spread_m = math.sqrt(100 * 0.02) * 0.05
    assert ends_m.mean() == pytest.approx(5.0, abs=4 * spread_m / math.sqrt(400))
    assert ends_m.std() == pytest.approx(spread_m, rel=0.15)


def test_robot_that_is_pushed_aside_turns_no_more_than_its_body():
    _, _, qz, qw = drive([(Pose(0.0, 0.03, 0.0), Twist(0.0, 0.3, 0.0))], MODEL, robots=2000).odometry_pose.T
    assert np.var(2.0 * np.arctan2(qz, qw)) == pytest.approx(2 * 0.01 * 0.03**2, rel=0.15)


def test_twist_carries_the_noise_of_the_pose():
    motion, twist = arc(0.5, 0.0)
    reading = drive([(motion, twist)], MODEL)[0].odometry
    pose = reading.pose.pose
    assert reading.twist.linear_x_mps == pytest.approx(math.hypot(pose.x_m, pose.y_m) / STEP_S)
    assert reading.twist.angular_z_radps == pytest.approx(pose.yaw_rad / STEP_S)
    assert reading.twist != twist


STRAIGHT = [arc(0.6, 0.0)] * 60
BACK = [arc(-0.6, 0.0)] * 60
TURN = [arc(0.0, math.pi / 2.0)] * 10
ASIDE = [(Pose(0.0, 0.06, 0.0), Twist(0.0, 0.6, 0.0))] * 60
SLANTED = [(Pose(-0.03, 0.04, 0.05), Twist(-0.28, 0.41, 0.5))] * 60
SLOW_DRIFT = OdometryModel(alpha1=0.004, alpha2=0.002, alpha3=0.02, alpha4=0.001)


@pytest.mark.slow
@pytest.mark.parametrize(
    "ways",
    [
        STRAIGHT,
        BACK,
        STRAIGHT + TURN + STRAIGHT,
        STRAIGHT + TURN + TURN + STRAIGHT,
        TURN + STRAIGHT + TURN + BACK,
        [arc(0.6, 0.5)] * 120,
        [arc(0.6, -0.9)] * 60 + [(Pose(0.01, -0.03, 0.0), Twist(0.1, -0.3, 0.0))] * 30 + STRAIGHT,
    ],
    ids=["straight", "back", "corner", "out_and_home", "corner_back", "circle", "pushed_aside"],
)
def test_covariance_is_the_scatter_of_many_drifts_along_the_same_path(ways):
    check_scatter(drive(ways, SLOW_DRIFT, robots=8000), ways)


@pytest.mark.slow
@pytest.mark.parametrize(
    "ways",
    [STRAIGHT, ASIDE, TURN + STRAIGHT + ASIDE, SLANTED, SLANTED + TURN + BACK],
    ids=["straight", "aside", "corner", "slanted", "slanted_back"],
)
def test_covariance_of_an_omnidirectional_robot_is_the_scatter_of_its_drifts(ways):
    check_scatter(drive(ways, SLOW_DRIFT, robots=8000, omni=True), ways)


def check_scatter(readings: State, ways: list[tuple[Pose, Twist]]) -> None:
    x_m, y_m, qz, qw = readings.odometry_pose.T
    yaws_rad = 2.0 * np.arctan2(qz, qw)
    true = Pose(0.0, 0.0, 0.0)
    for motion, _ in ways:
        true = true @ motion
    errors = np.column_stack([x_m - true.x_m, y_m - true.y_m, np.angle(np.exp(1j * (yaws_rad - true.yaw_rad)))])
    scatter = errors.T @ errors / len(errors)
    published = np.zeros((3, 3))
    published[np.triu_indices(3)] = readings.odometry_pose_covariance.mean(axis=0)
    published += np.triu(published, 1).T
    # The entries of a covariance of 8000 samples are known to 1.6 %; the second order leaves some more.
    sigma = np.sqrt(np.diag(scatter))
    assert sigma.min() > 0.01
    np.testing.assert_allclose(published / np.outer(sigma, sigma), scatter / np.outer(sigma, sigma), atol=0.07)


def test_covariance_of_one_straight_path_equals_the_hand_calculation():
    # 60 steps of l = 0.06 m; each of its turns has the variance q = alpha2 l^2 and moves the end by its lever.
    exact_distance = OdometryModel(alpha1=0.0, alpha2=1e-6, alpha3=0.0, alpha4=0.0)
    step_m, q = 0.06, 1e-6 * 0.06**2
    lever_m = step_m * np.arange(60, 0, -1)  # of the first turn of each step, to the end
    yy = q * np.sum(lever_m**2) + q * np.sum((lever_m - step_m) ** 2)
    y_yaw = q * np.sum(lever_m) + q * np.sum(lever_m - step_m)
    covariance = drive(STRAIGHT, exact_distance).odometry_pose_covariance[0]
    assert covariance[3:] == pytest.approx([yy, y_yaw, 120 * q], rel=1e-3)
    assert np.abs(covariance[:3]).max() < 1e-3 * yy
    along = OdometryModel(alpha1=0.0, alpha2=0.0, alpha3=0.01, alpha4=0.0)
    covariance = drive(STRAIGHT, along).odometry_pose_covariance[0]
    assert covariance == pytest.approx([60 * 0.01 * step_m**2, 0, 0, 0, 0, 0], rel=1e-9, abs=1e-15)


def test_covariance_is_symmetric_positive_and_never_shrinks_in_yaw():
    team = Team(MODEL, [np.random.default_rng(9)])
    generator = np.random.default_rng(10)
    yaw_variance = 0.0
    for _ in range(500):
        motion, twist = arc(generator.uniform(-0.7, 0.7), generator.uniform(-2.0, 2.0))
        published = team.step(motion, twist).odometry_pose_covariance[0]
        covariance = np.zeros((3, 3))
        covariance[np.triu_indices(3)] = published
        eigenvalues = np.linalg.eigvalsh(covariance, UPLO="U")
        assert eigenvalues.min() > -1e-12 * eigenvalues.max()
        assert published[YAW_YAW] > yaw_variance
        yaw_variance = published[YAW_YAW]


def test_twist_variances_are_the_scatter_of_the_twist():
    motion, twist = arc(0.5, 0.7)
    readings = drive([(motion, twist)], MODEL, robots=8000)
    assert np.unique(readings.odometry_twist_variances, axis=0).shape == (1, 3)
    of_forward, of_left, of_turn = readings.odometry_twist_variances[0]
    assert readings.odometry_twist.var(axis=0) == pytest.approx([of_forward, 0.0, of_turn], rel=0.08, abs=0.0)
    assert of_left == 0.0


def test_exact_odometry_and_a_robot_at_rest_have_zero_covariance():
    for state in (drive(STRAIGHT + TURN, EXACT), drive([(Pose(0.0, 0.0, 0.0), Twist())] * 50, MODEL)):
        assert not state.odometry_pose_covariance.any()
        assert not state.odometry_twist_variances.any()


def test_omnidirectional_robot_errs_to_the_side_as_along_its_path():
    # One step: l = 0.06 m to the left while turning by 0.1 rad.
    motion, twist = Pose(0.0, 0.06, 0.1), Twist(0.03, 0.6, 1.0)
    readings = drive([(motion, twist)], MODEL, robots=8000, omni=True)
    way_m2, turn_rad2 = 0.02 * 0.06**2 + 0.03 * 0.1**2, 0.04 * 0.1**2 + 0.01 * 0.06**2
    assert readings.odometry_pose_covariance[0] == pytest.approx(
        [way_m2, 0.0, 0.0, way_m2, 0.0, turn_rad2], rel=1e-9, abs=1e-15
    )
    errors = readings.odometry_pose[:, :2] - (0.0, 0.06)
    assert np.cov(errors.T) == pytest.approx(np.diag([way_m2, way_m2]), abs=0.05 * way_m2)
    assert errors.mean(axis=0) == pytest.approx([0.0, 0.0], abs=4.0 * math.sqrt(way_m2 / 8000))
    assert readings.odometry_twist_variances[0] == pytest.approx(np.array([way_m2, way_m2, turn_rad2]) / STEP_S**2)
    assert readings.odometry_twist.var(axis=0) == pytest.approx(readings.odometry_twist_variances[0], rel=0.08)
    assert readings.odometry_twist.mean(axis=0) == pytest.approx([0.03, 0.6, 1.0], abs=0.01)


def test_omnidirectional_odometry_without_noise_is_the_true_path_and_stops_with_the_robot():
    true = Pose(0.0, 0.0, 0.0)
    for motion, _ in SLANTED:
        true = true @ motion
    x_m, y_m, qz, qw = drive(SLANTED, EXACT, omni=True).odometry_pose[0]
    assert (x_m, y_m, 2.0 * math.atan2(qz, qw)) == pytest.approx((true.x_m, true.y_m, true.yaw_rad), abs=1e-9)
    still = drive([(Pose(0.0, 0.0, 0.0), Twist())] * 50, MODEL, omni=True)
    assert [reading.odometry for reading in still] == [OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())]
