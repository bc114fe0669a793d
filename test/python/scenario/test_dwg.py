"""Drawings in DWG: they give the plan of the same drawing in DXF."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import ezdwg
import ezdxf
import pytest
from ezdwg import raw

from robotteamsim.cli import main
from robotteamsim.scenario import load_floor_plan

WALLS = {"layer": "WALLS"}
ROOM_MM = [(0, 0, 0, 0, 0), (6000, 0, 0, 0, 0), (6000, 4000, 0, 0, 0), (0, 4000, 0, 0, 0)]
THICK_MM = [(700, 0, 150, 150, 0), (700, 900, 150, 150, 0.5), (1500, 900, 150, 150, 0)]
"""Vertices: x, y, widths at the start and the end, bulge."""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def new(insunits: int = 4) -> ezdwg.Drawing:
    """Return an empty drawing, by default in mm."""
    drawing = ezdwg.new()
    drawing.header["insunits"] = insunits
    drawing.layers.update({name: {"color_index": 7} for name in ("WALLS", "COLUMNS", "FURNITURE")})
    return drawing


def draw(drawing: Any, dxf: bool) -> None:
    """Draw each kind of line and curve, and blocks that are turned, mirrored and nested, with ezdxf or ezdwg."""

    def with_(values: dict[str, Any]) -> dict[str, Any]:
        return {"dxfattribs": values} if dxf else values

    space = drawing.modelspace()
    for vertices, is_closed in ((ROOM_MM, True), (THICK_MM, False)):
        if dxf:
            space.add_lwpolyline(vertices, close=is_closed, dxfattribs=WALLS)
            continue
        points, widths = [vertex[:2] for vertex in vertices], [vertex[2:4] for vertex in vertices]
        bulges = [vertex[4] for vertex in vertices]
        space.add_lwpolyline(points, widths=widths, bulges=bulges, closed=is_closed, **WALLS)
    space.add_line((3000, 0), (3000, 1500), **with_(WALLS))
    space.add_arc((-3000, 2500), 700, 20, 160, **with_({**WALLS, "extrusion": (0, 0, -1)}))  # mirrored
    space.add_circle((5000, 1000), 450, **with_(WALLS))
    space.add_ellipse((4500, 3000), (600, 0, 0), 0.5, 0.0, math.pi, **with_(WALLS))
    curve = [(1000, 3000, 0), (1500, 3900, 0), (2000, 3000, 0), (2500, 3500, 0)]
    (space.add_open_spline if dxf else space.add_spline)(curve, **with_(WALLS))
    space.add_line((0, 500), (600, 500), **with_({"layer": "FURNITURE"}))
    space.add_line((0, 700), (600, 700), **with_({**WALLS, "invisible": 1 if dxf else True}))
    pillar = drawing.blocks.new("PILLAR", base_point=(100, 0))
    for one, other in itertools.pairwise([(0, 0), (300, 0), (300, 200), (0, 200), (0, 0)]):
        pillar.add_line(one, other)  # on layer 0
    pair = drawing.blocks.new("PAIR")
    pair.add_blockref("PILLAR", (0, 0), **with_({"layer": "COLUMNS", "xscale": -1.0, "rotation": 30.0}))
    pair.add_blockref("PILLAR", (900, 0), **with_({"layer": "COLUMNS"}))
    space.add_blockref("PAIR", (1500, 2200), **with_({"rotation": 15.0}))


def failed(capsys, *arguments: str) -> str:
    assert main(["plan", "import", *arguments]) == 2
    return capsys.readouterr().err.strip().splitlines()[-1]


def test_dwg_has_the_plan_of_its_dxf(capsys):
    document, drawing = ezdxf.new(setup=True), new()
    document.units = ezdxf.units.MM
    draw(document, dxf=True)
    draw(drawing, dxf=False)
    document.saveas("house.dxf")
    drawing.save("house.dwg")
    tables = []
    for suffix in ("dxf", "dwg"):
        assert main(["plan", "import", f"house.{suffix}", "--out", f"{suffix}.yaml"]) == 0
        tables.append(Path(f"{suffix}.layers.yaml").read_text().splitlines()[1:])
    assert tables[0] == tables[1]
    assert '"WALLS": {kind: wall}' in "".join(tables[1])
    one, other = load_floor_plan("dxf.yaml"), load_floor_plan("dwg.yaml")
    assert len(one.walls) > 50
    assert len(one.blocks) == 2
    assert one.bounds.max == pytest.approx(other.bounds.max, abs=1e-6)
    for ours, expected in zip(other.walls, one.walls, strict=True):
        assert (*ours.start, *ours.end) == pytest.approx((*expected.start, *expected.end), abs=1e-5)
        assert ours.thickness_m == expected.thickness_m
    assert other.blocks == one.blocks


@pytest.mark.parametrize(("insunits", "unit_m"), [(1, 0.0254), (2, 0.3048), (4, 0.001), (6, 1.0)])
def test_unit_of_the_file_is_the_scale(insunits, unit_m):
    drawing = new(insunits)
    for ends in (((0, 0), (5.0 / unit_m, 0)), ((0, 0), (0, 3.0 / unit_m))):
        drawing.modelspace().add_line(*ends, layer="WALLS")
    drawing.save("room.dwg")
    assert main(["plan", "import", "room.dwg"]) == 0
    assert load_floor_plan("plan.yaml").bounds.max == pytest.approx((7.0, 5.0), abs=1e-6)


def test_file_without_a_unit_needs_a_scale(capsys):
    drawing = new(0)
    drawing.modelspace().add_line((0, 0), (5000, 0), layer="WALLS")
    drawing.save("room.dwg")
    line = failed(capsys, "room.dwg")
    assert line.endswith("room.dwg: names no known unit ($INSUNITS 0); give its scale with --metres-per-unit")
    assert main(["plan", "import", "room.dwg", "--metres-per-unit", "0.001", "--force"]) == 0
    assert load_floor_plan("plan.yaml").bounds.max == (7.0, 2.0)


def test_what_is_not_translated_is_counted_where_the_drawing_shows_it(capsys):
    drawing = new()
    space = drawing.modelspace()
    space.add_line((0, 0), (5000, 0), layer="WALLS")
    space.add_text("HALL", (0, 0), 100, layer="WALLS")
    drawing.paperspace().add_solid([(0, 0, 0), (1, 0, 0), (0, 1, 0)], layer="WALLS")
    for name, references in (("SHOWN", 2), ("UNUSED", 0)):
        drawing.blocks.new(name).add_solid([(0, 0, 0), (1, 0, 0), (0, 1, 0)], layer="WALLS")
        for _ in range(references):
            space.add_blockref(name, (0, 0), layer="FURNITURE")
    drawing.save("room.dwg")
    assert main(["plan", "import", "room.dwg"]) == 0
    assert "warning: left out: 1 SOLID on WALLS\n" in capsys.readouterr().err


def test_line_that_ezdwg_lists_but_does_not_decode_is_counted(capsys, monkeypatch):
    drawing = new()
    for y in (0, 1000, 2000):
        drawing.modelspace().add_line((0, y), (5000, y), layer="WALLS")
    drawing.save("room.dwg")
    decode = raw.decode_line_entities
    monkeypatch.setattr(raw, "decode_line_entities", lambda *_: [*decode("room.dwg")][1:])
    rows = raw.decode_line_arc_circle_entities("room.dwg")
    monkeypatch.setattr(raw, "decode_line_arc_circle_entities", lambda *_: (rows[0][1:], *rows[1:]))
    assert main(["plan", "import", "room.dwg"]) == 0
    assert "warning: left out: 1 undecoded LINE on WALLS\n" in capsys.readouterr().err
    assert len(load_floor_plan("plan.yaml").walls) == 2


def test_objects_of_unknown_kinds_are_counted(capsys, monkeypatch):
    drawing = new()
    drawing.modelspace().add_line((0, 0), (5000, 0), layer="WALLS")
    drawing.save("room.dwg")
    rows = raw.list_object_headers_with_type("room.dwg")
    entities = [row for row in rows if row[-1] == "E"]
    others = [(*row[:-1], "") for row in rows if row[-1] != "E"]  # as in files of AutoCAD 2004
    monkeypatch.setattr(raw, "list_object_headers_with_type", lambda _: [*entities, *others])
    assert main(["plan", "import", "room.dwg"]) == 0
    line = f"warning: left out: {len(others)} objects of unknown kinds, perhaps without a shape\n"
    assert line in capsys.readouterr().err


def test_what_cannot_be_imported_is_one_line(capsys, monkeypatch):
    drawing = new()
    drawing.save("empty.dwg")
    assert failed(capsys, "empty.dwg").endswith("empty.dwg: no layer of walls has lines; found no lines")
    data = Path("empty.dwg").read_bytes()
    for name, part, reason in (
        ("nothing.dwg", b"", "cannot be read as DWG: it is not a DWG file"),
        ("cut.dwg", data[: len(data) // 2], "cannot be read as DWG: it is damaged"),
        ("old.dwg", b"AC1009" + data[6:], "version 'AC1009'; expected a DWG file of AutoCAD R14 to 2018"),
    ):
        Path(name).write_bytes(part)
        assert failed(capsys, name) == f"robotteamsim: {name}: {reason}"
    assert "none.dwg: there is no such file" in failed(capsys, "none.dwg")
    entries = raw.list_object_map_entries("empty.dwg")
    monkeypatch.setattr(raw, "list_object_map_entries", lambda _: [*entries, (9999, 1), (9998, 1)])
    assert failed(capsys, "empty.dwg").endswith("empty.dwg: damaged: 2 of its objects cannot be read")
    monkeypatch.undo()
    Path("plan.yaml").unlink(missing_ok=True)


def test_a_million_entities_are_rejected_before_they_are_decoded(capsys, monkeypatch):
    new().save("room.dwg")
    row = raw.list_object_headers_with_type("room.dwg")[0]
    line = (*row[:-2], "LINE", "E")
    monkeypatch.setattr(raw, "list_object_headers_with_type", lambda _: [(n, *line[1:]) for n in range(10**6)])
    monkeypatch.setattr(raw, "list_object_map_entries", lambda _: [(n, 0) for n in range(10**6)])
    monkeypatch.setattr(ezdwg, "read", lambda _: pytest.fail("it was decoded"))
    assert failed(capsys, "room.dwg").endswith("room.dwg: 1000000 lines and other parts; expected at most 200000")


def test_another_file_of_the_same_name_is_read_again():
    for length, second in ((5000, "modelspace"), (4000, "paperspace")):
        drawing = new()
        drawing.modelspace().add_line((0, 0), (length, 0), layer="WALLS")
        getattr(drawing, second)().add_line((0, 0), (5000, 0), layer="WALLS")
        drawing.save(f"{length}.dwg")
    for length_m in (5.0, 4.0):
        Path(f"{1000.0 * length_m:g}.dwg").replace("room.dwg")
        assert main(["plan", "import", "room.dwg", "--force"]) == 0
        assert load_floor_plan("plan.yaml").bounds.max[0] == 2.0 + length_m
