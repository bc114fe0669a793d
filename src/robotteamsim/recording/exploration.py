"""How much of a building that nobody knew a team has found, how fast, and how right its maps are."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import msgspec
import numpy as np

from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.runtime.located import Located
from robotteamsim.maps.found_map import CELL_M, FoundMap
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.plan import OCCUPIED, UNKNOWN
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
from robotteamsim.simulation.controllers import TeamControllers

_NEAR_M = 0.1
"""A found wall this near to a true one is right."""


class Exploration(msgspec.Struct, frozen=True):
    """What a team found of a building that it did not know.

    known:      share of the floor that some robot knows at the end. The floor is where the centre of the smallest robot
                can be, cells of 0.1 m.
    t90_s, t99_s: when 90 % and 99 % of the floor were known [s]; None: never.
    right:      share of found wall cells within 10 cm of a true one, centre to centre: mean over the robots' maps.
    aligned:    the same, after each map was turned and shifted so that it fits best.
    bytes_per_s: sent by a robot, in all its messages, while the mission ran.
    """

    known: float
    t90_s: float | None
    t99_s: float | None
    right: float
    aligned: float
    bytes_per_s: float


def found_maps(simulation: Simulation) -> tuple[FoundMap, ...]:
    """Return the maps of the robots whose controllers run in this process, by id; () if they know the building."""
    controllers = simulation.controllers
    if not isinstance(controllers, TeamControllers):
        return ()
    running = (guard.controller for guard in controllers.guards)
    return tuple(one.found for one in running if isinstance(one, Located) and one.found is not None)


class KnownFloor:
    """The floor of a building, where the centre of the smallest robot can be, and which share of it a team knows."""

    def __init__(self, setup: Setup) -> None:
        """Args: setup: with the true building."""
        grid = known_map(setup.building, setup.smallest_reach_m).grid
        start = grid.nearest_free(setup.start_m(0), 1.0)
        shape = setup.building.grid(CELL_M).cells.shape
        self._floor = np.zeros(shape, bool) if start is None else np.isfinite(grid.distance_map(start))

    def share(self, maps: Iterable[MapSource]) -> float:
        """Return the share of the floor that is in one of the maps at least, 0 to 1; 1 without any floor.

        Args: maps: what robots have found.
        """
        known = np.zeros_like(self._floor)
        for found in maps:
            known |= found.grid(CELL_M).cells != UNKNOWN
        return float(np.mean(known[self._floor])) if self._floor.any() else 1.0


class ExplorationLog(Observer):
    """An observer that measures what the team of a simulation finds, once per second."""

    def __init__(self, simulation: Simulation) -> None:
        self.exploration: Exploration | None = None
        """The result, once the mission has ended; None if the robots know the building."""
        self._simulation = simulation

    def begin(self, setup: Setup) -> None:
        """Discard an earlier trial."""
        self.exploration = None
        self._walls = setup.building.grid(CELL_M).cells == OCCUPIED
        self._floor = KnownFloor(setup)
        self._every = max(round(1.0 / setup.scenario.run.step_s), 1)
        self._reached_s: dict[float, float] = {}
        self._share, self._bytes, self._num_robots = 0.0, 0, setup.scenario.num_robots

    def step(self, record: StepRecord) -> None:
        """Process one step."""
        if record.mission.state != "running":
            return
        self._bytes += sum(len(m.payload.encode()) for decision in record.decisions for m in decision.outbox)
        if record.step_index % self._every == 0:
            self._look(record.mission.time_s)

    def end(self, result: Result) -> None:
        """Compute the result."""
        self._look(result.time_s)
        maps = found_maps(self._simulation)
        if not maps:
            return
        errors = [map_error(found.cells == OCCUPIED, self._walls) for found in maps]
        right, aligned = np.mean(errors, axis=0).tolist()
        self.exploration = Exploration(
            known=round(self._share, 4),
            t90_s=self._reached_s.get(0.9),
            t99_s=self._reached_s.get(0.99),
            right=round(right, 4),
            aligned=round(aligned, 4),
            bytes_per_s=round(self._bytes / (self._num_robots * max(result.time_s, 1e-9)), 1),
        )

    def values(self) -> dict[str, Any]:
        """Return the result as plain values for JSON; empty before the end, and if there is none."""
        return {} if self.exploration is None else {"exploration": msgspec.to_builtins(self.exploration)}

    def _look(self, time_s: float) -> None:
        self._share = self._floor.share(found_maps(self._simulation))
        for share in (0.9, 0.99):
            if self._share >= share:
                self._reached_s.setdefault(share, time_s)


def map_error(found: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """Return the shares of found cells within _NEAR_M of a true one: as they are, and after a rigid alignment.

    The alignment is a minimum of a robust sum of distances [fitzgibbon2003]. Without a found cell, both are 1.

    Args: found, true: cells with walls, bool, of the same shape.
    """
    from scipy import ndimage, optimize  # of the extra 'campaign'

    if not found.any():
        return 1.0, 1.0
    if not true.any():
        return 0.0, 0.0
    away_m = ndimage.distance_transform_edt(~true) * CELL_M
    places = np.argwhere(found).astype(float)
    middle = places.mean(axis=0)
    arm = max(float(np.hypot(*(places - middle).T).mean()), 1.0)

    def distances_m(motion: np.ndarray) -> np.ndarray:
        """Args: motion: shifts along rows and columns, and the turn times the mean lever arm [cells]."""
        cos, sin = math.cos(motion[2] / arm), math.sin(motion[2] / arm)
        moved = (places - middle) @ np.array([[cos, sin], [-sin, cos]]) + middle + motion[:2]
        return np.asarray(ndimage.map_coordinates(away_m, moved.T, order=1, mode="nearest"))

    still = np.zeros(3)
    best = optimize.least_squares(distances_m, still, loss="soft_l1", f_scale=_NEAR_M).x
    right, aligned = (float(np.mean(distances_m(at) <= _NEAR_M + 1e-6)) for at in (still, best))
    return right, max(right, aligned)
