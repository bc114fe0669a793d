"""Measure what the levels of a building cost: links, radio maps and a mission of `office_tower`.

Each figure stands beside that of one level of the building, a plan of its own, in the same run; all take turns, so
that a busy machine slows them all.
Usage: python bench/levels_bench.py [--rounds 5]
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load, load_floor_plan
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import level_at
from robotteamsim.scenario.sections import Radio
from robotteamsim.simulation import Simulation

ROBOTS, RESOLUTION_M = 1000, 0.1


def one_level(plan: FloorPlan) -> FloorPlan:
    """Return the first level of a building as a plan of its own."""
    level = plan.levels[0]
    kept = {
        key: tuple(one for one in getattr(plan, key) if level_at(plan.levels, one.start) is level)
        for key in ("walls", "doors")
    }
    return FloorPlan(name=level.name, bounds=level.bounds, materials=plan.materials, **kept)


def robots_on(plan: FloorPlan) -> np.ndarray:
    """Return the places of robots, in turn on each level, shape (n, 2) [m]."""
    rng = np.random.default_rng(1)
    floors = [level.bounds for level in plan.levels] or [plan.bounds]
    return np.array([rng.uniform(floors[i % len(floors)].min, floors[i % len(floors)].max) for i in range(ROBOTS)])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    tower = load_floor_plan("office_tower")
    alone = one_level(tower)
    fields = [RadioField(plan, Radio()) for plan in (alone, tower)]
    places = [robots_on(plan) for plan in (alone, tower)]
    scenario = load("office_tower")
    works: dict[str, Callable[[], Any]] = {
        "links, one level": lambda: fields[0].rssi_matrix_dbm(places[0]),
        "links, three levels": lambda: fields[1].rssi_matrix_dbm(places[1]),
        "radio map, one level": lambda: fields[0].rssi_map_dbm((10.0, 8.0), RESOLUTION_M),
        "radio map, that level of three": lambda: fields[1].rssi_map_dbm(
            (10.0, 8.0), RESOLUTION_M, bounds=tower.levels[0].bounds
        ),
        "radio map, three levels": lambda: fields[1].rssi_map_dbm((10.0, 8.0), RESOLUTION_M),
        "mission": lambda: Simulation(scenario).run().time_s,
    }
    spent_s: dict[str, list[float]] = {name: [] for name in works}
    simulated_s = 0.0
    for _ in range(rounds):
        for name, work in works.items():
            begin_s = time.process_time()
            result = work()
            spent_s[name].append(time.process_time() - begin_s)
            simulated_s = result if name == "mission" else simulated_s
    median_s = {name: statistics.median(values) for name, values in spent_s.items()}
    links = ROBOTS * (ROBOTS - 1) / 2.0
    for name, used_s in median_s.items():
        alone_s = median_s.get(f"{name.partition(',')[0]}, one level")
        if alone_s is not None:
            each = f"{1e9 * used_s / links:.0f} ns each" if name.startswith("links") else f"{1e3 * used_s:.2f} ms"
            print(f"{name:<32}{used_s / alone_s:.1f} times that of one level, {each}")
    print(f"{'mission':<32}{simulated_s / median_s['mission']:.0f} times real time")


if __name__ == "__main__":
    main()
