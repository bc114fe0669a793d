"""Victims whom smoke and heat harm."""

from __future__ import annotations

from robotteamsim.hazards import Doses, HazardField
from robotteamsim.mission.events import VictimCollapsed, VictimDied
from robotteamsim.mission.status import OUT_OF_DANGER, VictimState
from robotteamsim.mission.victims import Victims
from robotteamsim.scenario.fire import Fire


class Casualties:
    """The doses of the victims who are not yet saved, in a scenario with fire."""

    def __init__(self, fire: Fire) -> None:
        self._doses = Doses(fire)
        self._update_s = fire.update_s

    def forget(self, name: str) -> None:
        """Start with no dose again, for a victim who was moved."""
        self._doses.forget(name)

    def judge(
        self, field: HazardField, victims: Victims
    ) -> list[tuple[int, VictimState, VictimCollapsed | VictimDied]]:
        """Add the doses of an update of fire and smoke; return index, new state and event of all whom they harm."""
        named = zip(victims.all, victims.states, strict=True)
        exposed = [victim for victim, state in named if state not in OUT_OF_DANGER]
        changed = self._doses.expose(
            [victim.name for victim in exposed], [victim.position for victim in exposed], field, self._update_s
        )
        indices = {victim.name: index for index, victim in enumerate(victims.all)}
        return [(indices[name], state, self._event(name, state)) for name, state in changed.items() if state != "well"]

    def _event(self, name: str, state: VictimState) -> VictimCollapsed | VictimDied:
        dose = self._doses.of(name)
        return (VictimDied if state == "dead" else VictimCollapsed)(name, dose.gas, dose.heat)
