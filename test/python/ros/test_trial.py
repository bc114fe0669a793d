from __future__ import annotations

import numpy as np

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.network.messages import NetworkState
from robotteamsim.ros.nodes.trial import Trial
from robotteamsim.scenario import Scenario
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
from robotteamsim.simulation import Result, Simulation, StepRecord

STEP_NS = 100_000_000


class Recorder:
    def __init__(self) -> None:
        self.steps: list[int] = []
        self.result: Result | None = None
        self.abandoned = False

    def begin(self, scenario: Scenario) -> None:
        self.name = scenario.name

    def step(self, record: StepRecord) -> None:
        self.steps.append(record.step_index)

    def end(self, result: Result) -> None:
        self.result = result

    def abandon(self) -> None:
        self.abandoned = True


def step(trial: Trial, index: int, *places_m: tuple[float, float]) -> list[str]:
    """Step with robots at these places, who hear nothing; return the kinds of the events."""
    poses = [PoseReading.from_pose(Pose(x, y, 0.0)) for x, y in places_m]
    nothing = np.zeros((2, 2))
    network = NetworkState(nothing, nothing, nothing > 0, nothing.astype(np.int32), nothing, 0.0, nothing > 0)
    events = trial.step(
        index * STEP_NS,
        tuple(RobotReading.of(p, Twist(), OdometryReading(p, Twist()), np.zeros(0, np.float32), False) for p in poses),
        tuple(VoiceReading(0.0, False, (pose.x_m, pose.y_m), 0.0) for pose in poses),
        network,
        (Decision(), Decision()),
    )
    return [event.kind for event in events]


def test_trial_ends_with_the_mission_and_adds_nothing_up_afterwards(hall_scenario):
    recorder = Recorder()
    trial = Trial(hall_scenario(), [recorder])
    assert step(trial, 1, (3.0, 4.0), (3.0, 6.0)) == ["start"]
    assert step(trial, 2, (16.0, 5.0), (3.0, 6.0)) == ["area_explored"]
    assert trial.result is None
    assert step(trial, 3, (5.0, 5.0), (3.0, 6.0)) == ["area_explored", "end"]
    step(trial, 4, (5.0, 5.0), (3.0, 6.0))
    assert recorder.steps == [1, 2, 3]
    assert trial.result == recorder.result
    assert (trial.result.steps, trial.result.end) == (3, "areas_explored")
    trial.abandon()
    assert not recorder.abandoned


def test_abandoned_trial_tells_its_recorders(hall_scenario):
    recorder = Recorder()
    trial = Trial(hall_scenario(), [recorder])
    step(trial, 1, (3.0, 4.0), (3.0, 6.0))
    trial.abandon()
    assert recorder.abandoned
    assert recorder.result is None


def test_trial_of_what_a_simulation_does_has_its_result(hall_scenario):
    scenario = hall_scenario()
    simulation, trial = Simulation(scenario), Trial(scenario, [])
    while trial.result is None:
        record = simulation.step()
        trial.step(record.sim_time_ns, record.readings, record.voices, record.network, record.decisions)
    expected = Simulation(scenario).run()
    assert trial.result.trajectory_hash == expected.trajectory_hash
    assert trial.result.robots == expected.robots
    assert trial.result.time_s == expected.time_s
