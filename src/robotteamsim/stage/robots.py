"""Stage's position models and their rangers as robots of a scenario."""

import math
from typing import Any

import numpy as np
import shapely
from pydantic_core import PydanticCustomError

from robotteamsim.rng import stream
from robotteamsim.scenario.body import MAX_CORNERS, check_footprint
from robotteamsim.scenario.drives import AnyDrive, CarDrive, Drive, OmniDrive
from robotteamsim.scenario.plan import Corners, counter_clockwise
from robotteamsim.scenario.sections import Odometry, PlacedRobot
from robotteamsim.stage.rangers import RangerReader
from robotteamsim.stage.solids import DEFAULT_SIZE_M, body_of, box, moved, polygons
from robotteamsim.stage.values import ASIDE_M, Pose2, Values, compose, tidy
from robotteamsim.stage.world_file import Entity

DEVICES = (
    *("camera", "fiducial", "fiducialfinder", "blobfinder", "bumper", "wifi", "speech", "blinkenlight"),
    *("lightindicator", "indicator", "ptz", "powerpack"),
)
"""Sensors and signals of Stage that robots do not have here."""

_BOUNDS = ("x", "y", "z", "turning")
_DEFAULT_BOUNDS = (-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -math.pi / 2.0, math.pi / 2.0)

_ODOM_ERROR = np.array([0.03, 0.03, 0.0, 0.05])
"""The widths of the intervals of the shares of x, y, z and heading."""

MAX_GAP_SHARE = 0.01
"""A body counts as convex if at most this share of its convex hull is missing."""


class RobotReader:
    """Converts position models to robots."""

    def __init__(self, values: Values, step_ms: float) -> None:
        """Args: step_ms: length of a step of the world [ms]."""
        self._values, self._notes = values, values.notes
        self._rangers = RangerReader(values, step_ms)

    def read(self, entity: Entity, parent: Pose2, number: int) -> PlacedRobot:
        """Return one robot. Args: parent: the frame that its pose is given in.  number: of the robot, from 1 on.

        Raises: ScenarioError: one line with file, line and key.
        """
        values = self._values
        local, z = values.pose(entity, "pose")
        if abs(z) > ASIDE_M:
            self._notes.of(entity, "pose", f"z {z:g} counts as 0; robots drive on the floor")
        if values.whole(entity, "obstacle_return", 1) == 0 or values.number(entity, "ranger_return", "f", 1.0) < 0.0:
            key = "obstacle_return" if entity.get("obstacle_return") else "ranger_return"
            self._notes.of(entity, key, "others hit and detect this robot here")
        x_m, y_m, yaw_rad = compose(parent, local)
        keys: dict[str, Any] = {
            "start_pose": (tidy(x_m), tidy(y_m), yaw_rad),
            **self._body(entity),
            "drive": self._drive(entity),
            "odometry": self._odometry(entity, number),
        }
        keys |= self._rangers.read(entity)
        sources = {"start_pose": "pose", "mass_kg": "mass"}
        sources |= dict.fromkeys(("radius_m", "footprint_m", "height_m"), "size")
        return self._notes.checked(PlacedRobot, keys, {key: (entity, name) for key, name in sources.items()})

    def _shapes(self, entity: Entity, frame: Pose2) -> list[np.ndarray]:
        """Return the outlines of a robot and of the parts on it that are obstacles, in `base_link` [m]."""
        shapes = [moved(outline, frame) for outline in body_of(entity, self._values).outlines]
        for part in entity.children:
            if part.kind in DEVICES:
                self._notes.say(part.place, f"{part.called}: omitted: robots have no {part.kind} here")
            elif part.kind not in ("block", "sensor") and self._values.whole(part, "obstacle_return", 1):
                if part.kind not in ("model", "ranger", "laser"):
                    text = f"{part.called}: part of its robot's body, without a function: a '{part.kind}'"
                    self._notes.say(part.place, text)
                shapes += self._shapes(part, compose(frame, self._values.pose(part, "pose")[0]))
        return shapes

    def _body(self, entity: Entity) -> dict[str, Any]:
        """Return a disc, or the convex hull if it has few corners and contains the robot's origin."""
        size = self._values.size(entity, DEFAULT_SIZE_M)
        if entity.get("bitmap") is not None:
            self._notes.of(entity, "bitmap", f"{self._values.text(entity, 'bitmap', '')}: becomes a box of its size")
        outlines = self._shapes(entity, (0.0, 0.0, 0.0)) or [box(size)]
        body = shapely.union_all([shapely.Polygon(part) for outline in outlines for part in polygons(outline)])
        # Without collinear corners; in whole nanometres, without digits from rounding.
        hull = shapely.convex_hull(body).simplify(1e-9)
        distances = [math.hypot(*corner) for corner in hull.exterior.coords]
        reach_m, inner_m = max(distances), hull.exterior.distance(shapely.Point(0.0, 0.0))
        is_whole = hull.area - body.area <= MAX_GAP_SHARE * hull.area
        is_round = reach_m - min(distances) < 0.02 * reach_m and inner_m > 0.9 * reach_m and len(distances) > 8
        keys: dict[str, Any] = {"radius_m": tidy(reach_m)}
        becomes = f"a disc of {reach_m:.3g} m"
        for shape, name in ((hull.envelope, "a box"), (hull, "its convex hull")):
            corners = tuple((tidy(x), tidy(y)) for x, y in shape.exterior.coords[:-1])
            if is_footprint(corners) and not is_round and shape.area < math.pi * reach_m**2:
                keys, becomes = {"footprint_m": counter_clockwise(corners)}, name
        if not (is_round or (is_whole and becomes == "its convex hull")):
            text = f"the body of '{entity.called}' is not convex with 3 to {MAX_CORNERS} corners around its origin"
            self._notes.of(entity, "size", f"{text}: it becomes {becomes}")
        if size[2] > 0.0:
            keys["height_m"] = tidy(size[2])
        mass_kg = self._values.number(entity, "mass", "f", 0.0)
        if mass_kg < 0.0:
            self._notes.of(entity, "mass", f"{mass_kg:g} counts as not given")
        return {**keys, "mass_kg": mass_kg} if mass_kg > 0.0 else keys

    def _drive(self, entity: Entity) -> AnyDrive:
        kind = self._values.choice(entity, "drive", ("diff", "omni", "car"), "diff")
        speed_mps, turn_radps = self._bounds(entity, "velocity_bounds", kind)
        keys: dict[str, Any] = {"max_speed_mps": speed_mps}
        if entity.get("acceleration_bounds") is not None:
            keys["max_acceleration_mps2"], turn_radps2 = self._bounds(entity, "acceleration_bounds", kind)
            if kind != "car":
                keys["max_turn_acceleration_radps2"] = turn_radps2
        models: dict[str, type[Drive] | type[OmniDrive] | type[CarDrive]]
        models = {"diff": Drive, "omni": OmniDrive, "car": CarDrive}
        if kind == "car":
            self._notes.of(entity, "drive", "the turn of a command is a yaw rate here, a steering angle in Stage")
            wheelbase_m = self._values.number(entity, "wheelbase", "l", 1.0)
            steering_rad = math.atan2(turn_radps * wheelbase_m, speed_mps)
            keys |= {"kind": "car", "wheelbase_m": wheelbase_m, "max_steering_rad": tidy(steering_rad)}
        else:
            keys |= {"max_turn_radps": turn_radps} | ({"kind": "omni"} if kind == "omni" else {})
        sources = {key: "acceleration_bounds" if "acceleration" in key else "velocity_bounds" for key in keys}
        sources |= {"wheelbase_m": "wheelbase"}
        return self._notes.checked(models[kind], keys, {key: (entity, name) for key, name in sources.items()})

    def _bounds(self, entity: Entity, key: str, drive: str) -> tuple[float, float]:
        """Return the limits of speed and turn, or of their changes."""
        given = self._values.numbers(entity, key, "llllllaa", _DEFAULT_BOUNDS)
        for axis in (0, 3):
            low, high = given[2 * axis : 2 * axis + 2]
            if abs(low + high) > 1e-9 * max(abs(high), 1.0):
                text = f"the lower and upper limits of {_BOUNDS[axis]} differ; the upper one is used for both"
                self._notes.of(entity, key, text)
        if drive == "omni" and given[2:4] != given[:2]:
            self._notes.of(entity, key, "the limits of x and y differ; those of x are used for every direction")
        return tidy(given[1]), tidy(given[7])

    def _odometry(self, entity: Entity, number: int) -> Odometry:
        """Return exact odometry for "gps", and noise of the size of Stage's fixed shares for "odom".

        A given `odom_error` is the shares; without it, each is drawn once, uniformly within half of _ODOM_ERROR (Stage
        4.3, model_position.cc).
        """
        values, notes = self._values, self._notes
        if entity.get("localization_origin") is not None:
            values.numbers(entity, "localization_origin", "llla", ())
            notes.of(entity, "localization_origin", "omitted: odometry starts at 0 here")
        drawn = tuple(stream(1, "stage odom_error", number).uniform(-0.5, 0.5, 4) * _ODOM_ERROR)
        error = values.numbers(entity, "odom_error", "llla", drawn)
        if values.choice(entity, "localization", ("gps", "odom"), "gps") == "gps":
            return Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
        text = "a fixed share of every motion in Stage, noise of that magnitude here: alpha1 and alpha3"
        notes.of(entity, "odom_error" if entity.get("odom_error") else "localization", text)
        keys = {"alpha1": tidy(error[3] ** 2), "alpha2": 0.0, "alpha3": tidy(error[0] ** 2), "alpha4": 0.0}
        return notes.checked(Odometry, keys, dict.fromkeys(keys, (entity, "odom_error")))


def is_footprint(corners: Corners) -> bool:
    """Whether these are the corners of a valid body."""
    try:
        check_footprint("", corners)
    except PydanticCustomError:
        return False
    return True
