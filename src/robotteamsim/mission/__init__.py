"""What the team has to do, what happened, and when it ends."""

from robotteamsim.mission.mission import Mission
from robotteamsim.mission.status import Event, MissionStatus

__all__ = ["Event", "Mission", "MissionStatus"]
