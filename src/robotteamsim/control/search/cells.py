"""The cells of a plan: losses of voices between them, paths between them, and where a victim may be."""

import math
from dataclasses import dataclass

import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.known_map import Disc, known_map
from robotteamsim.propagation import voice_obstacles
from robotteamsim.scenario.building import Doors, MapSource
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.scenario.fire import Block
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Voice
from robotteamsim.swarm import Vector

NO_CELL = -1

NUM_LOSSES = 256
"""Losses are whole numbers of steps from 0 to 255."""


@dataclass(frozen=True, slots=True)
class CellGrid:
    """Square cells over a plan; row 0 has the lowest y, cells are numbered row by row."""

    origin_m: Vector
    cell_m: float
    rows: int
    columns: int

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.rows * self.columns

    def cell_of(self, place: Vector) -> int:
        """Return the cell that contains a place in `map` [m]; the nearest one for a place beyond the plan."""
        row = math.floor((place[1] - self.origin_m[1]) / self.cell_m)
        column = math.floor((place[0] - self.origin_m[0]) / self.cell_m)
        return min(max(row, 0), self.rows - 1) * self.columns + min(max(column, 0), self.columns - 1)

    def centre_of(self, cell: int) -> Vector:
        """Return the centre of a cell in `map` [m]."""
        row, column = divmod(cell, self.columns)
        return self.origin_m[0] + (column + 0.5) * self.cell_m, self.origin_m[1] + (row + 0.5) * self.cell_m

    def nearest(self, cells: np.ndarray, place: Vector) -> int:
        """Return the cell of several whose centre is nearest to a place in `map` [m]; NO_CELL if there are none."""
        if not cells.size:
            return NO_CELL
        rows, columns = np.divmod(cells, self.columns)
        x_m = self.origin_m[0] + (columns + 0.5) * self.cell_m - place[0]
        y_m = self.origin_m[1] + (rows + 0.5) * self.cell_m - place[1]
        return int(cells[np.argmin(x_m**2 + y_m**2)])


def reachable_cell(
    paths: _core.control.CellPaths, grid: CellGrid, source_m: Vector, start: int, save_distance_m: float
) -> int:
    """Return the cell to drive to from the cell `start` for a voice at a place in `map` [m]; NO_CELL if there is none.

    A cell without a path may be too tight for a robot, or behind a wall. Then it is the nearest one with a path, if a
    victim somewhere in the cell of the voice can be saved from there.
    """
    if start == NO_CELL:
        return NO_CELL
    cell = paths.start_of(source_m)
    if cell != NO_CELL and math.isfinite(paths.length_m(cell, start)):
        return cell
    cell = grid.nearest(np.flatnonzero(np.isfinite(paths.lengths_from(start))), source_m)
    within_m = save_distance_m + math.sqrt(0.5) * grid.cell_m
    return cell if cell != NO_CELL and math.dist(grid.centre_of(cell), source_m) <= within_m else NO_CELL


def cell_grid(scenario: Scenario) -> CellGrid:
    """Return the cells of the belief: of `cell_m`, or as many times doubled as `most_cells` demands."""
    search = scenario.control.as_kind(SearchControl)
    (x_low, y_low), (x_high, y_high) = scenario.plan.bounds.min, scenario.plan.bounds.max
    cell_m = search.cell_m
    while True:
        rows, columns = math.ceil((y_high - y_low) / cell_m), math.ceil((x_high - x_low) / cell_m)
        if rows * columns <= search.most_cells:
            return CellGrid((x_low, y_low), cell_m, rows, columns)
        cell_m *= 2.0


def loss_step_db(voice: Voice) -> float:
    """Return the unit of losses: the loudest voice is silent after a loss of 250 steps [dB]."""
    return max(-voice.constant_db[0], 1.0) / 250.0


def _voice_losses(building: MapSource, voice: Voice, grid: CellGrid, doors: Doors) -> _core.control.VoiceLosses:
    faces, unit_db = voice_obstacles(building.plan, voice)
    face_set = faces.core()
    for name, closed in doors:
        face_set.set_active(faces.door_face(name), closed)
    return _core.control.VoiceLosses(
        faces=face_set,
        origin_m=grid.origin_m,
        cell_m=grid.cell_m,
        rows=grid.rows,
        columns=grid.columns,
        slope_db=5.0 * sum(voice.exponent),
        wall_unit_db=unit_db,
        min_distance_m=voice.min_distance_m,
        # A robot perceives the loudest cell whose centre is within the radius.
        nearer_m=max(voice.local_best_radius_m - 0.5 * voice.map_resolution_m, 0.0),
        step_db=loss_step_db(voice),
    )


def voice_losses(building: MapSource, voice: Voice, grid: CellGrid, doors: Doors) -> _core.control.VoiceLosses:
    """Return the losses of voices between all cells, with doors as believed."""
    # The noise is not known to the robots.
    return building.shared(_voice_losses, voice.model_copy(update={"noise_db": 0.0}), grid, doors)


def cell_paths(
    building: MapSource,
    robot_radius_m: float,
    grid: CellGrid,
    doors: Doors,
    kept_out: Disc | None,
    hot: tuple[Block, ...] = (),
) -> _core.control.CellPaths:
    """Return the paths between all cells for one size of robot, outside a disc and hot places."""
    return _core.control.CellPaths(
        grid=known_map(building, robot_radius_m, doors, hot).grid,
        origin_m=grid.origin_m,
        cell_m=grid.cell_m,
        rows=grid.rows,
        columns=grid.columns,
        kept_out=kept_out,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Where victims may be, and where robots listen, as seen from one start.

    prior:      probability of each cell, float32; all 0 if no cell can be reached.
    candidates: cells to listen at.
    num_open:   number of cells in which a victim may be.
    """

    prior: np.ndarray
    candidates: list[int]
    num_open: int


def places(
    building: MapSource, robot_radius_m: float, grid: CellGrid, start: int, save_distance_m: float, stride: int
) -> Places:
    """Return the places that matter to a robot.

    A victim may be in each cell that has a free place within reach of a save, or next to a cell that has one.

    Args: start: cell of a robot, -1 for none.  stride: distance of candidates in cells.
    """
    # Closed doors may open: they do not rule a room out.
    opened = tuple(sorted((door.name, False) for door in building.plan.doors if door.closed))
    reached = np.zeros((grid.rows, grid.columns), dtype=bool)
    if start >= 0:
        lengths = building.shared(cell_paths, robot_radius_m, grid, opened, None).lengths_from(start)
        reached = np.isfinite(lengths).reshape(reached.shape)
    free = known_map(building, robot_radius_m, opened).grid
    prior = np.zeros(grid.size, dtype=np.float32)
    for cell in np.flatnonzero(_beside(reached)):
        near = free.nearest_free(grid.centre_of(int(cell)), save_distance_m)
        prior[cell] = near is not None
    total = prior.sum()
    rows, columns = np.nonzero(reached)
    on_lattice = (rows % stride == stride // 2) & (columns % stride == stride // 2)
    # A cell without a neighbour on the lattice is a candidate itself.
    lattice = np.zeros_like(reached)
    lattice[rows[on_lattice], columns[on_lattice]] = True
    covered = lattice.copy()
    for _ in range(stride):
        covered = _beside(covered)
    candidates = np.flatnonzero(lattice | (reached & ~covered)).tolist()
    return Places(prior / total if total > 0.0 else prior, candidates, int(total))


def _beside(cells: np.ndarray) -> np.ndarray:
    """Return the cells, bool, and their neighbours."""
    padded = np.pad(cells, 1)
    rows, columns = cells.shape
    shifted = [padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    beside: np.ndarray = np.logical_or.reduce(shifted)
    return beside


def unheard(voice: Voice, noise_db: float) -> np.ndarray:
    """Return for each loss the probability that a victim is not heard over the noise, float32, shape (256,).

    Loudness -l_c and exponent gamma are uniform in their ranges. The loss of a middling exponent is over distance; that
    of another exponent is proportional to it.
    """
    step_db = loss_step_db(voice)
    (low_db, high_db), (low, high) = voice.constant_db, voice.exponent
    quantiles = (np.arange(16) + 0.5) / 16
    loudness_db = -(low_db + (high_db - low_db) * quantiles)
    exponent = (low + (high - low) * quantiles) / (0.5 * (low + high))
    losses_db = np.arange(NUM_LOSSES) * step_db
    levels_db = loudness_db[None, :, None] - losses_db[:, None, None] * exponent[None, None, :]
    missed = np.mean(levels_db < noise_db, axis=(1, 2))
    missed[-1] = 1.0
    return np.asarray(missed, dtype=np.float32)
