"""Fire and smoke of one trial."""

from __future__ import annotations

import functools
from collections import deque
from typing import Protocol

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.hazards.field import BURNING, HazardField
from robotteamsim.hazards.topology import Topology, check_free, fuel_of_cells, topology
from robotteamsim.rng import stream
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.fire import Fire, updates
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.scenario import Scenario

_AIR_KJ_M3_K = 1.204 * 1.005
"""Heat capacity of a cubic metre of air at 20 degC [kJ/(m^3 K)]."""


class ClosedDoors(Protocol):
    """The doors of a plan; `world.doors.DoorStates` is one."""

    version: int

    def closed(self) -> dict[str, bool]:
        """Return whether each door is closed, by name."""


class HazardSource(Protocol):
    """Fire and smoke as functions of time: simulated, or the result of another program."""

    field: HazardField
    """Of the last update."""
    updated: bool
    """Whether the last step was an update."""

    def step(self, sim_time_ns: int, doors: ClosedDoors) -> bool:
        """Advance to the step with this stamp [ns]; return whether this was an update, see `Fire.updates_at`."""

    def ignite(self, position_m: Point) -> None:
        """Set fire to a place in `map` [m]. Raises: ValueError: nothing burns there."""

    def burnt_doors(self) -> tuple[str, ...]:
        """Return the names of the doors that have burnt through, which cannot be closed any more."""


class Hazards:
    """Simulated fire and smoke. It depends only on the scenario, the doors, and the ignitions.

    Random stream: ("fire",), one number per cell.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Prepare. Raises: PlacementError: fuel or an ignition is outside or in a wall, or an ignition has no fuel."""
        assert scenario.fire is not None
        self._plan, self._fire = scenario.plan, scenario.fire
        self._step_ns, self._update_ns = scenario.run.step_ns, self._fire.update_ns
        self.updated = False
        """Whether the last step was an update."""
        self._cells, self._fuel = _cells_and_fuel(scenario.plan, scenario.fire)
        self._ignitions = deque(sorted(_ignitions(scenario, self._cells, self._fuel)))
        self._core = _core.hazards.BurningFloor(
            self._cells.east,
            self._cells.north,
            list(self._cells.crossings),
            [_door(door, self._fire) for door in self._plan.doors],
            [_fuel(fuel.load_mj_m2, fuel.peak_kw_m2, fuel.growth_kw_s2, self._fire) for fuel in self._fire.fuel],
            self._fuel,
            stream(scenario.run.seed, "fire").exponential(size=self._cells.shape),
            cell_m=self._fire.cell_m,
            diffusivity_m2_s=self._fire.soot.diffusivity_m2_s,
            ambient_c=self._fire.heat.ambient_c,
            heat_kj_m2_k=_AIR_KJ_M3_K * self._fire.soot.height_m,
            convection_kw_m2_k=self._fire.heat.convection_w_m2_k / 1e3,
            emissivity=self._fire.heat.emissivity,
            soot_g_kj=self._fire.soot.yield_g_g / self._fire.soot.heat_kj_g,
            convective_share=self._fire.heat.convective_share,
        )
        self._doors_version: int | None = 0
        self._has_burnt = False
        self._burnt_doors: tuple[str, ...] = ()
        self.field = self._read()
        """Of the last update."""

    def step(self, sim_time_ns: int, doors: ClosedDoors) -> bool:
        """Advance to the step with this stamp [ns]; return whether this was an update, see `Fire.updates_at`."""
        self.updated = updates(sim_time_ns, self._step_ns, self._update_ns)
        if not self.updated:
            return False
        self._ignite_due(sim_time_ns - self._step_ns)
        if doors.version != self._doors_version or doors.version < 0:
            self._doors_version = doors.version
            closed = doors.closed()
            for index, door in enumerate(self._plan.doors):
                self._core.set_door(index, closed[door.name])
        if self._has_burnt:
            self._core.advance(self._fire.update_s)
            self._note_burnt_doors()
            self.field = self._read()
        return True

    def ignite(self, position_m: Point) -> None:
        """Set fire to a place in `map` [m]. Raises: ValueError: it is in a wall or outside, or nothing burns there."""
        try:
            row, col = _burning_cell(self._plan, "ignite", position_m, self._cells, self._fuel)
        except PlacementError as error:
            raise ValueError(str(error)) from None
        self._has_burnt |= self._core.ignite(row * self._cells.shape[1] + col)

    def burnt_doors(self) -> tuple[str, ...]:
        """Return the names of the doors that have burnt through."""
        return self._burnt_doors

    @property
    def heat_release_kw(self) -> float:
        """Heat release rate of the whole fire [kW]."""
        return self._core.heat_release_kw

    @property
    def soot_g(self) -> float:
        """Mass of the soot in the air [g]."""
        return float(np.sum(self._core.soot_g_m2())) * self._fire.cell_m**2

    @property
    def burning(self) -> np.ndarray:
        """Which cells burn, bool, shape (rows, cols); row 0 at the lowest y."""
        return self.field.burning

    @property
    def origin_m(self) -> Point:
        """Lower left corner of the cells in `map` [m]."""
        return self._cells.origin_m

    @property
    def resolution_m(self) -> float:
        """Size of a cell [m]."""
        return self._cells.resolution_m

    def temperature_c(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the temperature at some places, shape (n, 2) in `map` [m], in the last update [degC]."""
        return self.field.temperature_c(positions_m)

    def soot(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the soot in the air at some places in the last update [g/m^3]."""
        return self.field.soot(positions_m)

    def visibility_m(self, positions_m: np.ndarray) -> np.ndarray:
        """Return how far people see at some places in the last update [m]."""
        return self.field.visibility_m(positions_m)

    def _ignite_due(self, begin_ns: int) -> None:
        while self._ignitions and self._ignitions[0][0] <= begin_ns:
            self._has_burnt |= self._core.ignite(self._ignitions.popleft()[1])

    def _note_burnt_doors(self) -> None:
        burnt = tuple(door.name for i, door in enumerate(self._plan.doors) if self._core.is_burnt_through(i))
        if burnt != self._burnt_doors:
            self._burnt_doors = burnt

    def _read(self) -> HazardField:
        heat = self._fire.heat
        return HazardField(
            self._cells.origin_m,
            self._cells.resolution_m,
            self._core.temperature_c(heat.ambient_c, heat.flame_c),
            self._core.soot_g_m3(self._fire.soot.height_m),
            self._core.states(),
            self._fire,
        )


# Cached for the trials of a campaign: drawing the cells takes some tenths of a second.
@functools.lru_cache(maxsize=16)
def _cells_and_fuel(plan: FloorPlan, fire: Fire) -> tuple[Topology, np.ndarray]:
    cells = topology(plan, fire.cell_m)
    return cells, fuel_of_cells(plan, fire, cells)


def _ignitions(scenario: Scenario, cells: Topology, kinds: np.ndarray) -> list[tuple[int, int]]:
    """Return time [ns] and cell of each ignition of the fire and of the schedule."""
    assert scenario.fire is not None
    places = [
        (f"fire.ignitions.{i}.position", ignition.at_s, ignition.position)
        for i, ignition in enumerate(scenario.fire.ignitions)
    ]
    places += [
        (f"schedule.{i}.ignite", event.at_s, event.ignite)
        for i, event in enumerate(scenario.schedule)
        if event.ignite is not None
    ]
    found = []
    for key, at_s, position in places:
        row, col = _burning_cell(scenario.plan, key, position, cells, kinds)
        found.append((round(at_s * 1e9), row * cells.shape[1] + col))
    return found


def _burning_cell(plan: FloorPlan, key: str, position: Point, cells: Topology, kinds: np.ndarray) -> tuple[int, int]:
    """Return the cell of a place. Raises: PlacementError: it is outside, in a wall, or without fuel."""
    row, col = check_free(plan, key, position, cells)
    if kinds[row, col] < 0:
        place = f"[{position[0]:g}, {position[1]:g}]"
        raise PlacementError(f"{key}: {place}: there is no fuel; expected a place of fire.fuel", key)
    return row, col


def _door(door: Door, fire: Fire) -> tuple[bool, float, float]:
    """Return whether a door is closed at the start, its leakage when closed, and how long it endures flames [s]."""
    if door.kind == "fireproof" or door.name in fire.fireproof:
        return door.closed, 0.0, -1.0
    return door.closed, fire.soot.door_leakage, fire.heat.door_endures_s


def _fuel(load_mj_m2: float, peak_kw_m2: float, growth_kw_s2: float, fire: Fire) -> tuple[float, float, float]:
    """Return load [kJ] and peak [kW] of one cell, and its growth [kW/s^2]."""
    area_m2 = fire.cell_m**2
    return load_mj_m2 * 1e3 * area_m2, peak_kw_m2 * area_m2, growth_kw_s2


def ambient_field(scenario: Scenario) -> HazardField:
    """Return the field before anything burns."""
    assert scenario.fire is not None
    cells, _ = _cells_and_fuel(scenario.plan, scenario.fire)
    shape = cells.shape
    ambient = np.full(shape, scenario.fire.heat.ambient_c, dtype=np.float32)
    nothing = np.zeros(shape, dtype=np.float32)
    return HazardField(
        cells.origin_m, cells.resolution_m, ambient, nothing, np.zeros(shape, dtype=np.uint8), scenario.fire
    )


def is_burning(field: HazardField) -> bool:
    """Whether anything burns."""
    return bool((field.states == BURNING).any())
