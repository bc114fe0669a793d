"""How people leave: doses, lost visibility, exits, and the available against the required safe egress time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim.hazards import Dose, Doses, HazardField
from robotteamsim.hazards.field import FARTHEST_SIGHT_M
from robotteamsim.mission.events import ExitUntenable, VisibilityLost
from robotteamsim.mission.status import OUT_OF_DANGER
from robotteamsim.mission.victims import Casualties, Victims
from robotteamsim.scenario.rescue import Exit
from robotteamsim.scenario.scenario import Scenario

AT_CENTRE = "command centre"
"""Replaces the exit of people who are safe because they have reached the command centre."""


class PersonEgress(msgspec.Struct, frozen=True):
    """What fire and smoke have done to a person, and when they were safe. Times are of the mission's clock [s].

    flees:              whether they leave by themselves.
    gas, heat:          fractional effective doses (FED).
    visibility_m:       at their place; where they were last, if they are safe or dead.
    least_visibility_m: that they have met.
    untenable_s:        since when their conditions are untenable, by `fire.tenability`; None: they never were.
    out_s:              since when they are safe; None: they are not.
    exit:               by which; AT_CENTRE; "": they are not. A victim whom a robot saves stays in the building.
    """

    name: str
    flees: bool = False
    gas: float = 0.0
    heat: float = 0.0
    visibility_m: float = FARTHEST_SIGHT_M
    least_visibility_m: float = FARTHEST_SIGHT_M
    untenable_s: float | None = None
    out_s: float | None = None
    exit: str = ""

    @property
    def dose(self) -> float:
        """The larger dose."""
        return max(self.gas, self.heat)


class ExitEgress(msgspec.Struct, frozen=True):
    """The conditions at the centre of an exit; the doses are of somebody who stays there from the start."""

    name: str
    gas: float = 0.0
    heat: float = 0.0
    visibility_m: float = FARTHEST_SIGHT_M
    untenable_s: float | None = None


class Egress(msgspec.Struct, frozen=True):
    """How people leave, as of a step. Times are of the mission's clock [s].

    ignition_s: when the first fire began; None: nothing has burnt.
    people:     in the order of the mission's victims.
    exits:      in the order of `mission.exits`.
    """

    ignition_s: float | None = None
    people: tuple[PersonEgress, ...] = ()
    exits: tuple[ExitEgress, ...] = ()

    @property
    def evacuees(self) -> tuple[PersonEgress, ...]:
        """Those whose egress counts: people who flee; if nobody does, everybody."""
        return tuple(person for person in self.people if person.flees) or self.people

    @property
    def rset_s(self) -> float | None:
        """Required safe egress time: from ignition until the last evacuee is safe [iso13571]; None: not all are."""
        out_s = [person.out_s for person in self.evacuees]
        known_s = [time_s for time_s in out_s if time_s is not None]
        return max(known_s) - self.begin_s if known_s and len(known_s) == len(out_s) else None

    @property
    def aset_s(self) -> float | None:
        """Available safe egress time: from ignition until conditions are untenable for the first evacuee [iso13571].

        None: they were not, for anybody, before they were safe.
        """
        untenable_s = [person.untenable_s for person in self.evacuees if person.untenable_s is not None]
        return min(untenable_s) - self.begin_s if untenable_s else None

    @property
    def begin_s(self) -> float:
        """The time from which both egress times count: of the ignition; without one, of the mission's start."""
        return self.ignition_s or 0.0

    @property
    def num_out(self) -> dict[str, int]:
        """How many people are safe, by exit: all exits of the mission, then other places that somebody has reached."""
        counts = Counter(person.exit for person in self.people if person.out_s is not None)
        return {way_out.name: 0 for way_out in self.exits} | dict(sorted(counts.items()))

    @property
    def num_untenable(self) -> int:
        """How many evacuees met untenable conditions before they were safe."""
        return sum(person.untenable_s is not None for person in self.evacuees)

    @property
    def has_ways_out(self) -> bool:
        """Whether people can leave: there are exits, or somebody is safe at the command centre."""
        return bool(self.exits) or any(person.out_s is not None for person in self.people)

    def values(self) -> dict[str, Any]:
        """Return everything as plain values for JSON."""
        totals = {
            "aset_s": self.aset_s,
            "rset_s": self.rset_s,
            "num_untenable": self.num_untenable,
            "out": self.num_out,
        }
        parts: dict[str, Any] = msgspec.to_builtins(self)
        return {"ignition_s": parts.pop("ignition_s"), **totals, **parts}


class EgressMonitor:
    """Follows the egress of a mission with fire or exits, step by step."""

    def __init__(self, scenario: Scenario) -> None:
        self._exits: tuple[Exit, ...] = scenario.mission.exits
        self._limits = None if scenario.fire is None else scenario.fire.tenability
        self._update_s = 0.0 if scenario.fire is None else scenario.fire.update_s
        self._exit_doses = None if scenario.fire is None else Doses(scenario.fire)
        self._egress = Egress(
            people=tuple(PersonEgress(victim.name, victim.flees) for victim in scenario.mission.victims),
            exits=tuple(ExitEgress(way_out.name) for way_out in self._exits),
        )

    @property
    def state(self) -> Egress:
        """The egress so far."""
        return self._egress

    def ignite(self, time_s: float) -> None:
        """Note that something has begun to burn at a time of the mission's clock [s]."""
        if self._egress.ignition_s is None:
            self._egress = msgspec.structs.replace(self._egress, ignition_s=time_s)

    def leave(self, name: str, time_s: float, exit_name: str) -> None:
        """Note that somebody is safe since a time of the mission's clock [s], by an exit; see `PersonEgress.exit`."""
        self._set_people(
            msgspec.structs.replace(person, out_s=time_s, exit=exit_name) if person.name == name else person
            for person in self._egress.people
        )

    def place(self, name: str) -> None:
        """Start again with a victim who was added, or moved."""
        others = [person.name for person in self._egress.people]
        people = self._egress.people if name in others else (*self._egress.people, PersonEgress(name))
        self._set_people(PersonEgress(name) if person.name == name else person for person in people)

    def expose(
        self, time_s: float, field: HazardField, victims: Victims, casualties: Casualties
    ) -> Iterator[VisibilityLost | ExitUntenable]:
        """Note an update of fire and smoke; yield who cannot see far any more, and which exits become untenable.

        Args: time_s: of the mission's clock [s].
        """
        yield from self._expose_people(time_s, field, victims, casualties)
        if self._exits:
            yield from self._expose_exits(time_s, field)

    def _expose_people(
        self, time_s: float, field: HazardField, victims: Victims, casualties: Casualties
    ) -> Iterator[VisibilityLost]:
        assert self._limits is not None
        visibilities_m = _visibility_m(field, [victim.position for victim in victims.all])
        people = []
        for person, state, visibility_m in zip(self._egress.people, victims.states, visibilities_m, strict=True):
            dose = casualties.dose_of(person.name)
            now = msgspec.structs.replace(person, gas=dose.gas, heat=dose.heat)
            if state not in OUT_OF_DANGER:
                now = msgspec.structs.replace(
                    now, visibility_m=visibility_m, least_visibility_m=min(visibility_m, now.least_visibility_m)
                )
                if person.untenable_s is None and self._is_untenable(dose, visibility_m):
                    now = msgspec.structs.replace(now, untenable_s=time_s)
                if now.least_visibility_m < self._limits.visibility_m <= person.least_visibility_m:
                    yield VisibilityLost(person.name, visibility_m)
            people.append(now)
        self._set_people(people)

    def _expose_exits(self, time_s: float, field: HazardField) -> Iterator[ExitUntenable]:
        assert self._exit_doses is not None
        names, places = [way_out.name for way_out in self._exits], [way_out.center for way_out in self._exits]
        self._exit_doses.expose(names, places, field, self._update_s)
        exits = []
        for way_out, visibility_m in zip(self._egress.exits, _visibility_m(field, places), strict=True):
            dose = self._exit_doses.of(way_out.name)
            untenable_s = way_out.untenable_s
            if untenable_s is None and self._is_untenable(dose, visibility_m):
                untenable_s = time_s
                yield ExitUntenable(way_out.name, visibility_m, dose.gas, dose.heat)
            exits.append(ExitEgress(way_out.name, dose.gas, dose.heat, visibility_m, untenable_s))
        self._egress = msgspec.structs.replace(self._egress, exits=tuple(exits))

    def _is_untenable(self, dose: Dose, visibility_m: float) -> bool:
        assert self._limits is not None
        return dose.worst >= self._limits.dose or visibility_m < self._limits.visibility_m

    def _set_people(self, people: Iterator[PersonEgress] | Sequence[PersonEgress]) -> None:
        self._egress = msgspec.structs.replace(self._egress, people=tuple(people))


def _visibility_m(field: HazardField, places: Sequence[tuple[float, float]]) -> list[float]:
    if not places:
        return []
    found: list[float] = field.visibility_m(np.array(places, dtype=np.float64)).tolist()
    return found
