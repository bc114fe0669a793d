"""The victims of a mission: where they are, in which state, who calls, and whom smoke and heat harm."""

from __future__ import annotations

from collections.abc import Container, Mapping

import msgspec

from robotteamsim.hazards import Dose, Doses, HazardField
from robotteamsim.mission.events import Happening, VictimCollapsed, VictimDied
from robotteamsim.mission.status import NOT_ALONE, OUT_OF_DANGER, SILENT, VictimState
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.victims import Victim


class VictimNews(msgspec.Struct, frozen=True):
    """What happens to a victim in a step.

    index: of the victim.       state: from now on; None: as before.
    event: None if this is none.
    found: by whom and where the victim was located, which is a discovery; None: it is none.
    """

    index: int
    state: VictimState | None = None
    event: Happening | None = None
    found: tuple[int, Point] | None = None


class Victims:
    """All victims, in the order in which they were added. They change only by the methods."""

    def __init__(self, victims: tuple[Victim, ...]) -> None:
        self.all = victims
        """At their current positions."""
        self.states: list[VictimState] = ["waiting"] * len(victims)
        """Of each; changed by `change`."""
        self.collapsed: set[str] = set()
        """Names of those who have collapsed, whatever has happened to them since."""
        self.version = 0
        """Number of changes of places and states."""
        self._note_who_calls()

    def index(self, name: str) -> int | None:
        """Return the index of a victim; None if there is none of that name."""
        return next((index for index, victim in enumerate(self.all) if victim.name == name), None)

    def place(self, name: str, position_m: Point) -> int:
        """Add a victim, or move the one of that name, who then waits and calls; return the index."""
        found = self.index(name)
        index = len(self.all) if found is None else found
        self.all = (*self.all[:index], Victim(name=name, position=position_m), *self.all[index + 1 :])
        self.states[index : index + 1] = ["waiting"]
        self.collapsed.discard(name)
        self.version += 1
        self._note_who_calls()
        return index

    def move(self, places: Mapping[str, Point]) -> bool:
        """Move victims who are still in danger, by name [m, map]; return whether anybody has moved."""
        moved = tuple(
            victim
            if state in OUT_OF_DANGER or places.get(victim.name, victim.position) == victim.position
            else victim.model_copy(update={"position": places[victim.name]})
            for victim, state in zip(self.all, self.states, strict=True)
        )
        if moved == self.all:
            return False
        self.all = moved
        self.version += 1
        self._note_who_calls()
        return True

    def change(self, index: int, state: VictimState) -> bool:
        """Set a victim's state; return whether they have fallen silent or call again, which changes the voice map."""
        was_silent = self.states[index] in SILENT
        self.states[index] = state
        self.version += 1
        if was_silent == (state in SILENT):
            return False
        self._note_who_calls()
        return True

    def collapse(self, name: str) -> None:
        """Note that somebody has collapsed or died: they walk no more."""
        self.collapsed.add(name)

    def needs_help(self, index: int, enclosed: Container[str]) -> bool:
        """Return whether a victim cannot leave by themselves. Args: enclosed: to whom no path to an exit is open."""
        victim = self.all[index]
        return not victim.flees or victim.name in enclosed or victim.name in self.collapsed

    def somebody_flees(self, enclosed: Container[str]) -> bool:
        """Return whether somebody in the building may still reach an exit by themselves."""
        return any(
            state not in NOT_ALONE and not self.needs_help(index, enclosed) for index, state in enumerate(self.states)
        )

    def _note_who_calls(self) -> None:
        named = zip(self.all, self.states, strict=True)
        self.silent = tuple([victim.name for victim, state in named if state in SILENT])
        """Names of the victims who call no more."""


class Casualties:
    """The doses of the victims who are not yet saved, in a scenario with fire."""

    def __init__(self, fire: Fire) -> None:
        self._doses = Doses(fire)
        self._update_s = fire.update_s

    def dose_of(self, name: str) -> Dose:
        """Return the dose of a victim."""
        return self._doses.of(name)

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
