"""Controllers by name: those of this package, of installed packages, and any class by its place."""

from __future__ import annotations

import inspect
from pathlib import Path
from pkgutil import resolve_name

import msgspec
import pytest

from robotteamsim.control import algorithm_names, make_controller
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Decision, Task
from robotteamsim.scenario.controllers import ALGORITHMS, control_kind
from robotteamsim.setup import resolve

OTHERS = """
from robotteamsim.interface import Decision

class Still:
    def __init__(self, robot_id, scenario):
        pass

    def step(self, observation, inbox, task):
        return Decision()

class Counting(Still):
    def __init__(self, robot_id, scenario, *, arrival):
        self.arrival = arrival

class Mute:
    def __init__(self, robot_id, scenario):
        pass

number = 3
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on Python's path with the modules `others` and `broken`, and a package that names some of them."""
    (tmp_path / "others_of_test.py").write_text(OTHERS)
    (tmp_path / "broken_of_test.py").write_text("import no_such_module_at_all\n")
    (tmp_path / "exiting_of_test.py").write_text("raise SystemExit(3)\n")
    info = tmp_path / "others-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: others\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[robotteamsim.controllers]\nstill = others_of_test:Still\nrdpso = others_of_test:Still\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def place_of(controller: object) -> str:
    return f"{type(controller).__module__}:{type(controller).__name__}"


def keys_of(name: str) -> dict[str, str]:
    """Return keys of `control` with which an algorithm drives, and draws random numbers if it ever does."""
    return {"algorithm": name} | ({"map": "unknown", "choice": "rrt"} if name == "frontier" else {})


def make(hall_scenario, name: str):
    return make_controller(0, resolve(hall_scenario(control=keys_of(name))))


@pytest.mark.parametrize("name", ALGORITHMS)
def test_each_algorithm_is_still_and_silent_while_the_mission_does_not_run(team, hall_scenario, name):
    hall = team(hall_scenario(control=keys_of(name)))
    hall.task = Task(running=False)
    # A robot that does not know the building is localised around its controller.
    controllers = [getattr(controller, "controller", controller) for controller in hall.controllers]
    assert {place_of(controller) for controller in controllers} == {control_kind(name).controller}
    # What it believes is no action.
    decisions = {msgspec.structs.replace(one, localisation=None, found=None) for one in hall.step()}
    assert decisions == {Decision()}


@pytest.mark.usefixtures("folder")
def test_controller_of_an_installed_package_is_found_by_its_entry_point(hall_scenario):
    assert type(make(hall_scenario, "still")).__name__ == "Still"
    assert algorithm_names()[-1] == "still"


@pytest.mark.usefixtures("folder")
def test_no_package_takes_a_name_of_ours(hall_scenario):
    assert place_of(make(hall_scenario, "rdpso")) == control_kind("rdpso").controller


@pytest.mark.usefixtures("folder")
def test_class_is_found_by_its_place(hall_scenario):
    assert type(make(hall_scenario, "others_of_test:Still")).__name__ == "Still"


@pytest.mark.usefixtures("folder")
def test_controller_with_parameter_arrival_receives_the_number_of_arrivals(hall_scenario):
    scenario = hall_scenario(control={"algorithm": "others_of_test:Counting"})
    assert [make_controller(0, resolve(scenario)).arrival, make_controller(0, resolve(scenario), 2).arrival] == [1, 2]
    scenario = hall_scenario(control={"algorithm": "others_of_test:Still"})
    assert type(make_controller(0, resolve(scenario), 2)).__name__ == "Still"


def goals(team, scenario, arrival: int) -> list[tuple[float, float] | None]:
    """Return where robots go that have come so often, in each of the first 30 s without an area."""
    hall = team(scenario)
    hall.controllers = [make_controller(i, resolve(scenario), arrival) for i in range(len(hall.controllers))]
    hall.task = Task(running=True, epoch=1)
    return [decision.goal_m for _ in range(300) for decision in hall.step()]


RANDOM = sorted(
    name
    for name, kind in ALGORITHMS.items()
    if "arrival" in inspect.signature(resolve_name(kind.controller)).parameters
)


@pytest.mark.parametrize("name", RANDOM)
def test_controller_of_a_robot_that_comes_again_draws_other_numbers_each_time(team, hall_scenario, name):
    scenario = hall_scenario(control=keys_of(name))
    first, again, third = (goals(team, scenario, arrival) for arrival in (1, 2, 3))
    assert first != again != third != first
    assert again == goals(team, scenario, 2)


KNOWN = ", ".join([*ALGORITHMS, "still"])


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("rdspo", f"'rdspo' is not known; expected one of: {KNOWN}, module:Class, or policy.pt; did you mean 'rdpso'?"),
        (
            "no_such_module:Class",
            "'no_such_module:Class': ModuleNotFoundError: No module named 'no_such_module'; "
            "is its folder in PYTHONPATH?",
        ),
        (
            "others_of_test:Walker",
            "'others_of_test:Walker': AttributeError: module 'others_of_test' has no attribute 'Walker'",
        ),
        (
            "broken_of_test:Class",
            "'broken_of_test:Class': ModuleNotFoundError: No module named 'no_such_module_at_all'; "
            "is its folder in PYTHONPATH?",
        ),
        ("others_of_test:number", "'others_of_test:number' is 3; expected a class"),
        (
            "others_of_test:Mute",
            "'others_of_test:Mute' makes a others_of_test.Mute, which has no step(observation, inbox, task)",
        ),
        ("exiting_of_test:Class", "'exiting_of_test:Class': SystemExit: 3"),
        (
            ":Still",
            f"':Still' is not known; expected one of: {KNOWN}, module:Class, or policy.pt; did you mean 'still'?",
        ),
    ],
)
@pytest.mark.usefixtures("folder")
def test_unavailable_algorithm_is_reported_in_one_line(hall_scenario, name, line):
    with pytest.raises(ScenarioError) as raised:
        make(hall_scenario, name)
    assert str(raised.value) == f"hall: control.algorithm: {line}"
