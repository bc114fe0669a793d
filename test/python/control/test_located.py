"""A robot that is not where it believes to be: what its controller learns."""

import math

import numpy as np
import pytest

from robotteamsim.control.runtime.located import Located
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Estimate, Localisation, Observation, Task
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import FREE, UNKNOWN
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

TRUE, BELIEVED = Pose(3.0, 4.0, 0.5 * math.pi), Pose(10.0, 0.0, 0.0)


LOCALISATION = Localisation("ambiguous", (Estimate(BELIEVED), Estimate(TRUE)))


class _Fixed:
    looks = False
    particles = ()
    localisation = LOCALISATION

    def pose(self, observation, teammates=()):
        return BELIEVED


class _Kept:
    def step(self, observation, inbox, task):
        self.observation = observation
        return Decision(Twist(0.5))


@pytest.fixture
def step():
    """Return what the controller of a robot at TRUE gets that believes to be at BELIEVED, and the decision."""
    reading = PoseReading.from_pose(TRUE)
    robot = RobotReading(reading, Twist(), OdometryReading(reading, Twist()), np.zeros(0, np.float32), in_contact=False)
    kept = _Kept()
    # The voice is 2 m ahead and 1 m to the left.
    located = Located(lambda setup: kept, 0, resolve(load("garage_sar")), _Fixed())
    decision = located.step(Observation(0, 10**8, robot, VoiceReading(20.0, True, (2.0, 6.0), 25.0)), (), Task())
    return kept.observation, decision


@pytest.fixture
def observation(step):
    return step[0]


def test_its_pose_is_the_believed_one_everywhere(observation):
    assert observation.pose == BELIEVED
    assert observation.robot.true_pose == BELIEVED


def test_it_hears_a_voice_where_it_is_as_seen_from_the_robot(observation):
    assert observation.voice.local_best_m == pytest.approx((12.0, 1.0))
    assert observation.voice.local_best_level_db == 25.0


def test_decision_says_what_the_robot_believes(step):
    assert step[1] == Decision(Twist(0.5), localisation=LOCALISATION)


@pytest.fixture(scope="module")
def team():
    """Return the decisions of two robots that map the garage for 12 s, step by step."""
    simulation = Simulation(load("garage_unknown", ["robots.count=2", "run.seed=3"]))
    simulation.mission.start()
    return [(record, record.decisions) for record in (simulation.step() for _ in range(120))]


def test_robot_that_maps_shows_its_map_every_five_seconds_at_most(team):
    shown_s = [record.sim_time_s for record, (decision, _) in team if decision.found is not None]
    assert len(shown_s) == 3
    assert min(np.diff(shown_s)) == pytest.approx(5.0)


def test_map_that_is_shown_has_known_cells_up_to_its_border(team):
    found = next(decisions[1].found for _, decisions in reversed(team) if decisions[1].found is not None)
    for border in (found.cells[0], found.cells[-1], found.cells[:, 0], found.cells[:, -1]):
        assert np.any(border != UNKNOWN)
    assert np.count_nonzero(found.cells == FREE) * found.resolution_m**2 > 50.0


def test_robot_that_maps_believes_a_pose_near_the_true_one(team):
    record, decisions = team[-1]
    for reading, decision in zip(record.readings, decisions, strict=True):
        error = reading.true_pose.inverse() @ decision.localisation.pose
        assert 0.0 < math.hypot(error.x_m, error.y_m) < 0.1
        assert decision.localisation.state == "tracking"


def test_robot_by_odometry_believes_the_covariance_of_its_odometry_in_the_map():
    # Facing north at the start, what the odometry calls x is y on the map.
    start = "robots=[{start_pose: [10, 10, 1.5707963267948966]}]"
    simulation = Simulation(load("garage_sar", [start, "control.localisation=odometry"]))
    simulation.mission.start()
    record = [simulation.step() for _ in range(100)][-1]
    (estimate,) = record.decisions[0].localisation.estimates
    xx, xy, x_yaw, yy, y_yaw, yaw_yaw = record.readings[0].odometry.pose_covariance
    assert xx != pytest.approx(yy)
    assert estimate.covariance == pytest.approx((yy, -xy, -y_yaw, xx, x_yaw, yaw_yaw))
