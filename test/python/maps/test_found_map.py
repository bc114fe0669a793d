"""What a robot found, as a map and as walls."""

import numpy as np
import pytest

from robotteamsim.maps.found_map import CELL_M, FoundMap, walls_of, without_walls
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN, occupancy_grid
from robotteamsim.setup import resolve

ALL = slice(None), slice(None)


def seen(cells):
    """Return a grid as lasers see it: the inside of walls is unknown."""
    padded = np.pad(cells == OCCUPIED, 1, constant_values=False)
    inside = padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
    return np.where(inside & (cells == OCCUPIED), UNKNOWN, cells).astype(np.int8)


@pytest.fixture(scope="module")
def office():
    return resolve(load("office_manet"))


@pytest.fixture
def found(office):
    found = FoundMap(without_walls(office.plan))
    found.show([(ALL, seen(office.building.grid(CELL_M).cells))])
    return found


def test_a_robot_is_told_nothing_but_the_bounds(office):
    known = without_walls(office.plan)
    assert known.bounds == office.plan.bounds
    assert (known.walls, known.blocks, known.doors, known.levels) == ((), (), (), ())
    assert np.all(FoundMap(known).cells == UNKNOWN)


def test_walls_cover_the_occupied_cells_and_what_they_enclose(office, found):
    grid = office.building.grid(CELL_M)
    plan = without_walls(office.plan).model_copy(update={"blocks": walls_of(found.cells, found.origin_m)})
    wrong = occupancy_grid(plan, CELL_M).cells != grid.cells
    # The middle of a junction stays open, which no ray notices.
    assert np.count_nonzero(wrong) < 0.01 * np.count_nonzero(grid.cells == OCCUPIED)
    assert not np.any(wrong & (found.cells != UNKNOWN))


def test_radio_through_found_walls_is_that_of_the_plan_to_some_decibels(office, found):
    rng = np.random.default_rng(4)
    grid = office.building.grid(CELL_M)
    free = np.argwhere(grid.cells == FREE)[rng.integers(0, np.count_nonzero(grid.cells == FREE), 40)]
    places_m = (free[:, ::-1] + 0.5) * CELL_M + np.array(grid.origin_m)
    true, believed = (RadioField(plan, office.scenario.radio) for plan in (office.plan, found.plan))
    between = np.triu_indices(len(places_m), 1)
    error_db = (believed.rssi_matrix_dbm(places_m) - true.rssi_matrix_dbm(places_m))[between]
    assert abs(np.mean(error_db)) < 2.0
    assert np.sqrt(np.mean(error_db**2)) < 4.0


def test_a_change_is_a_new_version_and_forgets_what_was_computed(found):
    first, cells = found.shared(lambda of: np.count_nonzero(of.cells == OCCUPIED)), found.cells.copy()
    version = found.version
    assert not found.show([(ALL, cells.copy())])
    assert found.version == version
    cells[5:8, 5:8] = OCCUPIED
    assert found.show([(ALL, cells)])
    assert found.version == version + 1
    assert found.grid(CELL_M).cells[6, 6] == OCCUPIED
    assert first < np.count_nonzero(found.cells == OCCUPIED)


def test_no_other_resolution_can_be_had(found):
    with pytest.raises(ValueError, match=r"^resolution_m: 0.2; expected 0.1 for a map that was found$"):
        found.grid(0.2)


def test_slanted_wall_lets_no_ray_through():
    # Diagonal neighbours touch at a corner, which must not be a gap.
    cells = np.zeros((30, 30), np.int8)
    for i in range(25):
        cells[i, i : i + 2] = OCCUPIED
    plan = without_walls(Building(resolve(load("office_manet")).plan).plan)
    blocks = walls_of(cells, (0.0, 0.0))
    plan = plan.model_copy(update={"blocks": blocks})
    field = RadioField(plan, load("office_manet").radio)
    free = RadioField(without_walls(plan), load("office_manet").radio)
    for x_m in np.linspace(0.5, 2.0, 23):
        across = (x_m + 0.7, x_m - 0.3), (x_m - 0.3, x_m + 0.7)
        assert field.path_loss_db(*across) > free.path_loss_db(*across)
