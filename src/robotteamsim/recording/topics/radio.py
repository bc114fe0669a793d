"""The topics of voices, of messages between robots, and of their network."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

import msgspec
import numpy as np

from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, point
from robotteamsim.network.compact import CompactLinks, hops_among, row_bytes, unpacked
from robotteamsim.network.messages import Message, NetworkState, Traffic
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics.base import (
    Source,
    Topic,
    When,
    field_map,
    field_map_picture,
    read_field_map,
    read_point,
)
from robotteamsim.scenario.sensors.base import expect_within
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.simulation import StepRecord

LOUDEST_DB = 1e6
LARGEST_DBM = 1e3
"""Larger signals are not measurements; they are shown as such."""


class PublishedNetwork(msgspec.Struct, frozen=True, eq=False):
    """The network of n robots, as /network/state and /network/links have it.

    adjacency, endangered: bool, shape (n, n).
    hop_count:   int32, shape (n, n); -1 if no path exists, and on the diagonal for an absent robot.
    signals_dbm: of links, int16, shape (n, n), rounded, 0 elsewhere [dBm]; None where only links are published.
    """

    adjacency: np.ndarray
    endangered: np.ndarray
    hop_count: np.ndarray
    fiedler_value: float
    signals_dbm: np.ndarray | None = None


def voice(time_ns: int, reading: VoiceReading) -> RosMessage:
    """robotteamsim/Voice."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "level_db": reading.level_db,
        "heard": reading.heard,
        "local_best": point(reading.local_best_m),
        "local_best_level_db": reading.local_best_level_db,
    }


def read_voice(message: Any) -> VoiceReading:
    """Return what a robot hears. Raises: ValueError: impossible levels or places."""
    expect_within("level_db", message.level_db, 0.0, LOUDEST_DB)
    expect_within("local_best_level_db", message.local_best_level_db, 0.0, LOUDEST_DB)
    place_m = read_point("local_best", message.local_best)
    return VoiceReading(message.level_db, bool(message.heard), place_m, message.local_best_level_db)


def radio_map_picture(time_ns: int, field: FieldMap) -> RosMessage:
    """nav_msgs/OccupancyGrid of a map of signal strengths, for rviz: 0 at -100 dBm and below, 100 at 0 dBm."""
    return field_map_picture(time_ns, FieldMap(field.origin_m, field.resolution_m, field.values + 100.0))


def network_messages(time_ns: int, messages: Iterable[Message]) -> RosMessage:
    """robotteamsim/NetworkMessages, of `network/tx` and `network/rx`."""
    return {
        "header": header(time_ns, ""),
        "messages": [{"sender": m.sender, "receiver": m.receiver, "payload": m.payload} for m in messages],
    }


def read_network_messages(message: Any, num_robots: int) -> list[Message]:
    """Return the messages of `network/tx` or `network/rx`, in their order. Raises: ValueError: unknown ids."""
    for one in message.messages:
        if not 0 <= one.sender < num_robots or not -1 <= one.receiver < num_robots:
            raise ValueError(f"a message from {one.sender} to {one.receiver}; expected ids below {num_robots}")
    return [Message(one.sender, one.receiver, one.payload) for one in message.messages]


def read_outbox(message: Any, robot_id: int, num_robots: int) -> list[Message]:
    """Return the messages of a robot's `network/tx`. Raises: ValueError: unknown ids, or another sender."""
    sent = read_network_messages(message, num_robots)
    for one in sent:
        if one.sender != robot_id:
            raise ValueError(f"a message from {one.sender}; expected only from {robot_id}")
    return sent


def network_state(time_ns: int, network: NetworkState) -> RosMessage:
    """robotteamsim/NetworkState."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "num_robots": len(network.adjacency),
        "rssi_dbm": network.rssi_dbm,
        "link": network.link,
        "adjacency": network.adjacency,
        "hop_count": network.hop_count,
        "break_matrix": network.break_matrix,
        "fiedler_value": network.fiedler_value,
        "swarm_connectivity": network.swarm_connectivity,
        "endangered": network.endangered,
        "num_endangered": network.num_endangered,
        **_traffic(network.traffic),
    }


def read_network_state(message: Any) -> PublishedNetwork:
    """Return the network of a NetworkState. Raises: ValueError: matrices of another size."""
    n = message.num_robots
    matrices = message.adjacency, message.endangered, message.hop_count, message.rssi_dbm
    if wrong := [len(matrix) for matrix in matrices if len(matrix) != n * n]:
        raise ValueError(f"a matrix of {wrong[0]} values; expected {n * n}")
    adjacency, endangered, hop_count, rssi_dbm = (np.reshape(matrix, (n, n)) for matrix in matrices)
    links = adjacency.astype(bool)
    known_dbm = np.clip(np.where(links & np.isfinite(rssi_dbm), rssi_dbm, 0.0), -LARGEST_DBM, LARGEST_DBM)
    signals_dbm = np.rint(known_dbm).astype(np.int16)
    return PublishedNetwork(links, endangered.astype(bool), hop_count, message.fiedler_value, signals_dbm)


def network_links(time_ns: int, links: CompactLinks) -> RosMessage:
    """robotteamsim/NetworkLinks."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "num_robots": len(links.present),
        "present": links.present,
        "adjacency": links.adjacency,
        "endangered": links.endangered,
        "num_links": links.num_links,
        "num_endangered": links.num_endangered,
        "fiedler_value": links.fiedler_value,
        "swarm_connectivity": links.swarm_connectivity,
        "weakened_first": links.weakened[:, 0].tolist(),
        "weakened_second": links.weakened[:, 1].tolist(),
        "weakened_rssi_dbm": links.weakened_rssi_dbm,
        **_traffic(links.traffic),
    }


def read_network_links(message: Any) -> PublishedNetwork:
    """Return the network of a NetworkLinks. Raises: ValueError: rows of another size, or links of absent robots."""
    n = message.num_robots
    shape = (n, row_bytes(n))
    rows = [np.frombuffer(bits, np.uint8) for bits in (message.adjacency, message.endangered)]
    present = np.frombuffer(message.present, np.uint8) != 0
    if not (all(bits.size == shape[0] * shape[1] for bits in rows) and len(present) == n):
        raise ValueError(f"rows of {rows[0].size} bytes; expected {shape[0] * shape[1]}")
    adjacency, endangered = (unpacked(bits.reshape(shape), n) for bits in rows)
    return PublishedNetwork(adjacency, endangered, hops_among(adjacency, present), message.fiedler_value)


def _traffic(traffic: Traffic) -> dict[str, Any]:
    """Return the attributes that NetworkState and NetworkLinks have for the messages of a step."""
    return {
        "delivered": traffic.delivered,
        "lost": traffic.lost,
        "cut_off": traffic.cut_off,
        "mean_delay_s": traffic.mean_delay_s,
        "refused_senders": [refusal.sender for refusal in traffic.refused],
        "refused_bytes": [refusal.num_bytes for refusal in traffic.refused],
        "max_message_bytes": traffic.refused[0].limit_bytes if traffic.refused else 0,
    }


VOICE = Topic(
    "voice",
    "robotteamsim/Voice",
    When.STEP,
    lambda _, step, i: (step.voices[i],),
    voice,
    read=lambda message, *_: read_voice(message),
)
INBOX = Topic(
    "network/rx",
    "robotteamsim/NetworkMessages",
    When.STEP,
    lambda _, step, i: (step.inboxes[i],),
    network_messages,
    read=lambda message, setup, _: read_network_messages(message, setup.scenario.team_size),
)
HEARD_TOPICS = (VOICE, INBOX)
"""What a robot hears and receives."""

RADIO_MAP = Topic(
    "radio_map/values",
    "robotteamsim/FloatMap",
    When.REQUEST,
    lambda _, signals, __: (signals, "rssi", "dBm"),
    field_map,
    in_bags=False,
)
RADIO_MAP_TOPICS = (
    Topic(
        "radio_map",
        "nav_msgs/OccupancyGrid",
        When.REQUEST,
        lambda _, signals, __: (signals,),
        radio_map_picture,
        in_bags=False,
    ),
    RADIO_MAP,
)
"""The signal of a robot over the floor: here, the step is that `FieldMap`."""


def _voice_map(_: Source, record: StepRecord) -> tuple[FieldMap] | None:
    return None if record.voice_map is None else (record.voice_map,)


VOICE_MAP = Topic(
    "/voice_map/values",
    "robotteamsim/FloatMap",
    When.CHANGE,
    _voice_map,
    partial(field_map, quantity="voice_level", unit="dB"),
    latched=True,
    read=lambda message, *_: read_field_map(message),
)
VOICE_MAP_TOPICS = (
    Topic("/voice_map", "nav_msgs/OccupancyGrid", When.CHANGE, _voice_map, field_map_picture, latched=True),
    VOICE_MAP,
)

NETWORK_STATE = Topic(
    "/network/state",
    "robotteamsim/NetworkState",
    When.STEP,
    lambda _, record: (record.network,),
    network_state,
    is_in=lambda scenario: scenario.network.publish_matrices,
    read=lambda message, *_: read_network_state(message),
)
NETWORK_LINKS = Topic(
    "/network/links",
    "robotteamsim/NetworkLinks",
    When.STEP,
    lambda source, record: (source.links.encode(record.network),),
    network_links,
    read=lambda message, *_: read_network_links(message),
)
NETWORK_TOPICS = (NETWORK_LINKS, NETWORK_STATE)
