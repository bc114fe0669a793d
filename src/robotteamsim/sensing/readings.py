"""What a robot perceives in one step, in the form in which ROS messages carry it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robotteamsim.geometry import PoseReading, Twist


@dataclass(frozen=True, slots=True)
class OdometryReading:
    """A pose in `odom` and the twist in `base_link` that the wheels measured."""

    pose: PoseReading
    twist: Twist


@dataclass(frozen=True, slots=True)
class VoiceReading:
    """What a robot hears.

    level_db:            voice level at the robot [dB]; 0 where no voice is above the noise.
    heard:               whether any cell within the local-best radius is above the noise.
    local_best_m:        centre of the loudest cell within the radius, in `map` [m]; the robot itself if not heard.
    local_best_level_db: its level [dB]; 0 if not heard.
    """

    level_db: float
    heard: bool
    local_best_m: tuple[float, float]
    local_best_level_db: float


@dataclass(frozen=True, slots=True)
class RobotReading:
    """What the world gives one robot in one step.

    ranges_m: float32, shape (beams,), first beam at angle_min; no return as the scenario says.
    """

    ground_truth: PoseReading
    twist: Twist
    odometry: OdometryReading
    ranges_m: np.ndarray
    in_contact: bool


@dataclass(frozen=True, slots=True)
class Observation:
    """All that a controller is told of the world in one step; sim_time_ns is the stamp of every part."""

    robot_id: int
    sim_time_ns: int
    robot: RobotReading
    voice: VoiceReading
