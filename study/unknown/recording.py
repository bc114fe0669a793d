"""True paths of missions, and what robots on them measure with other noise."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.rng import stream
from robotteamsim.scenario import load
from robotteamsim.sensing.beams import core_limits
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Simulation
from robotteamsim.world.core_parts import core_fan


@dataclass(frozen=True)
class Recording:
    """What a team with equal lasers did, with an entry per step.

    poses:    true ones of base_link, x, y [m] and yaw [rad] in `map`, shape (steps, robots, 3).
    twists:   true ones in base_link, forward, left [m/s] and turn [rad/s], shape (steps, robots, 3).
    ranges_m: without noise, infinite without a return, shape (steps, robots, beams).
    """

    setup: Setup
    poses: np.ndarray
    twists: np.ndarray
    ranges_m: np.ndarray

    def moving(self) -> list[int]:
        """Return the robots that drove more than 10 m; the others, such as a base, have nothing to map."""
        steps_m = np.linalg.norm(np.diff(self.poses[:, :, :2], axis=0), axis=2)
        return [int(robot_id) for robot_id in np.flatnonzero(steps_m.sum(axis=0) > 10.0)]


@dataclass(frozen=True)
class Measured:
    """What a robot measures in one step: its odometry, the covariance of this, and the ranges of its laser [m]."""

    odometry: Pose
    covariance: tuple[float, ...]
    ranges_m: np.ndarray


@functools.lru_cache(maxsize=1)
def record(name: str, *overrides: str) -> Recording:
    """Run a mission whose robots know their true poses, and return what they did."""
    setup = resolve(load(name, list(overrides)))
    simulation = Simulation(setup)
    poses, twists, ranges_m = [], [], []
    simulation.mission.start()
    while simulation.mission.status.state != "ended":
        state = simulation.step().state
        x_m, y_m, qz, qw = state.true_pose.T
        poses.append(np.stack([x_m, y_m, 2.0 * np.arctan2(qz, qw)], axis=1))
        twists.append(np.array(state.true_twist))
        ranges_m.append(np.array(state.ranges_m, dtype=float))
    ranges = np.array(ranges_m)
    ranges[ranges >= setup.robots[0].laser.range_max_m] = np.inf
    return Recording(setup, np.array(poses), np.array(twists), ranges)


def measured_again(recording: Recording, robot_id: int, seed: int, noise_m: float) -> Iterator[Measured]:
    """Yield what a robot measures in each step from the second one on, with the noise of another seed."""
    robot = recording.setup.robots[robot_id]
    laser, model = robot.laser, robot.odometry
    lasers = _core.sensing.Lasers(core_fan(laser.beam_model().fan), core_limits(laser.beam_model()), [0])
    alphas = (model.alpha1, model.alpha2, model.alpha3, model.alpha4)
    sensors = _core.sensing.TeamSensors([lasers], [alphas], recording.setup.scenario.run.step_s, [False])
    odometry_noise, laser_noise = stream(seed, "odometry", robot_id), stream(seed, "laser", robot_id)
    poses, in_contact = recording.poses[:, robot_id], np.array([False])
    for step in range(1, len(poses)):
        if not sensors.noise_left:
            sensors.add_noise(odometry_noise.standard_normal((64, 3)))
        if noise_m > 0.0:
            sensors.set_range_noise(laser_noise.normal(0.0, noise_m, (1, laser.beams)))
        motion = Pose(*map(float, poses[step - 1])).inverse() @ Pose(*map(float, poses[step]))
        motions = np.array([[motion.x_m, motion.y_m, motion.yaw_rad]])
        state = _core.state.State(1, laser.beams)
        ranges_m = np.ascontiguousarray(recording.ranges_m[step, robot_id : robot_id + 1])
        twists = np.ascontiguousarray(recording.twists[step, robot_id : robot_id + 1])
        sensors.read_motion(state, poses[step : step + 1].copy(), twists, motions, in_contact, {}, [ranges_m])
        reading = state.readings()[0]
        odometry = reading.odometry
        yield Measured(odometry.pose.pose, odometry.pose_covariance, np.array(reading.ranges_m))


def beams_at_teammates(recording: Recording, robot_id: int, step: int, margin_m: float) -> np.ndarray:
    """Return which beams end at a teammate, at most so far from its body, bool, shape (beams,)."""
    laser = recording.setup.robots[robot_id].laser
    x_m, y_m, yaw_rad = recording.poses[step, robot_id]
    angles_rad, ranges_m = laser.angles_rad + yaw_rad, recording.ranges_m[step, robot_id]
    laser_x_m = x_m + laser.forward_m * math.cos(yaw_rad) - laser.left_m * math.sin(yaw_rad)
    laser_y_m = y_m + laser.forward_m * math.sin(yaw_rad) + laser.left_m * math.cos(yaw_rad)
    has_hit = np.isfinite(ranges_m)
    reach_m = np.where(has_hit, ranges_m, 0.0)
    ends_x_m, ends_y_m = laser_x_m + reach_m * np.cos(angles_rad), laser_y_m + reach_m * np.sin(angles_rad)
    at_teammate = np.zeros(laser.beams, dtype=bool)
    for other, robot in enumerate(recording.setup.robots):
        if other != robot_id:
            apart_m = np.hypot(ends_x_m - recording.poses[step, other, 0], ends_y_m - recording.poses[step, other, 1])
            at_teammate |= has_hit & (apart_m < robot.reach_m + margin_m)
    return at_teammate
