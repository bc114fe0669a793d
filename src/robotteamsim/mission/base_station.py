"""The discoveries delivered to the base, according to the messages that reach it."""

from collections.abc import Sequence

from robotteamsim.interface import Discovery, Message
from robotteamsim.interface.discovery import announced_in
from robotteamsim.mission.status import DeliveredDiscoveries
from robotteamsim.scenario.scenario import Scenario


class BaseStation:
    """Stores discoveries until a message that announces them reaches the base; does nothing without a base."""

    def __init__(self, scenario: Scenario) -> None:
        self.base = scenario.base
        self.undelivered: tuple[Discovery, ...] = ()
        """The discoveries not delivered to the base, in the order of discovery."""
        self.delivered = None if self.base is None else DeliveredDiscoveries()
        self._known: set[tuple[str, str]] = set()
        """Kind and name of the delivered discoveries."""
        # A robot that covers the floor knows the position of a victim only to a cell of the voice map.
        self._within_m = scenario.mission.save_distance_m + scenario.voice.map_resolution_m

    def add(self, discovery: Discovery) -> None:
        """Add a discovery; it replaces an undelivered one of the same kind and name."""
        if self.base is not None:
            key = discovery.kind, discovery.name
            others = (known for known in self.undelivered if (known.kind, known.name) != key)
            self.undelivered = (*others, discovery)

    def forget(self, kind: str, name: str) -> None:
        """Let the next discovery of this kind and name count again."""
        self._known.discard((kind, name))

    def deliver(self, inbox: Sequence[Message], time_s: float) -> list[tuple[Discovery, bool]]:
        """Return the newly delivered discoveries: those announced in the base's inbox, and the base's own.

        Each comes with whether it is the first of its kind and name. Only that one counts: a later one is news of a
        victim who has been seen again.

        Args: time_s: of the mission's clock [s].
        """
        if self.delivered is None:
            return []
        announced = [found for message in inbox for found in announced_in(message.payload)]
        now = [
            discovery
            for discovery in self.undelivered
            if discovery.robot_id == self.base or any(found.means(discovery, self._within_m) for found in announced)
        ]
        self.undelivered = tuple(discovery for discovery in self.undelivered if discovery not in now)
        delivered = []
        for discovery in now:
            key = discovery.kind, discovery.name
            delivered.append((discovery, key not in self._known))
            if key not in self._known:
                self._known.add(key)
                self.delivered = self.delivered.with_delay(time_s - discovery.time_s)
        return delivered
