"""A mission that is stepped with hand-made inputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from robotteamsim._core.state import State

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.mission import Event, Mission, Sensed
from robotteamsim.network.messages import NO_TRAFFIC, NetworkState
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading, state_of
from robotteamsim.setup import resolve

STEP_NS = 100_000_000
FAR_M = (1.0, 1.0)
SILENCE = VoiceReading(0.0, False, FAR_M, 0.0)


def pairs(num_robots: int, links: Sequence[tuple[int, int]]) -> np.ndarray:
    matrix = np.zeros((num_robots, num_robots), dtype=bool)
    for i, j in links:
        matrix[i, j] = matrix[j, i] = True
    return matrix


def put_links(
    state: State, endangered: Sequence[tuple[int, int]] = (), lost: Sequence[tuple[int, int]] = (), version: int = 0
) -> None:
    num_robots = len(state)
    weak, absent = pairs(num_robots, endangered), pairs(num_robots, lost)
    state.put_links(
        rssi_dbm=np.select([weak, absent], [-81.26, -97.04], -50.0),
        adjacency=~absent,
        endangered=weak,
        hop_count=np.ones((num_robots, num_robots), dtype=np.int32),
        fiedler_value=float(num_robots),
        version=version,
    )


def standing_at(place_m: tuple[float, float]) -> RobotReading:
    pose = PoseReading.from_pose(Pose(*place_m, 0.0))
    return RobotReading(pose, Twist(), OdometryReading(pose, Twist()), np.zeros(0, np.float32), in_contact=False)


def speaker_is_ann(place_m: tuple[float, float]) -> str:
    return "ann"


class Course:
    """Steps a mission of two robots; whatever is not given is quiet and far away."""

    def __init__(self, scenario: Scenario, speaker: Callable[[tuple[float, float]], str | None] = speaker_is_ann):
        self.mission, self.sim_time_ns = Mission(resolve(scenario), speaker), 0

    def step(
        self,
        positions=(),
        voices=(),
        endangered=(),
        excluded=(),
        present=(True, True),
        lost=(),
        decisions=None,
        traffic=NO_TRAFFIC,
        **more,
    ) -> tuple[Event, ...]:
        self.sim_time_ns += STEP_NS
        state = state_of(
            [standing_at(place_m) for place_m in (list(positions) + [FAR_M] * 2)[:2]],
            (list(voices) + [SILENCE] * 2)[:2],
        )
        put_links(state, endangered, lost, self.sim_time_ns)
        given = {
            "step_index": self.sim_time_ns // STEP_NS,
            "sim_time_ns": self.sim_time_ns,
            "state": state,
            "network": NetworkState(state, traffic),
            "inboxes": ((), ()),
            "present": np.array(present),
            "team_version": self.sim_time_ns,
        }
        decided = decisions or [Decision(excluded=i in excluded) for i in range(2)]
        return self.mission.step(Sensed(**(given | more)), decided)

    def kinds(self, **inputs) -> list[str]:
        return [event.kind for event in self.step(**inputs)]
