"""Stage's rangers as lasers and sonars of a robot."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from robotteamsim.scenario.base import Model
from robotteamsim.scenario.sensors import Laser, MountedLaser, Sonar, is_free_name
from robotteamsim.stage.solids import BODIES, DEFAULT_SIZE_M
from robotteamsim.stage.values import Pose2, Values, compose, tidy
from robotteamsim.stage.world_file import Entity

M = TypeVar("M", bound=Model)

RANGERS = ("ranger", "laser")

_UPDATE_INTERVAL_MS = 100.0
"""Default of `update_interval` of every model (Stage 4)."""

_DEFAULT_FOV_RAD = 0.1
"""Default of `fov` (Stage 4)."""

_LASER_DEFAULTS = (0.0, 8.0, math.pi, 180)
"""Defaults of range_min, range_max, fov and samples of the `laser` model (Stage 3)."""


@dataclass(frozen=True, slots=True)
class _Beams:
    """The beams of a sensor of a ranger, and its pose on the robot."""

    ranger: Entity
    sensor: Entity
    range_m: tuple[float, float]
    fov_rad: float
    samples: int
    noise_m: float
    mount: Pose2
    height_m: float


class RangerReader:
    """Converts rangers to lasers and sonars."""

    def __init__(self, values: Values, step_ms: float) -> None:
        self._values, self._notes, self._step_ms = values, values.notes, step_ms

    def read(self, robot: Entity) -> dict[str, Any]:
        """Return the keys `laser` and `sensors` of a robot, without those that it does not have.

        The sensors of rangers with "sonar" in their name, or with several sensors of one ray each, are sonars. The
        first of the others is the laser.

        Raises: ScenarioError: one line with file, line and key.
        """
        found = list(self._beams(robot, (0.0, 0.0, 0.0), 0.0))
        sonars = [beams for beams in found if self._is_sonar(beams)]
        lasers = [beams for beams in found if beams not in sonars]
        keys: dict[str, Any] = {}
        if lasers:
            keys["laser"] = self._laser(lasers.pop(0))
        else:
            what = "no ranger but sonars" if sonars else "no ranger"
            text = f"'{robot.called}' has {what}; it gets the default laser, as every robot has one here"
            self._notes.say(robot.place, text)
        names = iter(self._names([*lasers, *sonars]))
        sensors = [self._mounted_laser(beams, next(names)) for beams in lasers]
        keys["sensors"] = (*sensors, *(self._sonar(beams, next(names)) for beams in sonars))
        return keys

    def _is_sonar(self, beams: _Beams) -> bool:
        sensors = beams.ranger.of_kind("sensor")
        rays = [self._values.whole(sensor, "samples", 1) for sensor in sensors]
        names = f"{self._name(beams.ranger)} {beams.ranger.called}".lower()
        return "sonar" in names or (len(sensors) > 1 and set(rays) == {1})

    def _name(self, ranger: Entity) -> str:
        return self._values.text(ranger, "name", ranger.called)

    def _names(self, sensors: list[_Beams]) -> list[str]:
        """Return a unique name for each sensor: as in the file where that can be a topic."""
        names: list[str] = []
        for number, beams in enumerate(sensors, 1):
            wanted = re.sub(r"\W", "_", self._name(beams.ranger).lower(), flags=re.ASCII)
            if not is_free_name(wanted):
                wanted = f"{beams.ranger.kind}_{wanted}"
            name = wanted if wanted not in ("ranger", "laser") else f"{wanted}_{number}"
            while name in names:
                name = f"{wanted}_{number}"
                number += 1
            names.append(name)
        return names

    def _laser(self, beams: _Beams) -> Laser:
        if round(self._interval_ms(beams) / self._step_ms) > 1:
            text = f"the first laser scans in every step of {self._step_ms:g} ms; in Stage every"
            self._notes.of(beams.ranger, "update_interval", f"{text} {self._interval_ms(beams):g} ms")
        keys = self._angles(beams, beams.mount[2]) | _mount(beams.mount)
        del keys["yaw_rad"]
        return self._checked(Laser, beams, keys)

    def _mounted_laser(self, beams: _Beams, name: str) -> MountedLaser:
        every_steps = max(1, round(self._interval_ms(beams) / self._step_ms))
        keys = {"name": name, "every_steps": every_steps, **self._angles(beams, 0.0)}
        return self._checked(MountedLaser, beams, keys | _mount(beams.mount))

    def _interval_ms(self, beams: _Beams) -> float:
        return self._values.number(beams.ranger, "update_interval", "f", _UPDATE_INTERVAL_MS)

    def _angles(self, beams: _Beams, yaw_rad: float) -> dict[str, float]:
        """Return the directions of the beams; the only one of a sensor points straight ahead, as in Stage."""
        half_rad = max(0.5 * beams.fov_rad, 1e-6)
        return {
            "beams": beams.samples,
            "angle_min_rad": yaw_rad - (half_rad if beams.samples > 1 else 0.0),
            "angle_max_rad": yaw_rad + half_rad,
        }

    def _sonar(self, beams: _Beams, name: str) -> Sonar:
        keys: dict[str, Any] = {"name": name, "opening_rad": tidy(beams.fov_rad), **_mount(beams.mount)}
        if beams.samples > 1:
            keys["rays"] = beams.samples
        else:
            self._notes.of(beams.sensor, "samples", "one ray in Stage, a cone of rays here")
        return self._checked(Sonar, beams, keys)

    def _beams(self, carrier: Entity, frame: Pose2, z_m: float) -> Iterator[_Beams]:
        """Yield the beams of the rangers on a robot, or on a part of it, whose frame on the robot is given.

        A model that does not say otherwise carries others on its top.
        """
        values = self._values
        top_m = values.size(carrier, DEFAULT_SIZE_M)[2] if values.whole(carrier, "stack_children", 1) else 0.0
        for part in carrier.of_kind(*BODIES, "position", *RANGERS):
            (pose, z), (origin, origin_z) = values.pose(part, "pose"), values.pose(part, "origin")
            mount, height_m = compose(frame, pose), z_m + top_m + z
            yield from self._beams(part, mount, height_m)
            sensors = part.of_kind("sensor") if part.kind == "ranger" else [part] if part.kind == "laser" else []
            if part.kind == "ranger" and not sensors:
                self._notes.say(part.place, f"{part.called}: omitted: a ranger without a sensor measures nothing")
            if len(sensors) > 1:
                text = f"{part.called}: each sensor has a topic here; stage_ros publishes only the first one"
                self._notes.say(part.place, text)
            for sensor in sensors:
                yield self._of_sensor(part, sensor, compose(mount, origin), height_m + origin_z)

    def _of_sensor(self, ranger: Entity, sensor: Entity, mount: Pose2, height_m: float) -> _Beams:
        values = self._values
        if sensor is ranger:
            low, high, fov, samples = _LASER_DEFAULTS
            low, high = values.number(ranger, "range_min", "l", low), values.number(ranger, "range_max", "l", high)
        else:
            low, high = values.numbers(sensor, "range", "ll", (0.0, 5.0))
            mount, fov, samples = compose(mount, values.pose(sensor, "pose")[0]), _DEFAULT_FOV_RAD, 1
        if not high > low:
            self._notes.of(sensor, "range", f"the minimum, {low:g}, is not below the maximum and counts as 0")
            low = 0.0
        fov_rad, samples = values.number(sensor, "fov", "a", fov), values.whole(sensor, "samples", samples)
        return _Beams(ranger, sensor, (low, high), fov_rad, samples, self._noise_m(sensor), mount, height_m)

    def _noise_m(self, sensor: Entity) -> float:
        variance, share, angle = self._values.numbers(sensor, "noise", "lfa", (0.0, 0.0, 0.0))
        if share != 0.0 or angle != 0.0:
            self._notes.of(sensor, "noise", "only the constant part is simulated, not the parts for range and angle")
        if variance < 0.0:
            self._notes.of(sensor, "noise", f"{variance:g}, a variance, counts as 0")
        return math.sqrt(max(variance, 0.0))

    def _checked(self, model: type[M], beams: _Beams, keys: dict[str, Any]) -> M:
        """Return a sensor with the keys that all sensors have. Raises: ScenarioError."""
        sensor = beams.sensor
        common = {
            "range_min_m": tidy(beams.range_m[0]),
            "range_max_m": tidy(beams.range_m[1]),
            "height_m": tidy(beams.height_m),
            "noise_m": tidy(beams.noise_m),
        }
        bounds = ("range_min", "range_max") if sensor is beams.ranger else ("range", "range")
        sources = dict.fromkeys(("beams", "rays"), (sensor, "samples"))
        sources |= dict.fromkeys(("angle_min_rad", "angle_max_rad", "opening_rad"), (sensor, "fov"))
        sources |= {"range_min_m": (sensor, bounds[0]), "range_max_m": (sensor, bounds[1])}
        sources |= dict.fromkeys(("forward_m", "left_m", "height_m"), (beams.ranger, "pose"))
        sources |= {"noise_m": (sensor, "noise"), "every_steps": (beams.ranger, "update_interval")}
        return self._notes.checked(model, {**keys, **common}, sources)


def _mount(pose: Pose2) -> dict[str, float]:
    return {"forward_m": tidy(pose[0]), "left_m": tidy(pose[1]), "yaw_rad": tidy(pose[2])}
