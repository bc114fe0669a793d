"""The inputs and outputs of a controller: observation, messages, task, decision."""

from robotteamsim.interface.controller import Controller, Observation
from robotteamsim.interface.decision import OUTSIDE, Decision, SwarmContext
from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.localisation import Estimate, Localisation
from robotteamsim.interface.task import Assistance, Task
from robotteamsim.network.messages import EVERYBODY, Message

__all__ = [
    "EVERYBODY",
    "OUTSIDE",
    "Assistance",
    "Controller",
    "Decision",
    "Discovery",
    "Estimate",
    "Localisation",
    "Message",
    "Observation",
    "SwarmContext",
    "Task",
]
