"""Fire, smoke and heat on a grid of the plan, and what they do to people and robots."""

from robotteamsim.hazards.effects import Dose, Doses, HeatStress, PersonState, walking_speed_share
from robotteamsim.hazards.field import BURNING, BURNT_OUT, NOT_BURNING, HazardField, Ignited
from robotteamsim.hazards.hazards import Hazards
from robotteamsim.hazards.source import HazardSource

__all__ = [
    "BURNING",
    "BURNT_OUT",
    "NOT_BURNING",
    "Dose",
    "Doses",
    "HazardField",
    "HazardSource",
    "Hazards",
    "HeatStress",
    "Ignited",
    "PersonState",
    "walking_speed_share",
]
