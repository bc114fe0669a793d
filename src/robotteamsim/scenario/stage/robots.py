"""Stage's position models, with the rangers that they carry, as robots of a scenario."""

from __future__ import annotations

import math
from typing import Any

from robotteamsim.scenario.drives import AnyDrive, Drive, OmniDrive
from robotteamsim.scenario.sections import Laser, Odometry, PlacedRobot
from robotteamsim.scenario.stage.solids import DEFAULT_SIZE_M, body_of, disc_radius_m, reach_m
from robotteamsim.scenario.stage.values import Notes, Values, checked, compose, tidy
from robotteamsim.scenario.stage.world_file import Entity

DEVICES = (
    *("camera", "fiducial", "fiducialfinder", "blobfinder", "bumper", "wifi", "speech", "blinkenlight"),
    *("lightindicator", "indicator", "ptz", "powerpack"),
)
"""Sensors and signals of Stage that no robot has here."""

_BOUNDS = ("x", "y", "z", "turning")
_DEFAULT_BOUNDS = (-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -math.pi / 2.0, math.pi / 2.0)
_DEFAULT_FOV_RAD = 0.1
"""Of a sensor that says nothing (Stage 4)."""

_LASER_DEFAULTS = (0.0, 8.0, math.pi, 180)
"""range_min, range_max, fov and samples of the `laser` model (Stage 3)."""

_ASIDE_M = 1e-6
"""A ranger this near to the robot's axis stands on it."""


class RobotReader:
    """Makes robots of position models."""

    def __init__(self, values: Values, notes: Notes) -> None:
        self._values, self._notes = values, notes

    def read(self, entity: Entity) -> PlacedRobot:
        """Return one robot.

        Raises: ScenarioError: one line with file, line and key.
        """
        values = self._values
        self._check_parts(entity)
        pose, z = values.pose(entity, "pose")
        if abs(z) > _ASIDE_M:
            self._notes.say(entity.place_of("pose"), f"pose: z {z:g} counts as 0; robots drive on the floor")
        keys: dict[str, Any] = {
            "start_pose": (tidy(pose[0]), tidy(pose[1]), pose[2]),
            **self._body(entity),
            "drive": self._drive(entity),
            "odometry": self._odometry(entity),
        }
        laser = self._laser(entity)
        if laser is not None:
            keys["laser"] = laser
        said_by = {"start_pose": "pose", "radius_m": "size", "height_m": "size", "mass_kg": "mass"}
        return checked(PlacedRobot, keys, {key: (entity, name) for key, name in said_by.items()})

    def _check_parts(self, entity: Entity) -> None:
        """Refuse what would change how the robot moves, and note the devices that are left out."""
        known = {"ranger", "laser", "block"}
        for child in entity.children:
            if child.kind in DEVICES:
                self._notes.say(child.place, f"{child.called}: robots have no {child.kind} here: left out")
            elif child.kind not in known:
                raise child.place.wrong(f"{child.called}: a robot with a '{child.kind}' on it is not simulated")
        values = self._values
        if values.whole(entity, "obstacle_return", 1) == 0 or values.number(entity, "ranger_return", "f", 1.0) < 0.0:
            key = "obstacle_return" if entity.get("obstacle_return") else "ranger_return"
            raise entity.place_of(key).wrong(f"{key}: robots that others pass through or do not see are not simulated")

    def _body(self, entity: Entity) -> dict[str, float]:
        size = self._values.size(entity, DEFAULT_SIZE_M)
        body = body_of(entity, self._values)
        radius = disc_radius_m(body)
        if radius is None:
            radius = reach_m(body)
            self._notes.say(
                entity.place_of("size"),
                f"size: robots are round here: '{entity.called}' becomes the disc around its body, of {radius:.3g} m",
            )
        keys = {"radius_m": tidy(radius)}
        if size[2] > 0.0:
            keys["height_m"] = tidy(size[2])
        mass = self._values.number(entity, "mass", "f", 0.0)
        return {**keys, "mass_kg": mass} if mass != 0.0 else keys

    def _drive(self, entity: Entity) -> AnyDrive:
        kind = self._values.choice(entity, "drive", ("diff", "omni", "car"), "diff")
        if kind == "car":
            text = "drive: 'car' takes a steering angle for a turn in Stage; only 'diff' and 'omni' are read"
            raise entity.place_of("drive").wrong(text)
        limits = self._bounds(entity, "velocity_bounds", _DEFAULT_BOUNDS)
        assert limits is not None
        keys: dict[str, Any] = dict(zip(("max_speed_mps", "max_turn_radps"), limits, strict=True))
        changes = self._bounds(entity, "acceleration_bounds", None)
        if changes is not None:
            keys |= zip(("max_acceleration_mps2", "max_turn_acceleration_radps2"), changes, strict=True)
        said_by = {key: "acceleration_bounds" if "acceleration" in key else "velocity_bounds" for key in keys}
        places = {key: (entity, name) for key, name in said_by.items()}
        return checked(OmniDrive, {**keys, "kind": "omni"}, places) if kind == "omni" else checked(Drive, keys, places)

    def _bounds(self, entity: Entity, key: str, default: tuple[float, ...] | None) -> tuple[float, float] | None:
        """Return the limits of driving and of turning; none: they are not said and have no default."""
        if entity.get(key) is None and default is None:
            return None
        given = self._values.numbers(entity, key, "llllllaa", default or ())
        for axis in (0, 3):
            low, high = given[2 * axis : 2 * axis + 2]
            if abs(low + high) > 1e-9 * max(abs(high), 1.0):
                text = f"{key}: {_BOUNDS[axis]} has another limit below than above; the one above counts both ways"
                self._notes.say(entity.place_of(key), text)
        if self._values.text(entity, "drive", "diff") == "omni" and given[2:4] != given[:2]:
            text = f"{key}: y has other limits than x; those of x count for every direction"
            self._notes.say(entity.place_of(key), text)
        return tidy(given[1]), tidy(given[7])

    def _odometry(self, entity: Entity) -> Odometry:
        """Return exact odometry for "gps", and noise of the size of `odom_error` for "odom"."""
        values = self._values
        error = values.numbers(entity, "odom_error", "llla", (0.03, 0.03, 0.0, 0.05))
        if entity.get("localization_origin") is not None:
            values.numbers(entity, "localization_origin", "llla", ())
            self._notes.say(
                entity.place_of("localization_origin"),
                "localization_origin: odometry begins where the robot does, at 0",
            )
        if values.choice(entity, "localization", ("gps", "odom"), "gps") == "gps":
            return Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
        self._notes.say(
            entity.place_of("odom_error"),
            "odom_error: a fixed share of every motion in Stage, noise of that size here: alpha1 and alpha3",
        )
        keys = {"alpha1": tidy(error[3] ** 2), "alpha2": 0.0, "alpha3": tidy(error[0] ** 2), "alpha4": 0.0}
        return checked(Odometry, keys, dict.fromkeys(keys, (entity, "odom_error")))

    def _laser(self, entity: Entity) -> Laser | None:
        rangers = entity.of_kind("ranger", "laser")
        if not rangers:
            text = f"'{entity.called}' carries no ranger; every robot has one here, so it gets the default laser"
            self._notes.say(entity.place, text)
            return None
        if len(rangers) > 1:
            text = f"{rangers[1].called}: '{entity.called}' carries {len(rangers)} rangers; a robot has one laser here"
            raise rangers[1].place.wrong(text)
        ranger = rangers[0]
        if ranger.kind == "laser":
            sensor, range_m, fov, samples, noise_m = self._old_laser(ranger)
        else:
            sensor, range_m, fov, samples, noise_m = self._sensor(ranger)
        return self._placed(entity, ranger, sensor, (range_m, fov, samples, noise_m))

    def _sensor(self, ranger: Entity) -> tuple[Entity, tuple[float, float], float, int, float]:
        sensors = ranger.of_kind("sensor")
        if not sensors:
            raise ranger.place.wrong(f"{ranger.called}: a ranger without a sensor( ... ) measures nothing")
        for other in sensors[1:]:
            self._notes.say(other.place, f"{other.called}: stage_ros publishes a ranger's first sensor only, as here")
        values, sensor = self._values, sensors[0]
        low, high = values.numbers(sensor, "range", "ll", (0.0, 5.0))
        fov = values.number(sensor, "fov", "a", _DEFAULT_FOV_RAD)
        samples = values.whole(sensor, "samples", 1)
        variance, share, angle = values.numbers(sensor, "noise", "lfa", (0.0, 0.0, 0.0))
        if share != 0.0 or angle != 0.0:
            text = "noise: only the constant part is simulated, not the share of the range or the angle"
            self._notes.say(sensor.place_of("noise"), text)
        if variance < 0.0:
            raise sensor.place_of("noise").wrong(f"noise: {variance:g} is below 0")
        return sensor, (low, high), fov, samples, math.sqrt(variance)

    def _old_laser(self, laser: Entity) -> tuple[Entity, tuple[float, float], float, int, float]:
        values = self._values
        low, high, fov, samples = _LASER_DEFAULTS
        range_m = (values.number(laser, "range_min", "l", low), values.number(laser, "range_max", "l", high))
        return laser, range_m, values.number(laser, "fov", "a", fov), values.whole(laser, "samples", int(samples)), 0.0

    def _placed(
        self, robot: Entity, ranger: Entity, sensor: Entity, beams: tuple[tuple[float, float], float, int, float]
    ) -> Laser:
        """Return the laser where ranger and sensor stand on the robot."""
        values = self._values
        (low, high), fov, samples, noise_m = beams
        pose, z = values.pose(ranger, "pose")
        origin, origin_z = values.pose(ranger, "origin")
        mount = compose(pose, origin)
        if sensor is not ranger:
            mount = compose(mount, values.pose(sensor, "pose")[0])
        if abs(mount[1]) > _ASIDE_M:
            text = f"pose: '{ranger.called}' stands {mount[1]:.3g} m beside the robot's axis; lasers stand on it here"
            raise ranger.place_of("pose").wrong(text)
        base_m = values.size(robot, DEFAULT_SIZE_M)[2] if values.whole(robot, "stack_children", 1) else 0.0
        keys = {
            "beams": samples,
            "angle_min_rad": mount[2] - 0.5 * fov,
            "angle_max_rad": mount[2] + 0.5 * fov,
            "range_min_m": tidy(low),
            "range_max_m": tidy(high),
            "forward_m": tidy(mount[0]),
            "height_m": tidy(base_m + z + origin_z),
            "noise_m": tidy(noise_m),
        }
        bounds = ("range_min", "range_max") if sensor is ranger else ("range", "range")
        said_by = {
            "beams": (sensor, "samples"),
            "angle_min_rad": (sensor, "fov"),
            "angle_max_rad": (sensor, "fov"),
            "range_min_m": (sensor, bounds[0]),
            "range_max_m": (sensor, bounds[1]),
            "forward_m": (ranger, "pose"),
            "height_m": (ranger, "pose"),
            "noise_m": (sensor, "noise"),
        }
        return checked(Laser, keys, said_by)
