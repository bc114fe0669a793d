"""Conversion of messages between robots, and of their network, to ROS messages; `make` is that of `ros_messages`."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from robotteamsim.network.compact import CompactLinks
from robotteamsim.network.messages import Message, NetworkState, Traffic
from robotteamsim.recording.ros_messages import MAP_FRAME, Make, header


def network_messages(make: Make, time_ns: int, messages: Iterable[Message]) -> Any:
    """robotteamsim/NetworkMessages, of `network/tx` and `network/rx`."""
    return make(
        "robotteamsim/NetworkMessages",
        header=header(make, time_ns, ""),
        messages=[
            make("robotteamsim/NetworkMessage", sender=m.sender, receiver=m.receiver, payload=m.payload)
            for m in messages
        ],
    )


def network_state(make: Make, time_ns: int, network: NetworkState) -> Any:
    """robotteamsim/NetworkState."""
    return make(
        "robotteamsim/NetworkState",
        header=header(make, time_ns, MAP_FRAME),
        num_robots=len(network.adjacency),
        rssi_dbm=network.rssi_dbm.ravel(),
        link=network.link.ravel(),
        adjacency=network.adjacency.astype(np.uint8).ravel(),
        hop_count=network.hop_count.astype(np.int32).ravel(),
        break_matrix=network.break_matrix.ravel(),
        fiedler_value=float(network.fiedler_value),
        swarm_connectivity=float(network.swarm_connectivity),
        endangered=network.endangered.astype(np.uint8).ravel(),
        num_endangered=network.num_endangered,
        **_traffic(network.traffic),
    )


def network_links(make: Make, time_ns: int, links: CompactLinks) -> Any:
    """robotteamsim/NetworkLinks."""
    first, second = (np.ascontiguousarray(ids, dtype=np.uint32) for ids in links.weakened.T)
    return make(
        "robotteamsim/NetworkLinks",
        header=header(make, time_ns, MAP_FRAME),
        num_robots=len(links.present),
        present=links.present.astype(np.uint8),
        adjacency=links.adjacency.ravel(),
        endangered=links.endangered.ravel(),
        num_links=links.num_links,
        num_endangered=links.num_endangered,
        fiedler_value=float(links.fiedler_value),
        swarm_connectivity=float(links.swarm_connectivity),
        weakened_first=first,
        weakened_second=second,
        weakened_rssi_dbm=links.weakened_rssi_dbm,
        **_traffic(links.traffic),
    )


def _traffic(traffic: Traffic) -> dict[str, Any]:
    """Return the attributes that NetworkState and NetworkLinks have for the messages of a step."""
    return {
        "delivered": traffic.delivered,
        "lost": traffic.lost,
        "cut_off": traffic.cut_off,
        "mean_delay_s": float(traffic.mean_delay_s),
        "refused_senders": np.array([refusal.sender for refusal in traffic.refused], dtype=np.uint32),
        "refused_bytes": np.array([refusal.num_bytes for refusal in traffic.refused], dtype=np.uint32),
        "max_message_bytes": traffic.refused[0].limit_bytes if traffic.refused else 0,
    }
