"""The thermal camera, which sees hot places that no wall and no closed door hides."""

import functools

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, occupancy_grid
from robotteamsim.scenario.sensors import HeatSensor
from robotteamsim.sensing.readings import HeatReading
from robotteamsim.sensing.smoke import SmokyAir
from robotteamsim.world.contract import AnyWorld

SIGHT_RESOLUTION_M = 0.1
"""Size of the cells in which lines of sight are checked [m]."""


class ThermalCamera:
    """The cameras of a world: a reading in each step in which fire and smoke advance. Smoke does not hide heat."""

    def __init__(self, world: AnyWorld, air: SmokyAir) -> None:
        self._world = world
        self._air = air
        self._doors_version = 0
        self._sight: _core.plan.PlanningGrid | None = None

    def read(self, sensor: HeatSensor, position_m: tuple[float, float]) -> HeatReading | None:
        """Return the reading at a place in `map` [m]; None in a step without an update of fire and smoke."""
        field = self._air.field
        if not self._air.is_new:
            return None
        temperature_c = float(field.temperature_c(np.array([position_m]))[0])
        hot_m = _core.hazards.hot_in_sight(
            field.temperatures_c,
            field.origin_m,
            field.resolution_m,
            field.fire.heat.block_c,
            self._lines_of_sight(),
            position_m,
            sensor.range_m,
        )
        return HeatReading(temperature_c, tuple(hot_m))

    def _lines_of_sight(self) -> _core.plan.PlanningGrid:
        doors = self._world.door_states()
        if self._sight is None or doors.version != self._doors_version:
            self._doors_version = doors.version
            self._sight = _lines_of_sight(self._world.plan, tuple(doors.closed().items()))
        return self._sight


@functools.lru_cache(maxsize=16)
def _lines_of_sight(plan: FloorPlan, closed_doors: tuple[tuple[str, bool], ...]) -> _core.plan.PlanningGrid:
    """Return the cells that light passes."""
    grid = occupancy_grid(plan, SIGHT_RESOLUTION_M, dict(closed_doors))
    return _core.plan.PlanningGrid(grid.cells != FREE, grid.origin_m, SIGHT_RESOLUTION_M, 0.0)
