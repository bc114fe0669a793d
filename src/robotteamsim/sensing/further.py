"""Additional sensors of robots, such as lasers, cameras and GPS, each with its own topic."""

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import CameraError
from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Camera, Gps, LightSensor, MountedLaser
from robotteamsim.sensing.gps import fix, is_due
from robotteamsim.sensing.heat import ThermalCamera
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.readings import NOTHING_FURTHER, Fix, FurtherReadings
from robotteamsim.sensing.smoke import SmokyAir
from robotteamsim.sensing.sonar import Sonar
from robotteamsim.world.contract import AnyWorld


class FurtherSensors:
    """The additional sensors of all robots of a world.

    Random streams: ("laser", id, name), ("sonar", id, name) and ("gps", id).
    """

    def __init__(self, world: AnyWorld, robots: Sequence[PlacedRobot], seed: int, air: SmokyAir | None = None) -> None:
        """Args: robots: those of the world, in id order.  air: None if nothing can burn."""
        self._world = world
        self._robots = tuple(robots)
        self._seed = seed
        # A laser stores which edges are visible from each cell, so robots of one kind share it.
        lasers = dict.fromkeys(model for robot in self._robots for model in robot.lasers)
        self._lasers = {model: Laser(model, world) for model in lasers}
        sonars = dict.fromkeys(model for robot in self._robots for model in robot.sonars)
        self._air = air
        self._camera = None if air is None else ThermalCamera(world, air)
        self._sonars = {model: Sonar(model, world) for model in sonars}
        self.has_any = any(robot.mounts or _names(robot) or robot.heat for robot in self._robots)
        """Whether any robot has an additional sensor."""
        self.reset()

    def reset(self) -> None:
        """Restart all random streams."""
        self._streams: dict[tuple[int | str, ...], np.random.Generator] = {}
        for robot_id in range(len(self._robots)):
            self.restart(robot_id, ())

    def restart(self, robot_id: int, again: tuple[int, ...]) -> None:
        """Restart a robot's random streams. Args: again: appended to their names."""
        for kind, *name in _names(self._robots[robot_id]):
            self._streams[robot_id, kind, *name] = stream(self._seed, kind, robot_id, *name, *again)

    def read(self) -> tuple[FurtherReadings, ...]:
        """Return every robot's additional readings after the last step of the world; () if no robot has any."""
        if not self.has_any:
            return ()
        positions_m, present = self._world.positions_m().tolist(), self._world.present
        return tuple(
            NOTHING_FURTHER
            if present is not None and not present[robot_id]
            else FurtherReadings(
                scans_m=tuple(self._scan(robot_id, laser) for laser in robot.lasers),
                sonars_m=tuple(
                    self._sonars[sonar].read(robot_id, self._streams[robot_id, "sonar", sonar.name])
                    for sonar in robot.sonars
                ),
                images=tuple(self._image(robot_id, camera) for camera in robot.cameras),
                lights_lx=tuple(self._illuminance_lx(robot_id, sensor) for sensor in robot.light_sensors),
                fix=self._fix(robot_id, robot.gps, tuple(positions_m[robot_id])),
                heat=self._camera.read(robot.heat, tuple(positions_m[robot_id]))
                if self._camera and robot.heat
                else None,
            )
            for robot_id, robot in enumerate(self._robots)
        )

    def _fix(self, robot_id: int, gps: Gps | None, position_m: tuple[float, float]) -> Fix | None:
        if gps is None or not is_due(gps, self._world.sim_time_ns, self._world.step_ns):
            return None
        return fix(gps, position_m, self._streams[robot_id, "gps"])

    def _image(self, robot_id: int, camera: Camera) -> np.ndarray | None:
        if self._world.step_index % camera.every_steps:
            return None
        scene = self._world.scene
        if isinstance(scene, _core.world.World):
            raise CameraError(f"robots.cameras: '{camera.name}' needs run.world mujoco")
        return scene.image(robot_id, camera)

    def _illuminance_lx(self, robot_id: int, sensor: LightSensor) -> float:
        scene = self._world.scene
        # A scenario with light sensors in the plane is rejected.
        return 0.0 if isinstance(scene, _core.world.World) else scene.illuminance_lx(robot_id, sensor)

    def _scan(self, robot_id: int, laser: MountedLaser) -> np.ndarray | None:
        if self._world.step_index % laser.every_steps:
            return None
        scans: np.ndarray = self._lasers[laser].scan([robot_id], [self._streams[robot_id, "laser", laser.name]])
        if self._air is not None:
            self._air.dim(self._lasers[laser], [robot_id], scans)
        ranges_m: np.ndarray = scans[0]
        return ranges_m


def _names(robot: PlacedRobot) -> list[tuple[str, ...]]:
    """Return kind and name of each additional sensor of a robot; a kind of which it has only one has no names."""
    names: list[tuple[str, ...]] = [("laser", laser.name) for laser in robot.lasers]
    names += [("sonar", sonar.name) for sonar in robot.sonars]
    if robot.gps is not None:
        names.append(("gps",))
    return names
