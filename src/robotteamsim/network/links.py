"""The links of a team from step to step."""

from typing import TypeVar

import numpy as np

from robotteamsim import _core
from robotteamsim.network.messages import NetworkState
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.sections import Network as NetworkSection

Array = TypeVar("Array", bound=np.ndarray)


class TeamLinks:
    """Finds the links of a team; hop counts and the Fiedler value are computed only after links have changed."""

    def __init__(self, radio_field: RadioField, network: NetworkSection) -> None:
        self._by_distance = network.link == "distance"
        self._core = _core.network.TeamLinks(
            radio_field.core_faces,
            radio_field.core_model,
            by_distance=self._by_distance,
            lost_below_dbm=network.lost_below_dbm,
            max_distance_m=network.max_distance_m,
            endangered_below_dbm=network.endangered_below_dbm,
        )
        # The arrays of the last step.
        self._adjacency = self._endangered = np.zeros((0, 0), dtype=np.bool_)
        self._hop_count = np.zeros((0, 0), dtype=np.int32)
        self._no_break = np.zeros((0, 0))
        self._fiedler_value = 0.0

    def step(self, positions_m: np.ndarray) -> NetworkState:
        """Return the network without its traffic. Unchanged arrays are those of the last step, and read-only.

        Args:   positions_m: float64, shape (n, 2), in `map` [m].
        Raises: ValueError: a position is not finite.
        """
        core, n = self._core, len(positions_m)
        rssi_dbm = np.empty((n, n))
        link = np.empty((n, n)) if self._by_distance else rssi_dbm
        has_changed = core.step(positions_m, rssi_dbm, link)
        if has_changed or len(self._adjacency) != n:
            self._adjacency, self._hop_count = _read_only(core.adjacency()), _read_only(core.hop_count())
            self._endangered, self._no_break = _read_only(core.endangered()), _read_only(np.zeros((n, n)))
            self._fiedler_value = core.fiedler_value
        is_split = self._fiedler_value == 0.0
        return NetworkState(
            rssi_dbm,
            link,
            self._adjacency,
            self._hop_count,
            _core.network.break_matrix(link, self._hop_count) if is_split else self._no_break,
            self._fiedler_value,
            self._endangered,
        )


def _read_only(array: Array) -> Array:
    array.flags.writeable = False
    return array
