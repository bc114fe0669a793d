"""The collision-free speed model against hand calculations, published measurements and another implementation."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim import _core
from robotteamsim.scenario.people import People
from robotteamsim.world.people import crowd_parameters

TUNING = People()
NOBODY = np.zeros((0, 3))


def rectangle(x0: float, y0: float, x1: float, y1: float) -> _core.world.Solid:
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return _core.world.Solid(corners, [corners])


def crowd(*solids: _core.world.Solid, doors: tuple[_core.world.Door, ...] = ()) -> _core.world.Crowd:
    return _core.world.Crowd(list(solids), list(doors), crowd_parameters(TUNING))


def rows(positions: np.ndarray, target: tuple[float, float], speed: float) -> np.ndarray:
    n = len(positions)
    return np.column_stack([positions, np.tile(target, (n, 1)), np.full(n, speed), np.full(n, TUNING.radius_m)])


def test_walker_without_anybody_ahead_walks_at_the_desired_speed():
    moved = crowd().step(rows(np.array([[0.0, 0.0]]), (30.0, 40.0), 1.2), NOBODY, [], 5.0)
    assert moved[0] == pytest.approx([3.6, 4.8])


def test_speed_is_the_gap_to_the_one_ahead_over_the_time_gap():
    ahead = np.array([[1.0, 0.0, 0.25]])  # gap 1.0 - 0.15 - 0.25 = 0.6 m, T = 1 s: 0.6 m/s
    moved = crowd().step(rows(np.array([[0.0, 0.0]]), (9.0, 0.0), 1.2), ahead, [], 0.01)
    assert moved[0] == pytest.approx([0.006, 0.0])


def test_person_next_to_the_path_does_not_slow_a_walker():
    beside = np.array([[0.5, 0.5, 0.2], [-0.5, 0.0, 0.2]])
    moved = crowd().step(rows(np.array([[0.0, 0.0]]), (9.0, 0.0), 1.2), beside, [], 0.01)
    assert math.hypot(*moved[0]) == pytest.approx(0.012)


def test_walker_stops_at_a_wall_and_at_a_closed_door_but_passes_an_open_one():
    leaf = rectangle(2.0, -0.5, 2.1, 0.5)
    walls = rectangle(2.0, 0.5, 2.1, 9.0), rectangle(2.0, -9.0, 2.1, -0.5)
    people = crowd(*walls, doors=(_core.world.Door(leaf, True),))
    start = rows(np.array([[0.0, 0.0]]), (5.0, 0.0), 1.0)
    assert people.step(start, NOBODY, [True], 20.0)[0][0] <= 2.0 - TUNING.radius_m + 1e-9
    assert people.step(start, NOBODY, [False], 20.0)[0] == pytest.approx([5.0, 0.0])


def test_queue_behind_a_slow_walker_keeps_the_spacing_of_its_speed():
    # In single file d = l + v T, with l = 0.3 m and T = 1 s; measured: 0.36 m + 1.06 s v [seyfried2005].
    for speed in (0.3, 0.5, 0.8):
        positions = np.column_stack([-1.2 * np.arange(6.0), np.zeros(6)])
        for _ in range(600):
            walkers = rows(positions, (1e3, 0.0), 1.2)
            walkers[0, 4] = speed
            positions = crowd().step(walkers, NOBODY, [], 0.1)
        spacings = -np.diff(positions[:, 0])
        assert spacings == pytest.approx(np.full(5, 0.3 + speed), abs=0.01)
        assert spacings == pytest.approx(np.full(5, 0.36 + 1.06 * speed), abs=0.12)


def speed_in_a_corridor(num_people: int, length_m: float = 12.0, width_m: float = 1.8) -> float:
    """Return the mean speed in a straight corridor whose ends are joined."""
    people = crowd(
        rectangle(-50.0, -1.0, length_m + 50.0, 0.0), rectangle(-50.0, width_m, length_m + 50.0, width_m + 1.0)
    )
    index = np.arange(num_people)
    columns = math.ceil(num_people / 3)
    positions = np.column_stack([index // 3 * length_m / columns, 0.4 + 0.5 * (index % 3)])
    positions[:, 1] += 0.05 * np.sin(7.0 * index)
    travelled = []
    for step in range(400):
        walkers = rows(positions, (0.0, 0.0), 1.34)
        walkers[:, 2:4] = positions + np.array([100.0, 0.0])
        radii = np.full(num_people, TUNING.radius_m)
        copies = [np.column_stack([positions + np.array([shift, 0.0]), radii]) for shift in (-length_m, length_m)]
        moved = people.step(walkers, np.vstack(copies), [], 0.05)
        if step >= 200:
            travelled.append(np.mean(moved[:, 0] - positions[:, 0]) / 0.05)
        positions = moved
        positions[:, 0] %= length_m
    return float(np.mean(travelled))


@pytest.mark.parametrize("density", [0.5, 1.0, 1.5, 2.0])
def test_speed_in_a_corridor_falls_with_the_density_as_measured(density):
    measured = 1.34 * (1.0 - math.exp(-1.913 * (1.0 / density - 1.0 / 5.4)))  # [weidmann1993]
    assert speed_in_a_corridor(round(density * 12.0 * 1.8)) == pytest.approx(measured, abs=0.25)


def door_flow(width_m: float) -> tuple[float, float]:
    """Return the flow of people through a door [1/s], and the smallest gap between two bodies so far [m]."""
    half = 0.5 * width_m
    people = crowd(
        rectangle(4.0, half, 4.2, 6.0),
        rectangle(4.0, -6.0, 4.2, -half),
        rectangle(-6.0, 4.0, 4.2, 4.2),
        rectangle(-6.0, -4.2, 4.2, -4.0),
    )
    positions = np.array([[-3.0 + 0.7 * i, -2.8 + 0.7 * j] for i in range(8) for j in range(9)])
    positions += 0.05 * np.sin(np.arange(144.0)).reshape(72, 2)
    closest, passed_s = math.inf, []
    for step in range(1, 1501):
        walkers = rows(positions, (4.6, 0.0), 1.34)
        beyond = positions[:, 0] > 4.1
        walkers[beyond, 2:4] = (30.0, 0.0)
        moved = people.step(walkers, NOBODY, [], 0.05)
        passed_s += [step * 0.05] * int(np.count_nonzero((positions[:, 0] <= 4.1) & (moved[:, 0] > 4.1)))
        positions = moved[moved[:, 0] < 8.0]
        away = np.hypot(*(positions[:, None] - positions[None]).transpose(2, 0, 1))
        closest = min(closest, float(np.min(away + 9.0 * np.eye(len(positions)), initial=9.0)))
    tenth, sixtieth = passed_s[9], passed_s[59]
    return 50.0 / (sixtieth - tenth), closest - 2.0 * TUNING.radius_m


@pytest.mark.slow
def test_flow_through_a_door_of_one_metre_is_within_the_published_range_and_nobody_overlaps():
    flow, gap_m = door_flow(1.0)
    assert 1.2 < flow < 2.2  # 1.22 [weidmann1993] to 1.9 [seyfried2009] persons per second and metre
    assert gap_m > -0.05


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radius_m", "time_gap_s", "theirs"), [(0.15, 1.0, 1.611), (0.2, 1.0, 0.898), (0.15, 0.8, 1.885)]
)
def test_flow_through_a_door_agrees_with_that_of_jupedsim(radius_m, time_gap_s, theirs, monkeypatch):
    # JuPedSim 1.4.2, the same room, people and parameters: study/people/jupedsim_door.py.
    tuning = People(radius_m=radius_m, time_gap_s=time_gap_s)
    monkeypatch.setitem(globals(), "TUNING", tuning)
    assert door_flow(1.0)[0] == pytest.approx(theirs, rel=0.12)


def counter_flow_s(opposing: int) -> float:
    """Return when the last of 100 people has crossed a corridor of 10 x 2 m, against others [s].

    Both rooms at its ends have 10 x 10 m. Everybody walks at 1.25 m/s, and leaves 2 m beyond the corridor.
    """
    people = crowd(
        *(rectangle(x - 0.2, -5.0, x, 5.0) for x in (-10.0, 20.2)),
        *(rectangle(x, y, x + 10.0, y + 0.2) for x in (-10.0, 10.0) for y in (-5.2, 5.0)),
        *(rectangle(0.0, y, 10.0, y + 4.2) for y in (-5.2, 1.0)),
    )
    index = np.arange(100 + opposing)
    east, rank = index < 100, index % 100
    along = -9.3 + 0.9 * (rank // 10) + 0.05 * np.sin(2.0 * index)
    across = -4.3 + 0.95 * (rank % 10) + 0.05 * np.sin(2.0 * index + 1.0)
    positions = np.column_stack([np.where(east, along, 10.0 - along), across])
    for step in range(1, 10_000):
        walked_m = np.where(east, positions[:, 0], 10.0 - positions[:, 0])
        target_m = np.where(walked_m < 0.2, 1.0, 12.5)
        target_x = np.where(east, target_m, 10.0 - target_m)
        walkers = rows(positions, (0.0, 0.0), 1.25)
        walkers[:, 2:4] = np.column_stack([target_x, np.clip(positions[:, 1], -0.8, 0.8)])
        positions = people.step(walkers, NOBODY, [], 0.05)
        there = np.where(east, positions[:, 0], 10.0 - positions[:, 0]) > 12.0
        positions, east = positions[~there], east[~there]
        if not east.any():
            return step * 0.05
    return math.inf


@pytest.mark.slow
def test_iso_20414_6_counter_flow_takes_longer_the_more_people_come():
    times_s = [counter_flow_s(opposing) for opposing in (0, 10, 50)]
    assert times_s == pytest.approx([50.1, 75.5, 180.8], rel=0.05)


def test_wrong_input_is_rejected():
    with pytest.raises(ValueError, match="one value per door"):
        crowd().step(rows(np.array([[0.0, 0.0]]), (1.0, 0.0), 1.0), NOBODY, [True], 0.1)
    with pytest.raises(ValueError, match="the position of a walker"):
        crowd().step(rows(np.array([[math.nan, 0.0]]), (1.0, 0.0), 1.0), NOBODY, [], 0.1)
