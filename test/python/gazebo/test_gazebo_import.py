"""Gazebo worlds as floor plans."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from robotteamsim.gazebo import GazeboImport, export_world, import_world
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import obstacles, solids


@pytest.fixture
def plan_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return what a world given as the text in its <world> is imported as."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))

    def imported(text: str, **options: object) -> GazeboImport:
        Path("a.world").write_text(f'<sdf version="1.6"><world name="w">{text}</world></sdf>', encoding="utf-8")
        return import_world("a.world", **options)

    return imported


def _box(size: str, pose: str = "0 0 0.5 0 0 0", name: str = "collision") -> str:
    geometry = f"<geometry><box><size>{size}</size></box></geometry>"
    return f'<collision name="{name}"><pose>{pose}</pose>{geometry}</collision>'


def _model(collisions: str, pose: str = "", name: str = "house", more: str = "") -> str:
    placed = f"<pose>{pose}</pose>" if pose else ""
    link = f'<link name="link">{collisions}</link>'
    return f'<model name="{name}"><static>true</static>{placed}{more}{link}</model>'


@pytest.mark.parametrize("name", ["garage_sar", "office_manet", "mrl_arena_mapping", "isr_floor_0_sar"])
def test_exported_walls_blocks_and_bounds_come_back_as_they_were(name, tmp_path):
    plan = load(name).plan
    world = tmp_path / "a.world"
    world.write_text(export_world(load(name)).world, encoding="utf-8")
    back = import_world(world).plan
    assert (back.bounds.min, back.bounds.max) == (plan.bounds.min, plan.bounds.max)
    assert len(back.walls) == len(plan.walls)
    for one, other in zip(plan.walls, back.walls, strict=True):
        assert (other.name, other.height_m) == (one.name, pytest.approx(one.height_m))
        assert other.thickness_m == pytest.approx(one.thickness_m, abs=1e-6)
        np.testing.assert_allclose((other.start, other.end), (one.start, one.end), atol=2e-6)
    static = {solid.name: solid for solid in solids(plan) if solid.kind in ("block", "pillar")}
    blocks = [solid for solid in solids(back) if solid.kind in ("block", "pillar")]
    assert len(blocks) == len(static)
    for block in blocks:
        one = static[block.name]
        assert block.kind == one.kind
        assert shapely.hausdorff_distance(block.polygon, one.polygon) < 1e-5


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize(
    "motion", [{}, {"motion": "swing", "angle_rad": -1.2, "time_s": 3.5}, {"motion": "slide", "time_s": 1.0}]
)
def test_exported_doors_come_back_as_they_were(motion, closed, tmp_path):
    garage = load("garage_sar")
    doors = tuple(door.model_copy(update={**motion, "closed": closed}) for door in garage.plan.doors)
    scenario = garage.model_copy(update={"plan": garage.plan.model_copy(update={"doors": doors})})
    world = tmp_path / "a.world"
    world.write_text(export_world(scenario).world, encoding="utf-8")
    back = import_world(world).plan.doors
    for one, other in zip(doors, back, strict=True):
        before, after = (door.model_dump(exclude={"start", "end", "angle_rad"}) for door in (one, other))
        assert after == before
        assert other.leaf_angle_rad == pytest.approx(one.leaf_angle_rad)
        np.testing.assert_allclose((other.start, other.end), (one.start, one.end), atol=2e-6)


def test_upright_boxes_are_walls_along_their_longer_side(plan_of):
    plan = plan_of(_model(_box("0.2 6 2.4", "3 4 1.2 0 0 0"), "1 0 0 0 0 1.5707963267948966")).plan
    (wall,) = plan.walls
    np.testing.assert_allclose(sorted([wall.start, wall.end]), [(-6.0, 3.0), (0.0, 3.0)], atol=1e-6)
    assert (wall.name, wall.thickness_m, wall.height_m) == ("house", 0.2, pytest.approx(2.4))
    assert plan.bounds.min == pytest.approx((-6.0, 2.9))


def test_thick_or_square_boxes_cylinders_and_polylines_are_blocks(plan_of):
    points = "".join(f"<point>{point}</point>" for point in ("0 0", "2 0", "2 2", "1 0.5", "0 0"))
    polyline = f"<geometry><polyline>{points}<height>1</height></polyline></geometry>"
    cylinder = "<geometry><cylinder><radius>0.5</radius><length>2</length></cylinder></geometry>"
    plan = plan_of(
        _model(_box("4 0.9 1"), "9 0 0 0 0 0", "thick")
        + _model(_box("0.5 0.5 1"), "0 9 0 0 0 0", "square")
        + _model(f'<collision name="c">{cylinder}</collision>', "5 5 1 0 0 0", "tank")
        + _model(f'<collision name="c">{polyline}</collision>', "-3 0 0 0 0 0", "star")
    ).plan
    assert plan.walls == ()
    areas = {block.name: shapely.Polygon(block.polygon).area for block in plan.blocks}
    assert areas == {
        "thick": pytest.approx(3.6),
        "square": pytest.approx(0.25),
        "tank": pytest.approx(math.pi * 0.25, rel=0.02),
        "star": pytest.approx(1.5),
    }
    assert {block.name: block.height_m for block in plan.blocks}["tank"] == pytest.approx(2.0)


def test_box_on_its_side_keeps_its_outline(plan_of):
    plan = plan_of(_model(_box("1 3 0.2", "0 0 0.5 0 1.5707963267948966 0"))).plan
    (wall,) = plan.walls
    assert (wall.thickness_m, wall.height_m) == (pytest.approx(0.2), pytest.approx(1.0))
    assert math.dist(wall.start, wall.end) == pytest.approx(3.0)


def test_nested_models_links_and_frames_are_placed_in_each_other(plan_of):
    """By hand: (10, 0) + turn of 90 degrees applied to (1, 2) + (0.5, 0)."""
    inner = (
        f'<model name="room"><pose>1 2 0 0 0 0</pose><link name="l">{_box("4 0.2 1", "0.5 0 0.5 0 0 0")}</link></model>'
    )
    turned = "10 0 0 0 0 1.5707963267948966"
    nested = f'<model name="house"><static>1</static><pose>{turned}</pose>{inner}</model>'
    # The same with named frames: `corner` is at (1, 2), and the link is 0.5 m from it.
    frames = (
        '<frame name="corner"><pose>1 2 0 0 0 0</pose></frame>'
        f'<link name="l"><pose relative_to="corner">0.5 0 0 0 0 0</pose>{_box("4 0.2 1")}</link>'
    )
    named = f'<model name="house"><static>1</static><pose degrees="true">10 0 0 0 0 90</pose>{frames}</model>'
    for text in (nested, named):
        (wall,) = plan_of(text).plan.walls
        np.testing.assert_allclose(sorted([wall.start, wall.end]), [(8.0, -0.5), (8.0, 3.5)], atol=1e-6)


def test_models_are_relative_to_frames_links_and_joints_of_others(plan_of):
    base = _model(_box("4 0.2 1"), "2 0 0 0 0 0", "base")
    joint = '<joint name="j" type="fixed"><parent>world</parent><child>link</child><pose>0 3 0 0 0 0</pose></joint>'
    beside = _box("4 0.2 1").replace("<pose>", '<pose relative_to="j">')
    second = _model(beside, "0 0 0 0 0 0", "second", joint)
    third = _model(_box("4 0.2 1"), "0 7 0 0 0 0", "third").replace("<pose>0 7", '<pose relative_to="base::link">0 7')
    walls = plan_of(base + second + third).plan.walls
    assert [wall.start for wall in walls] == [(0.0, 0.0), (-2.0, 3.0), (0.0, 7.0)]


def test_included_models_come_from_model_folders(plan_of, tmp_path):
    folder = tmp_path / "models" / "shelf"
    folder.mkdir(parents=True)
    for version, length in (("1.4", 1), ("1.6", 5)):
        model = _model(_box(f"{length} 0.4 2"), name="shelf", pose="100 100 0 0 0 0")
        (folder / f"{version}.sdf").write_text(f'<sdf version="{version}">{model}</sdf>')
    files = "".join(f'<sdf version="{version}">{version}.sdf</sdf>' for version in ("1.6", "1.4"))
    (folder / "model.config").write_text(f"<model>{files}</model>")
    include = "<include><uri>model://shelf</uri><name>{}</name><pose>{} 0 0 0 0 0</pose></include>"
    text = include.format("left", 0) + include.format("right", 8)
    plan = plan_of(text, model_folders=[tmp_path / "models"]).plan
    assert [(wall.name, wall.start, wall.end) for wall in plan.walls] == [
        ("left", (-2.5, 0.0), (2.5, 0.0)),
        ("right", (5.5, 0.0), (10.5, 0.0)),
    ]


def test_ground_lintels_and_moving_models_are_not_walls(plan_of):
    found = plan_of(
        "<include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>"
        + _model(_box("9 9 0.02", "0 0 0 0 0 0"), name="slab")
        + _model(_box("4 0.2 1") + _box("1 0.2 0.4", "2.5 0 2.2 0 0 0", "lintel"))
        + _model(_box("1 0.3 1"), name="cart").replace("true", "false")
    )
    assert [wall.name for wall in found.plan.walls] == ["house_1"]
    assert found.notes == (
        "a.world:1: 'house_2': omitted: it begins 2 m above the floor",
        "a.world: omitted, because they are not static: cart",
    )


MESH = "<geometry><mesh><uri>model://ship/hull.dae</uri></mesh></geometry>"


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (
            f'<collision name="hull">{MESH}</collision>',
            "in 'house_2': a mesh 'model://ship/hull.dae' cannot become a wall",
        ),
        (_box("4 0.2 1", "0 0 0.5 0.3 0 0", "hull"), "in 'house_2': it leans; expected vertical sides"),
        (
            '<collision name="hull"><geometry><sphere><radius>1</radius></sphere></geometry></collision>',
            "in 'house_2': a sphere cannot become a wall",
        ),
    ],
)
def test_shape_that_cannot_become_a_wall_is_named_or_refused(plan_of, refused, text, note):
    world = _model(_box("4 0.2 1") + text)
    found = plan_of(world)
    assert len(found.plan.walls) == 1
    assert found.notes == (f"a.world:1: collision 'hull': {note}",)
    assert refused(world, strict=True) == found.notes[0]


def test_missing_model_is_named_or_refused(plan_of, refused):
    world = _model(_box("4 0.2 1")) + "<include><uri>model://../secret</uri></include>"
    note = (
        "a.world:1: include: there is no model 'model://../secret'; expected a folder with it in --models or "
        "GAZEBO_MODEL_PATH"
    )
    assert plan_of(world).notes == (note,)
    assert refused(world, strict=True) == note


def test_walls_of_equal_names_get_numbers(plan_of):
    plan = plan_of(_model(_box("4 0.2 1")) + _model(_box("4 0.2 1"), "0 3 0 0 0 0")).plan
    assert [wall.name for wall in plan.walls] == ["house", "house_2"]
    assert obstacles(plan).area == pytest.approx(1.6)


@pytest.fixture
def refused(plan_of):
    """Return the one line with which a world is refused."""
    from robotteamsim.errors import ScenarioError

    def message(text: str, **options: object) -> str:
        with pytest.raises(ScenarioError) as caught:
            plan_of(text, **options)
        assert "\n" not in str(caught.value)
        return str(caught.value)

    return message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<model", "a.world:1: not XML: not well-formed (invalid token)"),
        ("", "a.world: no static box, cylinder or polyline stands on the floor"),
        (_model(_box("4 0.2")), "a.world:1: size: '4 0.2' is not 3 numbers"),
        (_model(_box("4 -0.2 1")), "a.world:1: size: '4 -0.2 1' is not above 0"),
        (_model(_box("nan 1 1")), "a.world:1: size: 'nan 1 1' is beyond 1000000"),
        (_model(_box("1 1 1", "0 0 0")), "a.world:1: pose: '0 0 0' is not 6 numbers"),
        (_model("<collision name='c'/>"), "a.world:1: collision 'c': <geometry> is missing"),
        (_model(_box("1 1 1")).replace("true", "yes"), "a.world:1: static: 'yes' is not true or false"),
        (
            _model(_box("4 0.2 1")).replace("<pose>", '<pose relative_to="lost">'),
            "a.world:1: collision 'collision': there is no frame 'lost' that its pose could be relative to",
        ),
        (
            _model(_box("4 0.2 1"), "0 0 0 0 0 0", "me").replace("<pose>0 0 0 0 0 0", '<pose relative_to="me">'),
            "a.world:1: model 'me': frame 'me' is relative to itself",
        ),
        (_model(_box("2000 0.2 1")), "a.world: bounds.max: x 1000 is more than 1000 m from min, -1000"),
    ],
)
def test_mistake_is_one_line_with_its_place(refused, text, message):
    assert refused(text) == message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "b.world:1: not XML: no element found"),
        ("<robot/>", "b.world:1: <robot> is not a world of Gazebo; expected <sdf>"),
        ("<sdf/>", "b.world:1: sdf: has neither a <world> nor a <model>"),
        ("<sdf>\n<world/><world/></sdf>", "b.world:2: world: b.world has 2 worlds; expected one"),
        ("<sdf>" * 60 + "</sdf>" * 60, "b.world:1: nested more than 50 levels deep"),
        ("<sdf>" + "<a/>" * 200_000 + "</sdf>", "b.world:1: more than 200000 elements"),
    ],
)
def test_file_that_is_not_a_world_is_refused(tmp_path, monkeypatch, text, message):
    from robotteamsim.errors import ScenarioError

    monkeypatch.chdir(tmp_path)
    Path("b.world").write_text(text)
    with pytest.raises(ScenarioError) as caught:
        import_world("b.world")
    assert str(caught.value) == message


def test_entities_are_refused_before_they_expand(tmp_path, monkeypatch):
    from robotteamsim.errors import ScenarioError

    monkeypatch.chdir(tmp_path)
    bomb = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10 if i else "lol" * 10}">' for i in range(12))
    for declared in (bomb, '<!ENTITY e11 SYSTEM "file:///etc/passwd">'):
        Path("b.world").write_text(f"<?xml version='1.0'?>\n<!DOCTYPE sdf [{declared}]><sdf>&e11;</sdf>")
        with pytest.raises(ScenarioError, match=r"^b\.world:2: <!DOCTYPE> is not supported; expected plain SDF$"):
            import_world("b.world")


def test_models_that_include_each_other_are_refused(plan_of, refused, tmp_path):
    folder = tmp_path / "twin"
    folder.mkdir()
    include = "<include><uri>model://twin</uri></include>"
    (folder / "model.sdf").write_text(f'<sdf><model name="twin"><static>1</static>{include}</model></sdf>')
    assert refused(include) == "twin/model.sdf:1: include: more than 10 models include each other"
    (folder / "model.sdf").write_text(f'<sdf><model name="twin"><static>1</static>{include * 5}</model></sdf>')
    assert refused(include).startswith("twin/model.sdf:1: include: more than 10")
