"""Victims whom smoke and heat harm."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.hazards import Doses, HazardField
from robotteamsim.mission.status import OUT_OF_DANGER, VictimState
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.victims import Victim


class Casualties:
    """The doses of the victims who are not yet saved, in a scenario with fire."""

    def __init__(self, fire: Fire) -> None:
        self._doses = Doses(fire)
        self._update_s = fire.update_s
        self._field: HazardField | None = None

    def follow(self, field: HazardField | None) -> None:
        """Note fire and smoke of the current step; None if it has no update of them."""
        self._field = field

    def forget(self, name: str) -> None:
        """Start with no dose again, for a victim who was moved."""
        self._doses.forget(name)

    def judge(self, victims: Sequence[Victim], states: Sequence[VictimState]) -> list[tuple[int, VictimState, str]]:
        """Add the doses of an update; return index, new state and dose, as a text, of each victim whom they harm."""
        field, self._field = self._field, None
        if field is None:
            return []
        exposed = [victim for victim, state in zip(victims, states, strict=True) if state not in OUT_OF_DANGER]
        changed = self._doses.expose(
            [victim.name for victim in exposed], [victim.position for victim in exposed], field, self._update_s
        )
        indices = {victim.name: index for index, victim in enumerate(victims)}
        return [(indices[name], state, self._text(name)) for name, state in changed.items() if state != "well"]

    def _text(self, name: str) -> str:
        dose = self._doses.of(name)
        return f"FED {dose.gas:.2f} from gas, {dose.heat:.2f} from heat"
