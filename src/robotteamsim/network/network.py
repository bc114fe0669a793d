"""The ad hoc network of a team: who has a link to whom, and which messages arrive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.network.graph import break_matrix, fiedler_value, hop_count
from robotteamsim.network.messages import EVERYBODY, Message, NetworkState
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.sections import Network as NetworkSection


@dataclass(frozen=True, slots=True, eq=False)
class _Topology:
    """What follows from the adjacency alone; kept while no link comes or goes."""

    adjacency: np.ndarray
    hops: np.ndarray
    fiedler: float


class Network:
    """The undirected radio network of `num_robots` robots [dissertation, 5.2.2].

    A link exists where the signal is at least `lost_below_dbm`, or, for links by distance, where the distance is at
    most `max_distance_m`. It is endangered where its signal is below `endangered_below_dbm`.
    """

    def __init__(self, radio_field: RadioField, network: NetworkSection, num_robots: int) -> None:
        self._radio_field = radio_field
        self._section = network
        self._num_robots = num_robots
        self._topology: _Topology | None = None

    def step(
        self, positions_m: np.ndarray, outboxes: Sequence[Sequence[Message]]
    ) -> tuple[NetworkState, list[tuple[Message, ...]]]:
        """Return the network at these positions, and what each robot receives over it.

        Args:
            positions_m: shape (n, 2), in `map` [m].
            outboxes:    messages sent in the step before, one sequence per robot in id order.
        Returns: the state, and one inbox per robot in id order. A message arrives where a path of links exists now;
                 an inbox is sorted by sender, then in the order of sending. Nobody receives his own messages.
        Raises: ValueError: wrong number of robots; a position is not finite; a message with a sender that is not the
                owner of the outbox, or a receiver that does not exist.
        """
        positions_m = np.asarray(positions_m, dtype=np.float64)
        if positions_m.shape != (self._num_robots, 2):
            raise ValueError(f"positions_m must have shape ({self._num_robots}, 2), got {positions_m.shape}")
        self._check(outboxes)
        state = self._state(positions_m)
        return state, self._deliver(state.hop_count, outboxes)

    def reset(self) -> None:
        """Forget the last topology, as a new network."""
        self._topology = None

    def _state(self, positions_m: np.ndarray) -> NetworkState:
        rssi_dbm = self._radio_field.rssi_matrix_dbm(positions_m)
        if self._section.link == "signal":
            link = rssi_dbm
            adjacency = rssi_dbm >= self._section.lost_below_dbm
        else:
            link = np.hypot(*(positions_m[:, None, :] - positions_m[None, :, :]).transpose(2, 0, 1))
            adjacency = link <= self._section.max_distance_m
        np.fill_diagonal(adjacency, False)
        topology = self._topology_of(adjacency)
        return NetworkState(
            rssi_dbm=rssi_dbm,
            link=link,
            adjacency=adjacency,
            hop_count=topology.hops,
            break_matrix=break_matrix(link, topology.hops),
            fiedler_value=topology.fiedler,
            endangered=adjacency & (rssi_dbm < self._section.endangered_below_dbm),
        )

    def _topology_of(self, adjacency: np.ndarray) -> _Topology:
        if self._topology is None or not np.array_equal(self._topology.adjacency, adjacency):
            self._topology = _Topology(adjacency, hop_count(adjacency), fiedler_value(adjacency))
        return self._topology

    def _check(self, outboxes: Sequence[Sequence[Message]]) -> None:
        if len(outboxes) != self._num_robots:
            raise ValueError(f"outboxes must hold one sequence per robot: {self._num_robots}, got {len(outboxes)}")
        for robot_id, outbox in enumerate(outboxes):
            for message in outbox:
                if message.sender != robot_id:
                    raise ValueError(f"outbox of robot {robot_id} holds a message from sender {message.sender}")
                if message.receiver != EVERYBODY and not 0 <= message.receiver < self._num_robots:
                    raise ValueError(
                        f"outbox of robot {robot_id}: receiver {message.receiver} does not exist; "
                        f"wanted 0..{self._num_robots - 1}, or {EVERYBODY} for everybody"
                    )

    def _deliver(self, hops: np.ndarray, outboxes: Sequence[Sequence[Message]]) -> list[tuple[Message, ...]]:
        sent = [message for outbox in outboxes for message in outbox]
        if not all(message.receiver == EVERYBODY for message in sent):
            return [
                tuple(m for m in sent if m.receiver in (receiver, EVERYBODY) and hops[m.sender, receiver] > 0)
                for receiver in range(self._num_robots)
            ]
        # Those who have a path to each other hear the same, but for what they sent themselves.
        num_sent = np.array([len(outbox) for outbox in outboxes])
        heard: dict[bytes, tuple[tuple[Message, ...], list[int]]] = {}
        inboxes = []
        for receiver, senders in enumerate(hops >= 0):
            key = senders.tobytes()
            if key not in heard:
                messages = tuple(message for message in sent if senders[message.sender])
                heard[key] = messages, np.cumsum(num_sent * senders).tolist()
            messages, ends = heard[key]
            inboxes.append(messages[: ends[receiver] - len(outboxes[receiver])] + messages[ends[receiver] :])
        return inboxes
