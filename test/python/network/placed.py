"""A network of robots that stand where a test puts them."""

from __future__ import annotations

import numpy as np
from robotteamsim._core.state import State

from robotteamsim.geometry import Pose
from robotteamsim.network import Network


def standing_at(positions_m: np.ndarray) -> State:
    """Return the state of robots at these positions."""
    state = State(len(positions_m))
    for robot_id, (x_m, y_m) in enumerate(positions_m):
        state.place(robot_id, Pose(float(x_m), float(y_m), 0.0))
    return state


class PlacedNetwork(Network):
    """Takes positions instead of a state; robots that do not take part are nowhere."""

    _present: np.ndarray | bool = True

    def follow_team(self, present: np.ndarray) -> None:
        self._present = present[:, None]
        super().follow_team(present)

    def step(self, positions_m, outboxes):
        return super().step(standing_at(np.where(self._present, positions_m, np.nan)), outboxes)
