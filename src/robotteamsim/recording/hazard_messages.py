"""Topics and messages of fire and smoke, for bags written without ROS and for the nodes."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from robotteamsim.hazards import BURNING, BURNT_OUT, HazardField
from robotteamsim.hazards.field import FARTHEST_SIGHT_M
from robotteamsim.propagation import FieldMap
from robotteamsim.recording import ros_messages
from robotteamsim.recording.ros_messages import Make
from robotteamsim.scenario.plan import OccupancyGrid

FIRE_GRID, TEMPERATURE = "/fire/grid", "/fire/temperature"
SMOKE_GRID, SOOT = "/smoke/grid", "/smoke/soot"
BURNING_VALUE, BURNT_OUT_VALUE = 100, 50
"""Values of cells in /fire/grid; others are 0."""


def hazard_messages(make: Make, time_ns: int, field: HazardField) -> Iterator[tuple[str, Any]]:
    """Yield topic and message of each map of fire and smoke."""
    origin_m, resolution_m = field.origin_m, field.resolution_m

    def grid(cells: np.ndarray) -> Any:
        return ros_messages.occupancy_grid(make, time_ns, OccupancyGrid(origin_m, resolution_m, cells))

    def values(numbers: np.ndarray, quantity: str, unit: str) -> Any:
        return ros_messages.field_map(make, time_ns, FieldMap(origin_m, resolution_m, numbers), quantity, unit)

    yield FIRE_GRID, grid(fire_cells(field))
    yield TEMPERATURE, values(field.temperatures_c, "temperature", "degC")
    yield SMOKE_GRID, grid(smoke_cells(field))
    yield SOOT, values(field.soot_g_m3, "soot", "g/m^3")


def fire_cells(field: HazardField) -> np.ndarray:
    """Return the cells of /fire/grid, int8, shape (rows, cols)."""
    cells = np.zeros(field.states.shape, dtype=np.int8)
    cells[field.states == BURNING] = BURNING_VALUE
    cells[field.states == BURNT_OUT] = BURNT_OUT_VALUE
    return cells


def smoke_cells(field: HazardField) -> np.ndarray:
    """Return the cells of /smoke/grid, int8, shape (rows, cols): 0 for a visibility of 30 m, 100 for none."""
    soot = field.fire.soot
    extinction_per_m = np.maximum(soot.extinction_m2_g * field.soot_g_m3, soot.visibility_c / FARTHEST_SIGHT_M)
    visibility_m = soot.visibility_c / extinction_per_m
    return np.round(100.0 * (1.0 - visibility_m / FARTHEST_SIGHT_M)).astype(np.int8)
