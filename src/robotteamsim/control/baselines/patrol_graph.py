"""The graph that a robot patrols: that of the scenario, or one made from its known map."""

import math
from dataclasses import dataclass

import numpy as np

from robotteamsim.control.driving.known_map import UNREACHABLE_M, KnownMap, known_map
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import portals
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


@dataclass(frozen=True, slots=True)
class Graph:
    """Places in `map` [m], and for each its neighbours with the lengths of the paths to them [m]."""

    places: tuple[Vector, ...]
    edges: tuple[tuple[tuple[int, float], ...], ...]

    def nearest(self, position: Vector) -> int:
        """Return the vertex with the smallest straight distance to a position; the first one of ties."""
        return min(range(len(self.places)), key=lambda vertex: math.dist(self.places[vertex], position))


def patrol_graph(setup: Setup, robot_radius_m: float | None = None) -> Graph:
    """Return the graph of `mission.patrol`, for robots of this radius; None: as it is measured, for the smallest one.

    Raises: ScenarioError: the plan has no room for one.
    """
    scenario, patrol = setup.scenario, setup.scenario.mission.patrol
    if patrol.graph is not None:
        vertices = patrol.graph.vertices
        edges = tuple(tuple(zip(vertex.neighbours, vertex.lengths_m, strict=True)) for vertex in vertices)
        return Graph(tuple(vertex.position for vertex in vertices), edges)
    radius_m = setup.smallest_reach_m if robot_radius_m is None else robot_radius_m
    graph = reachable_lattice(setup, radius_m, patrol.spacing_m, patrol.longest_edge)
    if not graph.places:
        key = "mission.patrol.spacing_m"
        text = f"{key}: {patrol.spacing_m:g} m leaves no two places of the plan linked"
        raise ScenarioError(scenario.origin.line(text, key))
    return graph


def reachable_lattice(setup: Setup, robot_radius_m: float, spacing_m: float, longest_edge: float) -> Graph:
    """Return the free places next to the points of a square lattice, linked to their four neighbours by free paths.

    Only places that can be reached from the start of robot 0 count, and of these the largest connected part is kept.

    Args: longest_edge: the longest path of an edge, in spacings.
    """
    return setup.building.shared(_lattice, robot_radius_m, spacing_m, longest_edge, setup.start_m(0))


def _lattice(building: MapSource, robot_radius_m: float, spacing_m: float, longest_edge: float, start: Vector) -> Graph:
    known = known_map(building, robot_radius_m)
    near = known.grid.nearest_free(start, 1.0)
    if near is None:
        return Graph((), ())
    lengths_m = known.grid.distance_map(near)
    places = {
        node: place
        for node, place in _places(building.plan, known, spacing_m).items()
        if math.isfinite(known.grid.value_at(lengths_m, place))
    }
    ways: dict[tuple[int, int], list[tuple[tuple[int, int], float]]] = {node: [] for node in places}
    for column, row in places:
        for other in ((column + 1, row), (column, row + 1)):
            if other not in places:
                continue
            _, length_m = known.grid.first_stretch(places[column, row], places[other], longest_edge * spacing_m)
            free = known.grid.is_line_free(places[column, row], places[other])
            # Without a path of that length, `distance_m` would return a straight distance through the wall.
            if free or math.dist(places[column, row], places[other]) + 1e-6 < length_m <= longest_edge * spacing_m:
                ways[column, row].append((other, length_m))
                ways[other].append(((column, row), length_m))
    for start_m, end_m, passage_m in portals(building.plan.levels, building.plan.passages, "robots") if places else ():
        (start, to_start_m), (end, to_end_m) = (_nearest(known, places, stop) for stop in (start_m, end_m))
        length_m = to_start_m + passage_m + to_end_m
        if start != end and math.isfinite(length_m):
            ways[start].append((end, length_m))
            ways[end].append((start, length_m))
    kept = _largest_part(ways)
    index = {node: i for i, node in enumerate(kept)}
    edges = tuple(tuple((index[other], length_m) for other, length_m in ways[node]) for node in kept)
    return Graph(tuple(places[node] for node in kept), edges)


def _nearest(known: KnownMap, places: dict[tuple[int, int], Vector], stop: Vector) -> tuple[tuple[int, int], float]:
    """Return the node with the shortest path to the stop of a passage, and its length [m]; inf without one."""
    lengths_m = known.distances_m(stop, np.array(list(places.values())))
    nearest = int(np.argmin(lengths_m))
    return list(places)[nearest], float(lengths_m[nearest]) if lengths_m[nearest] < UNREACHABLE_M else math.inf


def _places(plan: FloorPlan, known: KnownMap, spacing_m: float) -> dict[tuple[int, int], Vector]:
    (x_low, y_low), (x_high, y_high) = plan.bounds.min, plan.bounds.max
    places: dict[tuple[int, int], Vector] = {}
    for column, x in enumerate(np.arange(x_low + 0.5 * spacing_m, x_high, spacing_m).tolist()):
        for row, y in enumerate(np.arange(y_low + 0.5 * spacing_m, y_high, spacing_m).tolist()):
            place = known.grid.nearest_free((x, y), 0.25 * spacing_m)
            if place is not None:
                places[column, row] = place
    return places


def _largest_part(ways: dict[tuple[int, int], list[tuple[tuple[int, int], float]]]) -> list[tuple[int, int]]:
    """Return the nodes of the largest connected part, sorted; empty if no two nodes are linked."""
    largest: set[tuple[int, int]] = set()
    seen: set[tuple[int, int]] = set()
    for first in ways:
        part, waiting = {first}, [first] if first not in seen else []
        while waiting:
            for other, _ in ways[waiting.pop()]:
                if other not in part:
                    part.add(other)
                    waiting.append(other)
        seen |= part
        if len(part) > max(1, len(largest)):
            largest = part
    return sorted(largest)
