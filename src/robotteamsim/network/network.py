"""The ad hoc network of a team: its links, and the messages that arrive."""

import math
from collections.abc import Sequence
from typing import TypeVar

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.network.delivery import Delivery
from robotteamsim.network.messages import EVERYBODY, NO_TRAFFIC, Message, NetworkState, Refusal
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.sections import Network as NetworkSection

Array = TypeVar("Array", bound=np.ndarray)


class TeamLinks:
    """Finds the links of a team; hop counts and the Fiedler value are computed only after links have changed."""

    def __init__(self, radio_field: RadioField, network: NetworkSection, version: int = 0) -> None:
        """Args: version: that of the state before the first one."""
        self.version = version
        """Of the last state, see `NetworkState`."""
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
            self.version += 1
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
            self.version,
        )


def _read_only(array: Array) -> Array:
    array.flags.writeable = False
    return array


_NONE = np.zeros((0, 0))


def _among_all(network: NetworkState, present: np.ndarray) -> NetworkState:
    """Return the network of the present robots with rows and columns for all; present: bool, shape (n,)."""
    there, shape = np.ix_(present, present), (len(present), len(present))

    def spread(matrix: np.ndarray, nothing: float, kind: type) -> np.ndarray:
        whole: np.ndarray = np.full(shape, nothing, dtype=kind)
        whole[there] = matrix
        return whole

    return NetworkState(
        spread(network.rssi_dbm, -math.inf, np.float64),
        spread(network.link, 0.0, np.float64),
        spread(network.adjacency, False, np.bool_),
        spread(network.hop_count, -1, np.int32),
        spread(network.break_matrix, 0.0, np.float64),
        network.fiedler_value,
        spread(network.endangered, False, np.bool_),
        network.version,
    )


class Network:
    """The undirected radio network of `num_robots` robots [dissertation, 5.2.2].

    A link exists if the signal is at least `lost_below_dbm` or, for links by distance, the distance is at most
    `max_distance_m`. It is endangered if its signal is below `endangered_below_dbm`. `Delivery` describes how messages
    travel over links.
    """

    def __init__(
        self,
        radio_field: RadioField,
        network: NetworkSection,
        num_robots: int,
        *,
        seed: int = 0,
        step_ns: int = 100_000_000,
    ) -> None:
        """Make a network without messages. Args: seed: of message losses.  step_ns: length of a step [ns]."""
        self._radio_field = radio_field
        self._section = network
        self._num_robots = num_robots
        self._delivery = Delivery(network, num_robots, seed, step_ns)
        self._links = TeamLinks(self._radio_field, self._section)
        self._present = np.ones(num_robots, dtype=bool)
        self._everybody = True

    def follow_team(self, present: np.ndarray) -> None:
        """Let only these robots take part from now on. Args: present: whether each does, bool, shape (n,)."""
        if np.array_equal(present, self._present):
            return
        self._present, self._everybody = present, bool(present.all())
        # Links can be reused in the next step only for the same robots.
        self._links = TeamLinks(self._radio_field, self._section, self._links.version + 1)
        self._delivery.follow_team(present)

    def step(
        self, positions_m: np.ndarray, outboxes: Sequence[Sequence[Message]]
    ) -> tuple[NetworkState, Sequence[Sequence[Message]]]:
        """Return the network at these positions, and the messages that each robot receives.

        Args:
            positions_m: shape (n, 2), in `map` [m].
            outboxes:    messages sent in the previous step, one sequence per robot in id order.
        Returns: the state, and one inbox per robot in id order: messages that arrive in this step, sorted by sender,
                 then in the order of sending. A robot does not receive its own messages. Messages that are too large
                 are refused.
        Raises: ValueError: wrong number of robots; a position is not finite; a message whose sender is not the owner
                of the outbox, or whose receiver does not exist.
        """
        if len(positions_m) != self._num_robots:
            raise ValueError(f"positions_m must have shape ({self._num_robots}, 2), got {np.shape(positions_m)}")
        if len(outboxes) != self._num_robots:
            raise ValueError(f"outboxes must have one sequence per robot: {self._num_robots}, got {len(outboxes)}")
        refused: tuple[Refusal, ...] = ()
        if not any(outboxes):
            outboxes = ()
        else:
            refused = self._check(outboxes)
        if refused:
            limit = self._section.max_message_bytes
            outboxes = [[message for message in outbox if message.num_bytes <= limit] for outbox in outboxes]
        if self._everybody:
            state = self._links.step(positions_m)
        else:
            present = self._present
            state = _among_all(self._links.step(positions_m[present]) if present.any() else self._empty(), present)
        inboxes, traffic = self._delivery.step(state, outboxes, refused)
        return state if traffic is NO_TRAFFIC else msgspec.structs.replace(state, traffic=traffic), inboxes

    def _empty(self) -> NetworkState:
        """Return the network of nobody."""
        return NetworkState(_NONE, _NONE, _NONE, _NONE, _NONE, 0.0, _NONE, self._links.version)

    def _check(self, outboxes: Sequence[Sequence[Message]]) -> tuple[Refusal, ...]:
        """Return the messages that are too large. Raises: ValueError: as `step`."""
        limit, refused = self._section.max_message_bytes, []
        for robot_id, outbox in enumerate(outboxes):
            for message in outbox:
                if message.sender != robot_id:
                    raise ValueError(f"outbox of robot {robot_id} contains a message from sender {message.sender}")
                if message.receiver != EVERYBODY and not 0 <= message.receiver < self._num_robots:
                    raise ValueError(
                        f"outbox of robot {robot_id}: receiver {message.receiver} does not exist; "
                        f"expected 0..{self._num_robots - 1}, or {EVERYBODY} for everybody"
                    )
                # A character has at most 4 bytes, so the size of most messages need not be counted.
                if 4 * len(message.payload) > limit and message.num_bytes > limit:
                    refused.append(Refusal(robot_id, message.num_bytes, limit))
        return tuple(refused)
