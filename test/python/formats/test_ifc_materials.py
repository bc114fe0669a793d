"""Materials and fire ratings of IFC files."""

from __future__ import annotations

import pytest
from ifc_house import UNITS, House, opening_m, placed, read

from robotteamsim.scenario.materials import Layer


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4X3"])
def test_panels_and_posts_of_a_curtain_wall_are_glass(tmp_path, schema):
    house = House(schema)
    house.storey("EG", 0.0)
    whole = house.add("IfcCurtainWall", None, placed(0.0, 0.0, 0.0))
    house.wall((0.0, 0.0), (2.0, 0.0), 0.03, ifc_class="IfcPlate", of=whole)
    house.wall((3.0, 0.0), (5.0, 0.0), 0.03, ifc_class="IfcPlate", of=whole)
    post = house.wall((5.0, 0.0), (5.1, 0.0), 0.05, ifc_class="IfcMember", of=whole)
    house.layers(post, [("Aluminium", 0.05)], "IfcMaterial")
    house.wall((2.0, 0.0), (3.0, 0.0), 0.05, high=2.1, ifc_class="IfcDoor", of=whole)
    found = read(tmp_path, house)
    assert [wall.material for wall in found.plan.walls] == ["glass", "glass", "Aluminium"]
    assert opening_m(found.plan, (0.0, 0.0), (5.0, 0.0)) == pytest.approx(1.0, abs=1e-5)
    assert "2 panels of curtain walls: taken as 6 mm of glass" in found.notes
    assert len(found.plan.doors) == 1


STUD_WALL = [("Plasterboard", 0.0125), ("Metal - Stud Layer", 0.1), ("Vapour membrane", 0.0), ("Gypsum board", 0.0125)]
STUD_LAYERS = (
    Layer(of="plasterboard", thickness_m=0.0125),
    Layer(of="air", thickness_m=0.1),
    Layer(of="plasterboard", thickness_m=0.0125),
)


@pytest.mark.parametrize("kind", ["IfcMaterialLayerSet", "IfcMaterialLayerSetUsage"])
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4"])
def test_layers_have_their_thickness_and_studs_are_air(tmp_path, kind, unit, schema):
    house = House(schema, unit)
    house.storey("EG", 0.0)
    for wall in house.room():
        house.layers(wall, STUD_WALL, kind, "Partition")
    found = read(tmp_path, house)
    assert [(one.name, one.layers) for one in found.plan.materials] == [("Partition", STUD_LAYERS)]
    assert {wall.material for wall in found.plan.walls} == {"Partition"}
    guesses = "'Metal - Stud Layer' is taken as air, 'Gypsum board' is taken as plasterboard"
    assert f"materials by their names: {guesses}" in found.notes


@pytest.mark.parametrize(
    ("name", "substance"),
    [
        ("Concrete, Cast-in-Place gray", "concrete"),
        ("Masonry - Concrete Block", "brick"),
        ("Masonry - Brick", "brick"),
        ("Plaster", "plasterboard"),
        ("Gypsum Wall Board", "plasterboard"),
        ("Wood - Stud Layer", "air"),
        ("Insulation / Thermal Barriers - Rigid insulation", "air"),
        ("Air Infiltration Barrier", "air"),
        ("Glass", "glass"),
        ("Steel, 45-345", "metal"),
    ],
)
def test_one_material_fills_the_wall(tmp_path, name, substance):
    house = House()
    house.storey("EG", 0.0)
    walls = house.room()
    house.layers(walls[0], [(name, 0.0)], "IfcMaterial")
    house.layers(walls[1], [(name, 0.0)], "IfcMaterialList")
    house.layers(walls[2], [(name, 0.0)], "IfcMaterialConstituentSet", name)
    found = read(tmp_path, house)
    assert {(one.layers) for one in found.plan.materials} == {(Layer(of=substance, thickness_m=0.2),)}
    assert [wall.material for wall in found.plan.walls].count(None) == 1
    said = [note for note in found.notes if f"'{name}' is taken as {substance}" in note]
    assert len(said) == (substance not in name.lower() or "Block" in name)


@pytest.mark.parametrize(
    ("kind", "layers", "why"),
    [
        ("IfcMaterialList", STUD_WALL, "whose layers have no thickness"),
        ("IfcMaterialConstituentSet", STUD_WALL, "whose layers have no thickness"),
        ("IfcMaterialLayerSet", [("Brick", 0.1), (None, 0.1)], "with a layer without a material"),
        ("IfcMaterialLayerSet", [("Default Wall", 0.2)], "of 'Default Wall'"),
        ("IfcMaterialLayerSet", [("Brick", 3.0)], "'Brick' is 3 m thick"),
        ("IfcMaterialLayerSet", [("Brick", 0.01)] * 21, "'Wall' has 21 layers that a plan cannot have"),
        (None, [], "without a material"),
    ],
)
def test_wall_whose_layers_are_unknown_has_the_loss_of_its_thickness(tmp_path, kind, layers, why):
    house = House()
    house.storey("EG", 0.0)
    for wall in house.room():
        if kind:
            house.layers(wall, layers, kind)
    found = read(tmp_path, house)
    assert {wall.material for wall in found.plan.walls} == {None}
    assert found.plan.materials == ()
    assert f"walls and columns whose loss follows from their thickness: 4 {why}" in found.notes


@pytest.mark.parametrize(("ventilated", "expected"), [(True, "air"), ("UNKNOWN", "air"), (False, None), (None, None)])
def test_layer_without_a_material_is_air_only_if_it_says_so(tmp_path, ventilated, expected):
    house = House()
    house.storey("EG", 0.0)
    for wall in house.room():
        house.layers(wall, [("Brick", 0.1), (None, 0.05), ("Brick", 0.1)], "IfcMaterialLayerSet")
    for layer in house.file.by_type("IfcMaterialLayer"):
        if layer.Material is None:
            layer.IsVentilated = ventilated
    plan = read(tmp_path, house).plan
    layers = [[layer.of for layer in one.layers] for one in plan.materials]
    assert layers == ([["brick", expected, "brick"]] if expected else [])


def test_layer_sets_of_one_name_stay_apart(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    for wall, name in zip(house.room(), ("Brick", "Brick", "Concrete", "Glass"), strict=True):
        house.layers(wall, [(name, 0.2)], "IfcMaterialLayerSet", "Wall")
    plan = read(tmp_path, house).plan
    assert {one.name: one.layers[0].of for one in plan.materials} == {
        "Wall": "brick",
        "Wall 2": "concrete",
        "Wall 3": "glass",
    }


def test_furring_is_a_wall_of_its_own_before_the_masonry(tmp_path):
    house = House("IFC2X3", "INCHES")
    house.storey("EG", 0.0)
    masonry = house.wall((0.0, 0.0), (5.0, 0.0), 0.2)
    house.layers(masonry, [("Masonry - Brick", 0.2)], "IfcMaterialLayerSet", "Masonry")
    furring = house.wall((0.0, 0.127), (4.0, 0.127), 0.054)
    layers = [("Metal - Stud Layer", 0.038), ("Plasterboard", 0.016)]
    house.layers(furring, layers, "IfcMaterialLayerSetUsage", "Furring")
    house.wall((5.0, 0.1), (5.0, 3.0), 0.054)  # at a corner, not before a wall
    found = read(tmp_path, house)
    walls = {(wall.material, wall.thickness_m) for wall in found.plan.walls}
    assert walls == {("Masonry", 0.2), ("Furring", 0.054), (None, 0.054)}
    assert "2 walls in front of a parallel one: of both, the higher loss counts" in found.notes


def test_walls_of_each_class_are_walls_also_in_parts(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    for y, name in ((1.0, "IfcWall"), (2.0, "IfcWallStandardCase"), (3.0, "IfcWallElementedCase")):
        house.wall((0.0, y), (5.0, y), ifc_class=name)
    whole = house.add("IfcWallElementedCase", None, placed(0.0, 0.0, 0.0))
    for y, thickness, name in ((-0.05, 0.0125, "Plasterboard"), (0.05, 0.0125, "Gypsum")):
        board = house.wall((0.0, y), (5.0, y), thickness, ifc_class="IfcBuildingElementPart", of=whole)
        house.layers(board, [(name, 0.0)], "IfcMaterial")
    plan = read(tmp_path, house).plan
    assert sorted((wall.start[1], wall.thickness_m, wall.material or "") for wall in plan.walls) == [
        (-0.05, 0.0125, "Plasterboard"),
        (0.05, 0.0125, "Gypsum"),
        *((y, 0.2, "") for y in (1.0, 2.0, 3.0)),
    ]


@pytest.mark.parametrize(
    ("rating", "kind", "is_said"),
    [
        ("EI 60", "fireproof", False),
        ("T30", "fireproof", False),
        ("20 MIN", "fireproof", False),
        ("EI 0", "normal", True),
        ("Fire Rating", "normal", True),
        ("--FIRE_CODE--", "normal", True),
        ("Inside door: Fire Rating", "normal", True),
        ("60", "normal", True),
        ("", "normal", False),
    ],
)
def test_fire_rating_counts_with_minutes_or_a_class(tmp_path, rating, kind, is_said):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.filling(house.opening(south, 1.0, 0.9), rating=rating)
    found = read(tmp_path, house)
    assert [door.kind for door in found.plan.doors] == [kind]
    said = f"1 door whose FireRating has neither minutes nor a class: '{rating}'"
    assert (said in found.notes) == is_said
