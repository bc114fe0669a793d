"""Functions of the library for controllers equal straightforward ones, bit by bit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plain import PlainRuledOut, PlainSurroundings, plain_along_path, plain_first_stretch
from scipy import ndimage

from robotteamsim import _core
from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.control.rdpso.terms import Surroundings
from robotteamsim.geometry import Pose
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.sections import Laser

SIZE_M = 12.0


def cluttered_map(rng: np.random.Generator) -> KnownMap:
    """A hall with a dozen blocks."""
    corners_m = rng.uniform(0.5, SIZE_M - 2.0, (12, 2))
    blocks = tuple(
        Block(name=f"b{i}", polygon=((x, y), (x + 1.3, y), (x + 1.3, y + 0.4), (x, y + 0.4)))
        for i, (x, y) in enumerate(corners_m.tolist())
    )
    return KnownMap(Building(FloorPlan(name="hall", bounds=Bounds(max=(SIZE_M, SIZE_M)), blocks=blocks)), 0.2, ())


def scan(rng: np.random.Generator, beams: int) -> np.ndarray:
    """Ranges as a laser sees them: something near over some of the beams, else nothing or far away."""
    ranges_m = np.where(rng.random(beams) < 0.5, 5.0, rng.uniform(1.0, 5.0, beams))
    first = rng.integers(beams)
    ranges_m[first : first + rng.integers(1, beams // 2)] = rng.uniform(0.15, 1.2)
    return ranges_m.astype(np.float32)


def place(rng: np.random.Generator) -> tuple[float, float]:
    x, y = rng.uniform(0.0, SIZE_M, 2).tolist()
    return x, y


def test_nearest_place_is_the_first_of_the_nearest():
    rng = np.random.default_rng(4)
    for _ in range(200):
        position, places = place(rng), [place(rng) for _ in range(rng.integers(1, 9))]
        places += [(places[0][0], places[0][1])]
        nearest = _core.base.nearest_point(position, places)
        assert nearest == min(places, key=lambda other, position=position: math.dist(position, other))
    with pytest.raises(ValueError, match="points must not be empty"):
        _core.base.nearest_point((0.0, 0.0), [])


@pytest.mark.parametrize("beams", [5, 61, 181, 360])
def test_surroundings_equal_straightforward_ones(beams):
    rng = np.random.default_rng(beams)
    laser = Laser(beams=beams, forward_m=0.1)
    surroundings, plain = Surroundings(laser, 1.2), PlainSurroundings(laser, 1.2)
    found = 0
    for _ in range(200):
        pose, ranges_m = Pose(*rng.uniform(-3.0, 3.0, 3).tolist()), scan(rng, beams)
        expected = plain.attractor(pose, ranges_m)
        assert surroundings.clearest_place(pose, ranges_m) == expected
        found += expected is not None
    assert found > 50


def test_scans_are_read_equally_from_any_array():
    rng = np.random.default_rng(3)
    surroundings, pose = Surroundings(Laser(), 1.2), Pose(1.0, 2.0, 0.3)
    ranges_m = scan(rng, Laser().beams)
    expected = surroundings.clearest_place(pose, ranges_m)
    assert expected is not None
    for other in (ranges_m.astype(np.float64), np.repeat(ranges_m, 2)[::2]):
        assert surroundings.clearest_place(pose, other) == expected


@pytest.mark.parametrize("together", [True, False])
def test_ruled_out_cells_equal_those_of_a_straightforward_search(together):
    rng = np.random.default_rng(5)
    ruled_out = _core.control.RuledOut(radius_m=1.5, cell_m=0.25, next_to_m=0.75)
    plain = PlainRuledOut(1.5, 0.25, 0.75)
    answers = []
    for _ in range(15):
        cells = (np.floor(rng.uniform(-8.0, 8.0, (20, 2)) / 0.25) * 0.25 + 0.125).tolist()
        # Some are near those of earlier rounds, some hear nothing.
        heard = [((x + float(rng.normal(0.0, 0.05)), y), (x, y) if rng.random() < 0.6 else None) for x, y in cells]
        for position, loudest in heard:
            plain.add(position, loudest)
            if not together:
                ruled_out.add(position, loudest)
        if together:
            ruled_out.add_all(_core.control.HeardNotes(heard))
        for x, y in cells + rng.uniform(-9.0, 9.0, (20, 2)).tolist():
            answers.append(plain.covers((x, y)))
            assert ruled_out.covers((x, y)) == answers[-1]
    assert 0.2 < np.mean(answers) < 0.95
    ruled_out.clear()
    assert not any(ruled_out.covers((x, y)) for x, y in cells)


@pytest.mark.parametrize("seed", range(4))
def test_first_steps_of_paths_equal_those_of_a_straightforward_search(seed):
    rng = np.random.default_rng(seed)
    known, bends = cluttered_map(rng), 0
    for _ in range(100):
        start, goal = place(rng), place(rng)
        expected = plain_first_stretch(known.grid, start, goal, 14.0)
        assert known.grid.first_stretch(start, goal, 14.0) == expected
        assert known.grid.along_path(start, goal, 14.0) == plain_along_path(known.grid, start, goal, 14.0)
        bends += expected[0] != goal
    assert bends > 20


@pytest.mark.parametrize("seed", range(4))
def test_nearest_place_in_reach_is_the_first_of_the_nearest_cells_in_reach(seed):
    rng = np.random.default_rng(seed)
    known = cluttered_map(rng)
    free = known.grid.blocked() == 0
    rows, cols = np.indices(free.shape)
    x_m, y_m = (cols + 0.5) * 0.1, (rows + 0.5) * 0.1
    for _ in range(50):
        start, goal = place(rng), place(rng)
        in_disc = free & ((x_m - start[0]) ** 2 + (y_m - start[1]) ** 2 <= 1.5**2)
        labels, _ = ndimage.label(in_disc)
        label = labels[int(start[1] / 0.1), int(start[0] / 0.1)]
        found = known.grid.nearest_reachable(start, goal, 1.5)
        if label == 0:
            assert found is None
            continue
        to_goal = np.where(labels == label, (x_m - goal[0]) ** 2 + (y_m - goal[1]) ** 2, np.inf)
        row, col = np.unravel_index(to_goal.argmin(), free.shape)
        assert found == (pytest.approx(x_m[row, col]), pytest.approx(y_m[row, col]))
        field = known.grid.distance_map(goal) if known.grid.is_free(goal) else None
        if field is not None and np.isfinite(field[labels == label]).any():
            cell, length_m = known.grid.least_reachable(field, start, 1.5)
            assert length_m == field[labels == label].min()
            assert known.grid.value_at(field, cell) == length_m
