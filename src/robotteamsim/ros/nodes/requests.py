"""What is wrong with a request to change the mission; the nodes `environment` and `mission` check the same."""

from __future__ import annotations

from pydantic import ValidationError

from robotteamsim.errors import PlacementError
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.problems import problems
from robotteamsim.scenario.sections import Mission, Victim, Voice
from robotteamsim.world.placement import check_mission


def problem_of_door(scenario: Scenario, name: str) -> str:
    """Return why there is no such door; "": there is one."""
    known = [door.name for door in scenario.plan.doors]
    return "" if name in known else f"unknown door '{name}'; known: {', '.join(known) or 'none'}"


def problem_of_noise(noise_db: float) -> str:
    """Return what is wrong with a background noise [dB]; "": nothing."""
    try:
        # The scenario's own model knows the range.
        Voice.model_validate({"noise_db": noise_db})
    except ValidationError as error:
        return str(problems(error, Voice)[0])
    return ""


def problem_of_victim(scenario: Scenario, name: str, position_m: tuple[float, float]) -> str:
    """Return why a victim cannot be at a place; "": nothing."""
    try:
        mission = Mission(victims=(Victim(name=name, position=position_m),))
        check_mission(scenario.plan, mission)
    except ValidationError as error:
        return str(problems(error, Mission)[0])
    except PlacementError as error:
        return f"set_victim: {error}"
    return ""
