"""The sensor that hears victims who call for help."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from robotteamsim import _core
from robotteamsim.propagation import FieldMap, VoiceField, VoiceSource
from robotteamsim.rng import stream
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.sections import Victim, Voice


class VoiceSensor:
    """Hears all victims that are not silenced, by the voice map [dissertation, 4.3].

    l_c and gamma of each victim are drawn once from the stream ("voice", name). The map is computed again only after a
    change.
    """

    def __init__(self, plan: FloorPlan, voice: Voice, victims: Sequence[Victim], seed: int) -> None:
        self._field = VoiceField(plan, voice)
        self._voice = voice
        self._noise_db = voice.noise_db
        self._doors = {door.name: door.closed for door in plan.doors}
        self._seed = seed
        self._sources: dict[str, VoiceSource] = {}
        self._mute = {victim.name for victim in victims if not victim.calling}
        """Victims who never call."""
        self._silenced: frozenset[str] = frozenset()
        self._map: FieldMap | None = None
        self._core: _core.sensing.VoiceSensor | None = None
        """Evaluates this map at positions."""
        self._speakers: dict[tuple[float, float], str | None] = {}
        """Results of `speaker` since the last change."""
        self.version = 0
        """Number of changes of the map so far."""
        for victim in victims:
            self._place(victim.name, victim.position)

    def map(self) -> FieldMap:
        """Return the voice level over the floor [dB]; 0 where no voice is above the noise, and in walls."""
        if self._map is None:
            calling = [source for name, source in self._sources.items() if self._calls(name)]
            self._map = self._field.map_db(calling)
        return self._map

    def hear(self, state: _core.state.State) -> None:
        """Write what each robot hears where it is into a state: the level of its cell, and the loudest cell nearby.

        The loudest cell is the one with the highest level among those whose centre is within the local-best radius; of
        equal ones, the one in the lowest row, then in the lowest column. Outside the map nothing is heard, and an
        absent robot, whose position is NaN, hears nothing.
        Raises: ValueError: a position is not finite.
        """
        self.core().hear(state)

    def core(self) -> _core.sensing.VoiceSensor:
        """Return what evaluates the current map at positions."""
        if self._core is None:
            voice_map, radius_m = self.map(), self._voice.local_best_radius_m
            self._core = _core.sensing.VoiceSensor(
                voice_map.origin_m, voice_map.resolution_m, voice_map.values, radius_m
            )
        return self._core

    def speaker(self, place_m: tuple[float, float]) -> str | None:
        """Return whose voice is the loudest at a place in `map` [m], by eq. (7) with walls; None if nobody calls.

        Of equally loud voices, it is that of the victim who was added first.
        Raises: ValueError: the place is not finite.
        """
        if place_m not in self._speakers:
            levels_db = {
                name: self._field.level_db(source, place_m)
                for name, source in self._sources.items()
                if self._calls(name)
            }
            self._speakers[place_m] = max(levels_db, key=levels_db.__getitem__, default=None)
        return self._speakers[place_m]

    def set_silenced(self, names: Collection[str]) -> None:
        """Silence these victims and let all others call. Raises: ValueError: no such victim."""
        silenced = frozenset(names)
        if silenced == self._silenced:
            return
        for name in names:
            if name not in self._sources:
                raise ValueError(f"there is no victim '{name}', only {', '.join(self._sources) or 'none'}")
        self._silenced = silenced
        self._change()

    def set_noise_db(self, noise_db: float) -> None:
        """Set the background noise [dB]. Raises: ValueError: negative or not finite."""
        self._field.set_noise_db(noise_db)
        if self._noise_db != noise_db:
            self._noise_db = noise_db
            self._change()

    def set_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Add a victim, or move the one with that name [m, map]; the victim calls (again), as loudly as before.

        Raises: ValueError: the position is not finite.
        """
        if not all(map(math.isfinite, position_m)):
            raise ValueError(f"position of victim '{name}' must be finite, got {position_m}")
        was_silent = name in self._sources and not self._calls(name)
        self._mute -= {name}
        if self._place(name, position_m) or was_silent:
            self._silenced -= {name}
            self._change()

    def move_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Move a victim [m, map], who calls, or is silent, as before. Raises: ValueError: no such victim."""
        if name not in self._sources:
            raise ValueError(f"there is no victim '{name}', only {', '.join(self._sources) or 'none'}")
        if self._place(name, position_m) and self._calls(name):
            self._change()

    def _calls(self, name: str) -> bool:
        return name not in self._silenced and name not in self._mute

    def _place(self, name: str, position_m: tuple[float, float]) -> bool:
        """Set the position of a victim, known or not, and return whether it has changed."""
        generator = stream(self._seed, "voice", name)
        constant_db = float(generator.uniform(*self._voice.constant_db))
        exponent = float(generator.uniform(*self._voice.exponent))
        source = VoiceSource(position_m, constant_db, exponent)
        has_changed = self._sources.get(name) != source
        self._sources[name] = source
        return has_changed

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door. Raises: ValueError: no such door."""
        self._field.set_door(name, closed)
        if self._doors[name] != closed:
            self._doors[name] = closed
            self._change()

    def _change(self) -> None:
        self._map = self._core = None
        self._speakers.clear()
        self.version += 1
