"""Stage's position models and their rangers as robots of a scenario."""

import math
from typing import Any

from robotteamsim.scenario.body import MAX_CORNERS
from robotteamsim.scenario.drives import AnyDrive, Drive, OmniDrive
from robotteamsim.scenario.sections import Odometry, PlacedRobot
from robotteamsim.stage.rangers import RangerReader
from robotteamsim.stage.solids import DEFAULT_SIZE_M, body_of, disc_radius_m, footprint_m, reach_m
from robotteamsim.stage.values import ASIDE_M, Notes, Values, checked, tidy
from robotteamsim.stage.world_file import Entity

DEVICES = (
    *("camera", "fiducial", "fiducialfinder", "blobfinder", "bumper", "wifi", "speech", "blinkenlight"),
    *("lightindicator", "indicator", "ptz", "powerpack"),
)
"""Sensors and signals of Stage that robots do not have here."""

_BOUNDS = ("x", "y", "z", "turning")
_DEFAULT_BOUNDS = (-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -math.pi / 2.0, math.pi / 2.0)


class RobotReader:
    """Converts position models to robots."""

    def __init__(self, values: Values, notes: Notes, step_ms: float) -> None:
        """Args: step_ms: length of a step of the world [ms]."""
        self._values, self._notes = values, notes
        self._rangers = RangerReader(values, notes, step_ms)

    def read(self, entity: Entity) -> PlacedRobot:
        """Return one robot.

        Raises: ScenarioError: one line with file, line and key.
        """
        values = self._values
        self._check_parts(entity)
        pose, z = values.pose(entity, "pose")
        if abs(z) > ASIDE_M:
            self._notes.of(entity, "pose", f"z {z:g} counts as 0; robots drive on the floor")
        keys: dict[str, Any] = {
            "start_pose": (tidy(pose[0]), tidy(pose[1]), pose[2]),
            **self._body(entity),
            "drive": self._drive(entity),
            "odometry": self._odometry(entity),
        }
        keys |= self._rangers.read(entity)
        sources = {"start_pose": "pose", "mass_kg": "mass"}
        sources |= dict.fromkeys(("radius_m", "footprint_m", "height_m"), "size")
        return checked(PlacedRobot, keys, {key: (entity, name) for key, name in sources.items()})

    def _check_parts(self, entity: Entity) -> None:
        """Reject parts that would change how the robot moves, and note the devices that are omitted."""
        known = {"ranger", "laser", "block"}
        for child in entity.children:
            if child.kind in DEVICES:
                self._notes.say(child.place, f"{child.called}: omitted: robots have no {child.kind} here")
            elif child.kind not in known:
                raise child.place.error(f"{child.called}: a robot with a '{child.kind}' on it is not simulated")
        values = self._values
        if values.whole(entity, "obstacle_return", 1) == 0 or values.number(entity, "ranger_return", "f", 1.0) < 0.0:
            key = "obstacle_return" if entity.get("obstacle_return") else "ranger_return"
            raise entity.error(key, "a robot that others cannot hit or detect is not simulated")

    def _body(self, entity: Entity) -> dict[str, Any]:
        """Return a disc, or a polygon if the body is convex, has few corners and contains the robot's origin."""
        size = self._values.size(entity, DEFAULT_SIZE_M)
        body = body_of(entity, self._values)
        radius, corners = disc_radius_m(body), footprint_m(body)
        if radius is None and not corners:
            radius = reach_m(body)
            text = (
                f"is not convex with 3 to {MAX_CORNERS} corners around its origin: it becomes a disc of {radius:.3g} m"
            )
            self._notes.of(entity, "size", f"the body of '{entity.called}' {text}")
        keys: dict[str, Any] = {"footprint_m": corners} if radius is None else {"radius_m": tidy(radius)}
        if size[2] > 0.0:
            keys["height_m"] = tidy(size[2])
        mass = self._values.number(entity, "mass", "f", 0.0)
        return {**keys, "mass_kg": mass} if mass != 0.0 else keys

    def _drive(self, entity: Entity) -> AnyDrive:
        kind = self._values.choice(entity, "drive", ("diff", "omni", "car"), "diff")
        if kind == "car":
            raise entity.error("drive", "in Stage, the turn of a 'car' is a steering angle; expected 'diff' or 'omni'")
        limits = self._bounds(entity, "velocity_bounds", _DEFAULT_BOUNDS)
        assert limits is not None
        keys: dict[str, Any] = dict(zip(("max_speed_mps", "max_turn_radps"), limits, strict=True))
        changes = self._bounds(entity, "acceleration_bounds", None)
        if changes is not None:
            keys |= zip(("max_acceleration_mps2", "max_turn_acceleration_radps2"), changes, strict=True)
        sources = {key: "acceleration_bounds" if "acceleration" in key else "velocity_bounds" for key in keys}
        places = {key: (entity, name) for key, name in sources.items()}
        return checked(OmniDrive, {**keys, "kind": "omni"}, places) if kind == "omni" else checked(Drive, keys, places)

    def _bounds(self, entity: Entity, key: str, default: tuple[float, ...] | None) -> tuple[float, float] | None:
        """Return the limits of speed and turn; None: they are not given and have no default."""
        if entity.get(key) is None and default is None:
            return None
        given = self._values.numbers(entity, key, "llllllaa", default or ())
        for axis in (0, 3):
            low, high = given[2 * axis : 2 * axis + 2]
            if abs(low + high) > 1e-9 * max(abs(high), 1.0):
                text = f"the lower and upper limits of {_BOUNDS[axis]} differ; the upper one is used for both"
                self._notes.of(entity, key, text)
        if self._values.text(entity, "drive", "diff") == "omni" and given[2:4] != given[:2]:
            self._notes.of(entity, key, "the limits of x and y differ; those of x are used for every direction")
        return tidy(given[1]), tidy(given[7])

    def _odometry(self, entity: Entity) -> Odometry:
        """Return exact odometry for "gps", and noise of the size of `odom_error` for "odom"."""
        values = self._values
        error = values.numbers(entity, "odom_error", "llla", (0.03, 0.03, 0.0, 0.05))
        if entity.get("localization_origin") is not None:
            values.numbers(entity, "localization_origin", "llla", ())
            self._notes.of(entity, "localization_origin", "omitted: odometry starts at 0 here")
        if values.choice(entity, "localization", ("gps", "odom"), "gps") == "gps":
            return Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
        text = "a fixed share of every motion in Stage, noise of that magnitude here: alpha1 and alpha3"
        self._notes.of(entity, "odom_error", text)
        keys = {"alpha1": tidy(error[3] ** 2), "alpha2": 0.0, "alpha3": tidy(error[0] ** 2), "alpha4": 0.0}
        return checked(Odometry, keys, dict.fromkeys(keys, (entity, "odom_error")))
