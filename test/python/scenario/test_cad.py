"""Drawings of CAD programs as floor plans."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf import units
from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace

from robotteamsim.cli import main
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load_floor_plan, solids
from robotteamsim.scenario.sections import Radio

LITTLE_MEMORY = """
import resource, sys
import ezdxf
from robotteamsim.cli import command_line, main
with open("/proc/self/statm") as file:
    used = int(file.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 60 * 2**20,) * 2)
sys.exit(main(["plan", "import", sys.argv[1], "--layers", "walls.yaml"]))
"""
"""Leaves 60 MiB for a drawing."""

ROOM_MM = [(0, 0), (6000, 0), (6000, 4000), (0, 4000)]


def new(unit: units.InsertUnits = units.InsertUnits.Meters) -> tuple[Drawing, Modelspace]:
    document = ezdxf.new(setup=True)
    document.units = unit
    return document, document.modelspace()


def walls_of(document: Drawing, *arguments: str) -> list[tuple]:
    """Import layer WALLS and return start, end and thickness of each wall, relative to the lower left line end."""
    document.saveas("drawing.dxf")
    assert (
        main(["plan", "import", "drawing.dxf", "--layers", "walls.yaml", "--out", "o.yaml", "--force", *arguments]) == 0
    )
    plan = load_floor_plan("o.yaml")
    lines = [(np.subtract(wall.start, 1.0), np.subtract(wall.end, 1.0), wall.thickness_m) for wall in plan.walls]
    return sorted((*sorted((tuple(start.tolist()), tuple(end.tolist()))), thickness) for start, end, thickness in lines)


@pytest.fixture
def drawing(tmp_path, monkeypatch) -> Path:
    """A room of 6 x 4 m in mm, far from the origin, with a block, a curve, a gap, text and a dimension line."""
    monkeypatch.chdir(tmp_path)
    document = ezdxf.new(setup=True)
    document.units = units.MM
    space = document.modelspace()
    walls = {"layer": "WALLS"}

    def at(x: float, y: float) -> tuple[float, float]:
        return 250_000.0 + x, 70_000.0 + y

    space.add_lwpolyline([at(*point) for point in ROOM_MM], close=True, dxfattribs=walls)
    space.add_line(at(3000, 0), at(3000, 1500), dxfattribs=walls)
    space.add_line(at(3000, 2500), at(3000, 4000), dxfattribs=walls)
    pillar = document.blocks.new("PILLAR")
    pillar.add_lwpolyline([(0, 0), (300, 0), (300, 300), (0, 300)], close=True)  # on layer 0
    space.add_blockref("PILLAR", at(5000, 2000), dxfattribs={"layer": "PILLARS"})
    space.add_arc(at(3000, 2500), 1000, 270, 360, dxfattribs={"layer": "DOORS"})
    space.add_text("KITCHEN", dxfattribs=walls).set_placement(at(500, 500))
    space.add_linear_dim(at(0, -500), at(0, 0), at(6000, 0), dxfattribs=walls).render()
    document.saveas("room.dxf")
    Path("walls.yaml").write_text("WALLS: {kind: wall}\n")
    return tmp_path


def failed(capsys, *arguments: str) -> str:
    status = main(["plan", "import", *arguments])
    assert status == 2
    return capsys.readouterr().err.strip().splitlines()[-1]


def test_lines_of_the_layers_are_walls_where_the_drawing_has_them(drawing, capsys):
    Path("walls.yaml").write_text("WALLS: {kind: wall, thickness_m: 0.12}")
    assert main(["plan", "import", "room.dxf", "--layers", "walls.yaml"]) == 0
    plan = load_floor_plan("plan.yaml")
    assert len(plan.walls) == 6
    assert plan.bounds.max == (8.0, 6.0)
    room = shapely.union_all([solid.polygon for solid in solids(plan)])
    # Its lower left corner is 1 m from that of the plan; half a wall is outside, half inside.
    assert room.bounds == pytest.approx((0.94, 0.94, 7.06, 5.06), abs=0.07)
    for x, y, is_wall in ((4.0, 2.0, True), (4.0, 3.0, False), (7.0, 3.0, True), (1.7, 1.7, False)):
        assert room.intersects(shapely.Point(x, y)) == is_wall


def test_blocks_have_the_layer_where_they_are_inserted(drawing):
    Path("walls.yaml").write_text("{WALLS: {kind: wall}, PILLARS: {kind: wall}}")
    assert main(["plan", "import", "room.dxf", "--layers", "walls.yaml", "--out", "both.yaml"]) == 0
    plan = load_floor_plan("both.yaml")
    assert (len(plan.walls), len(plan.blocks)) == (6, 1)  # a closed outline of 0.3 m is solid
    assert shapely.Polygon(plan.blocks[0].polygon).area == pytest.approx(0.09)


def test_layer_0_in_a_block_is_the_layer_of_the_nearest_reference(drawing):
    # ezdxf 1.4, "Notes on Rendering DXF Content": part on layer 0 in a block on layer A is drawn as on A.
    document, space = new()
    piece = document.blocks.new("PIECE")
    piece.add_line((0, 0), (4, 0))
    house = document.blocks.new("HOUSE")
    for layer, y in (("WALLS", 0), ("0", 2), ("FURNITURE", 4)):
        house.add_blockref("PIECE", (0, y), dxfattribs={"layer": layer})
    space.add_blockref("HOUSE", (0, 0), dxfattribs={"layer": "OTHER"})
    assert walls_of(document) == [((0.0, 0.0), (4.0, 0.0), 0.1)]
    space.add_blockref("HOUSE", (0, 10), dxfattribs={"layer": "WALLS"})
    assert [start for start, *_ in walls_of(document)] == [(0.0, 0.0), (0.0, 10.0), (0.0, 12.0)]


def test_layers_do_not_depend_on_case_and_invisible_parts_are_no_walls(drawing):
    document, space = new()
    space.add_line((0, 0), (4, 0), dxfattribs={"layer": "Walls"})
    space.add_line((0, 2), (4, 2), dxfattribs={"layer": "walls"})
    space.add_line((0, 4), (4, 4), dxfattribs={"layer": "WALLS", "invisible": 1})
    assert len(walls_of(document)) == 2


@pytest.mark.parametrize("kind", ["LWPOLYLINE", "const", "POLYLINE"])
def test_width_of_a_polyline_is_the_thickness_of_its_walls(drawing, kind):
    document, space = new()
    walls = {"layer": "WALLS"}
    if kind == "LWPOLYLINE":
        points = [(0, 0, 0.3, 0.3), (5, 0, 0.2, 0.2), (5, 4, 9, 9)]
        space.add_lwpolyline(points, format="xyse", dxfattribs=walls)
    elif kind == "const":
        space.add_lwpolyline([(0, 0), (5, 0), (5, 4)], dxfattribs={**walls, "const_width": 0.3})
    else:
        widths = {"default_start_width": 0.3, "default_end_width": 0.3}
        space.add_polyline2d([(0, 0), (5, 0), (5, 4)], dxfattribs={**walls, **widths})
    second_m = 0.2 if kind == "LWPOLYLINE" else 0.3
    assert walls_of(document) == [((0.0, 0.0), (5.0, 0.0), 0.3), ((5.0, 0.0), (5.0, 4.0), second_m)]


def test_polyline_wider_than_a_wall_is_a_block_and_a_curved_one_keeps_its_width(drawing):
    document, space = new()
    space.add_lwpolyline([(0, 0), (5, 0)], dxfattribs={"layer": "WALLS", "const_width": 1.2})
    space.add_lwpolyline([(0, 5, 1), (4, 5, 0)], format="xyb", dxfattribs={"layer": "WALLS", "const_width": 0.3})
    assert {thickness for *_, thickness in walls_of(document)} == {0.3}
    (block,) = load_floor_plan("o.yaml").blocks
    assert shapely.Polygon(block.polygon).area == pytest.approx(5 * 1.2)


def test_control_points_of_a_smoothed_polyline_are_no_walls(drawing):
    # DXF reference, VERTEX: flag 8 is on the curve, flag 16 a control point of its frame.
    document, space = new()
    polyline = space.add_polyline2d([(2, 2), (5, 7), (8, 2)], dxfattribs={"layer": "WALLS", "flags": 4})
    for vertex in polyline.vertices:
        vertex.dxf.flags = 16
    polyline.append_vertices([(2, 2), (5, 4.5), (8, 2)], dxfattribs={"flags": 8})
    assert [(start, end) for start, end, _ in walls_of(document)] == [((0, 0), (3, 2.5)), ((3, 2.5), (6, 0))]


@pytest.mark.parametrize("angle_deg", [0.0, 17.0])
def test_parallel_lines_are_the_faces_of_one_wall(drawing, angle_deg):
    document, space = new()
    rooms = [*zip(ROOM_MM, [*ROOM_MM[1:], ROOM_MM[0]], strict=True), *(((x, 0), (x, 4000)) for x in (2900, 3100))]
    turn = np.exp(1j * np.radians(angle_deg))
    for ends in rooms:
        one, other = (complex(*end) / 1000.0 * turn for end in ends)
        space.add_line((one.real, one.imag), (other.real, other.imag), dxfattribs={"layer": "WALLS"})
    thickness = [thickness for *_, thickness in walls_of(document)]
    assert sorted(thickness) == [0.1, 0.1, 0.1, 0.1, 0.2]
    plan = load_floor_plan("o.yaml")
    empty = plan.model_copy(update={"walls": ()})
    across = [(x + 2j) * turn - complex(*plan.drawing_offset_m) for x in (2, 5)]
    ends = [(place.real, place.imag) for place in across]
    loss_db = [RadioField(one, Radio()).path_loss_db(*ends) for one in (plan, empty)]
    assert loss_db[0] - loss_db[1] == pytest.approx(3.8)  # one wall up to 20 cm, Table 3


def test_doors_that_are_not_found_because_the_walls_are_turned_are_a_warning(drawing, capsys):
    for angle_deg in (0.0, 17.0):
        document, space = new()
        turn = np.exp(1j * np.radians(angle_deg))
        for ends in (((0, 0), (4, 0)), ((5, 0), (9, 0)), ((0, 0), (0, 5)), ((9, 0), (9, 5)), ((0, 5), (9, 5))):
            one, other = (complex(*end) * turn for end in ends)
            space.add_line((one.real, one.imag), (other.real, other.imag), dxfattribs={"layer": "WALLS"})
        walls_of(document, "--doors")
        doors, lines = load_floor_plan("o.yaml").doors, capsys.readouterr().err.splitlines()
        assert len(doors) == (1 if angle_deg == 0.0 else 0)
        assert any("and most walls are turned from these" in line for line in lines) == (angle_deg > 0.0)


def test_wall_system_of_faces_with_corners_junctions_and_openings_is_what_was_drawn(drawing):
    # An independent way: the outline of a union of boxes, without the lines at the ends of walls in the opening.
    boxes = [(0, 0, 8, 0.3), (0, 5.7, 8, 6), (0, 0, 0.3, 6), (7.7, 0, 8, 6), (4, 0, 4.12, 6), (0, 3, 4, 3.12)]
    drawn = shapely.union_all(shapely.box(*np.array(boxes).T)) - shapely.box(1, 2.5, 1.9, 3.5)
    document, space = new()
    for ring in shapely.get_parts(drawn.boundary):
        for one, other in zip(ring.coords[:-1], ring.coords[1:], strict=True):
            if {one[0], other[0]} not in ({1.0}, {1.9}):
                space.add_line(one, other, dxfattribs={"layer": "WALLS"})
    walls_of(document)
    found = shapely.union_all([solid.polygon for solid in solids(load_floor_plan("o.yaml"))])
    assert shapely.symmetric_difference(found, shapely.transform(drawn, lambda xy: xy + 1.0)).area < 1e-3


def test_line_from_wall_to_wall_of_a_room_is_not_a_face(drawing):
    document, space = new()
    for x in (0.0, 0.61, 1.3):
        space.add_line((x, 0), (x, 3), dxfattribs={"layer": "WALLS"})
    assert len(walls_of(document)) == 3


def test_what_is_left_out_is_counted(drawing, capsys):
    document, space = new()
    walls = {"layer": "WALLS"}
    space.add_line((0, 0), (4, 0), dxfattribs=walls)
    space.add_line((0, 3), (0.005, 3), dxfattribs=walls)
    space.add_solid([(0, 0), (1, 0), (0, 1)], dxfattribs=walls)
    space.add_hatch(dxfattribs=walls).paths.add_polyline_path([(0, 0), (1, 0), (1, 1)])
    space.add_hatch(dxfattribs={"layer": "OTHER"}).paths.add_polyline_path([(0, 0), (1, 0), (1, 1)])
    space.add_text("HALL", dxfattribs=walls)
    document.add_xref_def("kitchen.dxf", "KITCHEN")
    space.add_blockref("KITCHEN", (0, 0))
    space.add_blockref("NOWHERE", (0, 0))
    assert len(walls_of(document)) == 1
    counts = "1 of 2 lines, shorter than 0.01 m, 1 HATCH on WALLS, 1 SOLID on WALLS"
    absent = "attached drawing 'kitchen.dxf', missing block 'NOWHERE'"
    left_out, open_walls = capsys.readouterr().err.splitlines()
    assert left_out == f"robotteamsim: warning: left out: {counts}, {absent}"
    assert "the walls enclose no floor" in open_walls
    Path("other.yaml").write_text("OTHER: {kind: wall}")
    line = failed(capsys, "drawing.dxf", "--layers", "other.yaml")
    layers = f"OTHER (1 HATCH), WALLS (2 lines, 4 x 3 units, 1 HATCH, 1 SOLID), {absent}"
    assert line.endswith(f"drawing.dxf: no layer of walls has lines; found {layers}")


def test_part_of_an_unknown_kind_is_counted(drawing, capsys):
    document, space = new()
    space.add_line((0, 0), (4, 0), dxfattribs={"layer": "WALLS"})
    document.saveas("strange.dxf")
    text = Path("strange.dxf").read_text(encoding="utf-8")
    head, kind = "  2\nENTITIES\n", "  0\nPLANESURFACE\n  5\n{}\n100\nAcDbEntity\n  8\nWALLS\n"
    parts = kind.format("FFE") + kind.format("FFF") + " 60\n1\n"  # the second one is invisible
    Path("strange.dxf").write_text(text.replace(head, head + parts), encoding="utf-8")
    assert main(["plan", "import", "strange.dxf", "--layers", "walls.yaml"]) == 0
    assert capsys.readouterr().err.splitlines()[0] == "robotteamsim: warning: left out: 1 PLANESURFACE on WALLS"


def test_small_and_vast_drawings_ask_for_their_unit(drawing, capsys):
    document, space = new(units.InsertUnits.Millimeters)
    space.add_line((0, 0), (30, 0), dxfattribs={"layer": "WALLS"})
    space.add_line((0, 0), (0, 20), dxfattribs={"layer": "WALLS"})
    walls_of(document)
    assert "warning: the walls are 0.03 x 0.02 m; is $INSUNITS wrong?" in capsys.readouterr().err
    walls_of(document, "--metres-per-unit", "1")
    assert "wrong" not in capsys.readouterr().err
    line = failed(capsys, "drawing.dxf", "--layers", "walls.yaml", "--metres-per-unit", "100", "--force")
    assert line.endswith("; the walls are 3e+03 x 2e+03 m; is --metres-per-unit wrong?")
    line = failed(capsys, "drawing.dxf", "--layers", "walls.yaml", "--metres-per-unit", "1e-5", "--force")
    assert "0 of 2 lines are at least 0.01 m long; the walls are 0.0003 x 0.0002 m; is" in line


def test_offset_of_survey_coordinates_is_printed_and_stored(drawing, capsys):
    document, space = new()
    space.add_line((3512345.25, 5400123.5), (3512349.25, 5400123.5), dxfattribs={"layer": "WALLS"})
    assert walls_of(document) == [((0.0, 0.0), (4.0, 0.0), 0.1)]
    assert load_floor_plan("o.yaml").drawing_offset_m == (3512344.25, 5400122.5)
    assert "[0, 0] is [3512344.25, 5400122.5] m in the drawing" in capsys.readouterr().out


def test_an_existing_plan_is_only_replaced_with_force(drawing, capsys):
    Path("o.yaml").write_text("mine")
    line = failed(capsys, "room.dxf", "--layers", "walls.yaml", "--out", "o.yaml")
    assert line.endswith("o.yaml already exists; choose another name with --out, or --force replaces it")
    assert Path("o.yaml").read_text() == "mine"
    assert main(["plan", "import", "room.dxf", "--layers", "walls.yaml", "--out", "o.yaml", "--force"]) == 0
    assert load_floor_plan("o.yaml").walls


def test_gaps_between_walls_become_doors_on_request(drawing, capsys):
    command = ["plan", "import", "room.dxf", "--layers", "walls.yaml", "--doors", "--png", "import.png"]
    assert main(command) == 0
    (door,) = load_floor_plan("plan.yaml").doors
    np.testing.assert_allclose(sorted([door.start, door.end]), [(4.0, 2.5), (4.0, 3.5)], atol=0.03)
    assert Path("import.png").stat().st_size > 1000


def test_unit_of_the_file_can_be_replaced(drawing):
    command = ["plan", "import", "room.dxf", "--layers", "walls.yaml", "--metres-per-unit", "0.002"]
    assert main(command) == 0
    assert load_floor_plan("plan.yaml").bounds.max == (14.0, 10.0)


def test_file_without_units_needs_a_scale(drawing, capsys):
    document = ezdxf.readfile("room.dxf")
    document.units = units.InsertUnits.Unitless
    document.saveas("unitless.dxf")
    line = failed(capsys, "unitless.dxf", "--layers", "walls.yaml")
    assert line.endswith("names no known unit ($INSUNITS 0); give its scale with --metres-per-unit")


def test_what_the_reader_repairs_is_not_printed(drawing):
    text = Path("room.dxf").read_text(encoding="utf-8")
    Path("odd.dxf").write_text(text.replace("ENDTAB", "ENDTABLE", 1), encoding="utf-8")
    command = [sys.executable, "-m", "robotteamsim.cli", "plan", "import", "odd.dxf", "--layers", "walls.yaml"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    assert done.stderr == ""


def test_curve_of_any_size_becomes_few_lines_or_is_rejected(drawing, capsys):
    document = ezdxf.readfile("room.dxf")
    document.modelspace().add_circle((0, 0), 1e12, dxfattribs={"layer": "SKY"})
    document.modelspace().add_lwpolyline([], dxfattribs={"layer": "SKY"})
    document.saveas("large.dxf")
    assert main(["plan", "import", "large.dxf", "--layers", "walls.yaml"]) == 0
    assert len(load_floor_plan("plan.yaml").walls) == 6
    Path("plan.yaml").unlink()
    document.modelspace().add_spline().control_points = [(0, 1e300, 0), (5, 5, 0), (5, 1, 0), (0, 8, 0)]
    document.saveas("larger.dxf")
    assert "larger.dxf: cannot be read as DXF: a SPLINE has a size of " in failed(
        capsys, "larger.dxf", "--layers", "walls.yaml"
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["text.dxf", "--layers", "walls.yaml"], "text.dxf: cannot be read as DXF: it is not a DXF file"),
        (["none.dxf", "--layers", "walls.yaml"], "none.dxf: there is no such file"),
        (["cut.dxf", "--layers", "walls.yaml"], "cut.dxf: cannot be read as DXF: "),
        (["header.dxf", "--layers", "walls.yaml"], "header.dxf: cannot be read as DXF: "),
        (
            ["within_itself.dxf", "--layers", "walls.yaml"],
            "within_itself.dxf: cannot be read as DXF: a block contains itself",
        ),
        (["many.dxf", "--layers", "walls.yaml"], "many.dxf: more than 200000 lines"),
        (
            ["hatch.dxf", "--layers", "walls.yaml"],
            "more than 2000000 pairs of lines are closer than 0.6 m; are they a hatch?",
        ),
        (["nested.dxf", "--layers", "walls.yaml"], "nested.dxf: more than 200000 lines and other parts"),
        (["surveyors.dxf", "--layers", "walls.yaml"], "has a unit that cannot be converted ($INSUNITS 21)"),
        (
            ["room.dxf", "--layers", "walls.yaml", "--metres-per-pixel", "0.1"],
            "a drawing in DXF or DWG, for which there is no --metres",
        ),
        (["endless.dxf", "--layers", "walls.yaml"], "layer 'WALLS' has coordinates that are not finite"),
        (["empty.dxf"], "empty.dxf: no layer of walls has lines; found no lines"),
        (["room.dxf", "--layers", "walls.yaml", "--metres-per-unit", "1e6"], "room.dxf: bounds.max: "),
        (
            ["room.png", "--metres-per-pixel", "0.1", "--layers", "walls.yaml"],
            "of one, for which there is no --layer",
        ),
    ],
)
def test_what_cannot_be_imported_is_one_line(drawing, capsys, arguments, message):
    Path("text.dxf").write_text("walls\n", encoding="utf-8")
    whole = Path("room.dxf").read_text(encoding="utf-8")
    Path("cut.dxf").write_text(whole[: len(whole) // 2], encoding="utf-8")
    Path("header.dxf").write_text("  0\nSECTION\n  2\nHEADER\n  9\n$INSUNITS\n", encoding="utf-8")
    document = ezdxf.readfile("room.dxf")
    document.blocks.get("PILLAR").add_blockref("PILLAR", (0, 0))
    document.saveas("within_itself.dxf")
    document = ezdxf.readfile("room.dxf")
    copies = {"column_count": 30_000, "row_count": 30_000, "column_spacing": 1, "row_spacing": 1}
    document.modelspace().add_blockref("PILLAR", (0, 0), dxfattribs=copies)
    document.saveas("many.dxf")
    document, space = new()
    for row in range(2100):
        space.add_line((0, row * 1e-4), (5, row * 1e-4), dxfattribs={"layer": "WALLS"})
    document.saveas("hatch.dxf")
    document = ezdxf.readfile("room.dxf")
    for level in range(9):
        block = document.blocks.new(f"LEVEL_{level}")
        for _ in range(10):
            block.add_blockref(f"LEVEL_{level - 1}", (0, 0)) if level else block.add_point((0, 0))
    document.modelspace().add_blockref("LEVEL_8", (0, 0))
    document.saveas("nested.dxf")
    document = ezdxf.readfile("room.dxf")
    document.header["$INSUNITS"] = 21
    document.saveas("surveyors.dxf")
    document, space = new()
    document.saveas("empty.dxf")
    space.add_line((0, 0), (12345, 0), dxfattribs={"layer": "WALLS"})
    document.saveas("endless.dxf")
    endless = Path("endless.dxf").read_text(encoding="utf-8").replace("12345.0", "1e400")
    Path("endless.dxf").write_text(endless, encoding="utf-8")
    assert message in failed(capsys, *arguments)
    assert not Path("plan.yaml").exists()


@pytest.mark.usefixtures("drawing")
def test_a_damaged_configuration_of_ezdxf_is_one_line(tmp_path):
    (tmp_path / "ezdxf.ini").write_text("\0")
    command = "import sys; from robotteamsim.cli import main; sys.exit(main(sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", command, "plan", "import", "room.dxf", "--out", tmp_path / "plan.yaml"],
        env=os.environ | {"EZDXF_CONFIG_FILE": str(tmp_path / "ezdxf.ini")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert done.stderr.startswith(
        "robotteamsim: ezdxf: its configuration is damaged: File contains no section headers."
    )
    assert done.stderr.count("\n") == 1


def test_a_file_that_would_fill_the_memory_is_not_read(tmp_path, capsys):
    large = tmp_path / "large.dxf"
    with large.open("wb") as file:
        file.truncate(64 * 2**20 + 1)  # without data on the disk
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ezdxf, "readfile", lambda _: pytest.fail("it was read"))
        line = failed(capsys, str(large), "--layers", "walls.yaml")
    assert line == f"robotteamsim: {large}: larger than 64 MiB; expected a drawing of one floor"


@pytest.mark.slow
def test_a_lack_of_memory_is_named(tmp_path):
    large = tmp_path / "large.dxf"
    line = "0\nLINE\n8\nWALLS\n10\n0\n20\n0\n11\n1\n21\n1\n"
    large.write_text(f"0\nSECTION\n2\nENTITIES\n{line * 500_000}0\nENDSEC\n0\nEOF\n")
    done = subprocess.run([sys.executable, "-c", LITTLE_MEMORY, large], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (
        2,
        f"robotteamsim: {large}: cannot be read as DXF: out of memory\n",
    )
