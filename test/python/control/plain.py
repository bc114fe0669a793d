"""What the library does for the controllers, the plain way, and to the same bits."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np

from robotteamsim.geometry import Pose, Twist, normalise_angle
from robotteamsim.scenario.control_tuning import NavigatorTuning
from robotteamsim.scenario.sections import Laser, Robot
from robotteamsim.swarm import Vector

TUNING = NavigatorTuning()
ARRIVED_M, LASER_MARGIN_M, LOOK_AHEAD_M = TUNING.arrived_m, TUNING.laser_margin_m, TUNING.look_ahead_m
LONGEST_PATH_M, TURN_IN_PLACE_RAD = TUNING.longest_path_m, TUNING.turn_in_place_rad
TURN_GAIN_PER_S, BRAKING_MPS2 = TUNING.turn_gain_per_s, TUNING.braking_mps2
MANOEUVRING_MPS, ROOM_TO_TURN_M = TUNING.manoeuvring_mps, TUNING.room_to_turn_m
PROGRESS_M, STUCK_TIMEOUT_S, YIELD_TIMEOUT_S = TUNING.progress_m, TUNING.stuck_timeout_s, TUNING.yield_timeout_s
ESCAPE_M, ESCAPE_TIME_S, ESCAPE_HEADINGS = TUNING.escape_m, TUNING.escape_time_s, TUNING.escape_headings
NEAR_TEAMMATE_M = TUNING.near_teammate_m
LEFT_PENALTY_RAD, CHANGE_PENALTY_RAD = TUNING.sidestep_left_penalty, TUNING.sidestep_change_penalty
AHEAD_RAD = TUNING.sidestep_ahead_rad
SIDESTEPS_RAD = tuple(math.radians(10.0 * i) for i in range(-9, 10))


class PlainClearance:
    """What a scan says of the room around a robot."""

    def __init__(self, laser: Laser) -> None:
        self._laser = laser
        step_rad = (laser.angle_max_rad - laser.angle_min_rad) / (laser.beams - 1)
        self._angles_rad = [laser.angle_min_rad + i * step_rad for i in range(laser.beams)]

    def hits(self, ranges_m: np.ndarray, max_distance_m: float) -> list[Vector]:
        longest_m = self._laser.range_max_m * (1.0 - 1e-6)
        hits = [
            (self._laser.forward_m + range_m * math.cos(angle_rad), range_m * math.sin(angle_rad))
            for range_m, angle_rad in zip(ranges_m.tolist(), self._angles_rad, strict=True)
            if range_m < longest_m
        ]
        return [(x, y) for x, y in hits if x * x + y * y < max_distance_m * max_distance_m]

    def free_distance(self, ranges_m: np.ndarray, heading_rad: float, radius_m: float, max_distance_m: float) -> float:
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        free_m = max_distance_m
        for x, y in self.hits(ranges_m, max_distance_m + radius_m):
            along, across = x * cos + y * sin, y * cos - x * sin
            if along <= 0.0 or radius_m * radius_m - across * across <= 0.0:
                continue
            touch = along - math.sqrt(radius_m * radius_m - across * across)
            if touch >= 0.0:
                free_m = min(free_m, touch)
            elif along * along > 0.25 * (along * along + across * across):
                return 0.0
        return free_m


class PlainNavigator:
    """Drives one robot to a goal that may change in any step. Times are of the simulation [s]."""

    def __init__(self, body: Robot, robot_id: int, mode: str) -> None:
        self._robot_id = robot_id
        self._mode = mode
        self._drive = body.drive
        self._radius_m = body.reach_m
        self._clearance = PlainClearance(body.laser)
        low_rad, high_rad = body.laser.angle_min_rad, body.laser.angle_max_rad
        self._field_of_view_rad = (low_rad, high_rad)
        sidesteps_rad = [a for a in SIDESTEPS_RAD if low_rad <= a <= high_rad] or [0.0]
        self._sidesteps_rad = sidesteps_rad
        self._passing_side = 0
        self._goal: Vector | None = None
        self._map = None
        self._route: list[Vector] = []
        self._anchor: Vector = (math.inf, math.inf)
        self._anchor_s = 0.0
        self._escape: Vector | None = None
        self._escape_until_s = 0.0
        self._num_escapes = 0

    def drive(
        self,
        known_map,
        pose: Pose,
        ranges_m: np.ndarray,
        goal: Vector,
        speed_mps: float,
        time_s: float,
        teammates: Mapping[int, Vector],
    ) -> Twist:
        """Return the command of this step.

        Args: goal: in `map` [m]; one inside an obstacle stands for the nearest free point that can be reached.
              speed_mps: not to be exceeded.  teammates: where other robots were last heard to be, in `map` [m].
        """
        position = (pose.x_m, pose.y_m)
        if goal != self._goal or known_map is not self._map:
            self._goal, self._map = goal, known_map
            self._route = self._find_route(known_map, position, goal)
        self._watch_progress(known_map, pose, ranges_m, time_s, teammates)
        if self._escape is not None:
            return self._steer(pose, ranges_m, self._escape, self._drive.max_speed_mps, is_last=True)
        while len(self._route) > 1 and known_map.grid.is_line_free(position, self._route[1]):
            del self._route[0]
        if len(self._route) > 1 and math.dist(position, self._route[0]) < ARRIVED_M:
            del self._route[0]
        return self._steer(pose, ranges_m, self._route[0], speed_mps, is_last=len(self._route) == 1)

    def _find_route(self, known_map, position: Vector, goal: Vector) -> list[Vector]:
        """Return the points to drive to, one after the other; at least one."""
        grid = known_map.grid
        if self._mode == "straight":
            free_goal = grid.nearest_free(goal, 3.0)
            return [goal if free_goal is None else free_goal]
        if grid.is_line_free(position, goal):
            return [goal]
        start = grid.nearest_free(position, 1.0)
        if start is None:
            return [goal]
        corners = grid.waypoints(start, goal, LONGEST_PATH_M)
        if len(corners) > 1:
            return [*corners[1:-1], goal]
        return [plain_reachable_towards(grid, position, goal)]

    def _watch_progress(
        self, known_map, pose: Pose, ranges_m: np.ndarray, time_s: float, teammates: Mapping[int, Vector]
    ) -> None:
        """Start an escape when the robot wants to move and does not, end one when it is over."""
        position = (pose.x_m, pose.y_m)
        moved = math.dist(position, self._anchor) > PROGRESS_M
        arrived = math.dist(position, self._route[-1]) < 2.0 * ARRIVED_M
        if self._escape is not None:
            if time_s < self._escape_until_s and math.dist(position, self._escape) > ARRIVED_M:
                return
            self._escape = None
            self._anchor, self._anchor_s = position, time_s
        if moved or arrived:
            if moved:
                self._num_escapes = 0
            self._anchor, self._anchor_s = position, time_s
            return
        waited_s = time_s - self._anchor_s
        if waited_s <= YIELD_TIMEOUT_S or (waited_s <= STUCK_TIMEOUT_S and not self._yields(position, teammates)):
            return
        self._escape = self._find_escape(known_map, pose, ranges_m, teammates)
        self._escape_until_s = time_s + ESCAPE_TIME_S
        self._num_escapes += 1

    def _yields(self, position: Vector, teammates: Mapping[int, Vector]) -> bool:
        """Whether a teammate of lower id is near."""
        return any(
            math.dist(position, other) < NEAR_TEAMMATE_M
            for robot_id, other in teammates.items()
            if robot_id < self._robot_id
        )

    def _find_escape(self, known_map, pose: Pose, ranges_m: np.ndarray, teammates: Mapping[int, Vector]) -> Vector:
        """Return a point nearby with room around it. Robots, and one robot's attempts, begin to look at other sides."""
        position = (pose.x_m, pose.y_m)
        is_free = known_map.grid.is_free(position)
        best, best_room_m = position, -math.inf
        # Those farther away leave all the room that counts.
        reach_m = 2.0 * ESCAPE_M + self._radius_m + 1e-6
        near = [other for other in teammates.values() if math.dist(position, other) < reach_m]
        for i in range(ESCAPE_HEADINGS):
            heading = math.tau * ((i + 5 * self._robot_id + 3 * self._num_escapes) % ESCAPE_HEADINGS) / ESCAPE_HEADINGS
            point = (
                position[0] + ESCAPE_M * math.cos(heading),
                position[1] + ESCAPE_M * math.sin(heading),
            )
            if not (known_map.grid.is_line_free(position, point) if is_free else known_map.grid.is_free(point)):
                continue
            room_m = min((math.dist(point, other) - self._radius_m for other in near), default=ESCAPE_M)
            relative = normalise_angle(heading - pose.yaw_rad)
            if self._field_of_view_rad[0] <= relative <= self._field_of_view_rad[1]:
                seen_m = self._clearance.free_distance(ranges_m, relative, self._radius_m + LASER_MARGIN_M, ESCAPE_M)
                room_m = min(room_m, seen_m)
            room_m = min(room_m, ESCAPE_M)
            if room_m > best_room_m + 1e-9:
                best, best_room_m = point, room_m
        return best

    def _steer(self, pose: Pose, ranges_m: np.ndarray, point: Vector, speed_mps: float, is_last: bool) -> Twist:
        """Return the command that leads towards a point in sight, around what stands in the way."""
        d_x, d_y = point[0] - pose.x_m, point[1] - pose.y_m
        distance_m = math.hypot(d_x, d_y)
        if distance_m < ARRIVED_M:
            return Twist()
        wanted_rad = normalise_angle(math.atan2(d_y, d_x) - pose.yaw_rad)
        needed_m = min(distance_m, LOOK_AHEAD_M)
        radius_m = self._radius_m + LASER_MARGIN_M
        heading_rad, free_m = self._sidestep(ranges_m, wanted_rad, radius_m, needed_m)
        turn_radps = max(-self._drive.max_turn_radps, min(self._drive.max_turn_radps, TURN_GAIN_PER_S * heading_rad))
        if abs(heading_rad) > TURN_IN_PLACE_RAD:
            return Twist(self._manoeuvring_speed_mps(ranges_m, radius_m, speed_mps), 0.0, turn_radps)
        room_m = min(free_m, distance_m) if is_last else free_m
        forward_mps = min(speed_mps, self._drive.max_speed_mps, math.sqrt(2.0 * BRAKING_MPS2 * max(0.0, room_m)))
        return Twist(forward_mps * math.cos(heading_rad), 0.0, turn_radps)

    def _sidestep(
        self, ranges_m: np.ndarray, wanted_rad: float, radius_m: float, needed_m: float
    ) -> tuple[float, float]:
        """Return the heading to take and how far it is free."""

        def free_m(heading_rad: float) -> float:
            return self._clearance.free_distance(ranges_m, heading_rad, radius_m, needed_m)

        if free_m(wanted_rad) >= needed_m or abs(wanted_rad) >= AHEAD_RAD:
            self._passing_side = 0
            return wanted_rad, free_m(wanted_rad)
        ways = [(heading_rad, free_m(heading_rad)) for heading_rad in self._sidesteps_rad]
        free_ways = [way for way in ways if way[1] >= needed_m]
        if not free_ways:
            return min(ways, key=lambda way: (-way[1], abs(way[0] - wanted_rad)))

        def cost(way: tuple[float, float]) -> float:
            offset_rad = way[0] - wanted_rad
            changes = self._passing_side * offset_rad < 0.0
            return (
                abs(offset_rad)
                + (LEFT_PENALTY_RAD if offset_rad > 0.0 else 0.0)
                + (CHANGE_PENALTY_RAD if changes else 0.0)
            )

        best = min(free_ways, key=cost)
        self._passing_side = 1 if best[0] > wanted_rad else -1
        return best

    def _manoeuvring_speed_mps(self, ranges_m: np.ndarray, radius_m: float, speed_mps: float) -> float:
        """Return how fast to drive while turning far: not at all, but a car must; back where no room is ahead."""
        if self._drive.kind != "car":
            return 0.0
        has_room = self._clearance.free_distance(ranges_m, 0.0, radius_m, ROOM_TO_TURN_M) >= ROOM_TO_TURN_M
        return math.copysign(min(speed_mps, self._drive.max_speed_mps, MANOEUVRING_MPS), 1.0 if has_room else -1.0)


class PlainSurroundings:
    """The obstacle term of one robot."""

    def __init__(self, laser: Laser, sensing_radius_m: float) -> None:
        self._stride = max(1, laser.beams // 60)
        beams = len(range(0, laser.beams, self._stride))
        last_rad = laser.angle_min_rad
        last_rad += (beams - 1) * self._stride * (laser.angle_max_rad - laser.angle_min_rad) / (laser.beams - 1)
        self._clearance = PlainClearance(laser.model_copy(update={"beams": beams, "angle_max_rad": last_rad}))
        self._radius_m = sensing_radius_m
        self._headings_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, 13).tolist()

    def attractor(self, pose: Pose, ranges_m: np.ndarray) -> Vector | None:
        ranges_m = ranges_m[:: self._stride]
        if not self._clearance.hits(ranges_m, self._radius_m):
            return None
        candidates_m = [
            (reach_m * math.cos(heading_rad), reach_m * math.sin(heading_rad))
            for heading_rad in self._headings_rad
            for reach_m in (0.5 * self._radius_m, self._radius_m)
            if reach_m <= self._clearance.free_distance(ranges_m, heading_rad, 0.05, self._radius_m)
        ]
        hits_m = self._clearance.hits(ranges_m, 2.0 * self._radius_m)
        x, y = plain_farthest(hits_m, [(0.0, 0.0), *candidates_m])
        cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        return pose.x_m + cos * x - sin * y, pose.y_m + sin * x + cos * y


def plain_farthest(hits_m: list[Vector], places_m: list[Vector]) -> Vector:
    """Return the first of the places whose nearest hit is farthest away."""
    return max(places_m, key=lambda place: min(math.dist(place, hit) for hit in hits_m))


class PlainRuledOut:
    """What is known of where victims are not."""

    def __init__(self, radius_m: float, cell_m: float, next_to_m: float) -> None:
        self._radius_m, self._cell_m, self._next_to_m = radius_m, cell_m, next_to_m
        self._notes: dict[tuple[int, int, Vector | None], tuple[Vector, Vector | None]] = {}

    def add(self, position: Vector, loudest: Vector | None) -> None:
        key = (round(position[0] / 0.25), round(position[1] / 0.25), loudest)
        self._notes.setdefault(key, (position, loudest))

    def covers(self, place: Vector) -> bool:
        return any(self._rules_out(place, *note) for note in self._notes.values())

    def _rules_out(self, place: Vector, position: Vector, loudest: Vector | None) -> bool:
        distance_m = math.dist(place, position)
        is_it = loudest is not None and math.dist(place, loudest) < 0.5 * self._cell_m
        return distance_m < self._next_to_m or (distance_m < self._radius_m and not is_it)


def plain_reachable_towards(grid, start: Vector, goal: Vector) -> Vector:
    if grid.is_line_free(start, goal):
        return goal
    free_start = grid.nearest_free(start, 1.0)
    if free_start is None:
        return goal
    return grid.nearest_reachable(free_start, goal, math.dist(free_start, goal) + 0.1)


def plain_first_stretch(grid, start: Vector, goal: Vector, max_length_m: float) -> tuple[Vector, float]:
    straight_m = math.dist(start, goal)
    if grid.is_line_free(start, goal):
        return goal, straight_m
    free_start, free_goal = grid.nearest_free(start, 1.0), grid.nearest_free(goal, 1.0)
    if free_start is None or free_goal is None:
        return goal, straight_m
    corners = grid.waypoints(free_start, free_goal, max_length_m)
    if len(corners) < 2:
        return goal, straight_m
    length_m = 0.0  # `sum` adds more exactly from Python 3.12 on
    for a, b in itertools.pairwise(corners):
        length_m += math.dist(a, b)
    return corners[1], length_m


def plain_along_path(grid, start: Vector, goal: Vector, max_length_m: float) -> Vector:
    bend, length_m = plain_first_stretch(grid, start, goal, max_length_m)
    bend_m = math.dist(start, bend)
    if bend == goal or bend_m == 0.0:
        return goal
    stretch = length_m / bend_m
    return start[0] + stretch * (bend[0] - start[0]), start[1] + stretch * (bend[1] - start[1])
