"""What the library does for controllers is what the plain way gives, bit by bit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plain import PlainNavigator, PlainRuledOut, PlainSurroundings, plain_along_path, plain_first_stretch
from scipy import ndimage

from robotteamsim import _core
from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.control.driving.navigation import Navigator
from robotteamsim.control.rdpso.obstacles import Surroundings
from robotteamsim.geometry import Pose
from robotteamsim.scenario.control_tuning import NavigatorTuning
from robotteamsim.scenario.drives import CarDrive, Drive
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.sections import Laser, PlacedRobot

SIZE_M = 12.0


def cluttered_map(rng: np.random.Generator) -> KnownMap:
    """A hall with a dozen blocks."""
    corners_m = rng.uniform(0.5, SIZE_M - 2.0, (12, 2))
    blocks = tuple(
        Block(name=f"b{i}", polygon=((x, y), (x + 1.3, y), (x + 1.3, y + 0.4), (x, y + 0.4)))
        for i, (x, y) in enumerate(corners_m.tolist())
    )
    return KnownMap(FloorPlan(name="hall", bounds=Bounds(max=(SIZE_M, SIZE_M)), blocks=blocks), 0.2, ())


def scan(rng: np.random.Generator, beams: int) -> np.ndarray:
    """Ranges as a laser sees them: something near over some of the beams, else nothing or far away."""
    ranges_m = np.where(rng.random(beams) < 0.5, 5.0, rng.uniform(1.0, 5.0, beams))
    first = rng.integers(beams)
    ranges_m[first : first + rng.integers(1, beams // 2)] = rng.uniform(0.15, 1.2)
    return ranges_m.astype(np.float32)


def place(rng: np.random.Generator) -> tuple[float, float]:
    x, y = rng.uniform(0.0, SIZE_M, 2).tolist()
    return x, y


@pytest.mark.parametrize("mode", ["path", "straight"])
@pytest.mark.parametrize("drive", [Drive(), CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.6)])
@pytest.mark.parametrize("seed", range(3))
def test_navigator_commands_what_the_plain_one_commands(seed, drive, mode):
    rng = np.random.default_rng(seed)
    body = PlacedRobot(start_pose=(0.0, 0.0, 0.0), drive=drive, laser=Laser(forward_m=0.05))
    robots = Navigator(body, 3, mode, NavigatorTuning()), PlainNavigator(body, 3, mode)
    known, goal, x, y = cluttered_map(rng), place(rng), 6.0, 6.0
    escapes = 0
    for step in range(600):
        if step % 150 == 149:
            known, goal = cluttered_map(rng), place(rng)
        elif rng.random() < 0.03:
            goal = place(rng)
        x, y = (np.clip(rng.normal((x, y), 0.01), 0.1, SIZE_M - 0.1)).tolist()
        pose = Pose(x, y, float(rng.uniform(-math.pi, math.pi)))
        others = {i: (x + float(rng.normal()), y + float(rng.normal())) for i in (1, 5, 2)}
        ranges_m, speed_mps = scan(rng, body.laser.beams), float(rng.uniform(0.1, 0.9))
        sensed = pose, ranges_m, goal, speed_mps
        asked = []
        expected = robots[1].drive(known, *sensed, step * 100_000_000 * 1e-9, others)
        ask = lambda others=others, asked=asked: asked.append(1) or others  # noqa: E731
        assert robots[0].drive(known.grid, *sensed, step * 100_000_000, ask) == expected
        escapes += len(asked)
    assert escapes > 10


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
def test_surroundings_find_what_the_plain_ones_find(beams):
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


def test_scans_are_read_alike_whatever_array_holds_them():
    rng = np.random.default_rng(3)
    surroundings, pose = Surroundings(Laser(), 1.2), Pose(1.0, 2.0, 0.3)
    ranges_m = scan(rng, Laser().beams)
    expected = surroundings.clearest_place(pose, ranges_m)
    assert expected is not None
    for other in (ranges_m.astype(np.float64), np.repeat(ranges_m, 2)[::2]):
        assert surroundings.clearest_place(pose, other) == expected


@pytest.mark.parametrize("together", [True, False])
def test_ruled_out_covers_what_the_plain_one_covers(together):
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
def test_ways_begin_as_the_plain_ones(seed):
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
