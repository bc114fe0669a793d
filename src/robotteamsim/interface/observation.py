"""What one robot perceives in one step."""

import msgspec

from robotteamsim.sensing.readings import RobotReading, VoiceReading


class Observation(msgspec.Struct, frozen=True, gc=False, eq=False):
    """All that one controller perceives in one step; sim_time_ns is the stamp of every part."""

    robot_id: int
    sim_time_ns: int
    robot: RobotReading
    voice: VoiceReading
