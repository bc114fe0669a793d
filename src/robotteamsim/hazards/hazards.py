"""Fire and smoke of one trial."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.hazards.field import NOT_BURNING, HazardField, Ignited
from robotteamsim.hazards.source import ClosedDoors, HazardSource, cells_and_fuel
from robotteamsim.hazards.topology import Doorway, Topology, check_free
from robotteamsim.rng import stream
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.fire import Fire, updates
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.scenario import Scenario

_Curve = tuple[tuple[float, float], ...]
_AIR_KJ_M3_K = 1.204 * 1.005
"""Heat capacity of a cubic metre of air at 20 degC [kJ/(m^3 K)]."""


class Hazards:
    """Simulated fire and smoke. It depends only on the scenario, the doors, and the ignitions.

    What is ignited begins to burn at the end of the next update, or at time 0: t later, the field is that of t.

    Random stream: ("fire",), one number per place of fuel.
    """

    def __init__(self, scenario: Scenario, building: Building) -> None:
        """Prepare. Raises: PlacementError: fuel or an ignition is outside or in a wall, or an ignition has no fuel."""
        assert scenario.fire is not None
        self._plan, self._fire = scenario.plan, scenario.fire
        self._step_ns, self._update_ns = scenario.run.step_ns, self._fire.update_ns
        self.updated = False
        """Whether the last step was an update."""
        self._cells, self._fuel = building.shared(cells_and_fuel, scenario.fire)
        self._ignitions = deque(sorted(_ignitions(scenario, self._cells, self._fuel)))
        self._core = _core.hazards.BurningFloor(
            self._cells.east,
            self._cells.north,
            list(self._cells.crossings),
            [
                _door(door, doorway, self._fire)
                for door, doorway in zip(self._plan.doors, self._cells.doorways, strict=True)
            ],
            list(self._cells.openings),
            _fuels(self._fire, stream(scenario.run.seed, "fire")),
            self._fuel,
            gap_m=self._fire.gap_m,
            cell_m=self._fire.cell_m,
            diffusivity_m2_s=self._fire.soot.diffusivity_m2_s,
            height_m=self._fire.soot.height_m,
            ambient_c=self._fire.heat.ambient_c,
            heat_kj_m3_k=_AIR_KJ_M3_K,
            convection_kw_m2_k=self._fire.heat.convection_w_m2_k / 1e3,
            emissivity=self._fire.heat.emissivity,
            soot_g_kj=self._fire.soot.yield_g_g / self._fire.soot.heat_kj_g,
            convective_share=self._fire.heat.convective_share,
        )
        self._doors_version = 0
        self.ignited: tuple[Ignited, ...] = ()
        """What has begun to burn so far, in order."""
        self._alight: set[int] = set()
        """Indices of the places of fuel in which something has burnt."""
        self._ignite_due(0)
        self.field = self._read()
        """Of the last update."""
        self.version = 1
        """Number of changes of `field`."""

    def step(self, sim_time_ns: int, doors: ClosedDoors) -> bool:
        """Advance to the step with this stamp [ns]; return whether this was an update, see `Fire.updates_at`."""
        begin_ns = sim_time_ns - self._step_ns
        self.updated = updates(sim_time_ns, self._step_ns, self._update_ns)
        if self.updated:
            self._set_doors(doors)
            if self.ignited:
                self._core.advance(self._fire.update_s)
                self._note_spread()
        if self.updated or begin_ns == 0:
            self._ignite_due(begin_ns)
            if self.ignited:
                self.field = self._read()
                self.version += 1
        return self.updated

    def ignite(self, position_m: Point) -> None:
        """Set fire to a place in `map` [m], in the next update.

        Raises: ValueError: it is in a wall or outside, or nothing burns there.
        """
        try:
            row, col = _burning_cell(self._plan, "ignite", position_m, self._cells, self._fuel)
        except PlacementError as error:
            raise ValueError(str(error)) from None
        self._ignitions.appendleft((0, row * self._cells.shape[1] + col))

    def burnt_doors(self) -> tuple[str, ...]:
        """Return the names of the doors that have burnt through."""
        return tuple(door.name for i, door in enumerate(self._plan.doors) if self._core.is_burnt_through(i))

    @property
    def heat_release_kw(self) -> float:
        """Heat release rate of the whole fire [kW]."""
        return self._core.heat_release_kw

    @property
    def soot_g(self) -> float:
        """Mass of the soot in the air [g]."""
        return float(np.sum(self._core.soot_g_m2())) * self._fire.cell_m**2

    def _set_doors(self, doors: ClosedDoors) -> None:
        if doors.version != self._doors_version:
            self._doors_version = doors.version
            closed = doors.closed()
            for index, door in enumerate(self._plan.doors):
                self._core.set_door(index, closed[door.name])

    def _ignite_due(self, begin_ns: int) -> None:
        """Set fire to the cells that are due in a step that begins at this time [ns], if they have not burnt yet."""
        while self._ignitions and self._ignitions[0][0] <= begin_ns:
            cell = self._ignitions.popleft()[1]
            if self._core.ignite(cell):
                row, col = divmod(cell, self._cells.shape[1])
                self._note(int(self._fuel[row, col]), row, col, spread=False)

    def _note_spread(self) -> None:
        """Note the places of fuel that fire from elsewhere has reached in this update."""
        if len(self._alight) == len(self._fire.fuel):
            return
        has_burnt = self._core.states() != NOT_BURNING
        for index in np.unique(self._fuel[has_burnt]).tolist():
            if index not in self._alight:
                row, col = np.argwhere(has_burnt & (self._fuel == index))[0].tolist()
                self._note(index, row, col, spread=True)

    def _note(self, fuel: int, row: int, col: int, spread: bool) -> None:
        self._alight.add(fuel)
        (x, y), cell_m = self._cells.origin_m, self._cells.resolution_m
        position_m = x + cell_m * (col + 0.5), y + cell_m * (row + 0.5)
        self.ignited = (*self.ignited, Ignited(self._fire.fuel[fuel].name, position_m, spread))

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


def make_hazards(scenario: Scenario, building: Building) -> HazardSource:
    """Return the source of fire and smoke of a scenario with a fire: simulated, or the results of FDS.

    Raises: PlacementError: fuel, an ignition, or the folder of FDS is wrong; one line with file, key and value.
    """
    assert scenario.fire is not None
    try:
        if scenario.fire.fds is not None:
            from robotteamsim.hazards.fds import FdsHazards

            return FdsHazards(scenario, building)
        return Hazards(scenario, building)
    except PlacementError as error:
        raise PlacementError(scenario.origin.line(str(error), error.key), error.key) from None


def _ignitions(scenario: Scenario, cells: Topology, kinds: np.ndarray) -> list[tuple[int, int]]:
    """Return time [ns] and cell of each ignition of the fire, and check those of the schedule.

    Raises: PlacementError: one is outside, in a wall, or without fuel.
    """
    assert scenario.fire is not None
    found = []
    for i, ignition in enumerate(scenario.fire.ignitions):
        key = f"fire.ignitions.{i}.position"
        row, col = _burning_cell(scenario.plan, key, ignition.position, cells, kinds)
        found.append((round(ignition.at_s * 1e9), row * cells.shape[1] + col))
    for i, event in enumerate(scenario.schedule):
        if event.ignite is not None:
            _burning_cell(scenario.plan, f"schedule.{i}.ignite", event.ignite, cells, kinds)
    return found


def _burning_cell(plan: FloorPlan, key: str, position: Point, cells: Topology, kinds: np.ndarray) -> tuple[int, int]:
    """Return the cell of a place. Raises: PlacementError: it is outside, in a wall, or without fuel."""
    row, col = check_free(plan, key, position, cells)
    if kinds[row, col] < 0:
        place = f"[{position[0]:g}, {position[1]:g}]"
        raise PlacementError(f"{key}: {place}: there is no fuel; expected a place of fire.fuel", key)
    return row, col


def _door(door: Door, doorway: Doorway, fire: Fire) -> tuple[bool, float, float, float]:
    """Return whether a door is closed at the start, the shares of air that pass, and how long it endures flames [s]."""
    endures_s = fire.endures_s(door)
    is_tight = endures_s is None or door.kind == "fireproof"
    closed_share = 0.0 if is_tight else doorway.closed_share(fire.soot.door_leakage)
    return door.closed, doorway.open_share, closed_share, -1.0 if endures_s is None else endures_s


def _fuels(fire: Fire, random: np.random.Generator) -> list[tuple[float, float, float, _Curve]]:
    """Return load [kJ] and peak [kW] of one cell, growth [kW/s^2], and own curve [s, kW], of each place of fuel.

    A place's growth is that of its class times a number of a uniform distribution of mean 1: over many trials, the mean
    heat release rate at a time is that of the class.
    """
    area_m2, most = fire.cell_m**2, math.sqrt(3.0) * fire.growth_sd
    return [
        (fuel.load_mj_m2 * 1e3 * area_m2, fuel.peak_kw_m2 * area_m2, fuel.growth_kw_s2 * share, fuel.hrr or ())
        for fuel, share in zip(fire.fuel, random.uniform(1.0 - most, 1.0 + most, len(fire.fuel)), strict=True)
    ]
