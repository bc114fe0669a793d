"""The additional sensors of all robots, `robots.sensors`; `scenario.sensors` has the kinds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.rng import stream
from robotteamsim.scenario.plan import FREE, occupancy_grid
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Camera, LightSensor, Sensor
from robotteamsim.scenario.sensors.base import BeamModel, Moment, naming
from robotteamsim.sensing.beams import Beams, SmokyAir
from robotteamsim.world.contract import AnyWorld

SIGHT_RESOLUTION_M = 0.1
"""Size of the cells in which lines of sight to hot places are checked [m]."""


class CarriedSensors:
    """The additional sensors of all robots of a world. Random streams: (kind, id, name) of each."""

    def __init__(self, world: AnyWorld, robots: Sequence[PlacedRobot], seed: int, air: SmokyAir | None = None) -> None:
        """Args: robots: those of the world, in id order.  air: None if nothing can burn."""
        self._world = world
        self._seed = seed
        self._air = air
        surroundings = _Surroundings(world, air)
        self._carriers = {
            robot_id: (_Carrier(robot_id, surroundings), robot.sensors)
            for robot_id, robot in enumerate(robots)
            if robot.sensors
        }
        self.reset()

    def reset(self) -> None:
        """Restart all random streams."""
        self._generators: dict[tuple[int, str], np.random.Generator] = {}
        for robot_id in self._carriers:
            self.restart(robot_id, ())

    def restart(self, robot_id: int, again: tuple[int, ...]) -> None:
        """Restart a robot's random streams. Args: again: appended to their names."""
        for sensor in self._sensors_of(robot_id):
            generator = stream(self._seed, sensor.kind, robot_id, sensor.name, *again)
            self._generators[robot_id, sensor.name] = generator

    def read(self) -> dict[int, Mapping[str, Any]]:
        """Return the readings of the last step of the world, by robot and sensor; only of what measured in it."""
        if not self._carriers:
            return {}
        world = self._world
        fire_advances = self._air is not None and self._air.is_new
        moment = Moment(world.sim_time_ns, world.step_ns, fire_advances)
        readings: dict[int, dict[str, Any]] = {i: {} for i in self._carriers if world.present[i]}
        for robot_id, found in readings.items():
            carrier, sensors = self._carriers[robot_id]
            for sensor in sensors:
                with naming(sensor, robot_id):
                    if sensor.is_due(moment) and (self._air is not None or not sensor.needs_fire):
                        found[sensor.name] = sensor.measure(carrier, self._generators[robot_id, sensor.name])
        return {robot_id: MappingProxyType(found) for robot_id, found in readings.items()}

    def _sensors_of(self, robot_id: int) -> tuple[Sensor, ...]:
        return self._carriers[robot_id][1] if robot_id in self._carriers else ()


class _Surroundings:
    """What the sensors of a team share: equal beams, which store the edges in sight of each cell, and sight lines."""

    def __init__(self, world: AnyWorld, air: SmokyAir | None) -> None:
        self.world = world
        self.air = air
        self._beams: dict[BeamModel, Beams] = {}
        self._sight: _core.plan.PlanningGrid | None = None
        self._doors_version = 0

    def beams(self, model: BeamModel) -> Beams:
        """Return the beams of one kind."""
        if model not in self._beams:
            self._beams[model] = Beams(self.world, model)
        return self._beams[model]

    def sight(self) -> _core.plan.PlanningGrid:
        """Return the cells that light passes."""
        doors = self.world.door_states()
        if self._sight is None or doors.version != self._doors_version:
            self._doors_version = doors.version
            grid = occupancy_grid(self.world.plan, SIGHT_RESOLUTION_M, doors.closed())
            self._sight = _core.plan.PlanningGrid(grid.cells != FREE, grid.origin_m, SIGHT_RESOLUTION_M, 0.0)
        return self._sight


@dataclass(frozen=True, slots=True)
class _Carrier:
    """A robot as its sensors see it; see `scenario.sensors.base.Carrier` and `Air`."""

    robot_id: int
    around: _Surroundings

    @property
    def world(self) -> AnyWorld:
        return self.around.world

    @property
    def pose(self) -> Pose:
        return self.around.world.poses()[self.robot_id]

    @property
    def air(self) -> _Carrier:
        return self

    def ranges_m(self, beams: BeamModel, noise_m: np.ndarray) -> np.ndarray:
        rays = self.around.beams(beams)
        ranges_m = rays.scan([self.robot_id], _row(noise_m))
        if self.around.air is not None:
            rays.dim([self.robot_id], self.around.air.haze, ranges_m)
        return _unchangeable(ranges_m[0])

    def nearest_m(self, beams: BeamModel, noise_m: np.ndarray) -> float:
        return float(self.around.beams(beams).nearest([self.robot_id], _row(noise_m))[0])

    def illuminance_lx(self, sensor: LightSensor) -> float:
        return self.around.world.illuminance_lx(self.robot_id, sensor)

    def image(self, sensor: Camera) -> np.ndarray:
        return _unchangeable(self.around.world.image(self.robot_id, sensor))

    def temperature_c(self) -> float:
        assert self.around.air is not None
        return float(self.around.air.field.temperature_c(self._position_m())[0])

    def hot_places(self, range_m: float) -> tuple[tuple[tuple[float, float], ...], tuple[float, ...]]:
        assert self.around.air is not None
        field = self.around.air.field
        (position_m,) = self._position_m().tolist()
        hot_m = _core.hazards.hot_in_sight(
            field.temperatures_c,
            field.origin_m,
            field.resolution_m,
            field.fire.heat.block_c,
            self.around.sight(),
            tuple(position_m),
            range_m,
        )
        if not hot_m:
            return (), ()
        return tuple(hot_m), tuple(field.temperature_c(np.array(hot_m)).tolist())

    def _position_m(self) -> np.ndarray:
        return self.around.world.positions_m()[[self.robot_id]]


def _unchangeable(measured: np.ndarray) -> np.ndarray:
    """Return what was measured as an array that a controller cannot change: the record shares it."""
    measured.flags.writeable = False
    return measured


def _row(noise_m: np.ndarray) -> np.ndarray:
    """Return the noise of one robot as a table of one row, or an empty one."""
    return noise_m.reshape(1, -1) if noise_m.size else np.empty((0, 0))
