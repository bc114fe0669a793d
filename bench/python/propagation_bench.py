"""Maps, links and the network through NumPy, on the shipped garage; run by bench/run.py with pytest-benchmark.

`plain_us` is the time of one call from Python per cell or link, measured on a part of them.
"""

from __future__ import annotations

import itertools
import statistics
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from robotteamsim._core.state import State

from robotteamsim.geometry import Pose
from robotteamsim.network import Network
from robotteamsim.propagation import RadioField, VoiceField, VoiceSource
from robotteamsim.scenario import load_floor_plan
from robotteamsim.scenario.sections import Network as NetworkSection
from robotteamsim.scenario.sections import Radio, Voice

GARAGE = load_floor_plan("garage")
RESOLUTION_M = 0.05
SHAPE = (800, 1200)
TX_M = (9.0, 6.0)


def median_us(work: Callable[[], object], turns: int = 9) -> float:
    """Return the median of the processor's time that a call takes [us]."""
    times_s = []
    for _ in range(turns):
        start_s = time.process_time()
        work()
        times_s.append(time.process_time() - start_s)
    return statistics.median(times_s) * 1e6


def cell_centers(every: int) -> Iterator[tuple[float, float]]:
    """Yield the centres of every so many-th cell [m]."""
    for cell in range(0, SHAPE[0] * SHAPE[1], every):
        row, column = divmod(cell, SHAPE[1])
        yield (column + 0.5) * RESOLUTION_M, (row + 0.5) * RESOLUTION_M


@pytest.fixture
def out() -> np.ndarray:
    return np.zeros(SHAPE, dtype=np.float32)


def memset_us(out: np.ndarray) -> float:
    return median_us(lambda: out.fill(1.0), turns=99)


def plain_map_us(value: Callable[[tuple[float, float]], float]) -> float:
    every = 487  # no divisor of a row
    return median_us(lambda: [value(center) for center in cell_centers(every)], turns=3) * every


def test_radio_map(benchmark, out):
    field = RadioField(GARAGE, Radio())
    benchmark(lambda: field.rssi_map_dbm(TX_M, RESOLUTION_M, out=out))
    benchmark.extra_info |= {"work": "Python, garage: radio map into an array, 960k cells", "items": out.size}
    benchmark.extra_info |= {
        "memset_us": memset_us(out),
        "plain_us": plain_map_us(lambda center: field.path_loss_db(TX_M, center)),
    }


def test_voice_map_of_five_victims(benchmark, out):
    field = VoiceField(GARAGE, Voice(map_resolution_m=RESOLUTION_M))
    victims = [VoiceSource((5.0 + 11.0 * i, 4.0 + 7.5 * i), -75.0 + 0.5 * i, 5.0 + 0.2 * i) for i in range(5)]
    benchmark(lambda: field.map_db(victims, out=out))
    benchmark.extra_info |= {"work": "Python, garage: voice map of 5 victims into an array, 960k cells"}
    benchmark.extra_info |= {
        "items": out.size,
        "memset_us": memset_us(out),
        "plain_us": plain_map_us(lambda center: max(field.level_db(victim, center) for victim in victims)),
    }


def positions_m(count: int) -> np.ndarray:
    return np.random.default_rng(1).uniform((0.5, 0.5), (59.5, 39.5), (count, 2))


def standing_at(places_m: np.ndarray) -> State:
    """Return the state of a team at these places."""
    state = State(len(places_m))
    for robot_id, (x_m, y_m) in enumerate(places_m.tolist()):
        state.place(robot_id, Pose(x_m, y_m, 0.0))
    return state


@pytest.mark.parametrize("count", [30, 100])
def test_links(benchmark, count):
    field, places_m = RadioField(GARAGE, Radio()), positions_m(count)
    benchmark(lambda: field.rssi_matrix_dbm(places_m))
    links = count * (count - 1) // 2
    points = [tuple(place) for place in places_m.tolist()]
    plain_us = median_us(lambda: [field.path_loss_db(a, b) for a, b in itertools.combinations(points, 2)], turns=3)
    benchmark.extra_info |= {"work": f"Python, garage: links of {count} robots", "items": links, "plain_us": plain_us}


@pytest.mark.parametrize("count", [3, 30, 100])
def test_network_step(benchmark, count):
    network = Network(RadioField(GARAGE, Radio()), NetworkSection(), count)
    teams = itertools.cycle([standing_at(positions_m(count) + shift) for shift in (0.0, 0.2, 0.4)])
    silence = [()] * count
    benchmark(lambda: network.step(next(teams), silence))
    benchmark.extra_info |= {"work": f"Python, garage: network step of {count} robots that move"}
