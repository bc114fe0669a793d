"""Delivery of messages: hop by hop over the links of each step, with a delay per hop and losses on weak links."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim import rng
from robotteamsim._core.state import State
from robotteamsim.network.graph import next_hop
from robotteamsim.network.messages import EVERYBODY, NO_TRAFFIC, Batch, Inbox, Message, Refusal, Traffic
from robotteamsim.scenario.sections import Network as NetworkSection

Inboxes = Sequence[Sequence[Message]]


@dataclass(slots=True, eq=False)
class _Flight:
    """A message in transit.

    sent_step: the step in which it was sent.       number: its place in the outbox of that step.
    hops:      made so far.                         reached: bool, shape (n,): the robots that have received it.
    holders:   ids of the robots that forward it in the next hop.
    """

    message: Message
    sent_step: int
    number: int
    reached: np.ndarray
    holders: np.ndarray
    hops: int = 0


def loss_probability(rssi_dbm: np.ndarray, network: NetworkSection) -> np.ndarray:
    """Return the probability that a message is lost in one hop over links with these signals [dBm]; same shape.

    It rises linearly from 0 at `endangered_below_dbm` to 1 at `lost_below_dbm`; if both are equal, nothing is lost.
    """
    if network.loss == "none" or network.endangered_below_dbm == network.lost_below_dbm:
        return np.zeros_like(rssi_dbm)
    band_db = network.endangered_below_dbm - network.lost_below_dbm
    return np.clip((network.endangered_below_dbm - rssi_dbm) / band_db, 0.0, 1.0)


def is_instant(network: NetworkSection, num_robots: int, step_ns: int) -> bool:
    """Whether every message arrives in the next step or never; nothing is drawn or kept then."""
    return network.loss == "none" and round(network.hop_delay_s * 1e9) * (num_robots - 1) <= step_ns


class _Losses:
    """The losses of one step.

    may_happen: whether each robot has a link over which a transmission may be lost.
    """

    def __init__(self, probability: np.ndarray, seed: int, step: int) -> None:
        """Args: probability: see `loss_probability`, shape (n, n)."""
        self.may_happen: list[bool] = np.asarray(probability.any(axis=1)).tolist()
        self._probability, self._seed, self._step = probability, seed, step
        self._generators: dict[int, np.random.Generator] = {}

    def survivors(self, transmitter: int) -> np.ndarray:
        """Draw which robots in reach receive one transmission; bool, shape (n,)."""
        generator = self._generators.get(transmitter)
        if generator is None:
            generator = rng.stream(self._seed, "network", self._step, transmitter)
            self._generators[transmitter] = generator
        return np.asarray(generator.random(len(self._probability)) >= self._probability[transmitter])


class Delivery:
    """Carries messages between `num_robots` robots.

    A message to one robot follows, at each hop, the shortest path of that moment, over the strongest of equally good
    links, and is dropped if there is none. A message to everybody floods the network: each robot that receives it
    forwards it once, to all neighbours. Losses are drawn per link from the stream ("network", step, transmitter), so
    they depend only on the seed, the step, the pair and the number of messages that the transmitter sent in that step.
    """

    def __init__(self, network: NetworkSection, num_robots: int, seed: int, step_ns: int) -> None:
        self._section = network
        self._num_robots = num_robots
        self._seed = seed
        self._step_ns = step_ns
        self._hop_delay_ns = round(network.hop_delay_s * 1e9)
        self._is_instant = is_instant(network, num_robots, step_ns)
        self._step = 0
        self._flights: list[_Flight] = []
        self.follow_team(np.ones(num_robots, dtype=bool))

    def follow_team(self, present: np.ndarray) -> None:
        """Deliver only to these robots from now on. Args: present: whether each is there, bool, shape (n,)."""
        self._present, self._everybody = present, bool(present.all())
        self._num_others: list[int] = (int(np.count_nonzero(present)) - present).tolist()

    def step(
        self,
        state: State,
        outboxes: Sequence[Sequence[Message]],
        refused: tuple[Refusal, ...],
    ) -> tuple[Inboxes, Traffic]:
        """Accept the messages of the last step, carry all messages in transit, and return those that arrive now.

        Args: outboxes: one sequence per robot in id order; empty if no robot sent anything.
        """
        self._step += 1
        if not self._is_instant:
            return self._carry(state, outboxes, refused)
        if not outboxes:
            return [()] * self._num_robots, NO_TRAFFIC
        reach_all = self._everybody and state.fiedler_value > 0.0
        inboxes = deliver_at_once(state.hop_count, outboxes, reach_all)
        delivered = sum(map(len, inboxes))
        return inboxes, Traffic(
            delivered=delivered,
            cut_off=self._num_copies(outboxes) - delivered,
            mean_delay_s=self._step_ns / 1e9 if delivered else 0.0,
            refused=refused,
        )

    def _num_copies(self, outboxes: Sequence[Sequence[Message]]) -> int:
        """Return how many robots each message is for, summed; absent robots do not count for broadcasts."""
        others = self._num_others
        return sum(
            others[m.sender] if m.receiver == EVERYBODY else m.receiver != m.sender for box in outboxes for m in box
        )

    def _carry(
        self, links: State, outboxes: Sequence[Sequence[Message]], refused: tuple[Refusal, ...]
    ) -> tuple[Inboxes, Traffic]:
        losses = _Losses(loss_probability(links.rssi_dbm, self._section), self._seed, self._step)
        self._flights += [
            self._take_off(message, number)
            for outbox in outboxes
            for number, message in enumerate(outbox)
            if message.receiver != message.sender
        ]
        arrivals: list[list[_Flight]] = [[] for _ in range(self._num_robots)]
        lost = cut_off = 0
        going = []
        for flight in self._flights:
            if self._advance(flight, links, losses, arrivals):
                going.append(flight)
            else:
                missed, apart = self._missed(flight, links)
                lost, cut_off = lost + missed, cut_off + apart
        self._flights = going
        delays_steps = [self._step - flight.sent_step for arrived in arrivals for flight in arrived]
        for arrived in arrivals:
            arrived.sort(key=lambda flight: (flight.message.sender, flight.sent_step, flight.number))
        return [tuple(flight.message for flight in arrived) for arrived in arrivals], Traffic(
            delivered=len(delays_steps),
            lost=lost,
            cut_off=cut_off,
            mean_delay_s=sum(delays_steps) * self._step_ns / 1e9 / max(len(delays_steps), 1),
            refused=refused,
        )

    def _take_off(self, message: Message, number: int) -> _Flight:
        reached = np.zeros(self._num_robots, dtype=bool)
        reached[message.sender] = True
        return _Flight(message, self._step - 1, number, reached, np.array([message.sender]))

    def _advance(self, flight: _Flight, links: State, losses: _Losses, arrivals: list[list[_Flight]]) -> bool:
        """Let a message make the hops that are due and note whom it reaches; return whether it is still under way."""
        time_ns = (self._step - flight.sent_step) * self._step_ns
        due = self._num_robots if self._hop_delay_ns == 0 else time_ns // self._hop_delay_ns
        while flight.hops < due and len(flight.holders):
            flight.hops += 1
            if flight.message.receiver == EVERYBODY:
                flight.holders = self._flood(flight, links, losses)
                for robot_id in flight.holders.tolist():
                    arrivals[robot_id].append(flight)
                if flight.reached.all():
                    return False
            else:
                flight.holders = self._pass_on(flight, links, losses)
                if flight.reached[flight.message.receiver]:
                    arrivals[flight.message.receiver].append(flight)
                    return False
        return len(flight.holders) > 0

    def _flood(self, flight: _Flight, links: State, losses: _Losses) -> np.ndarray:
        """Let all holders pass a message on; return the ids of those who receive it for the first time."""
        heard = links.adjacency[flight.holders] & ~flight.reached
        for row, holder in enumerate(flight.holders.tolist()):
            if losses.may_happen[holder]:
                heard[row] &= losses.survivors(holder)
        fresh: np.ndarray = heard.any(axis=0)
        flight.reached |= fresh
        return np.flatnonzero(fresh)

    def _pass_on(self, flight: _Flight, links: State, losses: _Losses) -> np.ndarray:
        """Let the holder pass a message on towards its receiver; return the id of the next holder, or none."""
        holder = int(flight.holders[0])
        robot_id = next_hop(links.hop_count, links.rssi_dbm, holder, flight.message.receiver)
        if robot_id < 0 or (losses.may_happen[holder] and not losses.survivors(holder)[robot_id]):
            return np.array([], dtype=np.int64)
        flight.reached[robot_id] = True
        return np.array([robot_id])

    def _missed(self, flight: _Flight, links: State) -> tuple[int, int]:
        """Return how many copies of an ended flight were lost under way, and how many had no path of links."""
        sender, receiver, hops = flight.message.sender, flight.message.receiver, links.hop_count
        if receiver == EVERYBODY:
            missing = ~flight.reached & self._present
            lost = int(np.count_nonzero(missing & (hops[sender] > 0)))
            return lost, int(np.count_nonzero(missing)) - lost
        if flight.reached[receiver]:
            return 0, 0
        had_path = hops[sender, receiver] > 0 or flight.hops > 1
        return (1, 0) if had_path else (0, 1)


def deliver_at_once(hops: np.ndarray, outboxes: Sequence[Sequence[Message]], reach_all: bool) -> Inboxes:
    """Return the inbox of each robot, where every message arrives at all receivers that a path of links leads to.

    Robots that hear each other share a batch, unless there are messages to single robots.

    Args: hops: int32, shape (n, n), from `hop_count`.  reach_all: whether paths lead from everybody to everybody.
    """
    sent = [message for outbox in outboxes for message in outbox]
    if not all(message.receiver == EVERYBODY for message in sent):
        return [
            tuple(m for m in sent if m.receiver in (receiver, EVERYBODY) and hops[m.sender, receiver] > 0)
            for receiver in range(len(hops))
        ]
    inboxes: list[Sequence[Message]] = [()] * len(hops)
    for members in _connected_parts(hops, reach_all):
        batch = Batch(tuple(message for robot_id in members for message in outboxes[robot_id]))
        end = 0
        for robot_id in members:
            begin, end = end, end + len(outboxes[robot_id])
            inboxes[robot_id] = Inbox(batch, begin, end)
    return inboxes


def _connected_parts(hops: np.ndarray, reach_all: bool) -> Iterable[Sequence[int]]:
    """Return the robots of each part of the network in id order; those who are not there are in none."""
    if reach_all:
        return [range(len(hops))]
    rows = hops >= 0
    return {row.tobytes(): np.flatnonzero(row).tolist() for row in rows}.values()
