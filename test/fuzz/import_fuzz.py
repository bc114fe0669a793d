"""Any floor plan, map image, drawing or building: what is read can be used, all else is refused in one line.

The inputs are Hypothesis' own: arbitrary bytes, valid files with bytes or values changed, valid keys with odd values.
Usage: python test/fuzz/import_fuzz.py [--seconds 60] [--seed 0] [--core FILE]; with --core, that build of the C++ is
used instead of the installed one, such as the one under AddressSanitizer that `make fuzz` makes.
"""

from __future__ import annotations

import argparse
import io
import re
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import ezdwg
import ezdxf
import numpy as np
import yaml
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

PLAN = b"""\
name: room
bounds: {min: [0, 0], max: [10, 8]}
walls: [{name: divider, from: [6, 0], to: [6, 5]}, {name: slant, from: [1, 1], to: [3.5, 2.25], thickness_m: 0.35}]
blocks:
- {name: shelf, polygon: [[1, 6], [3, 6], [3, 7], [1, 7]]}
- {name: pillar, kind: pillar, polygon: [[8, 3], [9, 3], [8.5, 4]]}
doors: [{name: gate, from: [6, 5], to: [6, 6]}, {name: fire, kind: fireproof, closed: true, from: [6, 7], to: [6, 8]}]
bays: [{from: [8, 2], to: [9, 2], count: 2}]
"""
MAP = (
    b"image: map.png\nresolution: 0.1\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)
KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
MAX_SIDE_PIXELS = 24
TIME_LIMIT_S = 5.0


def drawing() -> bytes:
    """Return a DXF file of walls in mm: lines, a polyline, curves, and a block that is inserted turned and repeated."""
    document = ezdxf.new("R12")
    block = document.blocks.new("PILLAR")
    block.add_line((0, 0), (300, 0), dxfattribs={"layer": "WALLS"})
    space, walls = document.modelspace(), {"layer": "WALLS"}
    space.add_line((0, 0), (6000, 0), dxfattribs=walls)
    space.add_polyline2d([(0, 0), (0, 4000), (3000, 4000)], dxfattribs=walls)
    space.add_arc((3000, 2000), 800, 10, 250, dxfattribs=walls)
    space.add_circle((5000, 2000), 400, dxfattribs=walls)
    repeated = {**walls, "row_count": 2, "column_count": 2, "row_spacing": 900, "column_spacing": 900, "rotation": 30}
    space.add_blockref("PILLAR", (1000, 1000), dxfattribs=repeated)
    text = io.StringIO()
    document.write(text)
    return text.getvalue().encode()


def dwg_drawing() -> bytes:
    """Return a DWG file of walls in mm: lines, polylines, curves, and a block that is inserted turned."""
    document = ezdwg.new()
    document.layers["WALLS"] = {"color_index": 7}
    block = document.blocks.new("PILLAR")
    block.add_line((0, 0), (300, 0), layer="WALLS")
    space = document.modelspace()
    space.add_line((0, 0), (6000, 0), layer="WALLS")
    space.add_lwpolyline([(0, 0), (0, 4000), (3000, 4000)], bulges=[0, 0.5, 0], layer="WALLS")
    space.add_polyline2d([(3000, 0), (3000, 3000)], layer="WALLS")
    space.add_arc((3000, 2000), 800, 10, 250, layer="WALLS")
    space.add_spline([(0, 0, 0), (1000, 900, 0), (2000, 0, 0), (2500, 500, 0)], layer="WALLS")
    space.add_blockref("PILLAR", (1000, 1000), rotation=30, layer="WALLS")
    with tempfile.TemporaryDirectory() as folder:
        return Path(document.save(Path(folder) / "room.dwg").output_path).read_bytes()


def building() -> str:
    """Return an IFC file of two storeys with doors, a window, stairs and a lift."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "formats"))
    from ifc_house import House, placed

    house = House()
    for name, floor_m in (("EG", 0.0), ("OG", 3.0)):
        house.storey(name, floor_m)
        south, east, *_ = house.room(8.0, 6.0, low=floor_m, high=floor_m + 2.7)
        house.filling(house.opening(south, 6.5, 0.9, low=floor_m, high=floor_m + 2.1), rating="EI 30")
        house.filling(house.opening(east, 1.0, 0.9, low=floor_m + 0.9, high=floor_m + 2.1), "IfcWindow")
    house.layers(south, [("Brick", 0.1), ("Plaster", 0.1)], "IfcMaterialLayerSet")
    outline, hole = [(0, 0), (8, 0), (8, 6), (0, 6)], [(2.5, 1), (5, 1), (5, 2), (2.5, 2)]
    house.prism("IfcSlab", [outline, hole], 2.7, 3.0)
    # Extruded, like all shapes here: ifcopenshell 0.9.0 crashes on damaged IfcFacetedBrep. And without curves: it makes
    # millions of corners of one with a radius of 1000 km.
    stairs = house.add("IfcStair", None, placed(0.0, 0.0, 0.0))
    for i in range(14):
        low, high = 1.5 + 0.25 * i, 1.75 + 0.25 * i
        tread = [(low, 1.0), (high, 1.0), (high, 2.0), (low, 2.0)]
        house.prism("IfcStairFlight", [tread], 0.2 * i + 0.15, 0.2 * i + 0.2, of=stairs)
    cabin = [(3.0, 3.0), (4.5, 3.0), (4.5, 4.5), (3.0, 4.5)]
    house.prism("IfcTransportElement", [cabin], 0.0, 5.5).PredefinedType = "ELEVATOR"
    return str(house.file.to_string())


def fleet_building() -> str:
    """Return a building.yaml of Open-RMF of three levels with doors, glass, fiducials, a hole and a lift."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "formats"))
    from rmf_house import building_of_three

    found = building_of_three()
    for level in found["levels"].values():
        level["fiducials"] = [[0, 0, "a"], [500, 0, "b"], [500, 250, "c"]]
    found["levels"]["L2"]["holes"] = [{"vertices": [0, 1, 5]}]
    return str(yaml.safe_dump({"name": "house", **found}, default_flow_style=True))


def check(path: Path) -> None:
    """Read a plan, the yaml of a map, a drawing or a building, and use it.

    Only one-line errors of errors.py may come, within TIME_LIMIT_S.
    """
    # Imported late, so that --core comes first.
    from robotteamsim.errors import RobotTeamSimError
    from robotteamsim.formats.cad import CadImporter
    from robotteamsim.formats.ifc import IfcImporter
    from robotteamsim.formats.open_rmf import OpenRmfImporter
    from robotteamsim.scenario import load_floor_plan

    readers: dict[str, Callable[[], Any]] = {
        ".dwg": lambda: CadImporter().read(path, metres_per_unit=0.001).plan,
        ".dxf": lambda: CadImporter().read(path, metres_per_unit=0.001).plan,
        ".ifc": lambda: IfcImporter().read(path).plan,
        ".yml": lambda: OpenRmfImporter().read(path).plan,
    }
    begin_s = time.monotonic()
    try:
        plan = readers.get(path.suffix, lambda: load_floor_plan(path))()
        assert time.monotonic() - begin_s < TIME_LIMIT_S, "it takes too long"
        use(plan)
    except RobotTeamSimError as error:
        text = str(error)
        assert text, "an error says nothing"
        assert "\n" not in text, f"an error of several lines: {text!r}"
        assert len(text) < len(str(path)) * 2 + 500, f"an error of {len(text)} characters: {text[:600]!r}"


def use(plan: Any) -> None:
    """Do with a plan what a mission does: draw it, build its world, send radio through it, open and close its doors."""
    from robotteamsim.propagation import RadioField
    from robotteamsim.scenario import occupancy_grid, solids
    from robotteamsim.scenario.sections import Radio, Run
    from robotteamsim.world import World

    (min_x, min_y), (max_x, max_y) = plan.bounds.min, plan.bounds.max
    resolution_m = max(max_x - min_x, max_y - min_y) / 40.0
    grid = occupancy_grid(plan, resolution_m)
    assert max(grid.cells.shape) <= 41
    assert all(solid.polygon.area > 0.0 for solid in solids(plan))
    radio = RadioField(plan, Radio())
    corners = np.array([[min_x, min_y], [max_x, max_y], [min_x, max_y]])
    links = radio.rssi_matrix_dbm(corners)
    assert np.array_equal(links, links.T)
    assert np.isfinite(links).all()
    before = radio.rssi_map_dbm((min_x, min_y), resolution_m).values
    assert np.isfinite(before).all()
    for closed in (True, False, None):
        for door in plan.doors:
            radio.set_door(door.name, door.closed if closed is None else closed)
        anew = radio.rssi_map_dbm((min_x, min_y), resolution_m).values
        assert np.isfinite(anew).all()
    assert np.array_equal(anew, before)
    world = World(plan, (), Run())
    for door in plan.doors:
        world.set_door(door.name, not door.closed)
    world.step(())


ODD_BYTES = [b"\n", b": ", b"[", b"]", b"-1", b"1e9", b".nan", b"&a", b"*a", b"\x00", b"<a>", b"nan", b"0"]


def changed(valid: bytes) -> st.SearchStrategy[bytes]:
    """Return a strategy of a valid file with some stretches of bytes put in place of others."""
    stretch = st.binary(max_size=6) | st.sampled_from(ODD_BYTES)
    change = st.tuples(st.integers(0, len(valid)), st.integers(0, 8), stretch)

    def apply(changes: list[tuple[int, int, bytes]]) -> bytes:
        data = valid
        for start, length, new in changes:
            data = data[:start] + new + data[start + length :]
        return data

    return st.lists(change, max_size=4).map(apply)


IFC_VALUE = re.compile(r"(?<=[(,])(#\d+|-?\d+\.?\d*(?:E-?\d+)?|'[^']*'|\.\w+\.|\$)(?=[),])")
"""A value of an instance in a file of IFC."""

ODD_IFC_VALUES = ["$", "*", "''", "()", "#1", "#999999", "0.", "-1.", "1.E9", "1.E-9", "1.E300", "-1", ".T.", ".F."]

YAML_VALUE = re.compile(r"(?<=[\[ ])(-?\d+\.?\d*|'[^']*'|\w+)(?=[,\]}])")
"""A value in a YAML text of brackets."""

ODD_YAML_VALUES = [".nan", ".inf", "-1", "0", "1e-9", "1e9", "1e300", "''", "null", "[]", "{}", "true", "L9", "99"]


def damaged(valid: str, value: re.Pattern[str], odd: list[str]) -> st.SearchStrategy[bytes]:
    """Return a strategy of a text in which odd values, or others of the text, take the place of some."""
    values = list(value.finditer(valid))
    indices = st.integers(0, len(values) - 1)
    new = st.sampled_from(odd) | indices.map(lambda index: values[index][0])

    def apply(changes: dict[int, str]) -> bytes:
        text = valid
        for index in sorted(changes, reverse=True):
            text = text[: values[index].start()] + changes[index] + text[values[index].end() :]
        return text.encode()

    return st.dictionaries(indices, new, min_size=1, max_size=4).map(apply)


def odd_values() -> st.SearchStrategy[Any]:
    """Return a strategy of values that a key may be given by mistake."""
    number = (
        st.floats(width=32)
        | st.integers(-(10**6), 10**6)
        | st.sampled_from([1e-300, 1e-9, 1e-4, 0.001, 0.5, 10.0, 1e6, 1e300])
    )
    text = st.sampled_from(
        ["map.png", "map.pgm", "", ".", "..", "/", "map.yaml", "x" * 300, "a\x00b", "scale", "trinary"]
    )
    plain = st.none() | st.booleans() | number | text
    return plain | st.lists(plain | st.just(0.0), max_size=4) | st.just([0.0, 0.0, 0.0])


def maps() -> st.SearchStrategy[bytes]:
    """Return a strategy of the yaml of a map: valid keys, some with odd values."""
    keys = {**yaml.safe_load(MAP), "mode": "trinary"}
    odd = st.dictionaries(st.sampled_from(KEYS), odd_values(), max_size=2)
    return odd.map(lambda some: yaml.safe_dump(keys | some).encode())


@st.composite
def images(draw: st.DrawFn) -> bytes:
    """Return an image of few pixels in one of the formats that map_server reads, all kinds of depth and channels."""
    rows, columns = draw(st.integers(1, MAX_SIDE_PIXELS)), draw(st.integers(1, MAX_SIDE_PIXELS))
    shades = draw(st.lists(st.sampled_from([0, 100, 205, 254, 255]), min_size=1, max_size=3))
    suffix = draw(st.sampled_from([".png", ".pgm"]))
    channels = draw(st.sampled_from([1, 3, 4])) if suffix == ".png" else 1
    picks = np.frombuffer(draw(st.binary(min_size=rows * columns, max_size=rows * columns)), np.uint8)
    pixels = np.array(shades, np.uint8)[picks % len(shades)].reshape(rows, columns)
    if draw(st.booleans()):
        pixels = pixels.astype(np.uint16) * 257
    image = pixels if channels == 1 else np.repeat(pixels[:, :, None], channels, axis=2)
    return cv2.imencode(suffix, image)[1].tobytes()


ROOM_IMAGE = cv2.imencode(".png", cv2.rectangle(np.full((20, 24), 254, np.uint8), (3, 4), (9, 15), 0, 2))[1].tobytes()
ROOM_TEXT_IMAGE = b"P2\n# by hand\n6 4\n255\n" + b"0 254 254 254 205 0\n" * 4
HUGE_IMAGES = st.tuples(
    st.sampled_from([3, 10**5, 10**6, 2**31 - 1, 2**32]), st.sampled_from([3, 4, 10**5, 2**31 - 1])
).map(lambda size: b"P5\n%d %d\n255\n" % size + b"\xfe" * 64)
IMAGES = st.binary(max_size=64) | images() | changed(ROOM_IMAGE) | changed(ROOM_TEXT_IMAGE) | HUGE_IMAGES
NO_IMAGE = st.just(b"")
DRAWINGS = changed(drawing())
DWG_DRAWINGS = changed(dwg_drawing())
FILES = st.tuples(st.binary(max_size=64) | changed(PLAN), NO_IMAGE) | st.tuples(maps() | changed(MAP), IMAGES)


def check_bytes(folder: Path, text: bytes, image: bytes) -> None:
    """Check a yaml whose image, if it has one, has these bytes."""
    path = folder / "map.yaml"
    path.write_bytes(text)
    for name in ("map.png", "map.pgm"):
        (folder / name).write_bytes(image)
    check(path)


def fuzz(folder: Path, number: int, examples: int) -> None:
    """Check that many inputs; those of one seed are always the same."""

    @seed(number)
    @settings(max_examples=examples, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(files=FILES, dxf=DRAWINGS, dwg=DWG_DRAWINGS)
    def run(files: tuple[bytes, bytes], dxf: bytes, dwg: bytes) -> None:
        check_bytes(folder, *files)
        for name, data in (("room.dxf", dxf), ("room.dwg", dwg)):
            path = folder / name
            path.write_bytes(data)
            check(path)

    run()


def fuzz_buildings(folder: Path, number: int, examples: int) -> None:
    """Check that many buildings in IFC and of Open-RMF each; those of one seed are always the same."""
    valid, fleet = building(), fleet_building()
    # Not in the header: with a damaged schema, ifcopenshell 0.9.0 crashes.
    begin = valid.index("DATA;")
    head, body = valid[:begin].encode(), valid[begin:]
    bodies = damaged(body, IFC_VALUE, ODD_IFC_VALUES) | changed(body.encode())
    fleets = damaged(fleet, YAML_VALUE, ODD_YAML_VALUES) | changed(fleet.encode())

    @seed(number)
    @settings(max_examples=examples, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(body=bodies, text=fleets)
    def run(body: bytes, text: bytes) -> None:
        for name, data in (("house.ifc", head + body), ("house.yml", text)):
            path = folder / name
            path.write_bytes(data)
            check(path)

    run()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--core", type=Path)
    options = parser.parse_args()
    if options.core:
        from sanitized_core import use_core

        use_core(options.core)
    examples, buildings, rounds, end_s = 500, 50, 0, time.monotonic() + options.seconds
    with tempfile.TemporaryDirectory() as folder:
        while time.monotonic() < end_s:
            fuzz(Path(folder), options.seed + rounds, examples)
            fuzz_buildings(Path(folder), options.seed + rounds, buildings)
            rounds += 1
    seeds = f"seeds {options.seed} to {options.seed + rounds - 1}"
    print(f"import_fuzz: {rounds * (3 * examples + 2 * buildings)} inputs, {seeds}: nothing found")


if __name__ == "__main__":
    main()
