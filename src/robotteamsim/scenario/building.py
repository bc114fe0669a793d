"""A floor plan with what is computed from it, each thing once."""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import Portal, Traveller, portals
from robotteamsim.scenario.plan import OccupancyGrid, occupancy_grid

Doors = tuple[tuple[str, bool], ...]
"""Doors by name, and whether they are closed; those that are not listed are as in the plan."""

_KEPT = 16
"""Results of each function that are kept, the latest ones: doors and fire change maps again and again."""

P = ParamSpec("P")
T = TypeVar("T")


class MapSource(Protocol):
    """What a robot may know of a building. A `Building` is all of it; one that a robot maps changes."""

    @property
    def plan(self) -> FloorPlan:
        """The floor plan as believed."""

    @property
    def version(self) -> int:
        """Grows with each change; what was computed from an older version is out of date."""

    def shared(self, make: Callable[Concatenate[Any, P], T], *arguments: P.args, **keys: P.kwargs) -> T:
        """Return `make(self, *arguments)`, or its earlier result for equal arguments and the same version.

        Args: make: depends on nothing but the map and its arguments, which are hashable. Its result is not changed.
        """

    def grid(self, resolution_m: float, doors: Doors = ()) -> OccupancyGrid:
        """Return the occupancy grid, whose cells may be UNKNOWN; do not change it."""

    def portals(self, by: Traveller) -> list[Portal]:
        """Return the ways between levels, see `levels.portals`."""


class SharedResults:
    """Keeps what is computed from a source."""

    def __init__(self) -> None:
        self._functions: dict[Callable[..., Any], Callable[..., Any]] = {}

    def shared(self, make: Callable[Concatenate[Any, P], T], *arguments: P.args, **keys: P.kwargs) -> T:
        """As for all sources."""
        if make not in self._functions:
            this = weakref.ref(self)  # a reference to itself would keep it until the garbage collection
            self._functions[make] = functools.lru_cache(_KEPT)(lambda *args, **keys: make(this(), *args, **keys))
        result: T = self._functions[make](*arguments, **keys)
        return result

    def forget(self) -> None:
        """Forget all results, because the source has changed."""
        self._functions.clear()


class Building(SharedResults):
    """A floor plan, and the grids, maps and graphs that robots of a trial share, and trials on the same plan."""

    version = 0

    def __init__(self, plan: FloorPlan) -> None:
        super().__init__()
        self.plan = plan

    def grid(self, resolution_m: float, doors: Doors = ()) -> OccupancyGrid:
        """Return the occupancy grid, see `plan.occupancy_grid`; do not change it."""
        return self.shared(_grid, resolution_m, doors)

    def portals(self, by: Traveller) -> list[Portal]:
        """As for all sources."""
        return portals(self.plan.levels, self.plan.passages, by)

    def grid_without_doors(self, resolution_m: float) -> OccupancyGrid:
        """Return the occupancy grid of walls and blocks alone; do not change it."""
        return self.shared(_grid, resolution_m, None)


@functools.lru_cache(maxsize=8)
def building_of(plan: FloorPlan) -> Building:
    """Return the building of a plan, which all simulations in a process share: only the first one computes its maps."""
    return Building(plan)


def _grid(building: Building, resolution_m: float, doors: Doors | None) -> OccupancyGrid:
    plan = building.plan if doors is not None else building.plan.model_copy(update={"doors": ()})
    grid = occupancy_grid(plan, resolution_m, dict(doors or ()))
    grid.cells.flags.writeable = False
    return grid
