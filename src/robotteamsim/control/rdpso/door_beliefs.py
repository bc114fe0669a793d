"""Doors as a robot believes them: the plan says how they were, lasers and teammates say how they are."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.control.rdpso.update import Sighting
from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.sections import Laser
from robotteamsim.swarm import Vector

LEAF_TOLERANCE_M = 0.12
FEWEST_BEAMS = 5
CLEAR_MAJORITY = 0.8


class DoorBeliefs:
    """Which doors a robot takes to be closed. Newer sightings replace older ones; all robots keep the same rule."""

    def __init__(self, plan: FloorPlan, laser: Laser) -> None:
        self._doors = [(door, _middle(door)) for door in plan.doors]
        self._planned = {door.name: door.closed for door in plan.doors}
        self._sightings: dict[str, Sighting] = {}
        self.sightings: tuple[Sighting, ...] = ()
        """All that was seen or heard of doors, by name."""
        self.changed: tuple[tuple[str, bool], ...] = ()
        """The doors that are not as the plan says, by name, with whether they are closed."""
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
            if closed is not None and closed != self._believed(door.name):
                self._note((door.name, closed, iteration))

    def hear(self, sightings: tuple[Sighting, ...]) -> None:
        """Take over what a teammate saw later; of sightings in the same iteration, the closed door counts."""
        for name, closed, iteration in sightings:
            known = self._sightings.get(name)
            if name in self._planned and (known is None or (iteration, closed) > (known[2], known[1])):
                self._note((name, closed, iteration))

    def _note(self, sighting: Sighting) -> None:
        self._sightings[sighting[0]] = sighting
        self.sightings = tuple([self._sightings[name] for name in sorted(self._sightings)])
        self.changed = tuple([(name, closed) for name, closed, _ in self.sightings if closed != self._planned[name]])

    def _believed(self, name: str) -> bool:
        return self._sightings[name][1] if name in self._sightings else self._planned[name]

    def _seen_closed(self, door: Door, pose: Pose, ranges_m: np.ndarray) -> bool | None:
        """Return whether beams end at the leaf or go on behind it; none where too few tell."""
        cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        laser_x = pose.x_m + cos * self._laser.forward_m
        laser_y = pose.y_m + sin * self._laser.forward_m
        angles_rad = self._beam_angles_rad + pose.yaw_rad
        beam_x, beam_y = np.cos(angles_rad), np.sin(angles_rad)
        leaf_x, leaf_y = door.end[0] - door.start[0], door.end[1] - door.start[1]
        to_x, to_y = door.start[0] - laser_x, door.start[1] - laser_y
        across = beam_x * leaf_y - beam_y * leaf_x
        # Beams that graze the leaf tell little of where they end.
        steep = np.abs(across) > 0.3 * math.hypot(leaf_x, leaf_y)
        across = np.where(steep, across, 1.0)
        range_m = (to_x * leaf_y - to_y * leaf_x) / across
        place = (to_x * beam_y - to_y * beam_x) / across
        meets = steep & (range_m > 0.0) & (range_m < self._laser.range_max_m - 2.0 * LEAF_TOLERANCE_M)
        meets &= (place > 0.1) & (place < 0.9)
        num_ends = int(np.count_nonzero(meets & (np.abs(ranges_m - range_m) < LEAF_TOLERANCE_M)))
        num_passes = int(np.count_nonzero(meets & (ranges_m >= range_m + LEAF_TOLERANCE_M)))
        fewest = max(FEWEST_BEAMS, CLEAR_MAJORITY * (num_ends + num_passes))
        if num_ends >= fewest:
            return True
        return False if num_passes >= fewest else None


def _middle(door: Door) -> Vector:
    return (door.start[0] + door.end[0]) / 2.0, (door.start[1] + door.end[1]) / 2.0
