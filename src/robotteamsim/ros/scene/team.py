"""The team in the 3D scene: robots, their trails and the radio links between them."""

import itertools
import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from geometry_msgs.msg import Point
from scipy.sparse import csgraph
from scipy.spatial import distance
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.analysis.labels import ABOVE
from robotteamsim.geometry import Pose
from robotteamsim.network.messages import NetworkState
from robotteamsim.ros.scene import figures
from robotteamsim.ros.scene.lettering import Lettering, Name, Written
from robotteamsim.ros.scene.plan import TRAIL_Z_M
from robotteamsim.ros.scene.shapes import (
    TRAIL_LAYER,
    WHITE,
    Colour,
    Mesh,
    Position,
    circle_points,
    colour,
    drawn_below,
    faded,
    gradient,
    lines,
    marker,
    shaded,
)
from robotteamsim.scenario.body import corners_at
from robotteamsim.scenario.plan import Corners
from robotteamsim.scenario.scenario import Role

EXCLUDED = colour(palette.EXCLUDED_ROBOT)
BODY = colour(palette.ROBOT_BODY)
BUMPER = colour(palette.COLLISION)

ENDANGERED_DBM, SAFE_DBM = -80.0, -55.0
LINK_COLOURS = (
    (ENDANGERED_DBM, colour(palette.ENDANGERED_LINK)),
    (-70.0, colour(palette.WEAK_LINK)),
    (SAFE_DBM, colour(palette.STRONG_LINK)),
)
"""Colour by signal [dBm]: that of endangered links from their threshold on."""
RELAYED = colour(palette.RELAYED)
LINK_HEIGHT_M = 0.36
DASH_M = 0.8
FEW_ROBOTS = 8
"""Largest team for which links and hop counts of all pairs are shown; more would hide the scene."""

RING_MARGIN_M = 0.55
"""Radius of the ring that shows where a robot is: with the whole building in view, a robot is a few pixels wide."""
RING_WIDTH_M = 0.14
RING_Z_M = TRAIL_Z_M - 0.01
BUMPER_HALF_RAD = 0.35
HIT_WIDTH_M = 0.3
TURRET_M = 0.25
"""Limit of the size of lasers on large robots."""
MAX_LASERS = 17
"""That a robot can have: `robots.laser` and sixteen of `robots.lasers`."""
FAR_GOAL_M = 2.0
"""Goals that are nearer are not shown [m]."""
LABEL_M = 1.1
"""Height of a robot's number in a building of 60 x 40 m; all sizes but those of bodies scale with the building."""
HOPS_M = 0.9
ARROW_PER_RING = 1.6
"""How far the arrow reaches, in radii of the ring."""
BASE_PER_RING = 1.35
"""Half the side of the square around the base, in radii of its ring."""


@dataclass(frozen=True, slots=True)
class RobotView:
    """A robot as drawn; pose in the map frame, excluded: socially excluded, contacts as in `Contact`."""

    robot_id: int
    pose: Pose
    radius_m: float = 0.2
    height_m: float = 0.25
    excluded: bool = False
    corners_m: Corners = ()
    """Of a body that is not a disc, counter-clockwise in base_link; radius_m is then its reach."""
    contact_angles_rad: tuple[float, ...] = ()
    lasers_m: tuple[tuple[float, float], ...] = ()
    """Positions of its lasers in base_link; if none are known, one slightly ahead of the centre."""
    swarm: int | None = None
    """Its swarm; None if there is only one swarm."""
    base: bool = False
    """Whether discoveries are delivered to this robot."""
    goal_m: tuple[float, float] | None = None
    """Where it drives to."""
    role: Role = "robot"

    @property
    def words(self) -> str:
        """Its number, such as "R0", "base R0" or "F5" for a firefighter."""
        if self.role != "robot":
            return "centre" if self.role == "command_centre" else f"F{self.robot_id}"
        return f"base R{self.robot_id}" if self.base else f"R{self.robot_id}"

    def ring_m(self, unit: float) -> float:
        """Return the radius of its ring. Args: unit: see `view.unit`."""
        return self.radius_m + RING_MARGIN_M * unit


def robot_colour(number: int) -> Colour:
    """Return the colour of a robot, or of a swarm's rings, by its number."""
    return colour(palette.robot_colour(max(number, 0)))


def team_numbers(
    views: Sequence[RobotView],
    lettering: Lettering,
    taken: Sequence[shapely.Geometry] = (),
    before: Mapping[int, Written] | None = None,
) -> dict[int, Written]:
    """Return the number of each robot by its id, clear of walls, robots and other texts.

    Args: before: the last answer; numbers stay on their sides where they can.
    """
    height_m = LABEL_M * lettering.unit * (1.0 if len(views) <= FEW_ROBOTS else 0.8)
    rings = [shapely.Point(view.pose.x_m, view.pose.y_m).buffer(view.ring_m(lettering.unit), 4) for view in views]
    last = before or {}
    texts = [
        Name(
            view.words,
            (view.pose.x_m, view.pose.y_m),
            figures.CLEAR_M
            if view.role == "firefighter"
            else view.ring_m(lettering.unit) * (BASE_PER_RING if view.base else ARROW_PER_RING),
            height_m,
            last[view.robot_id].side if view.robot_id in last else ABOVE,
        )
        for view in views
    ]
    placed = lettering.place(texts, [*rings, *taken])
    return {view.robot_id: number for view, number in zip(views, placed, strict=True)}


def team_markers(
    views: Sequence[RobotView], lettering: Lettering, numbers: Mapping[int, Written] | None = None
) -> list[Marker]:
    """Return the markers of all robots. Args: numbers: from `team_numbers`, which finds them by default."""
    placed = team_numbers(views, lettering) if numbers is None else numbers
    return [part for view in views for part in robot_markers(view, lettering, placed[view.robot_id])]


def robot_markers(view: RobotView, lettering: Lettering, number: Written) -> list[Marker]:
    """Return body, deck, heading wedge, lasers, number, and a ring with an arrow to find the robot from far away.

    Ring, arrow and number are grey if the robot is excluded, and have the colour of its swarm if there are several; the
    deck always has the colour of the robot. At contacts the rim is red, with a red arc outside the ring. The base is in
    a square.
    """
    tint = robot_colour(view.robot_id)
    sign = EXCLUDED if view.excluded else tint if view.swarm is None else robot_colour(view.swarm)
    pose, radius_m, height_m = view.pose, view.radius_m, view.height_m
    x, y = pose.x_m, pose.y_m
    ring_m, width_m = view.ring_m(lettering.unit), RING_WIDTH_M * lettering.unit
    bumpers = [corner for angle in view.contact_angles_rad for corner in _bumper(view, angle)]
    hits = [corner for angle in view.contact_angles_rad for corner in _hit(ring_m, lettering.unit, angle)]

    def part(name: str, kind: int, tint: Colour, at: Position, size: Position) -> Marker:
        return marker(name, view.robot_id, kind, tint, position=at, yaw_rad=pose.yaw_rad, scale=size)

    def cylinder(name: str, tint: Colour, z: float, radius_m: float, height_m: float) -> Marker:
        return part(name, Marker.CYLINDER, tint, (x, y, z), (2.0 * radius_m, 2.0 * radius_m, height_m))

    def flat(name: str, kind: int, tint: Colour, z: float, corners: Sequence[tuple[float, float]]) -> Marker:
        result = part(name, kind, tint, (x, y, z), (1.0, 1.0, 1.0))
        result.points = [Point(along, across, 0.0) for along, across in corners]
        result.colors = [ColorRGBA(*tint)] * len(corners)
        return result

    ring = flat("rings", Marker.LINE_STRIP, sign, RING_Z_M, circle_points(ring_m, 24, closed=True))
    ring.scale.x = width_m
    touching = [("bumpers", height_m + 0.014, bumpers), ("hits", RING_Z_M + 0.02, hits)]
    return [
        cylinder("halos", faded(sign, 0.25), RING_Z_M, ring_m, 0.01),
        ring,
        flat("arrows", Marker.TRIANGLE_LIST, sign, RING_Z_M, _arrow(ring_m, width_m)),
        *(
            figures.firefighter(view.robot_id, (x, y), pose.yaw_rad)
            if view.role == "firefighter"
            else [
                *_body(view, tint, cylinder),
                *_turrets(view),
                flat("wedges", Marker.TRIANGLE_LIST, WHITE, height_m + 0.012, _wedge(radius_m)),
            ]
        ),
        *(flat(name, Marker.TRIANGLE_LIST, BUMPER, z_m, corners) for name, z_m, corners in touching if corners),
        *([_square(view, BASE_PER_RING * ring_m, width_m)] if view.base else []),
        *_goal(view, sign, width_m),
        lettering.label("robot_ids", view.robot_id, number, sign),
    ]


def _square(view: RobotView, half_m: float, width_m: float) -> Marker:
    """Return the square around the base, which does not turn with the robot."""
    x, y = view.pose.x_m, view.pose.y_m
    result = marker("bases", view.robot_id, Marker.LINE_STRIP, WHITE, position=(x, y, RING_Z_M), scale=(width_m, 0, 0))
    corners = ((-half_m, -half_m), (half_m, -half_m), (half_m, half_m), (-half_m, half_m), (-half_m, -half_m))
    result.points = [Point(*corner, 0.0) for corner in corners]
    return result


def _goal(view: RobotView, tint: Colour, width_m: float) -> Iterator[Marker]:
    """Yield a thin line to the goal; none for the next point of a swarm robot, which is beside it."""
    x, y = view.pose.x_m, view.pose.y_m
    if view.goal_m is None or math.dist(view.goal_m, (x, y)) < FAR_GOAL_M:
        return
    result = marker("goals", view.robot_id, Marker.LINE_STRIP, faded(tint, 0.6), scale=(0.5 * width_m, 0, 0))
    result.points = [Point(x, y, RING_Z_M), Point(*view.goal_m, RING_Z_M)]
    yield result


def _body(
    view: RobotView, tint: Colour, cylinder: Callable[[str, Colour, float, float, float], Marker]
) -> list[Marker]:
    """Return body and deck: cylinders, or prisms over the footprint."""
    if not view.corners_m:
        return [
            cylinder("bodies", BODY, 0.45 * view.height_m, view.radius_m, 0.9 * view.height_m),
            cylinder("decks", tint, 0.95 * view.height_m, 0.92 * view.radius_m, 0.1 * view.height_m),
        ]
    pose = (view.pose.x_m, view.pose.y_m, view.pose.yaw_rad)
    inner = tuple((0.92 * x, 0.92 * y) for x, y in view.corners_m)
    body, deck = Mesh(), Mesh()
    body.prism(corners_at(view.corners_m, pose), 0.0, 0.9 * view.height_m, BODY)
    deck.prism(corners_at(inner, pose), 0.9 * view.height_m, view.height_m, tint)
    return [body.marker("bodies", view.robot_id), deck.marker("decks", view.robot_id)]


def _wedge(radius_m: float) -> list[tuple[float, float]]:
    nose, tail = (0.9 * radius_m, 0.0), (-0.3 * radius_m, 0.0)
    left, right = (-0.65 * radius_m, 0.6 * radius_m), (-0.65 * radius_m, -0.6 * radius_m)
    return [nose, left, tail, nose, tail, right]


def _turrets(view: RobotView) -> list[Marker]:
    """Return a small drum for each laser."""
    places_m = view.lasers_m or ((0.45 * view.radius_m, 0.0),)
    width_m = (0.7 if len(places_m) == 1 else 0.5) * min(view.radius_m, TURRET_M)
    drums = []
    for i, (x_m, y_m) in enumerate(places_m):
        at = view.pose @ Pose(x_m, y_m, 0.0)
        position, scale = (at.x_m, at.y_m, view.height_m + 0.05), (width_m, width_m, 0.1)
        drums.append(
            marker("lasers", MAX_LASERS * view.robot_id + i, Marker.CYLINDER, BODY, position=position, scale=scale)
        )
    return drums


def _bumper(view: RobotView, angle_rad: float) -> list[tuple[float, float]]:
    """Return the triangles of the part of the rim that is within 0.35 rad of an angle."""
    angles_rad = angle_rad + np.linspace(-BUMPER_HALF_RAD, BUMPER_HALF_RAD, 8)
    outline = shapely.Polygon(view.corners_m).exterior if view.corners_m else None
    rims_m = [view.radius_m if outline is None else _rim_m(outline, angle) for angle in angles_rad.tolist()]
    return _band(angles_rad, 0.75 * np.array(rims_m), 1.1 * np.array(rims_m))


def _rim_m(outline: shapely.LinearRing, angle_rad: float) -> float:
    """Return the extent of a body in a direction."""
    far_m = 2.0 * max(math.hypot(x, y) for x, y in outline.coords)
    beam = shapely.LineString([(0.0, 0.0), (far_m * math.cos(angle_rad), far_m * math.sin(angle_rad))])
    return float(shapely.hausdorff_distance(shapely.Point(0.0, 0.0), shapely.intersection(outline, beam)))


def _hit(ring_m: float, unit: float, angle_rad: float) -> list[tuple[float, float]]:
    """Return the triangles of an arc outside the ring, wide enough to be seen with the whole building in view."""
    angles_rad = angle_rad + np.linspace(-BUMPER_HALF_RAD, BUMPER_HALF_RAD, 8)
    inner_m = np.full(8, ring_m + 0.5 * RING_WIDTH_M * unit)
    return _band(angles_rad, inner_m, inner_m + HIT_WIDTH_M * unit)


def _band(angles_rad: np.ndarray, inner_m: np.ndarray, outer_m: np.ndarray) -> list[tuple[float, float]]:
    """Return the triangles between two curves around the origin, given by their distances at some angles."""
    directions = np.column_stack([np.cos(angles_rad), np.sin(angles_rad)])
    inner, outer = (list(map(tuple, (reach_m[:, None] * directions).tolist())) for reach_m in (inner_m, outer_m))
    pieces = zip(inner, outer, inner[1:], outer[1:], strict=False)
    return [corner for a, b, c, d in pieces for corner in (a, b, c, c, b, d)]


def _arrow(ring_m: float, width_m: float) -> list[tuple[float, float]]:
    base_m, half_m = ring_m + 0.5 * width_m, 0.36 * ring_m
    return [
        (base_m + (ARROW_PER_RING - 1.0) * ring_m, 0.0),
        (base_m - 0.1 * ring_m, half_m),
        (base_m - 0.1 * ring_m, -half_m),
    ]


class Trail:
    """The path of a robot so far: points at least `spacing_m` apart."""

    def __init__(self, spacing_m: float = 0.2) -> None:
        self._spacing_m = spacing_m
        self._points: deque[tuple[float, float]] = deque()
        self._time_s = -math.inf

    @property
    def points_m(self) -> tuple[tuple[float, float], ...]:
        """Points from the oldest to the newest, in the map frame [m]."""
        return tuple(self._points)

    def add(self, x_m: float, y_m: float, time_s: float, max_speed_mps: float, max_points: int) -> None:
        """Add the current position; beyond `max_points` the oldest points are removed.

        If time jumps backwards, or the robot is farther away than it could have driven, the trail restarts.
        """
        elapsed_s, self._time_s = time_s - self._time_s, time_s
        if self._points:
            moved_m = math.dist(self._points[-1], (x_m, y_m))
            if elapsed_s < 0.0 or moved_m > self._spacing_m + 1.5 * max_speed_mps * elapsed_s:
                self._points.clear()
            elif moved_m < self._spacing_m:
                return
        self._points.append((x_m, y_m))
        while len(self._points) > max_points:
            self._points.popleft()


def trail_marker(robot_id: int, points_m: Sequence[tuple[float, float]], unit: float = 1.0) -> Marker:
    """Return a line that fades towards its oldest point; needs at least two points."""
    tint = robot_colour(robot_id)
    result = marker("trails", robot_id, Marker.LINE_STRIP, faded(tint, 0.99), scale=(0.16 * unit, 0.0, 0.0))
    # Trails have slightly different heights; otherwise they would flicker where they cross.
    z_m = TRAIL_Z_M + 0.003 * (robot_id % 8)
    for i, (x_m, y_m) in enumerate(points_m):
        result.points.append(Point(x_m, y_m, z_m))
        result.colors.append(ColorRGBA(*faded(shaded(tint, 0.9), 0.25 + 0.65 * (i + 1) / len(points_m))))
    return drawn_below(result, TRAIL_LAYER)


@dataclass(frozen=True, slots=True)
class LinkView:
    """One pair of robots: signal [dBm], whether a direct link exists, hops (-1: no path)."""

    first: int
    second: int
    rssi_dbm: float
    linked: bool
    hop_count: int


def link_views(network: NetworkState) -> list[LinkView]:
    """Return every pair of robots once, ordered by ids; for many robots only the links that connect them.

    These are the links without a better detour over a third robot (the relative neighbourhood graph by signal): they
    are few, rarely cross each other, and connect the same robots as all links.
    """
    pairs = list(itertools.combinations(range(len(network.adjacency)), 2))
    if len(network.adjacency) > FEW_ROBOTS:
        rssi_dbm = np.where(network.adjacency, network.rssi_dbm, -np.inf)
        pairs = [(i, j) for i, j in pairs if np.minimum(rssi_dbm[i], rssi_dbm[j]).max() < rssi_dbm[i, j]]
    return [
        LinkView(i, j, float(network.rssi_dbm[i, j]), bool(network.adjacency[i, j]), int(network.hop_count[i, j]))
        for i, j in pairs
    ]


def link_views_without_signals(network: NetworkState, positions_m: Mapping[int, tuple[float, float]]) -> list[LinkView]:
    """Return links of a network that was restored from its compact form: a spanning forest of the shortest ones.

    They are few, rarely cross each other, and connect the same robots as all links. Each has the signal of a safe or of
    an endangered link.
    """
    ids = np.array([i for i in sorted(positions_m) if i < len(network.adjacency)], dtype=np.int64)
    if not len(ids):
        return []
    places_m = np.array([positions_m[i] for i in ids.tolist()])
    # A distance of 0 would mean that there is no link.
    lengths_m = np.maximum(distance.squareform(distance.pdist(places_m)), 1e-6)
    forest = csgraph.minimum_spanning_tree(np.where(network.adjacency[np.ix_(ids, ids)], lengths_m, 0.0)).tocoo()
    pairs = np.sort(np.column_stack((ids[forest.row], ids[forest.col])), axis=1).tolist()
    return [LinkView(i, j, ENDANGERED_DBM if network.endangered[i, j] else SAFE_DBM, True, 1) for i, j in sorted(pairs)]


def link_markers(
    links: Sequence[LinkView], positions_m: Mapping[int, tuple[float, float]], lettering: Lettering
) -> list[Marker]:
    """Return direct links coloured by signal, and dashed lines with their hops for pairs connected over other robots.

    Args: positions_m: of each robot in the map frame [m]; pairs of unknown robots are omitted.
    """
    known = [link for link in links if link.first in positions_m and link.second in positions_m]
    reachable = [link for link in known if link.linked or link.hop_count > 0]
    solid, dashed, numbers = [], [], []
    for i, link in enumerate(reachable):
        start, end = _clear_of_robots(positions_m[link.first], positions_m[link.second])
        tint = gradient(LINK_COLOURS, link.rssi_dbm) if link.linked else RELAYED
        if link.linked:
            solid.append((start, end, tint))
        else:
            dashed += [(a, b, tint) for a, b in _dashes(start, end, DASH_M * lettering.unit)]
            if len(positions_m) <= FEW_ROBOTS and math.dist(start, end) > 5.0 * lettering.unit:
                # Not at the middle: in a chain of robots, the relays are often there.
                x, y, _ = _between(start, end, 0.4)
                hops = Written(f"{link.hop_count} hops", (x, y), HOPS_M * lettering.unit)
                numbers.append(lettering.label("hops", i, hops, tint))
    bundles = [("links", 0, solid, 0.12 * lettering.unit), ("links", 1, dashed, 0.07 * lettering.unit)]
    return [lines(name, i, segments, width_m) for name, i, segments, width_m in bundles if segments] + numbers


def _between(start: Position, end: Position, share: float) -> Position:
    x, y, z = (a + share * (b - a) for a, b in zip(start, end, strict=True))
    return (x, y, z)


def _clear_of_robots(first_m: tuple[float, float], second_m: tuple[float, float]) -> tuple[Position, Position]:
    """Return the ends of a link, shortened so that it does not cover the robots."""
    start, end = (*first_m, LINK_HEIGHT_M), (*second_m, LINK_HEIGHT_M)
    cut = min(0.3, 0.4 / max(math.dist(start, end), 1e-6))
    return _between(start, end, cut), _between(start, end, 1.0 - cut)


def _dashes(start: Position, end: Position, dash_m: float) -> Iterator[tuple[Position, Position]]:
    count = max(1, round(math.dist(start, end) / dash_m))
    for i in range(0, count, 2):
        yield _between(start, end, i / count), _between(start, end, min(i + 1, count) / count)
