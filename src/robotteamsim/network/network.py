"""The ad hoc network of a team: its links, and the messages that arrive."""

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.network.delivery import Delivery
from robotteamsim.network.messages import EVERYBODY, Message, NetworkState, Refusal
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.sections import Network as NetworkSection


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
        self._section = network
        self._num_robots = num_robots
        self._delivery = Delivery(network, num_robots, seed, step_ns)
        self.links = _core.network.TeamLinks(
            radio_field.core_faces,
            radio_field.core_model,
            by_distance=network.link == "distance",
            lost_below_dbm=network.lost_below_dbm,
            max_distance_m=network.max_distance_m,
            endangered_below_dbm=network.endangered_below_dbm,
        )

    def follow_team(self, present: np.ndarray) -> None:
        """Deliver only to these robots from now on. Args: present: whether each takes part, bool, shape (n,)."""
        self._delivery.follow_team(present)

    def step(
        self, state: _core.state.State, outboxes: Sequence[Sequence[Message]]
    ) -> tuple[NetworkState, Sequence[Sequence[Message]]]:
        """Write the links where the robots are into a state; return them, and the messages that each robot receives.

        Args:
            state:    of the step; a robot whose position is NaN is absent.
            outboxes: messages sent in the previous step, one sequence per robot in id order.
        Returns: the network, and one inbox per robot in id order: messages that arrive in this step, sorted by sender,
                 then in the order of sending. A robot does not receive its own messages. Messages that are too large
                 are refused.
        Raises: ValueError: wrong number of robots; a position is not finite; a message whose sender is not the owner
                of the outbox, or whose receiver does not exist.
        """
        self.links.step(state)
        return self.deliver(state, outboxes)

    def deliver(
        self, state: _core.state.State, outboxes: Sequence[Sequence[Message]]
    ) -> tuple[NetworkState, Sequence[Sequence[Message]]]:
        """Deliver messages over the links in a state, see `step`; `outboxes` may be empty if nobody sends."""
        if len(state) != self._num_robots:
            raise ValueError(f"the state must have {self._num_robots} robots, got {len(state)}")
        if outboxes and len(outboxes) != self._num_robots:
            raise ValueError(f"outboxes must have one sequence per robot: {self._num_robots}, got {len(outboxes)}")
        refused: tuple[Refusal, ...] = ()
        if not any(outboxes):
            outboxes = ()
        else:
            refused = self._check(outboxes)
        if refused:
            limit = self._section.max_message_bytes
            outboxes = [[message for message in outbox if message.num_bytes <= limit] for outbox in outboxes]
        inboxes, traffic = self._delivery.step(state, outboxes, refused)
        return NetworkState(state, traffic), inboxes

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
