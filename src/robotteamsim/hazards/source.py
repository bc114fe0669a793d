"""What simulates fire and smoke, or replays another program's, and what both begin with."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from robotteamsim.hazards.field import HazardField, Ignited
from robotteamsim.hazards.topology import Topology, fuel_of_cells, topology
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.fire import Fire


class ClosedDoors(Protocol):
    """The doors of a plan; `world.doors.DoorStates` is one."""

    version: int

    def closed(self) -> dict[str, bool]:
        """Return whether each door is closed, by name."""


class HazardSource(Protocol):
    """Fire and smoke as functions of time: simulated, or the result of another program."""

    field: HazardField
    """Of the last update."""
    version: int
    """Number of changes of `field`."""
    updated: bool
    """Whether the last step was an update."""
    ignited: tuple[Ignited, ...]
    """What has begun to burn so far, in order."""

    def step(self, sim_time_ns: int, doors: ClosedDoors) -> bool:
        """Advance to the step with this stamp [ns]; return whether this was an update, see `Fire.updates_at`."""

    def ignite(self, position_m: Point) -> None:
        """Set fire to a place in `map` [m]. Raises: ValueError: nothing burns there."""

    def burnt_doors(self) -> tuple[str, ...]:
        """Return the names of the doors that have burnt through, which cannot be closed any more."""


def cells_and_fuel(building: Building, fire: Fire) -> tuple[Topology, np.ndarray]:
    """Return the cells of a building, and the kind of fuel of each. Raises: PlacementError: fuel is in a wall."""
    cells = topology(building.plan, fire.cell_m)
    return cells, fuel_of_cells(building.plan, fire, cells)


def ambient_field(fire: Fire, building: Building) -> HazardField:
    """Return the field before anything burns."""
    cells, _ = building.shared(cells_and_fuel, fire)
    shape = cells.shape
    ambient = np.full(shape, fire.heat.ambient_c, dtype=np.float32)
    nothing = np.zeros(shape, dtype=np.float32)
    return HazardField(cells.origin_m, cells.resolution_m, ambient, nothing, np.zeros(shape, dtype=np.uint8), fire)
