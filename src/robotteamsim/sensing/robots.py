"""The sensors of all robots: laser, odometry, contact and additional sensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from robotteamsim import _core
from robotteamsim.hazards import HazardSource
from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Laser
from robotteamsim.sensing.beams import SmokyAir, core_limits
from robotteamsim.sensing.carried import CarriedSensors
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.core_parts import core_fan
from robotteamsim.world.world import World, fan_caster

_STEPS_PER_DRAW = 64


class Sensors(Protocol):
    """The sensors of a team."""

    def read(self) -> _core.state.State:
        """Return what every robot measures after the last step of the world; once after each step."""


class RobotSensors:
    """The sensors of all robots of a world. `include/robotteamsim/sensing/odometry.hpp` has the model of odometry.

    Random streams: ("odometry", id), ("laser", id), and those of `CarriedSensors`.

    When a robot arrives, its sensors restart. From the second arrival on, the names of its streams end with the number
    of the arrival, so that its noise does not depend on what happened before.
    """

    def __init__(
        self, world: AnyWorld, robots: Sequence[PlacedRobot], seed: int, hazards: HazardSource | None = None
    ) -> None:
        """Args: robots: those of the world, in id order.  hazards: None if nothing can burn."""
        self._world = world
        self._robots = tuple(robots)
        self._seed = seed
        self._kinds: dict[Laser, list[int]] = {}
        """The ids of the robots that have a laser of each kind."""
        for robot_id, robot in enumerate(self._robots):
            self._kinds.setdefault(robot.laser, []).append(robot_id)
        self._casts = [(world.caster(laser.beam_model().fan), ids) for laser, ids in self._kinds.items()]
        self._beams = max((laser.beams for laser in self._kinds), default=0)
        self._noisy = [i for i, robot in enumerate(self._robots) if robot.laser.noise_m > 0.0]
        self._air = None if hazards is None else SmokyAir(hazards)
        self._carried = CarriedSensors(world, robots, seed, self._air)
        self.reset()

    def read(self) -> _core.state.State:
        """Return what every robot measures after the last step of the world.

        Odometry adds the motion of that step, so call this once after each step.
        """
        world, core = self._world, self.core
        if world.arrivals != self._arrivals:
            self._restart_arrived()
        if self._air is not None:
            core.set_haze(self._air.haze)
        if not core.noise_left:
            self.draw()
        if self._noisy:
            core.set_range_noise(self._laser_noise_m())
        state = _core.state.State(len(self._robots), self._beams)
        if isinstance(world, World):
            core.read(state, world.core)
        else:
            ranges_m = [cast(ids) for cast, ids in self._casts]
            core.read_motion(state, *world.motion(), world.contact_angles_rad(), ranges_m)
        state.sensors = self._carried.read()
        return state

    def draw(self) -> int:
        """Draw the random numbers of the odometry for some steps, when none are left, and return for how many."""
        drawn = [generator.standard_normal((_STEPS_PER_DRAW, 3)) for generator in self._odometry_generators]
        self.core.add_noise(np.hstack([np.empty((_STEPS_PER_DRAW, 0)), *drawn]))  # also without robots
        return _STEPS_PER_DRAW

    def _laser_noise_m(self) -> np.ndarray:
        """Draw what is added to the ranges, shape (n, beams) [m]."""
        noise_m = np.zeros((len(self._robots), self._beams))
        for robot_id in self._noisy:
            laser = self._robots[robot_id].laser
            noise_m[robot_id, : laser.beams] = self._generators[robot_id].normal(0.0, laser.noise_m, laser.beams)
        return noise_m

    def reset(self) -> None:
        """Restart after `World.reset`: odometry at its origin, all random streams from their start."""
        self._arrivals = self._world.arrivals
        self._carried.reset()
        self._generators = [stream(self._seed, "laser", robot_id) for robot_id in range(len(self._robots))]
        self._odometry_generators = [stream(self._seed, "odometry", i) for i in range(len(self._robots))]
        models = [robot.odometry for robot in self._robots]
        self.core = _core.sensing.TeamSensors(
            [self._core_lasers(laser, ids) for laser, ids in self._kinds.items()],
            [(model.alpha1, model.alpha2, model.alpha3, model.alpha4) for model in models],
            self._world.step_ns * 1e-9,
            [robot.drive.kind == "omni" for robot in self._robots],
        )

    def _core_lasers(self, laser: Laser, robot_ids: list[int]) -> _core.sensing.Lasers:
        model = laser.beam_model()
        caster = fan_caster(self._world.plan, model.fan) if isinstance(self._world, World) else None
        return _core.sensing.Lasers(core_fan(model.fan), core_limits(model), robot_ids, caster)

    def _restart_arrived(self) -> None:
        arrivals = self._world.arrivals
        for robot_id, (before, now) in enumerate(zip(self._arrivals, arrivals, strict=True)):
            if before != now:
                again = (now,) if now > 1 else ()
                generator = self._odometry_generators[robot_id] = stream(self._seed, "odometry", robot_id, *again)
                self.core.restart(robot_id, generator.standard_normal((self.core.noise_left, 3)))
                self._generators[robot_id] = stream(self._seed, "laser", robot_id, *again)
                self._carried.restart(robot_id, again)
        self._arrivals = arrivals
