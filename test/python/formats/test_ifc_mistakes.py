"""IFC files that cannot be read, or are no floor plan."""

from __future__ import annotations

import re
from typing import Any

import pytest
from ifc_house import House, box, placed, read

from robotteamsim.errors import ScenarioError
from robotteamsim.formats import importer_of, importers
from robotteamsim.formats.ifc import IfcImporter


def _broken(house: House, change: Any) -> str:
    text: str = house.file.to_string()
    assert change(text) != text
    return str(change(text))


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda text: f"A text.\n{text}"[:9], "is not an IFC file: it does not begin with ISO-10303-21"),
        (lambda text: text[:0], "is not an IFC file"),
        (lambda text: text[: len(text) // 2], "is not complete: it does not end with END-ISO-10303-21;"),
        (lambda text: text.replace("'IFC4'", "'AP214'"), "cannot be read as IFC: No schema named AP214"),
        (lambda text: text.replace("AREASOLID(#", "AREASOLID(#9"), "cannot be read as IFC: Instance"),
        (lambda text: text.replace("((0.,0.,0.))", "((NAN,0.,0.))"), "cannot be read as IFC: Entity with name 'NAN'"),
        (lambda text: text.replace("((0.,0.,0.))", "((1.E999,0.,0.))"), "cannot be read as IFC: token 1.E999"),
        (lambda text: text.replace("((0.,0.,0.))", "((1.E20,0.,0.))"), "#"),
        (lambda text: re.sub(r"#\d+=IFCUNITASSIGNMENT.*\n", "", text), "cannot be read as IFC: Instance reference"),
        (lambda text: text.replace("IFCBUILDINGSTOREY", "IFCFACILITY"), "cannot be read as IFC: Entity"),
    ],
)
def test_damaged_file_is_one_line(tmp_path, change, line):
    house = House()
    house.storey("EG", 0.0)
    house.room()
    path = tmp_path / "house.ifc"
    path.write_text(_broken(house, change))
    with pytest.raises(ScenarioError, match=f"^{re.escape(f'{path}: {line}')}[^\n]*$"):
        IfcImporter().read(path)


def test_building_that_cannot_be_a_plan_is_one_line(tmp_path):
    def message(house: House, **options: Any) -> str:
        with pytest.raises(ScenarioError) as raised:
            read(tmp_path, house, **options)
        return str(raised.value).removeprefix(f"{tmp_path}/house.ifc: ")

    house = House()
    assert message(house) == "has no walls, so there is no building to import"
    house.wall((0.0, 0.0), (5.0, 0.0))
    assert message(house) == "has no storeys (IfcBuildingStorey)"
    storey = house.storey("EG", 0.0)
    assert message(house, level="1") == "there is no storey '1'; expected one of EG"
    house.wall((0.0, 0.0), (5000.0, 0.0))
    assert message(house) == f"#{storey.id()} (storey EG): bounds.max: x 5000.5 is more than 1000 m from min, -0.5"
    unitless = House(unit=None)
    unitless.storey("EG", 0.0)
    unitless.room()
    assert message(unitless) == "has no unit of length (IfcProject.UnitsInContext)"


def test_break_of_the_schema_is_one_line_with_its_entity(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.filling(house.opening(south, 1.0, 0.9))
    (relation,) = house.file.by_type("IfcRelFillsElement")
    text = re.sub(rf"(#{relation.id()}=.*),#\d+\);", r"\1,$);", house.file.to_string())
    path = tmp_path / "house.ifc"
    path.write_text(text)
    with pytest.raises(ScenarioError) as raised:
        IfcImporter().read(path)
    assert str(raised.value) == f"{path}: breaks the schema of IFC: #{relation.id()}.RelatedBuildingElement"


def test_place_that_ifcopenshell_cannot_read_is_one_line(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    door = house.filling(house.opening(south, 1.0, 0.9))
    door.ObjectPlacement.RelativePlacement.Location.Coordinates = (0.0, 0.0)  # valid, as for two dimensions
    with pytest.raises(ScenarioError, match=r"^[^\n]*house\.ifc: cannot be read as IFC: ValueError: [^\n]*$"):
        read(tmp_path, house)


def test_what_is_part_of_itself_or_placed_relative_to_itself_is_one_line(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    wall, *_ = house.room()
    stairs = house.add("IfcStair", None, placed(0.0, 0.0, 0.0))
    flight = house.flight((1.5, 1.5, 0.0), (1.0, 0.0), 8, of=stairs)
    loop = house.file.create_entity("IfcRelAggregates", "0" * 22, RelatingObject=flight, RelatedObjects=[stairs])
    ids = f"#{stairs.id()}, #{flight.id()}"
    with pytest.raises(ScenarioError, match=f"house.ifc: {ids}: part of itself, or placed relative to itself$"):
        read(tmp_path, house)
    house.file.remove(loop)
    wall.ObjectPlacement.PlacementRelTo = wall.ObjectPlacement
    with pytest.raises(ScenarioError, match=f"house.ifc: #{wall.ObjectPlacement.id()}: part of itself, or placed"):
        read(tmp_path, house)


def test_large_file_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "huge.ifc"
    with path.open("wb") as file:
        file.truncate(257 * 2**20)
    with pytest.raises(ScenarioError, match=r"huge\.ifc: 257 MiB; expected at most 256"):
        IfcImporter().read(path)
    with pytest.raises(ScenarioError, match="there is no such file"):
        IfcImporter().read(tmp_path / "none.ifc")


@pytest.mark.slow
def test_too_many_entities_are_one_line(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    house.room()
    text = house.file.to_string()
    (wall, *_) = re.findall(r"(?m)^#\d+(=IFCWALL\(.*)$", text)
    head, tail = text.split("ENDSEC;\nEND-ISO")
    path = tmp_path / "house.ifc"
    path.write_text(head + "".join(f"#{10**6 + i}{wall}\n" for i in range(100_000)) + "ENDSEC;\nEND-ISO" + tail)
    line = f"{path}: 100004 walls, openings, stairs and other parts; expected at most 100000"
    with pytest.raises(ScenarioError, match=f"^{re.escape(line)}$"):
        IfcImporter().read(path)


@pytest.mark.parametrize(("begin_m", "line"), [(1.5, "is open at [0.1"), (3.9, "is open on more than 2.5 m")])
def test_walls_that_do_not_close_are_named(tmp_path, begin_m, line):
    house = House()
    house.storey("EG", 0.0)
    for ends in (((0, 0), (6, 0)), ((6, 0), (6, 4)), ((6, 4), (0, 4)), ((0, 4), (0, begin_m))):
        house.wall(*ends)
    assert [line in note for note in read(tmp_path, house).notes if "the outer wall" in note] == [True]


def test_walls_on_no_storey_are_named(tmp_path):
    """Those of an upper floor for which the file has no storey."""
    house = House()
    house.storey("EG", 0.0)
    house.room()
    above = [wall.id() for wall in house.room(low=3.0, high=5.5)]
    ids = ", ".join(f"#{id_}" for id_ in above)
    line = f"above heads or below the floor of each storey, left out: 4 IfcWall ({ids})"
    assert line in read(tmp_path, house).notes
    assert not any("above heads" in note for note in read(tmp_path, house, level="EG").notes)


def test_lift_and_stairs_of_a_building_with_walls_on_one_storey_are_named(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    house.room()
    house.storey("OG", 3.0)
    lift = house.solids("IfcTransportElement", [box((4.0, 2.0, 0.0), (5.0, 3.0, 5.5))])
    lift.PredefinedType = "ELEVATOR"
    stairs = house.flight((1.0, 1.5, 0.0), (1.0, 0.0), 14)
    found = read(tmp_path, house)
    assert [note for note in found.notes if "joins no storeys" in note] == [
        f"#{stairs.id()} (IfcStairFlight): joins no storeys; it ends at 2.80 m, where no floor is",
        f"#{lift.id()} (IfcTransportElement): joins no storeys; its shape, from 0.00 to 5.50 m, is free on 1 storey",
    ]
    left_out = f"1 IfcStairFlight (#{stairs.id()}), 1 IfcTransportElement (#{lift.id()})"
    line = f"a plan of one storey has no passages; not joined to others: {left_out}"
    assert line in read(tmp_path, house, level="EG").notes


def test_file_is_recognised_by_its_content(tmp_path):
    path = tmp_path / "house.stp"
    path.write_text(House().file.to_string())
    assert isinstance(importer_of(path, importers().values()), IfcImporter)
