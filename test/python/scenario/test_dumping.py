"""A dumped scenario is read back as it was."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotteamsim.scenario import FloorPlan, Scenario, dump, load, load_floor_plan, write_floor_plan
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.door_places import misplaced_doors
from robotteamsim.scenario.floor_plan import BayRow, Block, Bounds, Door, Wall
from robotteamsim.scenario.sections import Area, Laser, Mission, PlacedRobot, Radio, Run, Team, Victim, Voice
from robotteamsim.scenario.yaml_text import parse

TEXT = st.text(
    st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"]), min_size=1, max_size=12
) | st.sampled_from(["1e6", "on", "null", "2001-01-01", "~", "- a", "a: b", "#", "0x1", "1_0", " ", "'"])
NUMBER = st.floats(-1e6, 1e6, allow_nan=False)
POINT = st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 100.0))
POSE = st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 100.0), st.floats(-6.28, 6.28))
MOTION = st.sampled_from([{}, {"motion": "swing", "angle_rad": -1.0}, {"motion": "slide", "time_s": 3.0}])
DOOR_KIND = st.sampled_from(["normal", "fireproof"])
MEMORY = st.sampled_from(["published", "grunwald_letnikov"])
LOSS_DB = st.floats(-200.0, 200.0)
TENTHS = st.integers(0, 1000).map(lambda tenths: tenths / 10)


@st.composite
def plans(draw: st.DrawFn) -> FloorPlan:
    names = iter(draw(st.lists(TEXT, min_size=9, max_size=9, unique=True)))
    ends = st.tuples(POINT, POINT).filter(lambda pair: pair[0] != pair[1])
    walls = [
        Wall(name=next(names), start=a, end=b, material=draw(st.none() | st.just("brick")))
        for a, b in draw(st.lists(ends, max_size=3))
    ]
    doors = [
        Door(name=next(names), start=a, end=b, kind=draw(DOOR_KIND), closed=draw(st.booleans()), **draw(MOTION))
        for a, b in [((0.0, a[1]), (1.0 + b[0] / 2.0, b[1])) for a, b in draw(st.lists(ends, max_size=3))]
    ]
    blocks = [
        Block(name=next(names), kind="pillar", polygon=((x, y), (x + 1.0, y), (x + 1.0, y + 0.5)))
        for x, y in draw(st.lists(st.tuples(st.floats(0.0, 99.0), st.floats(0.0, 99.0)), max_size=2))
    ]
    bays = [BayRow(start=a, end=b, count=3) for a, b in draw(st.lists(ends, max_size=1))]
    plan = FloorPlan(
        name=draw(TEXT), bounds=Bounds(max=(100.0, 100.0)), walls=walls, doors=doors, blocks=blocks, bays=bays
    )
    in_walls = {index for index, _ in misplaced_doors(plan)}
    return plan.model_copy(update={"doors": tuple(door for i, door in enumerate(plan.doors) if i not in in_walls)})


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    team = st.builds(Team, count=st.integers(1, 3000), start=POSE, start_poses=st.lists(POSE, max_size=3))
    robots = st.lists(
        st.builds(PlacedRobot, start_pose=POSE, laser=st.builds(Laser, beams=st.integers(1, 999))), min_size=1
    )
    areas = st.lists(st.builds(Area, name=TEXT, center=POINT), max_size=3, unique_by=lambda area: area.name)
    victims = st.lists(st.builds(Victim, name=TEXT, position=POINT), max_size=3, unique_by=lambda victim: victim.name)
    return Scenario(
        name=draw(TEXT),
        plan=draw(plans()),
        robots=draw(team | robots.map(tuple)),
        radio=Radio(materials=draw(st.dictionaries(TEXT, TENTHS, max_size=2)) | {"brick": 6.0}),
        voice=Voice(noise_db=draw(st.floats(0.0, 80.0)), constant_db=tuple(sorted(draw(st.tuples(LOSS_DB, LOSS_DB))))),
        control=RdpsoControl(alpha=draw(st.floats(0.0, 1.0)), memory=draw(MEMORY)),
        mission=Mission(areas=draw(areas), victims=draw(victims), autostart=draw(st.booleans())),
        run=Run(seed=draw(st.integers(0, 2**53))),
    )


@pytest.mark.slow
@settings(max_examples=60)
@given(scenarios())
def test_dumped_scenario_validates_to_an_equal_one(scenario: Scenario) -> None:
    assert Scenario.model_validate(parse(dump(scenario), "dump")) == scenario


@pytest.mark.slow
@settings(max_examples=30)
@given(plan=plans())
def test_written_floor_plan_is_read_back_equal(plan: FloorPlan, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    write_floor_plan(plan, path)
    assert load_floor_plan(path) == plan


def test_dump_names_a_shipped_map_and_load_finds_it(tmp_path: Path) -> None:
    scenario = load("garage_sar", ["voice.noise_db=20"])
    text = dump(scenario)
    assert "\nplan: garage\n" in text
    (tmp_path / "dumped.yaml").write_text(text, encoding="utf-8")
    assert load(tmp_path / "dumped.yaml") == scenario


def test_dump_names_another_plan_file_by_its_path(tmp_path: Path) -> None:
    (tmp_path / "hall.yaml").write_text("name: hall\nbounds: {max: [9, 9]}\n", encoding="utf-8")
    (tmp_path / "a.yaml").write_text("name: a\nplan: hall.yaml\nrobots: {start: [3, 3, 0]}\n", encoding="utf-8")
    scenario = load(tmp_path / "a.yaml")
    assert f"\nplan: {tmp_path / 'hall.yaml'}\n" in dump(scenario)


def test_dump_writes_a_changed_plan_itself() -> None:
    scenario = load("garage_sar")
    smaller = scenario.model_copy(update={"plan": scenario.plan.model_copy(update={"doors": ()})})
    assert "\nplan:\n  name: garage\n" in dump(smaller)
