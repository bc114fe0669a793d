"""Victims at random places that robots can reach."""

from __future__ import annotations

import numpy as np

from robotteamsim import _core, rng
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.levels import Traveller, portals
from robotteamsim.scenario.plan import FREE
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.victims import Victim
from robotteamsim.world.placement import placed_robots

CELL_M = 0.1
"""Victims are at centres of cells of this size."""

MARGIN_M = 0.05
"""Clearance that a robot needs in addition to its body, as controllers plan their paths."""

_NEAR_M = 1.0
"""How far from a start the reachable floor may begin, if the start itself is too close to a wall."""


def with_random_victims(scenario: Scenario, building: Building) -> Scenario:
    """Return a scenario with the victims of `mission.random_victims` at their places; the same if there are none.

    Each is at the centre of a cell, uniformly drawn from all cells that a robot present at the start can reach; if
    firefighters save, by the passages of people. The places depend on the plan, the reachable floor and the seed, but
    not on the controller, the noise or the number of robots.

    Raises: PlacementError: a robot has no room. ScenarioError: fewer cells can be reached than there are victims.
    """
    count, key = scenario.mission.random_victims, "mission.random_victims"
    if count == 0:
        return scenario
    robots = [robot for robot in placed_robots(scenario, building) if robot.present]
    starts = tuple(robot.start_pose[:2] for robot in robots)
    by: Traveller = "people" if scenario.mission.saved_by == "firefighter" else "robots"
    cells_m = building.shared(reachable_cells_m, min(robot.reach_m for robot in robots), starts, by)
    if len(cells_m) < count:
        line = (
            f"{key}: {count} victims, but robots can reach {len(cells_m)} free cells of {CELL_M:g} m from their start"
        )
        raise ScenarioError(scenario.origin.line(line, key))
    chosen = rng.stream(scenario.run.seed, "random_victims").choice(len(cells_m), count, replace=False)
    placed = tuple(
        Victim(name=f"random_{number}", position=(x, y))
        for number, (x, y) in enumerate(cells_m[chosen].round(3).tolist(), 1)
    )
    mission = scenario.mission.model_copy(update={"victims": (*scenario.mission.victims, *placed), "random_victims": 0})
    return scenario.model_copy(update={"mission": mission})


def reachable_cells_m(
    building: Building, reach_m: float, starts: tuple[Point, ...], by: Traveller, through_doors: bool = False
) -> np.ndarray:
    """Return the centres of all cells that a body of this radius can reach from any start, shape (n, 2), row by row.

    Args: by:            who goes between levels.
          through_doors: False: doors are as at the start; True: as if all were open.
    """
    occupancy = building.grid_without_doors(CELL_M) if through_doors else building.grid(CELL_M)
    by_passages = portals(building.plan.levels, building.plan.passages, by)
    grid = _core.plan.PlanningGrid(occupancy.cells != FREE, occupancy.origin_m, CELL_M, reach_m + MARGIN_M, by_passages)
    reached = np.zeros(occupancy.cells.shape, dtype=bool)
    for start in starts:
        place = grid.nearest_free(start, _NEAR_M)
        if place is None or reached[occupancy.cell_at(*place)]:
            continue
        reached |= np.isfinite(grid.distance_map(place))
    rows, columns = np.nonzero(reached)
    cells_m: np.ndarray = (np.stack([columns, rows], axis=1) + 0.5) * CELL_M + np.array(occupancy.origin_m)
    cells_m.flags.writeable = False
    return cells_m
