"""Stage's rangers as lasers and sonars of a robot."""

import math
import re
from dataclasses import dataclass
from typing import Any, TypeVar

from robotteamsim.scenario.base import Model
from robotteamsim.scenario.sensors import Laser, MountedLaser, Sonar, is_free_name
from robotteamsim.stage.solids import DEFAULT_SIZE_M
from robotteamsim.stage.values import ASIDE_M, Notes, Pose2, Values, checked, compose, tidy
from robotteamsim.stage.world_file import Entity

M = TypeVar("M", bound=Model)

_DEFAULT_FOV_RAD = 0.1
"""Default of `fov` (Stage 4)."""

_LASER_DEFAULTS = (0.0, 8.0, math.pi, 180)
"""Defaults of range_min, range_max, fov and samples of the `laser` model (Stage 3)."""


@dataclass(frozen=True, slots=True)
class _Beams:
    """The beams of a ranger and its pose on the robot."""

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

    def __init__(self, values: Values, notes: Notes, step_ms: float) -> None:
        self._values, self._notes, self._step_ms = values, notes, step_ms

    def read(self, robot: Entity) -> dict[str, Any]:
        """Return the keys `laser`, `lasers` and `sonars` of a robot, without those that it does not have.

        Rangers with "sonar" in their name are sonars. The first of the others is the laser, or the first of all.

        Raises: ScenarioError: one line with file, line and key.
        """
        rangers = robot.of_kind("ranger", "laser")
        if not rangers:
            text = f"'{robot.called}' has no ranger; it gets the default laser, as every robot has one here"
            self._notes.say(robot.place, text)
            return {}
        sonars = [ranger for ranger in rangers if "sonar" in self._name(ranger).lower()]
        lasers = [ranger for ranger in rangers if ranger not in sonars]
        if not lasers:
            lasers = [sonars.pop(0)]
        keys: dict[str, Any] = {"laser": self._laser(self._beams(robot, lasers.pop(0)))}
        names = iter(self._names([*lasers, *sonars]))
        sensors = [self._mounted_laser(self._beams(robot, laser), next(names)) for laser in lasers]
        keys["sensors"] = (*sensors, *(self._sonar(self._beams(robot, sonar), next(names)) for sonar in sonars))
        return keys

    def _name(self, ranger: Entity) -> str:
        return self._values.text(ranger, "name", ranger.called)

    def _names(self, rangers: list[Entity]) -> list[str]:
        """Return a unique name for each ranger: as in the file where that can be a topic."""
        names: list[str] = []
        for number, ranger in enumerate(rangers, 1):
            wanted = re.sub(r"\W", "_", self._name(ranger).lower(), flags=re.ASCII)
            if not is_free_name(wanted):
                wanted = f"{ranger.kind}_{wanted}"
            name = wanted if wanted not in ("ranger", "laser") else f"{wanted}_{number}"
            while name in names:
                name = f"{wanted}_{number}"
                number += 1
            names.append(name)
        return names

    def _laser(self, beams: _Beams) -> Laser:
        x_m, y_m, yaw_rad = beams.mount
        if abs(y_m) > ASIDE_M:
            text = f"'{beams.ranger.called}' is {y_m:.3g} m beside the robot's axis; expected the first laser on it"
            raise beams.ranger.error("pose", text)
        angles = {"angle_min_rad": yaw_rad - 0.5 * beams.fov_rad, "angle_max_rad": yaw_rad + 0.5 * beams.fov_rad}
        return self._checked(Laser, beams, {"beams": beams.samples, **angles, "forward_m": tidy(x_m)})

    def _mounted_laser(self, beams: _Beams, name: str) -> MountedLaser:
        interval_ms = self._values.number(beams.ranger, "update_interval", "f", self._step_ms)
        every_steps = max(1, round(interval_ms / self._step_ms)) if self._step_ms > 0.0 else 1
        angles = {"angle_min_rad": -0.5 * beams.fov_rad, "angle_max_rad": 0.5 * beams.fov_rad}
        keys = {"name": name, "beams": beams.samples, **angles, "every_steps": every_steps}
        return self._checked(MountedLaser, beams, keys | _mount(beams.mount))

    def _sonar(self, beams: _Beams, name: str) -> Sonar:
        keys: dict[str, Any] = {"name": name, "opening_rad": tidy(beams.fov_rad), **_mount(beams.mount)}
        if beams.samples > 1:
            keys["rays"] = beams.samples
        else:
            self._notes.of(beams.sensor, "samples", "one ray in Stage, a cone of rays here")
        return self._checked(Sonar, beams, keys)

    def _beams(self, robot: Entity, ranger: Entity) -> _Beams:
        """Return the beams of a ranger; its pose is relative to the top of the robot."""
        values = self._values
        pose, z = values.pose(ranger, "pose")
        origin, origin_z = values.pose(ranger, "origin")
        base_m = values.size(robot, DEFAULT_SIZE_M)[2] if values.whole(robot, "stack_children", 1) else 0.0
        mount, height_m = compose(pose, origin), base_m + z + origin_z
        if ranger.kind == "laser":
            low, high, fov, samples = _LASER_DEFAULTS
            range_m = values.number(ranger, "range_min", "l", low), values.number(ranger, "range_max", "l", high)
            fov_rad, samples = values.number(ranger, "fov", "a", fov), values.whole(ranger, "samples", samples)
            return _Beams(ranger, ranger, range_m, fov_rad, samples, 0.0, mount, height_m)
        sensor = self._sensor(ranger)
        low, high = values.numbers(sensor, "range", "ll", (0.0, 5.0))
        fov_rad, samples = values.number(sensor, "fov", "a", _DEFAULT_FOV_RAD), values.whole(sensor, "samples", 1)
        mount = compose(mount, values.pose(sensor, "pose")[0])
        return _Beams(ranger, sensor, (low, high), fov_rad, samples, self._noise_m(sensor), mount, height_m)

    def _sensor(self, ranger: Entity) -> Entity:
        sensors = ranger.of_kind("sensor")
        if not sensors:
            raise ranger.place.error(f"{ranger.called}: expected a sensor( ... ) in a ranger")
        for other in sensors[1:]:
            text = f"{other.called}: omitted: stage_ros publishes only the first sensor of a ranger"
            self._notes.say(other.place, text)
        return sensors[0]

    def _noise_m(self, sensor: Entity) -> float:
        variance, share, angle = self._values.numbers(sensor, "noise", "lfa", (0.0, 0.0, 0.0))
        if share != 0.0 or angle != 0.0:
            self._notes.of(sensor, "noise", "only the constant part is simulated, not the parts for range and angle")
        if variance < 0.0:
            raise sensor.error("noise", f"{variance:g} is below 0")
        return math.sqrt(variance)

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
        return checked(model, {**keys, **common}, sources)


def _mount(pose: Pose2) -> dict[str, float]:
    return {"forward_m": tidy(pose[0]), "left_m": tidy(pose[1]), "yaw_rad": tidy(pose[2])}
