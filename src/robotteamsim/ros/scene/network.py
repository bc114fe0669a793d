"""The network in the 3D scene: its matrices or, of a large team, its compact form."""

import logging
from collections.abc import Mapping

from robotteamsim import msg
from robotteamsim.network.compact import LinksDecoder
from robotteamsim.ros.scene.feed import Feed
from robotteamsim.ros.scene.team import LinkView, link_views, link_views_without_signals
from robotteamsim.ros.transport import msg_conversion

logger = logging.getLogger(__name__)

MAX_ROBOTS_WITH_MATRICES = 100
"""Larger teams are shown without signals: their matrices would slow the environment and the scene."""


class NetworkFeed:
    """The newest network: that of `/network/state` if somebody publishes it, else that of `/network/links`."""

    def __init__(self, num_robots: int) -> None:
        """Subscribe. Args: num_robots: size of the team."""
        self._links = Feed("/network/links", msg.NetworkLinks)
        with_matrices = num_robots <= MAX_ROBOTS_WITH_MATRICES
        self._matrices = Feed("/network/state", msg.NetworkState) if with_matrices else None
        self._newest: msg.NetworkState | msg.NetworkLinks | None = None
        self.num_endangered = 0
        """Number of endangered links."""

    def look(self) -> bool:
        """Take new messages; return whether there is a new network."""
        links = self._links.newest()
        newest = None if self._matrices is None else self._matrices.newest()
        if newest is None and not isinstance(self._newest, msg.NetworkState):
            newest = links
        if newest is None:
            return False
        self._newest, self.num_endangered = newest, newest.num_endangered
        return True

    def links(self, positions_m: Mapping[int, tuple[float, float]]) -> list[LinkView]:
        """Return the links to draw. Args: positions_m: of each known robot in `map` [m]."""
        try:
            if isinstance(self._newest, msg.NetworkState):
                return link_views(msg_conversion.network_state(self._newest))
            if isinstance(self._newest, msg.NetworkLinks):
                network = LinksDecoder().decode(msg_conversion.network_links(self._newest))
                return link_views_without_signals(network, positions_m)
        except ValueError:
            logger.warning("ignoring a network that cannot be read", exc_info=True)
        return []
