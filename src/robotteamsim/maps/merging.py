"""Maps that were begun at unknown places: where the one of a robot lies in the one of its team."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.interface.localisation import Estimate, Localisation, LocalisationState
from robotteamsim.maps.found_map import CELL_M, FoundMap
from robotteamsim.maps.own_map import cells_at
from robotteamsim.maps.recent_scans import LaserView, evenly, moved
from robotteamsim.maps.teammates import Disc
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.plan import FREE, OCCUPIED

_KEPT = 150
"""Scans with teammates in reach of messages."""

_EVERY_M = 2.0
"""Way of the robot between two searches [m]."""

_NEAR_M, _POINTS = 12.0, 150
"""The search uses so many occupied cells of the robot's own map, this near to it [m]."""

_FEWEST_POINTS = 50

_ON_WALL_M = 0.15
"""How far the cells of one map may be from those of the other [m]."""

_LEAST_SHARE, _AS_GOOD, _SAME_M, _SAME_RAD, _MOST_MATCHES = 0.4, 0.7, 0.5, 0.3, 100
"""Of the search, see `_core.maps.SubmapSearch`: of one that finds so many, none is believed."""

_AGREEING, _FEWEST_CELLS = 0.9, 100
"""Share of the occupied cells of each map that are occupied in the other, among those that both know; and how many."""

_SIGHTINGS, _APART_M, _BEAMS = 8, 2.0, 3
"""So many scans must show a teammate where the other map says that it is, at places this far apart [m], with so many
beams each that end where the robot's own map is free."""


_BESIDE_M = CELL_M * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
_AROUND_M = 2.0 * _BESIDE_M
"""A cell and those next to it, and those two cells away [m]: noise is not movement."""

_FAR_M = 1.0
"""No distance from a wall counts as more [m]."""


class Match(NamedTuple):
    """A place of the robot's own map in that of its team.

    pose:       of the frame of the own map, in `map`.
    cells:      number of occupied cells of which both maps know what is there.
    agreement:  share of these that are occupied in both.
    seen, missed: scans that showed a teammate where it says that it is, and that showed that it is not there.
    spread_m:   largest distance between two places where one was seen [m].
    """

    pose: Pose
    cells: int
    agreement: float
    seen: int
    missed: int
    spread_m: float

    @property
    def is_certain(self) -> bool:
        """Whether walls and sightings both confirm it."""
        fits = self.cells >= _FEWEST_CELLS and self.agreement >= _AGREEING
        return fits and self.seen >= _SIGHTINGS and self.spread_m >= _APART_M and 10 * self.missed <= self.seen


class _Look(NamedTuple):
    """A scan: the robot's pose in the frame of its own map, where beams end, and which do so where that is free."""

    pose: Pose
    ranges_m: np.ndarray
    ends_m: np.ndarray
    moving: np.ndarray
    teammates: tuple[Disc, ...]


class Merging:
    """Looks for the place of a robot's own map in the map of its team, by walls and by the sight of teammates.

    Walls alone prove nothing: in the office, maps of two wings agree in 97 % of 5,753 cells. The second witness are
    teammates: beams that end where a teammate says that it is, and where the robot's own map is free.
    """

    def __init__(self, view: LaserView, narrowest_m: float, found: FoundMap) -> None:
        """Args: narrowest_m: no robot is narrower.  found: both maps have its origin and shape, each in its frame."""
        self._view, self._narrowest_m, self._origin_m = view, narrowest_m, found.origin_m
        self._looks: deque[_Look] = deque(maxlen=_KEPT)
        rows, columns = found.cells.shape
        self._anywhere = ((columns * CELL_M) ** 2 / 12.0, 0.0, 0.0, (rows * CELL_M) ** 2 / 12.0, 0.0, math.pi**2 / 3.0)
        """Covariance of a pose of which the robot knows nothing: uniform within the bounds."""
        self._driven_m = 0.0
        self.matches: list[Match] = []
        """What the last search found, the one with the most sightings first."""

    def localisation(self, pose: Pose) -> Localisation:
        """Return what the robot knows of its pose. Args: pose: in the frame of its own map."""
        state: LocalisationState = "ambiguous" if len(self.matches) > 1 else "lost"
        poses = (pose, *(match.pose @ pose for match in self.matches))
        return Localisation(state, tuple(Estimate(each, self._anywhere) for each in poses))

    def note(self, pose: Pose, ranges_m: np.ndarray, teammates: Sequence[Disc], own: np.ndarray) -> None:
        """Note a scan. Args: teammates: where they say that they are, in `map`.  own: cells of the robot's map."""
        if self._looks:
            since = self._looks[-1].pose.inverse() @ pose
            self._driven_m += math.hypot(since.x_m, since.y_m)
        ends_m = self._view.ends_m(ranges_m)
        hits = (ranges_m > self._view.laser.range_min_m) & (ranges_m < self._view.laser.range_max_m)
        around = [self._at(own, moved(pose, ends_m) + shift) == FREE for shift in _AROUND_M]
        moving = hits & np.all(around, axis=0)
        self._looks.append(_Look(pose, ranges_m.copy(), ends_m, moving, tuple(teammates)))

    def search(self, own: np.ndarray, team: np.ndarray) -> Pose | None:
        """Return the pose of the frame of the robot's own map in `map`, once there is no doubt about it.

        Args: own, team: cells of both maps, int8, of the same shape.
        """
        moving = sum(np.count_nonzero(look.moving) >= _BEAMS for look in self._looks if look.teammates)
        if self._driven_m < _EVERY_M or moving < _SIGHTINGS:
            return None
        self._driven_m = 0.0
        found = [self._judged(pose, own, team) for pose in self._places(own, team)]
        found = [match for match in found if match.agreement >= _AGREEING]
        self.matches = sorted(found, key=lambda match: match.missed - match.seen)
        if not self.matches or not self.matches[0].is_certain:
            return None
        best, *others = self.matches
        return None if any(2 * match.seen >= best.seen for match in others) else best.pose

    def _places(self, own: np.ndarray, team: np.ndarray) -> list[Pose]:
        """Return where the walls near the robot fit those of the team."""
        here = self._looks[-1].pose
        walls_m = moved(here.inverse(), centers_m(own, self._origin_m))
        near_m = walls_m[np.hypot(*walls_m.T) < _NEAR_M]
        if len(near_m) < _FEWEST_POINTS:
            return []
        search = _core.maps.SubmapSearch(team == OCCUPIED, self._origin_m, CELL_M, _ON_WALL_M)
        points_m = evenly(near_m, _POINTS)
        matches = search.find(points_m, _LEAST_SHARE, _AS_GOOD, _SAME_M, _SAME_RAD, _MOST_MATCHES)
        if len(matches) >= _MOST_MATCHES:
            return []
        walls, points_m = WallField(team, self._origin_m), centers_m(own, self._origin_m)
        return [walls.aligned(pose @ here.inverse(), points_m)[0] for pose, _ in matches]

    def _judged(self, pose: Pose, own: np.ndarray, team: np.ndarray) -> Match:
        """Return how well a place of the own map fits."""
        known = agreeing = 0
        for cells, others, frame in ((own, team, pose), (team, own, pose.inverse())):
            walls_m = moved(frame, centers_m(cells, self._origin_m))
            there = self._at(others, walls_m)
            is_wall = np.any([self._at(others, walls_m + shift) == OCCUPIED for shift in _BESIDE_M], axis=0)
            known += int(np.count_nonzero(is_wall | (there == FREE)))
            agreeing += int(np.count_nonzero(is_wall))
        seen_m, missed = [], 0
        for look in self._looks:
            at = pose @ look.pose
            missed += self._view.misses(look.teammates, at, look.ranges_m, self._narrowest_m)
            on_teammates = look.moving & self._view.end_in(look.teammates, at, look.ends_m)
            if np.count_nonzero(on_teammates) >= _BEAMS:
                seen_m.append(moved(at, look.ends_m[on_teammates]).mean(axis=0))
        places_m = np.array(seen_m).reshape(-1, 2)
        spread_m = np.hypot(*(places_m[:, None] - places_m[None]).T).max(initial=0.0)
        return Match(pose, known, agreeing / max(known, 1), len(seen_m), missed, float(spread_m))

    def _at(self, cells: np.ndarray, points_m: np.ndarray) -> np.ndarray:
        """Return the cells of points, shape (n,); outside, they are UNKNOWN."""
        return cells_at(cells, points_m, self._origin_m)


class WallField:
    """The distances from walls, and where a map lies best on them."""

    def __init__(self, cells: np.ndarray, origin_m: Point) -> None:
        """Args: cells: int8.  origin_m: of cell (0, 0)."""
        field = _core.maps.DistanceField(cells == OCCUPIED, origin_m, CELL_M).distances_m()
        self._away_m, self._origin_m = np.minimum(field, _FAR_M).astype(float), origin_m

    def aligned(self, pose: Pose, points_m: np.ndarray) -> tuple[Pose, np.ndarray]:
        """Return a pose near the given one at which points lie better on walls, and those that do.

        Gauss-Newton steps on the distances of the points near walls, which weigh less the larger they are.

        Args: points_m: shape (n, 2) [m], in the frame with this pose.
        """
        moved_m = points_m
        for reach_m in (0.6, 0.5, 0.4, *[0.3] * 8):
            moved_m = moved(pose, points_m)
            away_m, slope = self._at(moved_m)
            near = away_m < reach_m
            at_m, away_m, slope, moved_m = moved_m[near], away_m[near], slope[near], moved_m[near]
            if len(at_m) < _FEWEST_POINTS:
                break
            middle_m = at_m.mean(axis=0)
            arm_m = at_m - middle_m
            jacobian = np.column_stack((slope, arm_m[:, 0] * slope[:, 1] - arm_m[:, 1] * slope[:, 0]))
            weighted = jacobian / (1.0 + (away_m / CELL_M) ** 2)[:, None]
            x_m, y_m, yaw_rad = np.linalg.solve(weighted.T @ jacobian + 1e-3 * np.eye(3), -weighted.T @ away_m)
            turn = Pose(0.0, 0.0, float(yaw_rad))
            shift_m = middle_m + np.array((x_m, y_m)) - moved(turn, middle_m[None])[0]
            pose = Pose(float(shift_m[0]), float(shift_m[1]), float(yaw_rad)) @ pose
        return pose, moved_m

    def _at(self, points_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the distances, shape (n,) [m], and their slopes along x and y, shape (n, 2): bilinear."""
        places = (points_m - self._origin_m) / CELL_M - 0.5
        rows, columns = self._away_m.shape
        low = np.clip(np.floor(places).astype(np.int64), 0, (columns - 2, rows - 2))
        (u, v), (column, row) = np.clip(places - low, 0.0, 1.0).T, low.T
        a, b = self._away_m[row, column], self._away_m[row, column + 1]
        c, d = self._away_m[row + 1, column], self._away_m[row + 1, column + 1]
        away_m = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d)
        slope = np.column_stack(((1 - v) * (b - a) + v * (d - c), (1 - u) * (c - a) + u * (d - b))) / CELL_M
        return away_m, slope


def centers_m(cells: np.ndarray, origin_m: Point) -> np.ndarray:
    """Return the centres of occupied cells, shape (n, 2) [m]. Args: origin_m: of cell (0, 0)."""
    return np.asarray((np.argwhere(cells == OCCUPIED)[:, ::-1] + 0.5) * CELL_M + origin_m)
