"""Tables of the layers of a drawing: which are walls, windows and doors."""

from __future__ import annotations

from pathlib import Path

import ezdxf
import pytest
from ezdxf import units

from robotteamsim.cli import main
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load_floor_plan
from robotteamsim.scenario.sections import Radio


@pytest.fixture
def house(tmp_path, monkeypatch) -> Path:
    """A room of 6 x 4 m whose walls are 0.2 m thick, with a door of 0.9 m, a gap of that width, a window of 1.8 m."""
    monkeypatch.chdir(tmp_path)
    document = ezdxf.new(setup=True)
    document.units = units.M
    space = document.modelspace()
    faces = [[(0, 0), (6, 0)], [(0, 0.2), (6, 0.2)], [(0, 4), (0.5, 4)], [(1.4, 4), (4, 4)], [(5.8, 4), (6, 4)]]
    faces += [[(0, 3.8), (0.5, 3.8)], [(1.4, 3.8), (4, 3.8)], [(5.8, 3.8), (6, 3.8)], [(0, 0), (0, 4)]]
    faces += [
        [(0.2, 0.2), (0.2, 3.8)],
        [(5.8, 0.2), (5.8, 1)],
        [(5.8, 1.9), (5.8, 3.8)],
        [(6, 0), (6, 1)],
        [(6, 1.9), (6, 4)],
    ]
    faces += [[(x, 3.8), (x, 4)] for x in (0.5, 1.4, 4, 5.8)] + [[(5.8, y), (6, y)] for y in (1, 1.9)]
    for ends in faces:
        space.add_line(*ends, dxfattribs={"layer": "A-WALL"})
    for y in (3.85, 3.95):
        space.add_line((4, y), (5.8, y), dxfattribs={"layer": "A-GLAZ"})
    space.add_line((0.5, 3.8), (0.5, 2.9), dxfattribs={"layer": "A-DOOR"})
    space.add_arc((0.5, 3.8), 0.9, 270, 360, dxfattribs={"layer": "A-DOOR"})
    space.add_line((2, 2), (3, 2), dxfattribs={"layer": "A-FURN"})
    space.add_text("ROOM", dxfattribs={"layer": "A-ANNO-ROOM"})
    document.saveas("house.dxf")
    return tmp_path


def failed(capsys, text: str) -> str:
    """Return the message of an import with a table that is wrong."""
    Path("my.yaml").write_text(text, encoding="utf-8")
    assert main(["plan", "import", "house.dxf", "--layers", "my.yaml"]) == 2
    assert not Path("plan.yaml").exists()
    return capsys.readouterr().err.strip()


@pytest.mark.usefixtures("house")
def test_layers_are_guessed_by_their_names_and_written_as_a_table(capsys):
    assert main(["plan", "import", "house.dxf", "--out", "room.yaml"]) == 0
    out, err = capsys.readouterr()
    assert "layers by their names: door: A-DOOR; wall: A-WALL; window: A-GLAZ; 1 other ignored\n" in err
    assert "room.layers.yaml: what was guessed; correct it for another import\n" in out
    lines = [line for line in Path("room.layers.yaml").read_text().splitlines() if not line.startswith("#")]
    assert [line.split("  # ")[0] for line in lines] == [
        '"A-DOOR": {kind: door}',
        '"A-FURN": {kind: ignore}',
        '"A-GLAZ": {kind: window}',
        '"A-WALL": {kind: wall}',
    ]
    assert lines[1].endswith("  # 1 line, 1 x 0 units")
    first = Path("room.yaml").read_bytes()
    again = ["plan", "import", "house.dxf", "--layers", "room.layers.yaml", "--out", "room.yaml", "--force"]
    assert main(again) == 0
    assert Path("room.yaml").read_bytes() == first


@pytest.mark.usefixtures("house")
def test_door_is_in_the_gap_that_its_layer_shows_and_the_window_is_glass():
    assert main(["plan", "import", "house.dxf"]) == 0
    plan = load_floor_plan("plan.yaml")
    (door,) = plan.doors  # the gap in the right wall has no door in the drawing
    assert sorted([door.start[0], door.end[0]]) == pytest.approx([1.5, 2.4], abs=0.03)
    (window,) = [wall for wall in plan.walls if wall.material == "glass"]
    assert sorted([window.start, window.end]) == [(5.0, 4.9), (6.8, 4.9)]
    assert window.thickness_m == pytest.approx(0.1)
    assert [layer.of for material in plan.materials for layer in material.layers] == ["glass"]


@pytest.mark.usefixtures("house")
def test_material_of_a_layer_has_the_thickness_of_its_walls():
    Path("my.yaml").write_text(
        "a-wall: {kind: wall, material: brick}\nA-FURN: {kind: wall, material: brick, thickness_m: 0.24}"
    )
    assert main(["plan", "import", "house.dxf", "--layers", "my.yaml"]) == 0
    plan = load_floor_plan("plan.yaml")
    assert {wall.thickness_m: wall.material for wall in plan.walls} == {0.2: "brick 0.2 m", 0.24: "brick 0.24 m"}
    radio = Radio.model_validate({"walls": "material", "frequency_mhz": 2450.0})
    empty = plan.model_copy(update={"walls": (), "blocks": ()})
    losses_db = [RadioField(one, radio).path_loss_db((3.5, 2.5), (3.5, 3.5)) for one in (plan, empty)]
    assert losses_db[0] - losses_db[1] == pytest.approx(6.4, abs=0.1)  # 240 mm of brick, ITU-R P.2040-3


@pytest.mark.usefixtures("house")
def test_part_of_a_door_layer_without_a_gap_is_a_warning(capsys):
    Path("my.yaml").write_text("{A-WALL: {kind: wall}, A-DOOR: {kind: door}, A-FURN: {kind: door}}")
    assert main(["plan", "import", "house.dxf", "--layers", "my.yaml"]) == 0
    assert "1 part of the layers of doors in no gap of 0.6 to 1.6 m along the axes" in capsys.readouterr().err


@pytest.mark.usefixtures("house")
def test_table_is_written_if_no_layer_is_called_a_wall_and_is_only_replaced_with_force(capsys):
    document = ezdxf.readfile("house.dxf")
    for part in document.modelspace().query("*[layer=='A-WALL' | layer=='A-GLAZ']"):
        part.dxf.layer = "Ebene 1"
    document.saveas("house.dxf")
    assert main(["plan", "import", "house.dxf"]) == 2
    table = Path("plan.layers.yaml").read_text(encoding="utf-8")
    assert '"Ebene 1": {kind: ignore}  # 22 lines, 6 x 4 units\n' in table
    assert "house.dxf: no layer of walls has lines; found A-DOOR (" in capsys.readouterr().err
    Path("plan.layers.yaml").write_text("mine")
    assert main(["plan", "import", "house.dxf"]) == 2
    assert "plan.layers.yaml already exists and is not replaced; --force replaces it" in capsys.readouterr().err
    assert Path("plan.layers.yaml").read_text() == "mine"
    assert main(["plan", "import", "house.dxf", "--force"]) == 2
    assert Path("plan.layers.yaml").read_text(encoding="utf-8") == table


@pytest.mark.usefixtures("house")
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("A-WALLS: {kind: wall}", "A-WALLS: house.dxf has no layer of this name; did you mean 'A-WALL'?"),
        ("A-WALL: {kind: wal}", "A-WALL.kind: 'wal' is not one of wall, door, window, ignore; did you mean 'wall'?"),
        ("A-WALL: {kind: wall, material: bricks}", "A-WALL.material: 'bricks' is not one of air, concrete, "),
        ("A-WALL: {kind: wall, thickness_m: 2}", "A-WALL.thickness_m: 2 is above 0.8"),
        ("A-DOOR: {kind: door, material: wood}", "A-DOOR.material: not allowed for a layer of kind door"),
        ("A-WALL: wall", "A-WALL: 'wall' is not a section, such as {kind: wall}"),
        ("A-WALL: {kind: wall}\na-wall: {kind: wall}", "a-wall: named twice; upper and lower case do not matter"),
        ("", "file is empty; expected a table of layers"),
    ],
)
def test_mistake_in_a_table_is_one_line_with_file_and_layer(capsys, text, message):
    line = failed(capsys, text)
    assert line.startswith(f"robotteamsim: my.yaml: {message}")
    assert "\n" not in line
