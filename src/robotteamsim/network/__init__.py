"""Who hears whom: links, hops, connectivity, delivery of messages."""

from robotteamsim.network.graph import break_matrix, connectivity_matrix, fiedler_value, hop_count
from robotteamsim.network.messages import EVERYBODY, Message, NetworkState
from robotteamsim.network.network import Network

__all__ = [
    "EVERYBODY",
    "Message",
    "Network",
    "NetworkState",
    "break_matrix",
    "connectivity_matrix",
    "fiedler_value",
    "hop_count",
]
