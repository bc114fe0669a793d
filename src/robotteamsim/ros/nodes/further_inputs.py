"""The further sensors of a robot, except for cameras, as received by its controller's node."""

from collections.abc import Callable
from functools import partial

from sensor_msgs.msg import Illuminance, LaserScan, NavSatFix, Range

from robotteamsim.msg import Heat
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.topics import Input
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.sections import Robot
from robotteamsim.scenario.sensors import Gps
from robotteamsim.sensing.gps import is_due
from robotteamsim.sensing.readings import NOTHING_FURTHER, FurtherReadings


class FurtherInputs:
    """Makes `RobotReading.further` from the topics of one robot."""

    def __init__(
        self, robot: Robot, prefix: str, step_ns: int, robot_id: int | None = None, fire: Fire | None = None
    ) -> None:
        """Args: prefix: of the names of the topics.  step_ns: length of a step [ns].  fire: of the scenario."""
        self._robot = robot
        self._fire = fire
        self._heat = f"{prefix}heat"
        self._lasers = [f"{prefix}{laser.name}" for laser in robot.lasers]
        self._sonars = [f"{prefix}{sonar.name}" for sonar in robot.sonars]
        self._lights = [f"{prefix}{sensor.name}" for sensor in robot.light_sensors]
        self._fix = f"{prefix}fix"
        self._step_ns = step_ns
        self._robot_id = robot_id
        self._has_any = bool(self.inputs)
        self.restart()

    @property
    def inputs(self) -> list[Input]:
        """The topics; without lockstep no step waits for them."""
        dues = [_due(laser.every_steps, self._step_ns) for laser in self._robot.lasers]
        mine = partial(Channel, robot_id=self._robot_id)
        inputs = [
            Input(mine(name, due=due), LaserScan, partial(conversion.read_ranges_m, beams=laser.beams))
            for name, laser, due in zip(self._lasers, self._robot.lasers, dues, strict=True)
        ]
        inputs += [Input(mine(name), Range) for name in self._sonars]
        inputs += [Input(mine(name), Illuminance) for name in self._lights]
        if self._robot.gps is not None:
            inputs.append(Input(mine(self._fix, due=_fix_due(self._robot.gps, self._step_ns)), NavSatFix))
        if self._robot.heat is not None and self._fire is not None:
            due = partial(self._fire.updates_at, step_ns=self._step_ns)
            inputs.append(Input(mine(self._heat, due=due), Heat))
        return inputs

    def restart(self) -> None:
        """Discard the ranges of sonars and the light; without lockstep the last holds until the next one arrives."""
        self._lights_lx = [0.0] * len(self._lights)
        self._sonars_m = [sonar.range_max_m for sonar in self._robot.sonars]

    def reading(self, step: Step) -> FurtherReadings:
        """Return the readings of the sensors in a step."""
        if not self._has_any:
            return NOTHING_FURTHER
        for i, name in enumerate(self._sonars):
            if (message := step.latest(name)) is not None:
                self._sonars_m[i] = float(message.range)
        for i, name in enumerate(self._lights):
            if (message := step.latest(name)) is not None:
                self._lights_lx[i] = float(message.illuminance)
        fix = step.latest(self._fix)
        scans_m = tuple(step.latest(name) for name in self._lasers)
        heat = step.latest(self._heat)
        return FurtherReadings(
            scans_m,
            tuple(self._sonars_m),
            None if fix is None else conversion.fix(fix),
            lights_lx=tuple(self._lights_lx),
            heat=None if heat is None else conversion.heat(heat),
        )


def _due(every_steps: int, step_ns: int) -> Callable[[int], bool] | None:
    """Return a function of a stamp [ns]: whether a laser measures in that step; None for every step."""
    return None if every_steps == 1 else lambda stamp_ns: stamp_ns // step_ns % every_steps == 0


def _fix_due(gps: Gps, step_ns: int) -> Callable[[int], bool] | None:
    """Return a function of a stamp [ns]: whether there is a fix in that step; None for every step."""
    return None if is_due(gps, step_ns, step_ns) else lambda stamp_ns: is_due(gps, stamp_ns, step_ns)
