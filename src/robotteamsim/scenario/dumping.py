"""Writing scenarios and floor plans as YAML."""

import os
from pathlib import Path

from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.shipped import shipped_map_name
from robotteamsim.scenario.yaml_text import write


def dump(scenario: Scenario, *, inline_plan: bool = False) -> str:
    """Return a scenario as YAML with every key; `load` reads an equal scenario from it.

    A shipped map is written as its name, another plan file as its absolute path.

    Args: inline_plan: write the plan itself even if it came from a file, so that the text is self-contained.
    """
    data = scenario.model_dump(by_alias=True, mode="json")
    if scenario.plan_file and not inline_plan:
        data["plan"] = shipped_map_name(Path(scenario.plan_file)) or scenario.plan_file
    return write(data)


def write_floor_plan(plan: FloorPlan, path: str | os.PathLike[str]) -> None:
    """Write a floor plan as a plan.yaml without keys that have their default. Raises: OSError."""
    data = plan.model_dump(by_alias=True, mode="json", exclude_defaults=True)
    Path(path).write_text(write(data), encoding="utf-8")
