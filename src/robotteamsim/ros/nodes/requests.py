"""Checks of requests that change the mission, for the nodes `environment` and `mission`."""

from robotteamsim.errors import PlacementError
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.sections import Mission, Victim, Voice
from robotteamsim.world.placement import check_mission


def check_door(scenario: Scenario, name: str) -> None:
    """Raises: ValueError: there is no such door."""
    known = [door.name for door in scenario.plan.doors]
    if name not in known:
        raise ValueError(f"unknown door '{name}'; known: {', '.join(known) or 'none'}")


def check_noise(noise_db: float) -> None:
    """Raises: ValueError: the background noise [dB] is out of range."""
    # The scenario's model has the range.
    checked(Voice, {"noise_db": noise_db}, ValueError)


def check_victim(scenario: Scenario, name: str, position_m: tuple[float, float]) -> None:
    """Raises: ValueError: a victim cannot have this name or be at this place [m, map]."""
    try:
        victim = checked(Victim, {"name": name, "position": position_m}, ValueError)
        check_mission(scenario.plan, Mission(victims=(victim,)))
    except (ValueError, PlacementError) as error:
        # This victim is the only one of the mission above.
        problem = str(error).removeprefix("mission.victims.0.")
        raise ValueError(f"set_victim: {name}: {problem}") from None
