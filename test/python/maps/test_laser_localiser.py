"""A robot that follows its pose by laser: it tracks, notices that it is lost, and finds itself without a wrong word."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from robotteamsim.geometry import Pose
from robotteamsim.interface import Observation
from robotteamsim.maps.hypothesis import Agreement
from robotteamsim.maps.laser_localiser import LaserLocaliser
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.simulation import Simulation

NO_VOICE = VoiceReading(0.0, False, (0.0, 0.0), 0.0)
ALONE = ("robots.count=1", "control.algorithm=cover", "mission.victims=[]")
FAR_SEEING = (
    "robots.laser.beams=361",
    "robots.laser.range_max_m=12",
    "robots.laser.angle_min_rad=-3.14159",
    "robots.laser.angle_max_rad=3.14159",
)
ALPHAS = {"alpha1": 0.01, "alpha2": 0.001, "alpha3": 0.001, "alpha4": 0.0001}


def driving(simulation: Simulation, seconds: float) -> Iterator[Observation]:
    """Yield what robot 0 measures, while it drives by its true pose."""
    for _ in range(round(seconds / simulation.scenario.run.step_s)):
        record = simulation.step()
        yield Observation(0, record.sim_time_ns, record.state.readings()[0], NO_VOICE)


def error_m(pose: Pose, observation: Observation) -> float:
    truth = observation.robot.true_pose
    return math.dist((pose.x_m, pose.y_m), (truth.x_m, truth.y_m))


def scaled_odometry(factor: float) -> tuple[str, ...]:
    return tuple(f"robots.odometry.{name}={factor * alpha}" for name, alpha in ALPHAS.items())


def tracked(setup: Setup, seconds: float) -> tuple[LaserLocaliser, list[Pose], list[float]]:
    localiser = LaserLocaliser(0, setup)
    poses, errors_m = [], []
    for observation in driving(Simulation(setup.scenario), seconds):
        poses.append(localiser.pose(observation))
        errors_m.append(error_m(poses[-1], observation))
    return localiser, poses, errors_m


def set_up(name: str, *settings: str) -> Setup:
    return Simulation(load(name, [*ALONE, *settings])).setup


def test_robot_tracks_its_pose_to_the_same_bits() -> None:
    setup = set_up("garage_sar")
    localiser, poses, errors_m = tracked(setup, 60.0)
    assert localiser.localisation.state == "tracking"
    assert np.median(errors_m) < 0.05
    assert max(errors_m) < 0.4
    assert tracked(setup, 60.0)[1] == poses
    (estimate,) = localiser.localisation.estimates
    assert 0.0 < estimate.covariance[0] < 0.1


def test_robot_whose_odometry_is_far_worse_says_that_it_is_lost_or_is_not() -> None:
    # Ten times the standard deviation: in the garage, where little is in view, robots lose themselves.
    setup = set_up("garage_sar", *scaled_odometry(100.0), "run.seed=3")
    localiser, wrong_s, worst_s = LaserLocaliser(0, setup), 0.0, 0.0
    for observation in driving(Simulation(setup.scenario), 150.0):
        is_wrong = (
            error_m(localiser.pose(observation), observation) > 2.0 and localiser.localisation.state == "tracking"
        )
        wrong_s = wrong_s + 0.1 if is_wrong else 0.0
        worst_s = max(worst_s, wrong_s)
    assert worst_s < 30.0


def test_robot_that_was_carried_elsewhere_finds_itself() -> None:
    setup = set_up("garage_sar", *FAR_SEEING)
    simulation, localiser = Simulation(setup.scenario), LaserLocaliser(0, setup)
    for observation in driving(simulation, 10.0):
        localiser.pose(observation)
    simulation.world.set_pose(0, Pose(40.0, 20.0, 2.0))
    states = []
    for observation in driving(simulation, 90.0):
        pose = localiser.pose(observation)
        if not states or states[-1] != localiser.localisation.state:
            states.append(localiser.localisation.state)
        if "lost" in states and localiser.localisation.state == "tracking":
            break
    assert states == ["tracking", "lost", "tracking"]
    assert error_m(pose, observation) < 0.3


def number_around_each(localiser: LaserLocaliser) -> list[int]:
    """Return how many particles are nearest to each place where the robot may be."""
    places = np.array([(one.pose.x_m, one.pose.y_m) for one in localiser.localisation.estimates])
    particles = np.array([(one.x_m, one.y_m) for one in localiser.particles])
    nearest = np.linalg.norm(particles[:, None] - places, axis=2).argmin(axis=1)
    return np.bincount(nearest, minlength=len(places)).tolist()


@pytest.mark.parametrize("has_teammate", [False, True])
def test_robot_in_a_symmetrical_building_is_ambiguous_until_it_meets_a_teammate(has_teammate: bool) -> None:
    # A square of four equal barriers in a square room: four places, each turned by a right angle about (3, 3).
    setup = set_up("tutorial_arena", "robots.laser.range_max_m=12", "robots.count=2")
    simulation, localiser = Simulation(setup.scenario), LaserLocaliser(0, setup, arrival=2)
    seen: set[tuple[str, int]] = set()
    around: set[tuple[int, ...]] = set()
    for _ in range(1200):
        record = simulation.step()
        mine, other = record.state.readings()[:2]
        at = other.true_pose.x_m, other.true_pose.y_m
        observation = Observation(0, record.sim_time_ns, mine, NO_VOICE)
        pose = localiser.pose(observation, [(at, 0.5)] if has_teammate else [])
        seen.add((localiser.localisation.state, len(localiser.localisation.estimates)))
        assert localiser.localisation.state != "tracking" or error_m(pose, observation) < 0.3
        around.add((len(localiser.localisation.estimates), *number_around_each(localiser)))
    assert ("ambiguous", 4) in seen
    assert around <= {(1, 100), (2, 50, 50), (3, 33, 33, 33), (4, 25, 25, 25, 25)}
    assert (localiser.localisation.state == "tracking") is has_teammate


def test_robot_whose_laser_sees_nothing_goes_by_its_odometry() -> None:
    setup = set_up("garage_sar", "robots.laser.range_max_m=0.1", "robots.odometry.alpha1=0.001")
    localiser, _, errors_m = tracked(setup, 20.0)
    assert localiser.localisation.state == "tracking"  # nothing contradicts
    assert max(errors_m) < 1.0
    assert localiser.localisation.estimates[0].covariance[0] > 1e-4


def test_robot_that_cannot_move_stays_where_it_is() -> None:
    setup = set_up("garage_sar")
    localiser, poses = LaserLocaliser(0, setup), set()
    simulation = Simulation(setup.scenario)
    observation = next(driving(simulation, 1.0))
    for _ in range(50):
        poses.add(localiser.pose(observation))
    assert len(poses) == 1
    assert localiser.localisation.state == "tracking"


def test_agreement_is_that_of_the_last_metres() -> None:
    agreement = Agreement(window_m=2.0)
    agreement.add(0.5, 40, 40)
    assert agreement.contradicting == 0.0  # too few for a verdict
    agreement.add(0.5, 40, 0)
    assert agreement.contradicting == 0.5
    assert agreement.is_known_over(1.0)
    assert not agreement.is_known_over(1.5)
    agreement.add(2.0, 60, 15)  # the first scan was 2.5 m ago
    assert agreement.contradicting == pytest.approx(0.15)


def test_mission_localised_by_laser_explores_and_saves_as_many() -> None:
    scenario = load("tutorial_arena", ["control.localisation=laser", "robots.count=2", "robots.spacing_m=0.6"])
    result = Simulation(scenario).run()
    assert result.areas_explored == result.num_areas
    assert Simulation(scenario).run().trajectory_hash == result.trajectory_hash
