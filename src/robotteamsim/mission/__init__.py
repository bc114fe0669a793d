"""The mission: areas, victims, events, end conditions."""

from robotteamsim.mission.mission import Mission
from robotteamsim.mission.status import Event, MissionStatus

__all__ = ["Event", "Mission", "MissionStatus"]
