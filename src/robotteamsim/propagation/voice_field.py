"""Propagation of victims' voices: the voice model and the voice map."""

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim import _core
from robotteamsim.propagation.faces import UNITS_PER_DB, Faces, material_faces, thickness_faces, voice_faces
from robotteamsim.propagation.field_map import FieldMap, map_array
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import OCCUPIED, OccupancyGrid, occupancy_grid
from robotteamsim.scenario.sections import Voice

_HALF_MM_DB = 20.0 * math.log10(math.e) * 0.05
"""20 log10(A0 / A) of eq. (5) for mu = 1/cm and the unit of `thickness_faces`, half a millimetre."""


@dataclass(frozen=True, slots=True)
class VoiceSource:
    """The voice of a victim.

    position_m:  of the victim, in `map` [m].
    constant_db: l_c of eq. (7), negative [dB]: -78 is a shout of 78 dB at 1 m.
    exponent:    gamma of eq. (7), above 0.
    Raises: ValueError: constant_db or exponent is not finite, or exponent is not above 0.
    """

    position_m: tuple[float, float]
    constant_db: float
    exponent: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.constant_db):
            raise ValueError(f"constant_db must be finite, got {self.constant_db}")
        if not (self.exponent > 0.0 and math.isfinite(self.exponent)):
            raise ValueError(f"exponent must be finite and > 0, got {self.exponent}")

    def core(self) -> _core.propagation.VoiceSource:
        """Return this source for the C++ core."""
        return _core.propagation.VoiceSource(self.position_m, self.constant_db, self.exponent)


def voice_obstacles(plan: FloorPlan, voice: Voice) -> tuple[Faces, float]:
    """Return the faces that attenuate voices by `voice.wall_model`, and the loss of one unit [dB]."""
    if voice.wall_model == "material":
        return material_faces(plan, voice), 1.0 / UNITS_PER_DB
    by_thickness = voice.wall_model == "thickness"
    unit_db = _HALF_MM_DB * voice.attenuation_per_cm if by_thickness else voice.wall_loss_db / 2.0
    floor_units = round(voice.floor_loss_db / unit_db) if unit_db > 0.0 else 0
    return thickness_faces(plan, floor_units) if by_thickness else voice_faces(plan, floor_units), unit_db


@functools.lru_cache(maxsize=16)
def _grid_and_solid_cells(plan: FloorPlan, resolution_m: float) -> tuple[OccupancyGrid, np.ndarray]:
    """Return the grid of a voice map and its solid cells, bool; trials on one plan share them."""
    # A door's leaf is thinner than a cell, so doors do not make cells solid.
    grid = occupancy_grid(plan.model_copy(update={"doors": ()}), resolution_m)
    solid = grid.cells == OCCUPIED
    grid.cells.flags.writeable = solid.flags.writeable = False
    return grid, solid


class VoiceField:
    """Voice levels on one floor [dissertation, eq. 7]; docs/propagation.md defines them.

    level(d) = -l_c - 10 gamma log10(d) - walls. With `voice.wall_model: count` the walls, blocks, pillars and closed
    doors on the straight line cost K l_w (6); with `thickness`, 20 log10(e) mu d, d being their thicknesses (5); with
    `material`, those of the plan's materials what their mass makes them lose, see `material_faces`.
    Positions are rounded to whole millimetres.
    """

    def __init__(self, plan: FloorPlan, voice: Voice) -> None:
        self._faces, self._unit_db = voice_obstacles(plan, voice)
        self._core_faces = self._faces.core()
        self._grid, self._solid = _grid_and_solid_cells(plan, voice.map_resolution_m)
        self._voice = voice
        self.set_noise_db(voice.noise_db)

    def level_db(self, source: VoiceSource, at_m: tuple[float, float]) -> float:
        """Return the level of eq. (7) at a point in `map`, also below the noise [dB].

        Raises: ValueError: a coordinate is not finite.
        """
        return _core.propagation.voice_level_db(self._core_faces, self._model, source.core(), at_m)

    def map_db(self, sources: Sequence[VoiceSource], *, out: np.ndarray | None = None, threads: int = 1) -> FieldMap:
        """Return the highest level of all sources in each cell [dB]; 0 below the noise and in cells that touch a solid.

        Levels are within 5e-5 dB of `level_db`, and bit-identical on all machines.
        Args:   out: float32, shape (rows, cols), C-contiguous: the map is written here, without allocating memory.
                threads: number of threads, 0 for one per core; it does not change the values.
        Raises: ValueError: a source's position is not finite, or `out` has another shape or type.
        """
        values = map_array(self._solid.shape, out)
        _core.propagation.write_voice_map_db(
            self._core_faces,
            self._model,
            [source.core() for source in sources],
            self._grid.origin_m,
            self._grid.resolution_m,
            self._solid,
            values,
            threads,
        )
        return FieldMap(self._grid.origin_m, self._grid.resolution_m, values)

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door. Raises: ValueError: no such door."""
        self._core_faces.set_active(self._faces.door_face(name), closed)

    def set_noise_db(self, noise_db: float) -> None:
        """Set the background noise [dB], below which voices are not heard. Raises: ValueError: negative, not finite."""
        if not 0.0 <= noise_db < float("inf"):
            raise ValueError(f"noise_db must be finite and >= 0, got {noise_db}")
        self._model = _core.propagation.VoiceModel(
            noise_db=noise_db, unit_db=self._unit_db, min_distance_m=self._voice.min_distance_m
        )
