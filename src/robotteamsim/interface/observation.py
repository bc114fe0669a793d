"""What one robot perceives in one step."""

from __future__ import annotations

from typing import NamedTuple

from robotteamsim.sensing.readings import RobotReading, VoiceReading


class Observation(NamedTuple):
    """All that a controller is told of the world in one step; sim_time_ns is the stamp of every part."""

    robot_id: int
    sim_time_ns: int
    robot: RobotReading
    voice: VoiceReading
