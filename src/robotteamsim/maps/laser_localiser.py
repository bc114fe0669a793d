"""Localisation by laser in a building whose plan is known: `control.localisation: laser`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim import _core, rng
from robotteamsim.geometry import Pose
from robotteamsim.interface import Localisation, Observation
from robotteamsim.interface.localisation import LocalisationState
from robotteamsim.maps.hypothesis import Hypothesis
from robotteamsim.maps.localiser import LevelChanges
from robotteamsim.maps.recent_scans import LaserView, RecentScans, Scan, evenly
from robotteamsim.maps.teammates import Disc
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.plan import FREE
from robotteamsim.scenario.sensors.laser import Laser
from robotteamsim.setup import Setup
from robotteamsim.world.core_parts import core_fan

_STILL = Pose(0.0, 0.0, 0.0)

_SEARCH_CELL_M, _ON_WALL_M = 0.1, 0.15
"""Cells of the search in the plan, and how far from a wall a point may lie there [m]."""

_SAME_M, _SAME_RAD = 0.5, 0.3
"""Poses that differ less are one place [m, rad]."""

_FEWEST_POINTS = 50
"""With fewer, a robot has not seen enough to search for it."""

_AS_GOOD = 0.8
"""A place counts if it has at least this share of the points on walls that the best place has."""

_MOST_MATCHES = 200
"""A search that finds so many has not found all: what the robot has seen is everywhere."""

_MOST_PLACES = 50
"""With more places to follow, the robot has not seen enough, either."""

_FOUND_M, _FOUND_RAD = 0.25, 0.04
"""Standard deviations of a place that the search found, which cover those that count as the same [m, rad]."""

_DECISIVE = 3
"""A place is dropped once so many scans did not show a teammate who should be in view, or showed one only elsewhere."""

_FEWEST_ON_TEAMMATE = 3
"""Of a teammate that a scan shows: they end where the plan is free, and where the teammate says that it is."""

_SHOWN = 100
"""Particles for display, at most: messages and bags have 56 bytes for each."""

_TRUSTED_M = 2.0
"""When a robot notices that it is lost, it has been so for longer: older scans may be from elsewhere [m]."""


class LaserLocaliser:
    """Follows a robot with particles, and searches the plan for what it saw last when they disagree; a `Localiser`.

    Its state is tracking from a known start; lost once too many beams contradict the map. A lost robot searches the
    plan for all places where its last metres fit, and follows each: those that go on to fit are where it may be. With
    one it is tracking again, with several ambiguous, until the sight of a teammate decides.
    """

    looks = True

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        """Args: arrival: number of the robot's arrivals, with the start; a robot that comes back begins lost."""
        scenario, body = setup.scenario, setup.robots[robot_id]
        again = (arrival,) if arrival > 1 else ()
        self._tuning = tuning = scenario.control.laser_localisation
        self._rng = rng.stream(scenario.run.seed, "localisation", robot_id, *again)
        self._building, self._view = setup.building, LaserView(body.laser)
        self._model = setup.building.shared(_beam_model, body.laser, tuning.cell_m)
        self._noise, self._step_s, self._omni = body.odometry, scenario.run.step_s, body.drive.kind == "omni"
        self._levels = LevelChanges(robot_id, setup)
        self._state: LocalisationState = "tracking" if arrival == 1 else "lost"
        self._main = self._around(Pose(*body.start_pose), tuning.start_m, tuning.start_rad)
        self._narrowest_m = setup.smallest_reach_m
        self._places: list[Hypothesis] = []
        """Unless it is tracking: where it may be."""
        self._odometry = self._weighed = _STILL
        """Poses in `odom`: of the last step, and of the last scan that was weighed."""
        self._scans = RecentScans(self._view, tuning.submap_m)
        self._driven_m = self._searched_m = 0.0

    @property
    def localisation(self) -> Localisation:
        """Where the robot may be; a lost robot may be elsewhere."""
        return Localisation(self._state, tuple(each.estimate for each in self._stated))

    @property
    def particles(self) -> tuple[Pose, ...]:
        """Particles for display, around the places of `localisation`."""
        stated = self._stated
        count = max(min(_SHOWN, self._tuning.particles) // len(stated), 1)
        return tuple(pose for each in stated for pose in each.particles(count))

    @property
    def _stated(self) -> list[Hypothesis]:
        return self._followed if self._state == "ambiguous" else [self._main]

    def pose(self, observation: Observation, teammates: Sequence[Disc] = ()) -> Pose:
        """See `Localiser`: the pose of the most likely place."""
        shift_m = self._levels.shift_m(observation)
        if shift_m is not None:
            for each in self._followed:
                each.shift(shift_m)
            self._scans.forget_before(math.inf)
        before, self._odometry = self._odometry, observation.robot.odometry.pose.pose
        motion = before.inverse() @ self._odometry
        if motion != _STILL:
            self._driven_m += math.hypot(motion.x_m, motion.y_m)
            for each in self._followed:
                noise = self._rng.standard_normal((self._tuning.particles, 3))
                each.move(motion, self._noise, self._step_s, self._omni, noise)
        since = self._weighed.inverse() @ self._odometry
        driven_m = math.hypot(since.x_m, since.y_m)
        if driven_m >= self._tuning.update_m or abs(since.yaw_rad) >= self._tuning.update_rad:
            self._weighed = self._odometry
            self._look(observation.robot.ranges_m, driven_m, teammates)
        return self._main.pose

    @property
    def _followed(self) -> list[Hypothesis]:
        return [self._main, *(each for each in self._places if each is not self._main)]

    def _look(self, ranges_m: np.ndarray, driven_m: float, teammates: Sequence[Disc]) -> None:
        """Weigh all places by a scan, and decide whether the robot knows where it is."""
        tuning, ends_m = self._tuning, self._view.ends_m(ranges_m)
        self._compare_with_teammates(ranges_m, ends_m, teammates)
        for each in self._followed:
            beams = evenly(_indices(~self._view.end_in(teammates, each.pose, ends_m)), tuning.beams)
            each.weigh(ranges_m, beams, self._rng.random())
            each.agreement.add(driven_m, *self._agreement(each.weighed.pose, ranges_m, beams))
        beams = _indices(~self._view.end_in(teammates, self._main.pose, ends_m))
        self._scans.add(self._driven_m, Scan(self._odometry, ranges_m, beams))
        if self._state != "tracking":
            self._find_itself()
        elif self._main.agreement.contradicting > tuning.lost_fraction:
            self._state = "lost"
            self._scans.forget_before(self._driven_m - _TRUSTED_M)

    def _compare_with_teammates(self, ranges_m: np.ndarray, ends_m: np.ndarray, teammates: Sequence[Disc]) -> None:
        """Drop the places from which scans should show teammates and do not, or show fewer than from others."""
        for each in self._places:
            at_teammates = _indices(self._view.end_in(teammates, each.pose, ends_m))
            is_seen = self._agreement(each.pose, ranges_m, at_teammates)[1] >= _FEWEST_ON_TEAMMATE
            each.sightings += is_seen - self._view.misses(teammates, each.pose, ranges_m, self._narrowest_m)
        least = self._most_sightings - _DECISIVE
        self._places = [each for each in self._places if each.sightings > least]

    @property
    def _most_sightings(self) -> int:
        return max([0, *(each.sightings for each in self._places)])

    def _find_itself(self) -> None:
        """Drop the places that do not fit, search for others, and believe those that have fitted for long enough."""
        tuning = self._tuning
        # A search would find again what teammates have ruled out.
        if self._state == "lost" and self._driven_m - self._searched_m >= tuning.search_every_m:
            self._searched_m = self._driven_m
            found = [self._around(pose, _FOUND_M, _FOUND_RAD) for pose in self._search()]
            most = self._most_sightings
            for each in found:  # only what scans show from now on can tell it from the others
                each.sightings = most
            self._places += found
        places: list[Hypothesis] = []
        for each in self._places:
            is_new = not any(other.is_at(each.pose, _SAME_M) for other in places)
            if is_new and each.agreement.contradicting <= tuning.fits_fraction:
                places.append(each)
        self._places = places if len(places) <= _MOST_PLACES else []
        confirmed = [each for each in self._places if each.agreement.is_known_over(tuning.confirm_m)]
        if confirmed:
            self._main = min(confirmed, key=lambda each: each.agreement.contradicting)
        only = len(confirmed) == len(self._places) == 1
        if only and self._main.agreement.contradicting <= 0.5 * tuning.fits_fraction:
            self._state, self._places = "tracking", []
        else:
            self._state = "ambiguous" if len(confirmed) > 1 else "lost"

    def _search(self) -> list[Pose]:
        """Return all poses at which the last scans fit the plan; none if they fit in too many places."""
        tuning = self._tuning
        points_m = self._scans.points_m(self._odometry, tuning.submap_points)
        if len(points_m) < _FEWEST_POINTS:
            return []
        search = self._building.shared(_submap_search)
        matches = search.find(points_m, tuning.found_fraction, _AS_GOOD, _SAME_M, _SAME_RAD, _MOST_MATCHES)
        if len(matches) >= _MOST_MATCHES:
            return []
        return [pose for pose, _ in matches if self._contradicting(pose) <= tuning.fits_fraction]

    def _contradicting(self, pose: Pose) -> float:
        """Return the fraction of informative beams of the last scans that contradict the map, for a pose of now."""
        total = np.zeros(2)
        for then, scan in self._scans.seen_from(self._odometry):
            beams = evenly(scan.beams, self._tuning.beams)
            total += self._agreement(pose @ then, scan.ranges_m, beams)
        return float(total[1] / max(total[0], 1.0))

    def _agreement(self, pose: Pose, ranges_m: np.ndarray, beams: np.ndarray) -> tuple[int, int]:
        """Return how many beams of a scan are informative, and how many of these contradict the map."""
        return self._model.agreement(pose, ranges_m, beams, self._tuning.tolerance_m, self._tuning.tolerance_rad)

    def _around(self, pose: Pose, spread_m: float, spread_rad: float) -> Hypothesis:
        tuning = self._tuning
        particles = _core.maps.ParticleFilter(
            beams=self._model,
            sigma_m=tuning.sigma_m,
            outliers=tuning.outliers,
            power=tuning.power,
            mean=pose,
            spread=(spread_m, spread_m, spread_rad),
            noise=self._rng.standard_normal((tuning.particles, 3)),
        )
        return Hypothesis(particles, tuning.window_m)


def _beam_model(building: Building, laser: Laser, cell_m: float) -> _core.maps.BeamModel:
    field = building.shared(_distance_field, cell_m)
    return _core.maps.BeamModel(field, core_fan(laser.beam_model().fan), laser.range_min_m)


def _distance_field(building: Building, cell_m: float) -> _core.maps.DistanceField:
    grid = building.grid(cell_m)
    return _core.maps.DistanceField(grid.cells != FREE, grid.origin_m, cell_m)


def _submap_search(building: Building) -> _core.maps.SubmapSearch:
    grid = building.grid(_SEARCH_CELL_M)
    return _core.maps.SubmapSearch(grid.cells != FREE, grid.origin_m, _SEARCH_CELL_M, _ON_WALL_M)


def _indices(of: np.ndarray) -> np.ndarray:
    """Return which values are true, as indices of beams: int32."""
    return np.flatnonzero(of).astype(np.int32)
