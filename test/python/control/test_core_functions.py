"""Functions of the library for controllers against straightforward calculations."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
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


def hits_of(laser: Laser, ranges_m: np.ndarray, stride: int) -> np.ndarray:
    """Return the hits of every `stride`-th beam in base_link, shape (n, 2) [m]."""
    angles_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, laser.beams)[::stride]
    ranges_m = ranges_m[::stride].astype(float)
    places_m = np.stack((laser.forward_m + ranges_m * np.cos(angles_rad), ranges_m * np.sin(angles_rad)), axis=1)
    return places_m[ranges_m < laser.range_max_m * (1.0 - 1e-6)]


def free_m(hits_m: np.ndarray, heading_rad: float, radius_m: float, most_m: float) -> float:
    """Return how far a disc can move before it touches a hit; one inside it counts only within 60 degrees."""
    along = hits_m @ (math.cos(heading_rad), math.sin(heading_rad))
    across = hits_m @ (-math.sin(heading_rad), math.cos(heading_rad))
    is_ahead = (along > 0.0) & (np.abs(across) < radius_m)
    along, across = along[is_ahead], across[is_ahead]
    touch = along - np.sqrt(radius_m**2 - across**2)
    touch = touch[(touch >= 0.0) | (along > 0.5 * np.hypot(along, across))]
    return max(touch.min(initial=most_m), 0.0)


@pytest.mark.parametrize("beams", [5, 61, 181, 360])
def test_clearest_place_is_the_best_of_13_headings_at_half_and_the_whole_radius(beams):
    rng, radius_m, found = np.random.default_rng(beams), 1.2, 0
    laser = Laser(beams=beams, forward_m=0.1)
    surroundings = Surroundings(laser, radius_m)
    headings_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, 13)
    for _ in range(200):
        pose, ranges_m = Pose(*rng.uniform(-3.0, 3.0, 3).tolist()), scan(rng, beams)
        hits_m = hits_of(laser, ranges_m, max(1, beams // 60))
        place_m = surroundings.clearest_place(pose, ranges_m)
        if np.hypot(*hits_m.T).min(initial=np.inf) >= radius_m:
            assert place_m is None
            continue
        found += 1
        places_m = [(0.0, 0.0)] + [
            (reach_m * math.cos(heading_rad), reach_m * math.sin(heading_rad))
            for heading_rad in headings_rad
            for reach_m in (0.5 * radius_m, radius_m)
            if reach_m <= free_m(hits_m, heading_rad, 0.05, radius_m)
        ]
        near_m = hits_m[np.hypot(*hits_m.T) < 2.0 * radius_m]
        best = max(places_m, key=lambda place, near_m=near_m: np.hypot(*(near_m - place).T).min())
        expected = pose @ Pose(*best, 0.0)
        assert place_m == pytest.approx((expected.x_m, expected.y_m), abs=1e-9)
    assert found > 50


def test_scans_are_read_equally_from_any_array():
    rng = np.random.default_rng(3)
    surroundings, pose = Surroundings(Laser(), 1.2), Pose(1.0, 2.0, 0.3)
    ranges_m = scan(rng, Laser().beams)
    expected = surroundings.clearest_place(pose, ranges_m)
    assert expected is not None
    for other in (ranges_m.astype(np.float64), np.repeat(ranges_m, 2)[::2]):
        assert surroundings.clearest_place(pose, other) == expected


Note = tuple[tuple[float, float], tuple[float, float] | None]


class Listener:
    """The notes of a robot, searched in a straightforward way, beside those of the core."""

    def __init__(self) -> None:
        self.core = _core.control.RuledOut(radius_m=1.5, cell_m=0.25, next_to_m=0.75)
        self._notes: dict[tuple, Note] = {}

    def add(self, note: Note, *, to_core: bool = False) -> None:
        # Of robots that hear the same close together, only the first counts.
        (x, y), loudest = note
        self._notes.setdefault((round(x / 0.25), round(y / 0.25), loudest), note)
        if to_core:
            self.core.add(*note)

    def covers(self, place: tuple[float, float]) -> bool:
        for position, loudest in self._notes.values():
            away_m = math.dist(place, position)
            is_loudest = loudest is not None and math.dist(place, loudest) < 0.125
            if away_m < 0.75 or (away_m < 1.5 and not is_loudest):
                return True
        return False


def notes(rng: np.random.Generator, count: int) -> list[Note]:
    """Return notes, some near each other, some of robots that hear nothing."""
    cells = (np.floor(rng.uniform(-8.0, 8.0, (count, 2)) / 0.25) * 0.25 + 0.125).tolist()
    return [((x + float(rng.normal(0.0, 0.05)), y), (x, y) if rng.random() < 0.6 else None) for x, y in cells]


def places(rng: np.random.Generator, near: list[Note]) -> list[tuple[float, float]]:
    return [position for position, _ in near] + list(map(tuple, rng.uniform(-9.0, 9.0, (20, 2)).tolist()))


@pytest.mark.parametrize("together", [True, False])
def test_ruled_out_cells_equal_those_of_a_straightforward_search(together):
    rng, robot, answers = np.random.default_rng(5), Listener(), []
    for _ in range(15):
        heard = notes(rng, 20)
        for note in heard:
            robot.add(note, to_core=not together)
        if together:
            robot.core.add_all(_core.control.HeardNotes(heard))
        for place in places(rng, heard):
            answers.append(robot.covers(place))
            assert robot.core.covers(place) == answers[-1]
    assert 0.2 < np.mean(answers) < 0.95
    robot.core.clear()
    assert not any(robot.core.covers(place) for place in places(rng, heard))


def test_robots_that_hear_different_teammates_rule_out_what_each_of_them_heard():
    rng, robots, answers = np.random.default_rng(6), [Listener() for _ in range(6)], []
    for turn in range(40):
        own = notes(rng, len(robots))
        for robot, note in zip(robots, own, strict=True):
            robot.add(note, to_core=True)
        # The team splits into other groups, in some turns not at all; a robot may miss a turn.
        groups = rng.integers(0, 1 + turn % 4, len(robots))
        for group in set(groups.tolist()):
            members = np.flatnonzero(groups == group).tolist()
            heard = _core.control.HeardNotes([own[i] for i in members])
            for i in members if rng.random() < 0.9 else members[1:]:
                robots[i].core.add_all(heard)
                for k in members:
                    robots[i].add(own[k])
        for place in places(rng, own):
            answers += [robot.covers(place) for robot in robots]
            assert [robot.core.covers(place) for robot in robots] == answers[-len(robots) :]
        if turn == 20:
            robots[2] = Listener()
    assert 0.2 < np.mean(answers) < 0.95


@pytest.mark.parametrize("seed", range(4))
def test_first_stretch_of_a_path_ends_at_its_first_waypoint_and_has_its_whole_length(seed):
    rng = np.random.default_rng(seed)
    grid, bends = cluttered_map(rng).grid, 0
    for _ in range(100):
        start, goal = place(rng), place(rng)
        ends = grid.nearest_free(start, 1.0), grid.nearest_free(goal, 1.0)
        corners = [] if None in ends or grid.is_line_free(start, goal) else grid.waypoints(*ends, 14.0)
        bend, length_m = goal, math.dist(start, goal)
        if len(corners) > 1:
            bend, length_m = corners[1], sum(math.dist(a, b) for a, b in itertools.pairwise(corners))
        first, path_m = grid.first_stretch(start, goal, 14.0)
        assert (first, path_m) == (bend, pytest.approx(length_m, rel=1e-12))
        along = grid.along_path(start, goal, 14.0)
        if bend in (goal, start):
            assert along == goal
            continue
        # As far away as the goal by the path, in the direction of its first waypoint.
        stretch = path_m / math.dist(start, bend)
        assert along == pytest.approx(np.add(start, stretch * np.subtract(bend, start)))
        bends += 1
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


def test_lengths_to_several_places_are_those_to_each():
    generator = np.random.default_rng(4)
    known, goal = cluttered_map(generator), (6.0, 6.0)
    places_m = generator.uniform(-2.0, SIZE_M + 2.0, (200, 2))  # some in blocks, some outside
    expected_m = [known.distance_m(goal, tuple(place)) for place in places_m.tolist()]
    assert known.distances_m(goal, places_m).tolist() == expected_m
    assert known.distances_m(goal, places_m.reshape(4, 50, 2)).ravel().tolist() == expected_m
    assert known.distances_m(goal, places_m[:0]).size == 0


def test_a_path_is_found_with_and_without_a_distance_map():
    rng = np.random.default_rng(5)
    known = cluttered_map(rng)
    for _ in range(30):
        start, goal = known.grid.nearest_free(place(rng), 5.0), known.grid.nearest_free(place(rng), 5.0)
        length_m = known.grid.value_at(known.grid.distance_map(start), goal)
        limits_m = (length_m + 0.01, max(length_m - 0.01, 0.0))
        found = [known.has_path(start, goal, limit_m) for limit_m in limits_m]
        known.distance_map(start)
        assert [known.has_path(start, goal, limit_m) for limit_m in limits_m] == found
        assert found[0] == math.isfinite(length_m)


def test_unknown_cells_in_view_are_those_on_rays_before_walls():
    rng = np.random.default_rng(6)
    cells = rng.choice([0, 100, -1], (30, 40), p=[0.5, 0.05, 0.45]).astype(np.int8)
    places = np.stack((rng.integers(0, 30, 20), rng.integers(0, 40, 20)), axis=1).astype(np.int32)
    rays = np.cumsum(rng.integers(-1, 2, (12, 15, 2)), axis=1).astype(np.int32)
    areas_m2 = rng.random(15)
    expected = []
    for at in places.tolist():
        sum_m2 = 0.0
        for ray in (at + rays).tolist():
            for (row, column), area_m2 in zip(ray, areas_m2, strict=True):
                if not (0 <= row < 30 and 0 <= column < 40) or cells[row, column] == 100:
                    break
                sum_m2 += area_m2 * (cells[row, column] == -1)
        expected.append(sum_m2)
    assert _core.control.unknown_in_view(cells, places, rays, areas_m2) == pytest.approx(expected)
    with pytest.raises(ValueError, match="one area per cell"):
        _core.control.unknown_in_view(cells, places, rays, areas_m2[1:])
