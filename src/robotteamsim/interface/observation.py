"""The input of one controller from its robot's sensors in one step."""

import msgspec

from robotteamsim.sensing.readings import RobotReading, VoiceReading


class Observation(msgspec.Struct, frozen=True, eq=False):
    """Everything that one controller perceives in one step; sim_time_ns is the stamp of all parts."""

    robot_id: int
    sim_time_ns: int
    robot: RobotReading
    voice: VoiceReading
