"""Scenarios from files, shipped names and overrides."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import load, load_floor_plan, map_names, scenario_names

SCENARIO = """\
name: room
plan:
  name: room
  bounds: {min: [0, 0], max: [10, 8]}
robots: {count: 2, start: [3, 3, 0]}
mission:
  victims:
    - {name: ann, position: [2, 2]}
    - {name: bob, position: [4, 4]}
"""


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(SCENARIO, encoding="utf-8")
    return "room.yaml"


def _message(path: str, *overrides: str) -> str:
    with pytest.raises(ScenarioError) as raised:
        load(path, overrides)
    return str(raised.value)


def test_shipped_scenario_loads_by_name_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scenario = load("garage_sar")
    assert scenario.plan.name == "garage"
    assert [area.name for area in scenario.mission.areas] == [f"area_{i}" for i in range(1, 6)]


def test_shipped_names_are_listed() -> None:
    assert {"garage_sar", "garage_sar_published", "tutorial_arena"} <= set(scenario_names())


def test_published_garage_is_the_garage_with_every_addition_switched_off():
    switches = ("communication.gated=false", "rule_out_places=false", "navigation=straight", "memory_of=commands")
    switches = (*switches, "exclusion.while_approaching=true", "exclusion.min_robots=0", "swarms.min=0")
    garage = load("garage_sar", [f"control.{switch}" for switch in switches])
    assert load("garage_sar_published") == garage.model_copy(update={"name": "garage_sar_published"})
    assert {"garage", "tutorial_arena"} <= set(map_names())


def test_override_of_the_algorithm_drops_the_keys_of_the_file_that_it_lacks(caplog) -> None:
    published = load("garage_sar_published", ["control.algorithm=greedy"]).control
    assert (published.algorithm, published.navigation, published.rule_out_places) == ("greedy", "straight", False)
    assert caplog.messages == [
        "garage_sar_published.yaml: control.communication, control.memory_of, control.exclusion, control.swarms: "
        "dropped, not keys of 'greedy' (--set)"
    ]


def test_override_of_the_algorithm_keeps_overridden_keys_that_are_then_rejected() -> None:
    line = "--set: control.memory_of: unknown key of greedy; known to rdpso, pso, dpso, rpso"
    with pytest.raises(ScenarioError, match=f"^{line}$"):
        load("garage_sar_published", ["control.algorithm=greedy", "control.memory_of=motion"])


def test_override_of_the_algorithm_drops_no_key_that_was_never_one(tmp_path) -> None:
    path = tmp_path / "my.yaml"
    path.write_text("name: my\nplan: garage\nrobots: {start: [3, 3, 0]}\ncontrol: {alfa: 0.5, alpha: 0.5}\n")
    with pytest.raises(ScenarioError, match=r"my.yaml: control.alfa: unknown key"):
        load(path, ["control.algorithm=greedy"])
    assert load("garage_sar", ["control={algorithm: greedy}"]).control.algorithm == "greedy"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("garage_sra", "no shipped scenario of this name; did you mean 'garage_sar'?"),
        ("nowhere/room.yaml", "there is no such file"),
        ("folder/", "Is a directory"),
        ("binary.yaml", "not a text file in UTF-8"),
    ],
)
def test_name_of_no_scenario_is_rejected(room: str, name: str, message: str) -> None:
    Path("folder").mkdir()
    Path("binary.yaml").write_bytes(b"\xff\xfe\x00")
    assert _message(name) == f"{name}: {message}"
    assert _message("") == "the name of the scenario is empty"


def test_override_replaces_a_value_of_the_file(room: str) -> None:
    assert load(room, ["mission.victims.1.position=[1, 2]"]).mission.victims[1].position == (1.0, 2.0)


def test_override_adds_a_section_that_the_file_leaves_out(room: str) -> None:
    scenario = load(room, ["voice.noise_db=20", "run.seed=7"])
    assert (scenario.voice.noise_db, scenario.run.seed) == (20.0, 7)


def test_later_override_wins(room: str) -> None:
    assert load(room, ["run.seed=1", "run.seed=2"]).run.seed == 2


def test_override_reaches_into_an_inline_plan_and_into_a_plan_file() -> None:
    scenario = load("garage_sar", ["plan.doors.1.closed=false"])
    assert [door.closed for door in scenario.plan.doors] == [False, False]
    assert scenario.plan_file is None


def test_plan_given_as_override_is_relative_to_the_current_folder(room: str) -> None:
    Path("hall.yaml").write_text("name: hall\nbounds: {max: [9, 9]}\n", encoding="utf-8")
    Path("folder").mkdir()
    Path("folder/room.yaml").write_text(SCENARIO, encoding="utf-8")
    assert load("folder/room.yaml", ["plan=hall.yaml"]).plan.name == "hall"
    assert _message("folder/room.yaml", "plan=hull.yaml") == "--set: plan: there is no file 'hull.yaml'"


@pytest.mark.parametrize("overrides", ["run.seed=1", {"run.seed": 1}, None, [None], ["run.seed=1", b"run.seed=1"]])
def test_overrides_that_are_not_a_list_are_rejected(overrides: object) -> None:
    with pytest.raises(ScenarioError, match=r"^overrides: .*; expected a list of KEY=VALUE, such as \['run.seed=1'\]$"):
        load("garage_sar", overrides)


@pytest.mark.parametrize("name", [None, 5, b"garage_sar", ["garage_sar"]])
def test_name_of_another_kind_is_rejected(name: object) -> None:
    with pytest.raises(ScenarioError, match=r"^load: .*; expected a file, or the name of a shipped scenario$"):
        load(name)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("voice.nois_db=20", "--set: voice.nois_db: unknown key; did you mean 'noise_db'?"),
        ("voice.noise_db=99", "--set: voice.noise_db: 99 is above 80"),
        ("voice.noise_db=", "--set: voice.noise_db: null is not a number"),
        ("run.seed=1.5", "--set: run.seed: 1.5 is not a whole number"),
        ("voice.noise_db", "--set: 'voice.noise_db' is not of the form KEY=VALUE, such as voice.noise_db=20"),
        ("=3", "--set: '=3' is not of the form KEY=VALUE, such as voice.noise_db=20"),
        ("voice..noise_db=3", "--set: 'voice..noise_db=3' is not of the form KEY=VALUE, such as voice.noise_db=20"),
        ("run.seed=[1", "--set: run.seed: expected ',' or ']', but got '<stream end>'"),
        ("mission.victims.2.name=eve", "--set: mission.victims.2: index 2 out of range (list has 2 items)"),
        ("mission.victims.x.name=eve", "--set: mission.victims.x: 'x' is not an index (list has 2 items)"),
        ("name.short=r", "--set: name.short: name is 'room', not a section"),
        (
            "voice.constant_db.0=-70",
            "--set: voice.constant_db.0: the file has no list voice.constant_db; set the whole list",
        ),
        ("plan.walls=3", "--set: plan.walls: 3 is not a list"),
        ("mission.patrol.graph=no.graph", "--set: mission.patrol.graph: there is no file 'no.graph'"),
        # The file has no control.swarms: what its defaults do not fit is what was set.
        ("control.swarms.min=3", "--set: control.swarms.initial: 1 is below min, 3"),
        ("control.swarms.initial=2", "--set: control.swarms.max: 1 is below initial, 2"),
        ("plan.bounds.max=[-1, 2]", "--set: plan.bounds.max: x -1 is not above min, 0"),
        ("plan.bounds.max=[1e-300, 2]", "--set: plan.bounds.max: x 1e-300 is less than 0.01 m from min, 0"),
    ],
)
def test_wrong_override_is_rejected_with_its_exact_message(room: str, override: str, message: str) -> None:
    assert _message(room, override) == message


def test_mistake_in_the_file_is_not_blamed_on_an_override(room: str) -> None:
    Path(room).write_text(SCENARIO + "voice: {noise_db: 99}\n", encoding="utf-8")
    assert _message(room, "run.seed=3") == "room.yaml: voice.noise_db: 99 is above 80"


def test_further_errors_are_in_the_notes(room: str) -> None:
    Path(room).write_text(SCENARIO + "voice: {noise_db: 99, nois: 1}\nrun: {seed: -1}\n", encoding="utf-8")
    with pytest.raises(ScenarioError) as raised:
        load(room)
    assert [str(raised.value), *raised.value.__notes__] == [
        "room.yaml: voice.nois: unknown key; did you mean 'noise_db'?",
        "room.yaml: voice.noise_db: 99 is above 80",
        "room.yaml: run.seed: -1 is below 0",
    ]


def test_mistake_in_a_plan_file_names_that_file(room: str) -> None:
    Path("hall.yaml").write_text("name: hall\nbounds: {max: [9, 9]}\nwall: []\n", encoding="utf-8")
    Path(room).write_text("name: room\nplan: hall.yaml\nrobots: {start: [3, 3, 0]}\n", encoding="utf-8")
    assert _message(room) == "hall.yaml: wall: unknown key; did you mean 'walls'?"
    with pytest.raises(ScenarioError, match=r"^hall.yaml: wall: unknown key"):
        load_floor_plan("hall.yaml")


def test_shipped_plan_loads_by_name_and_a_missing_one_is_named() -> None:
    assert load_floor_plan("garage").name == "garage"
    with pytest.raises(ScenarioError, match=r"^garaj: no shipped map of this name; did you mean 'garage'"):
        load_floor_plan("garaj")
    with pytest.raises(ScenarioError, match=r"^maps/garaj.yaml: there is no such file$"):
        load_floor_plan("maps/garaj.yaml")


def test_share_folder_of_a_catkin_package_path_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "robotteamsim"
    for name in ("scenarios/garage_sar.yaml", "scenarios/mine.yaml", "maps/garage/plan.yaml"):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(SCENARIO, encoding="utf-8")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{tmp_path}")
    assert load("mine").name == "room"
