"""The radio network of a team: links, hops, connectivity, delivery of messages."""

from robotteamsim.network.delivery import loss_probability
from robotteamsim.network.graph import fiedler_value, hop_count, newly_endangered, next_hop
from robotteamsim.network.messages import EVERYBODY, Message, NetworkState, Refusal, Traffic
from robotteamsim.network.network import Network

__all__ = [
    "EVERYBODY",
    "Message",
    "Network",
    "NetworkState",
    "Refusal",
    "Traffic",
    "fiedler_value",
    "hop_count",
    "loss_probability",
    "newly_endangered",
    "next_hop",
]
