"""A hand-made trial of two robots: what recorders see of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from robotteamsim._core.state import State

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, SwarmContext, Task
from robotteamsim.mission.events import Event, VictimSaved
from robotteamsim.mission.status import MissionStatus
from robotteamsim.network.messages import EVERYBODY, Message, NetworkState
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading, state_of
from robotteamsim.setup import resolve
from robotteamsim.simulation import Result, RobotTotals, StepRecord

STEP_NS = 100_000_000


class Trial:
    """Makes records in which robot i drives east at 0.5 m/s from (3, 4 + 2 i)."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.setup = scenario, resolve(scenario)

    def records(self, steps: int) -> Iterator[StepRecord]:
        for index in range(1, steps + 1):
            yield self.record(index)

    def record(self, index: int) -> StepRecord:
        time_s = index * STEP_NS / 1e9
        saved = index >= 3
        status = MissionStatus(
            state="running",
            end="",
            time_s=time_s,
            explored=(False, False),
            victims=("saved" if saved else "waiting", "waiting"),
            target_area=0,
            endangered_links=0,
            task=Task(running=True, epoch=int(saved), area_center_m=(16.0, 5.0), area_radius_m=2.0),
        )
        saves = Event(time_s, VictimSaved("ann", 1, 2, robot_id=1), "robot 1 saves ann (1 of 2)")
        events = (saves,) if index == 3 else ()
        message = Message(sender=0, receiver=EVERYBODY, payload='{"best": 1.5}')
        state = state_of(
            [self.reading(robot_id, time_s) for robot_id in range(2)],
            [VoiceReading(21.5, True, (3.5, 4.5), 24.0), VoiceReading(0.0, False, (3.0, 6.0), 0.0)],
        )
        self.put_links(state)
        return StepRecord(
            present=np.ones(2, dtype=bool),
            step_index=index,
            sim_time_ns=index * STEP_NS,
            state=state,
            network=NetworkState(state),
            inboxes=((), (message,)),
            decisions=(
                Decision(
                    Twist(0.5, 0.0, 0.1),
                    outbox=(message,),
                    goal_m=(16.0, 5.0),
                    local_best=2.5,
                    local_best_m=(3.5, 4.5),
                    search_counter=3,
                ),
                Decision(excluded=True, context=SwarmContext(*(0.1 * i for i in range(10)))),
            ),
            mission=status,
            events=events,
            victims=self.scenario.mission.victims,
            noise_db=10.0,
            voice_map=FieldMap((0.0, 0.0), 0.25, np.full((40, 80), 12.4)) if index in (1, 4) else None,
        )

    @staticmethod
    def reading(robot_id: int, time_s: float) -> RobotReading:
        truth = PoseReading.from_pose(Pose(3.0 + 0.5 * time_s, 4.0 + 2.0 * robot_id, 0.3))
        odometry = OdometryReading(
            PoseReading.from_pose(Pose(0.5 * time_s, 0.01, 0.31)),
            Twist(0.5, 0.0, 0.02),
            pose_covariance=(0.1 * time_s, 0.02, 0.03, 0.2 * time_s, 0.05, 1.0 / 3.0),
            twist_variances=(0.01, 0.0, 0.02),
        )
        ranges_m = np.linspace(0.5, 5.0, 181, dtype=np.float32)
        return RobotReading(truth, Twist(0.5, 0.0, 0.0), odometry, ranges_m, in_contact=False)

    @staticmethod
    def put_links(state: State) -> None:
        off_diagonal = ~np.eye(2, dtype=bool)
        state.put_links(
            rssi_dbm=np.where(off_diagonal, -81.5, 0.0),
            adjacency=off_diagonal,
            endangered=off_diagonal,
            hop_count=off_diagonal.astype(np.int32),
            fiedler_value=2.0,
            version=1,
        )

    def result(self, steps: int) -> Result:
        return Result(
            scenario=self.scenario.name,
            seed=1,
            noise_db=10.0,
            end="time_limit",
            time_s=steps * STEP_NS / 1e9,
            areas_explored=0,
            num_areas=2,
            victims_saved=1,
            num_victims=2,
            endangered_links=1,
            trajectory_hash="ab" * 32,
            steps=steps,
            sim_time_s=steps * STEP_NS / 1e9,
            robots=(RobotTotals(1.0, 0.0, 0.0, 0.1), RobotTotals(2.0, 0.5, 1.0, 0.2)),
            wall_s=0.5,
        )

    def play(self, recorder: object, steps: int) -> None:
        """Let a recorder see a whole trial."""
        recorder.begin(self.setup)
        for record in self.records(steps):
            recorder.step(record)
        recorder.end(self.result(steps))


@pytest.fixture
def trial(hall_scenario: Callable[..., Scenario]) -> Trial:
    return Trial(hall_scenario())
