"""Whether a scenario may name any Python class or policy as its controller: making it runs code of that file."""

from __future__ import annotations

from robotteamsim.control.runtime.registry import algorithm_names
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.controllers import is_policy_file
from robotteamsim.scenario.scenario import Scenario

KEYS = ("control", "control.algorithm")


def is_foreign(name: str) -> bool:
    """Whether a name is the file of a policy, or `module:Class` and not the entry point of an installed package.

    PyTorch unpickles parts of a policy, and the policy names classes.
    """
    return is_policy_file(name) or (":" in name and name not in algorithm_names())


def check_foreign(name: str, place: str, remedy: str) -> None:
    """Refuse a name that comes from a file.

    Args:   place: of the name: a file, or the option by which the user typed it, which is allowed.
            remedy: how to allow it.
    Raises: ScenarioError.
    """
    if is_foreign(name) and not place.startswith("--"):
        raise ScenarioError(f"{place}: control.algorithm: '{name}' runs any code; if you trust the file, add {remedy}")


def check_scenario(scenario: Scenario, remedy: str) -> None:
    """Refuse a scenario whose file names such a class. Raises: ScenarioError."""
    origin = scenario.origin
    place = "--set" if origin.is_set("control.algorithm") else origin.place
    check_foreign(scenario.control.algorithm, place, remedy)
