"""Maps that were begun at unknown places: where the one of a robot lies in the one of its team.

All constants are ours, from the missions of study/unknown.
"""

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
from robotteamsim.maps.hypothesis import are_one_place
from robotteamsim.maps.own_map import cells_at
from robotteamsim.maps.recent_scans import LaserView, evenly, moved
from robotteamsim.maps.teammates import Disc
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.plan import FREE, OCCUPIED

_KEPT = 150
"""So many of the last scans in whose step teammates said where they are."""

_EVERY = 4
"""A search needs so many scans since the last one."""

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
"""So many scans must show a teammate where it says that it is, at places so far apart [m], with so many beams each."""

_MISSED_SHARE, _RIVAL_SHARE = 0.1, 0.5
"""Of the sightings: at most so many scans show that a teammate is not there; no other place has so many sightings."""

_CONFIRMED, _SEEN_AT_M, _SEEN_MOST = 3, 0.6, 3
"""So many times a teammate must see something move where the robot would be, within this distance [m]; how many such
places a message has at most."""

_BESIDE_M = CELL_M * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
"""A cell and those next to it [m]."""

_FAR_M = 1.0
"""No distance from a wall counts as more [m]."""


class Match(NamedTuple):
    """A place of the robot's own map in that of its team.

    pose:       of the frame of the own map, in `map`.
    cells:      number of occupied cells of which both maps know what is there.
    agreement:  share of these that are occupied in both.
    seen, missed: scans that showed a teammate where it says that it is, and that showed that it is not there.
    spread_m:   largest distance between two places where one was seen [m].
    confirmed:  how many times a teammate saw something move where the robot would be.
    """

    pose: Pose
    cells: int
    agreement: float
    seen: int
    missed: int
    spread_m: float
    confirmed: int

    @property
    def is_certain(self) -> bool:
        """Whether walls, what the robot sees and what teammates see all confirm it."""
        fits = self.cells >= _FEWEST_CELLS and self.agreement >= _AGREEING
        sees = self.seen >= _SIGHTINGS and self.spread_m >= _APART_M and self.missed <= _MISSED_SHARE * self.seen
        return fits and sees and self.confirmed >= _CONFIRMED


class _Look(NamedTuple):
    """A scan.

    pose:      of the robot in the frame of its own map.
    moving:    beams that end at what moves, bool.
    teammates: where they said just before that they are, in `map`.
    reported:  where they saw something move that is none of them, in `map` [m].
    """

    pose: Pose
    ranges_m: np.ndarray
    ends_m: np.ndarray
    moving: np.ndarray
    teammates: tuple[Disc, ...]
    reported: tuple[Point, ...]


class Merging:
    """Looks for the place of a robot's own map in the map of its team, by walls and by the sight of teammates.

    Walls alone prove nothing: in the office, maps of two wings agree in 97 % of 5,753 cells. The second witness are
    teammates: beams that end where a teammate says that it is, and where the robot's own map is free. And the teammate
    must see the robot: in a building with two equal halves, somebody else may be where it would be seen.
    """

    def __init__(self, view: LaserView, narrowest_m: float, found: FoundMap) -> None:
        """Args: narrowest_m: no robot is narrower.  found: both maps have its origin and shape, each in its frame."""
        self._view, self._narrowest_m, self._origin_m = view, narrowest_m, found.origin_m
        self._looks: deque[_Look] = deque(maxlen=_KEPT)
        rows, columns = found.cells.shape
        self._anywhere = ((columns * CELL_M) ** 2 / 12.0, 0.0, 0.0, (rows * CELL_M) ** 2 / 12.0, 0.0, math.pi**2 / 3.0)
        """Covariance of a pose of which the robot knows nothing: uniform within the bounds."""
        self._new = 0
        """Scans since the last search."""
        self.matches: list[Match] = []
        """What the last search found, the one with the most sightings first."""

    def localisation(self, pose: Pose) -> Localisation:
        """Return what the robot knows of its pose. Args: pose: in the frame of its own map."""
        state: LocalisationState = "ambiguous" if len(self.matches) > 1 else "lost"
        poses = (pose, *(match.pose @ pose for match in self.matches))
        return Localisation(state, tuple(Estimate(each, self._anywhere) for each in poses))

    def note(
        self,
        pose: Pose,
        ranges_m: np.ndarray,
        teammates: Sequence[Disc],
        reported: Sequence[Point],
        own: np.ndarray,
    ) -> None:
        """Note a scan after teammates have said where they are. Args: see `_Look`.  own: cells of the own map."""
        ends_m = self._view.ends_m(ranges_m)
        moving = self._view.hits(ranges_m) & is_open(own, moved(pose, ends_m), self._origin_m)
        self._looks.append(_Look(pose, ranges_m.copy(), ends_m, moving, tuple(teammates), tuple(reported)))
        self._new += 1

    def search(self, here: Pose, own: np.ndarray, team: np.ndarray) -> Pose | None:
        """Return the pose of the frame of the robot's own map in `map`, once there is no doubt about it.

        Args:   here: of the robot in that frame.
                own, team: cells of both maps, int8, of the same shape.
        """
        moving = sum(np.count_nonzero(look.moving) >= _BEAMS for look in self._looks if look.teammates)
        if self._new < _EVERY or moving < _SIGHTINGS:
            return None
        self._new = 0
        found = [self._judged(pose, own, team) for pose in self._places(here, own, team)]
        found = [match for match in found if match.agreement >= _AGREEING]
        self.matches = sorted(found, key=lambda match: match.missed - match.seen)
        if not self.matches or not self.matches[0].is_certain:
            return None
        best, *others = self.matches
        is_rivalled = any(match.seen >= _RIVAL_SHARE * best.seen for match in others)
        return None if is_rivalled else best.pose

    def _places(self, here: Pose, own: np.ndarray, team: np.ndarray) -> list[Pose]:
        """Return where the walls near the robot fit those of the team."""
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
        places: list[Pose] = []
        for pose, _ in matches:
            place = walls.aligned(pose @ here.inverse(), points_m)
            if not any(are_one_place(place @ here, other @ here, _SAME_M) for other in places):
                places.append(place)
        return places

    def _judged(self, pose: Pose, own: np.ndarray, team: np.ndarray) -> Match:
        """Return how well a place of the own map fits."""
        known = agreeing = 0
        for cells, others, frame in ((own, team, pose), (team, own, pose.inverse())):
            walls_m = moved(frame, centers_m(cells, self._origin_m))
            there = self._at(others, walls_m)
            is_wall = np.any([self._at(others, walls_m + shift) == OCCUPIED for shift in _BESIDE_M], axis=0)
            known += int(np.count_nonzero(is_wall | (there == FREE)))
            agreeing += int(np.count_nonzero(is_wall))
        seen_m, missed, confirmed = [], 0, 0
        for look in self._looks:
            at = pose @ look.pose
            confirmed += any(math.dist(each, (at.x_m, at.y_m)) < _SEEN_AT_M for each in look.reported)
            missed += self._view.misses(look.teammates, at, look.ranges_m, self._narrowest_m)
            on_teammates = look.moving & self._view.end_in(look.teammates, at, look.ends_m)
            if np.count_nonzero(on_teammates) >= _BEAMS:
                seen_m.append(moved(at, look.ends_m[on_teammates]).mean(axis=0))
        places_m = np.array(seen_m).reshape(-1, 2)
        spread_m = np.hypot(*(places_m[:, None] - places_m[None]).T).max(initial=0.0)
        return Match(pose, known, agreeing / max(known, 1), len(seen_m), missed, float(spread_m), confirmed)

    def _at(self, cells: np.ndarray, points_m: np.ndarray) -> np.ndarray:
        """Return the cells of points, shape (n,); outside, they are UNKNOWN."""
        return cells_at(cells, points_m, self._origin_m)


class WallField:
    """The distances from walls, and where a map lies best on them."""

    def __init__(self, cells: np.ndarray, origin_m: Point) -> None:
        """Args: cells: int8.  origin_m: of cell (0, 0)."""
        field = _core.maps.DistanceField(cells == OCCUPIED, origin_m, CELL_M).distances_m()
        self._away_m, self._origin_m = np.minimum(field, _FAR_M).astype(float), origin_m

    def aligned(self, pose: Pose, points_m: np.ndarray) -> Pose:
        """Return a pose near the given one at which points lie better on walls, in 0.1 mm and millionths of a radian.

        Gauss-Newton steps on the distances of the points near walls, which weigh less the larger they are.

        Args: points_m: shape (n, 2) [m], in the frame with this pose.
        """
        for reach_m in (0.6, 0.5, 0.4, *[0.3] * 8):
            moved_m = moved(pose, points_m)
            away_m, slope = self._at(moved_m)
            near = away_m < reach_m
            at_m, away_m, slope = moved_m[near], away_m[near], slope[near]
            if len(at_m) < _FEWEST_POINTS:
                break
            middle_m = at_m.mean(axis=0)
            arm_m = at_m - middle_m
            jacobian = np.column_stack((slope, arm_m[:, 0] * slope[:, 1] - arm_m[:, 1] * slope[:, 0]))
            weighted = jacobian / (1.0 + (away_m / CELL_M) ** 2)[:, None]
            # Sums whose last bits do not depend on the processor, as those of BLAS do.
            normal = (weighted[:, :, None] * jacobian[:, None, :]).sum(axis=0)
            x_m, y_m, yaw_rad = np.linalg.solve(normal + 1e-3 * np.eye(3), -(weighted * away_m[:, None]).sum(axis=0))
            turn = Pose(0.0, 0.0, float(yaw_rad))
            shift_m = middle_m + np.array((x_m, y_m)) - moved(turn, middle_m[None])[0]
            pose = Pose(float(shift_m[0]), float(shift_m[1]), float(yaw_rad)) @ pose
        return Pose(round(pose.x_m, 4), round(pose.y_m, 4), round(pose.yaw_rad, 6))

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


def is_open(cells: np.ndarray, points_m: np.ndarray, origin_m: Point) -> np.ndarray:
    """Return whether a map is free at points and 0.2 m around: what beams hit there moves. Bool, shape (n,)."""
    around = [cells_at(cells, points_m + shift, origin_m) == FREE for shift in 2.0 * _BESIDE_M]
    return np.asarray(np.all(around, axis=0))


def moving_places(ends_m: np.ndarray, moving: np.ndarray) -> tuple[Point, ...]:
    """Return where several neighbouring beams end at what moves [m], the largest things first, at most `_SEEN_MOST`.

    Args: ends_m: shape (beams, 2).  moving: bool, shape (beams,).
    """
    beams = np.flatnonzero(moving)
    things = [each for each in np.split(beams, np.flatnonzero(np.diff(beams) > 2) + 1) if len(each) >= _BEAMS]
    largest = sorted(things, key=len, reverse=True)[:_SEEN_MOST]
    return tuple((round(float(x), 2), round(float(y), 2)) for x, y in (ends_m[each].mean(axis=0) for each in largest))


def centers_m(cells: np.ndarray, origin_m: Point) -> np.ndarray:
    """Return the centres of occupied cells, shape (n, 2) [m]. Args: origin_m: of cell (0, 0)."""
    return np.asarray((np.argwhere(cells == OCCUPIED)[:, ::-1] + 0.5) * CELL_M + origin_m)
