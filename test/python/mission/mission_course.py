"""A mission that is stepped with hand-made inputs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.interface import Decision
from robotteamsim.mission import Event, Mission, MissionInput
from robotteamsim.network.messages import NetworkState
from robotteamsim.sensing.readings import VoiceReading

STEP_NS = 100_000_000
FAR_M = (1.0, 1.0)
SILENCE = VoiceReading(0.0, False, FAR_M, 0.0)


def pairs(num_robots: int, links: Sequence[tuple[int, int]]) -> np.ndarray:
    matrix = np.zeros((num_robots, num_robots), dtype=bool)
    for i, j in links:
        matrix[i, j] = matrix[j, i] = True
    return matrix


def network_of(
    num_robots: int, endangered: Sequence[tuple[int, int]] = (), lost: Sequence[tuple[int, int]] = (), version: int = 0
) -> NetworkState:
    zeros = np.zeros((num_robots, num_robots))
    weak, absent = pairs(num_robots, endangered), pairs(num_robots, lost)
    return NetworkState(
        rssi_dbm=np.select([weak, absent], [-81.26, -97.04], -50.0),
        link=zeros,
        adjacency=~absent,
        hop_count=np.ones((num_robots, num_robots), dtype=np.int32),
        break_matrix=zeros,
        fiedler_value=float(num_robots),
        endangered=weak,
        version=version,
    )


class Course:
    """Steps a mission of two robots; whatever is not given is quiet and far away."""

    def __init__(self, mission: Mission) -> None:
        self.mission, self.sim_time_ns = mission, 0

    def step(
        self, positions=(), voices=(), endangered=(), excluded=(), present=(True, True), lost=(), **more
    ) -> tuple[Event, ...]:
        self.sim_time_ns += STEP_NS
        given = {
            "sim_time_ns": self.sim_time_ns,
            "positions_m": np.array((list(positions) + [FAR_M] * 2)[:2]),
            "voices": (list(voices) + [SILENCE] * 2)[:2],
            "speaker": lambda place_m: "ann",
            "network": network_of(2, endangered, lost, self.sim_time_ns),
            "decisions": [Decision(excluded=i in excluded) for i in range(2)],
            "present": np.array(present),
            "team_version": self.sim_time_ns,
        }
        return self.mission.step(MissionInput(**(given | more)))

    def kinds(self, **inputs) -> list[str]:
        return [event.kind for event in self.step(**inputs)]
