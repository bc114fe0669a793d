"""The mission: areas, victims, events, end conditions."""

from robotteamsim.mission.events import Event
from robotteamsim.mission.mission import Mission
from robotteamsim.mission.sensed import Sensed
from robotteamsim.mission.status import MissionStatus

__all__ = ["Event", "Mission", "MissionStatus", "Sensed"]
