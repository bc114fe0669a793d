"""The scenario: one YAML file, one typed model."""

from __future__ import annotations

from pydantic import Field

from robotteamsim.scenario.base import Model, tuple_of
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.sections import Control, Mission, Network, PlacedRobot, Radio, Run, Team, Voice


class Scenario(Model):
    """Everything that one trial depends on. `plan` is a path in YAML and the loaded plan here."""

    name: str = Field(description="shown in tables and results")
    plan: FloorPlan = Field(description="floor plan file, or map_server yaml, relative to this file")
    robots: Team | tuple_of(PlacedRobot) = Field(description="a team of equal robots, or a list")  # type: ignore[valid-type]
    radio: Radio = Radio()
    voice: Voice = Voice()
    network: Network = Network()
    control: Control = Control()
    mission: Mission = Mission()
    run: Run = Run()
