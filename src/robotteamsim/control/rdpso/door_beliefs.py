"""A robot's beliefs about doors: as in the plan, until its laser or a teammate sees another state."""

import math

import numpy as np

from robotteamsim.control.rdpso.team import Sighting
from robotteamsim.geometry import Pose
from robotteamsim.scenario.controllers.driving import DoorTuning
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.sections import Laser


class DoorBeliefs:
    """The doors that a robot believes to be closed. Newer sightings replace older ones, by one rule for all robots."""

    def __init__(self, plan: FloorPlan, laser: Laser, tuning: DoorTuning) -> None:
        self._tuning = tuning
        middles = [tuple((a + b) / 2.0 for a, b in zip(door.start, door.end, strict=True)) for door in plan.doors]
        self._doors = list(zip(plan.doors, middles, strict=True))
        self._planned = {door.name: door.closed for door in plan.doors}
        self._sightings: dict[str, Sighting] = {}
        self.sightings: tuple[Sighting, ...] = ()
        """The last sighting of each door by the robot or its teammates, sorted by name."""
        self.changed: tuple[tuple[str, bool], ...] = ()
        """The doors that differ from the plan, sorted by name, and whether they are closed."""
        self._laser = laser
        self._range_m = laser.range_max_m
        self._beam_angles_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, laser.beams)

    def look(self, pose: Pose, ranges_m: np.ndarray, iteration: int) -> None:
        """Note the doors that the laser sees in another state than believed."""
        position, range_m = (pose.x_m, pose.y_m), self._range_m
        for door, middle in self._doors:
            if math.dist(position, middle) > range_m:
                continue
            closed = self._seen_closed(door, pose, ranges_m)
            seen = self._sightings.get(door.name)
            if closed is not None and closed != (seen.closed if seen else self._planned[door.name]):
                self._note(Sighting(door.name, closed, iteration))

    def hear(self, sightings: tuple[Sighting, ...]) -> None:
        """Adopt newer sightings of teammates; if sightings of one iteration differ, the door counts as closed."""
        for seen in sightings:
            known = self._sightings.get(seen.door)
            is_newer = known is None or (seen.iteration, seen.closed) > (known.iteration, known.closed)
            if is_newer and seen.door in self._planned:
                self._note(seen)

    def _note(self, sighting: Sighting) -> None:
        self._sightings[sighting.door] = sighting
        self.sightings = tuple(self._sightings[name] for name in sorted(self._sightings))
        self.changed = tuple((s.door, s.closed) for s in self.sightings if s.closed != self._planned[s.door])

    def _seen_closed(self, door: Door, pose: Pose, ranges_m: np.ndarray) -> bool | None:
        """Return whether beams end at the leaf (True) or pass through it (False); None if too few agree."""
        laser = pose @ Pose(self._laser.forward_m, self._laser.left_m, 0.0)
        angles_rad = self._beam_angles_rad + pose.yaw_rad
        beam_x, beam_y = np.cos(angles_rad), np.sin(angles_rad)
        leaf_x, leaf_y = door.end[0] - door.start[0], door.end[1] - door.start[1]
        to_x, to_y = door.start[0] - laser.x_m, door.start[1] - laser.y_m
        across = beam_x * leaf_y - beam_y * leaf_x
        # The range of a beam that grazes the leaf is uncertain.
        steep = np.abs(across) > 0.3 * math.hypot(leaf_x, leaf_y)
        across = np.where(steep, across, 1.0)
        range_m = (to_x * leaf_y - to_y * leaf_x) / across
        place = (to_x * beam_y - to_y * beam_x) / across
        meets = steep & (range_m > 0.0) & (range_m < self._laser.range_max_m - 2.0 * self._tuning.leaf_tolerance_m)
        meets &= (place > 0.1) & (place < 0.9)
        num_ends = int(np.count_nonzero(meets & (np.abs(ranges_m - range_m) < self._tuning.leaf_tolerance_m)))
        num_passes = int(np.count_nonzero(meets & (ranges_m >= range_m + self._tuning.leaf_tolerance_m)))
        fewest = max(self._tuning.fewest_beams, self._tuning.clear_majority * (num_ends + num_passes))
        if num_ends >= fewest:
            return True
        return False if num_passes >= fewest else None
