"""The team in the 3D scene: robots, their trails and the radio links between them."""

import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from scipy.sparse import csgraph
from scipy.spatial import distance

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.nodes.scene.building import TRAIL_LAYER, TRAIL_Z_M
from robotteamsim.nodes.scene.shapes import (
    WHITE,
    Mesh,
    circle_points,
    colour,
    drawn_below,
    faded,
    label,
    lines,
    person,
    shaded,
)
from robotteamsim.recording.topics.markers import CYLINDER, LINE_STRIP, Colour, Marker, Position
from robotteamsim.recording.topics.radio import PublishedNetwork
from robotteamsim.scenario.scenario import Role
from robotteamsim.scenario.sections import Robot

EXCLUDED, BODY = colour(palette.EXCLUDED_ROBOT), colour(palette.ROBOT_BODY)
HELMET, COAT = colour(palette.HELMET), colour(palette.TURNOUT_COAT)
LINK, ENDANGERED_LINK = colour(palette.STRONG_LINK), colour(palette.ENDANGERED_LINK)
LINK_Z_M = 0.07
FEW_ROBOTS = 8
"""Largest team whose links are all shown; more would hide the scene."""
RING_MARGIN_M, RING_WIDTH_M, RING_Z_M = 0.55, 0.14, TRAIL_Z_M - 0.01
"""The ring shows where a robot is: with the whole building in view, a robot is a few pixels wide."""
NUMBER_M = 1.1
"""Height of a robot's number in a building of 60 x 40 m; all sizes but those of bodies scale with the building."""
TRAIL_SPACING_M = 0.2


@dataclass
class RobotPicture:
    """A robot as drawn: it, and where it has been."""

    robot_id: int
    model: Robot = field(default_factory=Robot)
    role: Role = "robot"
    is_base: bool = False
    """Whether discoveries are delivered to this robot."""
    pose: Pose | None = None
    """In the map frame; None before the first one."""
    time_s: float = -math.inf
    """Of the pose."""
    trail_m: deque[tuple[float, float]] = field(default_factory=deque)
    """Earlier positions, from the oldest to the newest, in the map frame [m]."""
    excluded: bool = False
    """Whether it is socially excluded."""
    swarm: int | None = None
    """Its swarm; None if there is only one swarm."""

    @property
    def words(self) -> str:
        """Its number, such as "R0", "base R0" or "F5" for a firefighter."""
        if self.role != "robot":
            return "centre" if self.role == "command_centre" else f"F{self.robot_id}"
        return f"base R{self.robot_id}" if self.is_base else f"R{self.robot_id}"

    def move(self, time_s: float, pose: Pose) -> None:
        """Note the current pose.

        If time jumps backwards, or the robot is farther away than it could have driven, the trail restarts.
        """
        elapsed_s, self.time_s, self.pose = time_s - self.time_s, time_s, pose
        place_m = (pose.x_m, pose.y_m)
        moved_m = math.dist(self.trail_m[-1], place_m) if self.trail_m else math.inf
        if elapsed_s < 0.0 or moved_m > TRAIL_SPACING_M + 1.5 * self.model.drive.max_speed_mps * elapsed_s:
            self.trail_m.clear()
        if not self.trail_m or moved_m >= TRAIL_SPACING_M:
            self.trail_m.append(place_m)


def robot_colour(number: int) -> Colour:
    """Return the colour of a robot, or of a swarm's rings, by its number."""
    return colour(palette.robot_colour(max(number, 0)))


def team_markers(robots: Sequence[RobotPicture], size: float, text_z_m: float) -> Iterator[Marker]:
    """Yield the markers of all robots. Args: size: see `shapes.unit`.  text_z_m: height of texts, above the walls.

    Numbers are on the side that is away from the rest of the team, where they rarely cover each other.
    """
    seen = [(robot, robot.pose) for robot in robots if robot.pose is not None]
    center_m = np.mean([(pose.x_m, pose.y_m) for _, pose in seen], axis=0) if seen else (0.0, 0.0)
    height_m = NUMBER_M * size * (1.0 if len(seen) <= FEW_ROBOTS else 0.8)
    for robot, pose in seen:
        x, y = pose.x_m, pose.y_m
        sign = EXCLUDED if robot.excluded else robot_colour(robot.robot_id if robot.swarm is None else robot.swarm)
        ring_m = robot.model.reach_m + RING_MARGIN_M * size
        yield from _body(robot, pose)
        yield from _ring(robot, pose, sign, ring_m, RING_WIDTH_M * size)
        away_rad = math.atan2(y - center_m[1], x - center_m[0]) if len(seen) > 1 else math.pi / 2.0
        along_m, across_m = ring_m + 1.1 * height_m, ring_m + 0.8 * height_m
        at = (x + along_m * math.cos(away_rad), y + across_m * math.sin(away_rad), text_z_m)
        yield label("robot_ids", robot.robot_id, robot.words, sign, at, height_m)


def _body(robot: RobotPicture, pose: Pose) -> list[Marker]:
    """Return body and deck: cylinders, or a prism over the footprint; or a firefighter."""
    tint, model = robot_colour(robot.robot_id), robot.model
    if robot.role == "firefighter":
        return person("firefighters", robot.robot_id, pose, COAT, head=HELMET, lies=False)
    if model.corners_m:
        mesh, footprint = Mesh(), shapely.Polygon(model.corners_m)
        mesh.prism(footprint, 0.0, 0.9 * model.height_m, BODY)
        mesh.prism(shapely.affinity.scale(footprint, 0.92, 0.92), 0.9 * model.height_m, model.height_m, tint)
        return [_placed(mesh.marker("bodies", robot.robot_id), pose)]
    width_m, height_m = 2.0 * model.reach_m, model.height_m
    return [
        Marker(
            name,
            robot.robot_id,
            CYLINDER,
            part_tint,
            position=(pose.x_m, pose.y_m, z * height_m),
            scale=(part * width_m, part * width_m, thickness * height_m),
        )
        for name, part_tint, z, part, thickness in (("bodies", BODY, 0.45, 1.0, 0.9), ("decks", tint, 0.95, 0.92, 0.1))
    ]


def _ring(robot: RobotPicture, pose: Pose, sign: Colour, ring_m: float, width_m: float) -> Iterator[Marker]:
    """Yield a ring with an arrow ahead; a second, white ring around the base."""
    for name, tint, radius_m in (("rings", sign, ring_m), ("bases", WHITE, 1.35 * ring_m)):
        if name == "rings" or robot.is_base:
            ring = Marker(name, robot.robot_id, LINE_STRIP, tint, scale=(width_m, 0.0, 0.0))
            ring.points = [(x, y, RING_Z_M) for x, y in circle_points(radius_m, 24)]
            yield _placed(ring, pose)
    arrow, base_m, half_m = Mesh(), ring_m, 0.36 * ring_m
    corners = [(1.6 * ring_m, 0.0), (base_m - 0.1 * ring_m, half_m), (base_m - 0.1 * ring_m, -half_m)]
    arrow.triangle([(x, y, RING_Z_M) for x, y in corners], [sign] * 3)
    yield _placed(arrow.marker("arrows", robot.robot_id), pose)


def _placed(item: Marker, pose: Pose) -> Marker:
    """Return a marker of points in base_link, moved to a robot."""
    item.position, item.yaw_rad = (pose.x_m, pose.y_m, item.position[2]), pose.yaw_rad
    return item


def trail_marker(robot_id: int, points_m: Sequence[tuple[float, float]], size: float) -> Marker:
    """Return a line that fades towards its oldest point; needs at least two points."""
    tint = robot_colour(robot_id)
    result = Marker("trails", robot_id, LINE_STRIP, faded(tint, 0.99), scale=(0.16 * size, 0.0, 0.0))
    # Trails have slightly different heights; otherwise they would flicker where they cross.
    z_m = TRAIL_Z_M + 0.003 * (robot_id % 8)
    result.points = [(x, y, z_m) for x, y in points_m]
    opacities = np.linspace(0.25, 0.9, len(points_m)).tolist()
    result.tints = [faded(shaded(tint, 0.9), opacity) for opacity in opacities]
    return drawn_below(result, TRAIL_LAYER)


def link_markers(
    links: PublishedNetwork | None, positions_m: Mapping[int, tuple[float, float]], size: float
) -> list[Marker]:
    """Return the links; of many robots only a spanning forest of the shortest ones, which connects the same robots.

    Args: positions_m: of each robot in the map frame [m]; links of other robots are omitted.
    """
    ids = [] if links is None else [i for i in sorted(positions_m) if i < len(links.adjacency)]
    if links is None or not ids:
        return []
    # A distance of 0 would mean that there is no link.
    lengths_m = distance.squareform(distance.pdist([positions_m[robot_id] for robot_id in ids])) + 1e-6
    lengths_m = np.triu(np.where(links.adjacency[np.ix_(ids, ids)], lengths_m, 0.0))
    if len(ids) > FEW_ROBOTS:
        lengths_m = csgraph.minimum_spanning_tree(lengths_m).toarray()
    segments = list[tuple[Position, Position, Colour]]()
    for i, j in np.argwhere(lengths_m).tolist():
        tint = ENDANGERED_LINK if links.endangered[ids[i], ids[j]] else LINK
        segments.append(((*positions_m[ids[i]], LINK_Z_M), (*positions_m[ids[j]], LINK_Z_M), tint))
    return [lines("links", 0, segments, 0.12 * size)]
