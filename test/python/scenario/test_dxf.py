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

from robotteamsim.cli import main
from robotteamsim.scenario import load_floor_plan, solids

LITTLE_MEMORY = """
import resource, sys
import ezdxf
from robotteamsim.cli import command_line, main
with open("/proc/self/statm") as file:
    used = int(file.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 60 * 2**20,) * 2)
sys.exit(main(["plan", "import", sys.argv[1], "--layer", "WALLS"]))
"""
"""Leaves 60 MiB for a drawing."""

ROOM_MM = [(0, 0), (6000, 0), (6000, 4000), (0, 4000)]


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
    return tmp_path


def failed(capsys, *arguments: str) -> str:
    status = main(["plan", "import", *arguments])
    assert status == 2
    return capsys.readouterr().err.strip().splitlines()[-1]


def test_lines_of_the_layers_are_walls_where_the_drawing_has_them(drawing, capsys):
    assert main(["plan", "import", "room.dxf", "--layer", "WALLS", "--wall-thickness", "0.12"]) == 0
    plan = load_floor_plan("plan.yaml")
    assert len(plan.walls) == 6
    assert plan.bounds.max == (8.0, 6.0)
    room = shapely.union_all([solid.polygon for solid in solids(plan)])
    # Its lower left corner is 1 m from that of the plan; half a wall is outside, half inside.
    assert room.bounds == pytest.approx((0.94, 0.94, 7.06, 5.06), abs=0.07)
    for x, y, is_wall in ((4.0, 2.0, True), (4.0, 3.0, False), (7.0, 3.0, True), (1.7, 1.7, False)):
        assert room.intersects(shapely.Point(x, y)) == is_wall


def test_blocks_have_the_layer_where_they_are_inserted(drawing):
    assert main(["plan", "import", "room.dxf", "--layer", "WALLS", "--layer", "PILLARS", "--out", "both.yaml"]) == 0
    assert len(load_floor_plan("both.yaml").walls) == 10


def test_gaps_between_walls_become_doors_on_request(drawing, capsys):
    command = ["plan", "import", "room.dxf", "--layer", "WALLS", "--doors", "--png", "import.png"]
    assert main(command) == 0
    (door,) = load_floor_plan("plan.yaml").doors
    np.testing.assert_allclose(sorted([door.start, door.end]), [(4.0, 2.5), (4.0, 3.5)], atol=0.03)
    assert Path("import.png").stat().st_size > 1000


def test_unit_of_the_file_can_be_replaced(drawing):
    command = ["plan", "import", "room.dxf", "--layer", "WALLS", "--metres-per-unit", "0.002"]
    assert main(command) == 0
    assert load_floor_plan("plan.yaml").bounds.max == (14.0, 10.0)


def test_layers_are_listed_if_none_is_chosen(drawing, capsys):
    line = failed(capsys, "room.dxf")
    assert "room.dxf: choose the layers of walls with --layer; found DOORS (" in line
    assert line.endswith("PILLARS (4 lines), WALLS (6 lines)")
    line = failed(capsys, "room.dxf", "--layer", "MURS")
    assert "room.dxf: layer 'MURS' has no lines; found DOORS (" in line


def test_file_without_units_needs_a_scale(drawing, capsys):
    document = ezdxf.readfile("room.dxf")
    document.units = units.InsertUnits.Unitless
    document.saveas("unitless.dxf")
    line = failed(capsys, "unitless.dxf", "--layer", "WALLS")
    assert line.endswith("names no known unit ($INSUNITS 0); give its scale with --metres-per-unit")


def test_what_the_reader_repairs_is_not_printed(drawing):
    text = Path("room.dxf").read_text(encoding="utf-8")
    Path("odd.dxf").write_text(text.replace("ENDTAB", "ENDTABLE", 1), encoding="utf-8")
    command = [sys.executable, "-m", "robotteamsim.cli", "plan", "import", "odd.dxf", "--layer", "WALLS"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    (warning,) = done.stderr.splitlines()
    assert warning.startswith("robotteamsim: warning: no door leads from the largest part of the floor to ")


def test_curve_of_any_size_becomes_few_lines_or_is_rejected(drawing, capsys):
    document = ezdxf.readfile("room.dxf")
    document.modelspace().add_circle((0, 0), 1e12, dxfattribs={"layer": "SKY"})
    document.modelspace().add_lwpolyline([], dxfattribs={"layer": "SKY"})
    document.saveas("large.dxf")
    assert main(["plan", "import", "large.dxf", "--layer", "WALLS"]) == 0
    assert len(load_floor_plan("plan.yaml").walls) == 6
    Path("plan.yaml").unlink()
    document.modelspace().add_spline().control_points = [(0, 1e300, 0), (5, 5, 0), (5, 1, 0), (0, 8, 0)]
    document.saveas("larger.dxf")
    assert "larger.dxf: cannot be read as DXF: a SPLINE has a size of " in failed(
        capsys, "larger.dxf", "--layer", "WALLS"
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["text.dxf", "--layer", "WALLS"], "text.dxf: cannot be read as DXF: it is not a DXF file"),
        (["none.dxf", "--layer", "WALLS"], "none.dxf: there is no such file"),
        (["cut.dxf", "--layer", "WALLS"], "cut.dxf: cannot be read as DXF: "),
        (["header.dxf", "--layer", "WALLS"], "header.dxf: cannot be read as DXF: "),
        (
            ["within_itself.dxf", "--layer", "WALLS"],
            "within_itself.dxf: cannot be read as DXF: a block contains itself",
        ),
        (["many.dxf", "--layer", "WALLS"], "many.dxf: more than 200000 lines"),
        (["nested.dxf", "--layer", "WALLS"], "nested.dxf: more than 200000 lines and other parts"),
        (["surveyors.dxf", "--layer", "WALLS"], "has a unit that cannot be converted ($INSUNITS 21)"),
        (["room.dxf", "--layer", "WALLS", "--metres-per-pixel", "0.1"], "--metres-per-pixel: only for images"),
        (["room.dxf", "--layer", "WALLS", "--wall-thickness", "2"], "thickness_m: 2.0 is above 0.8"),
        (["room.dxf", "--layer", "WALLS", "--metres-per-unit", "1e6"], "room.dxf: bounds.max: "),
        (["room.png", "--metres-per-pixel", "0.1", "--layer", "WALLS"], "--layer: only for DXF files"),
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
        line = failed(capsys, str(large), "--layer", "WALLS")
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
