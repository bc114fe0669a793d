"""Doors hang at walls, in gaps."""

from __future__ import annotations

import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.scenario import load, load_floor_plan
from robotteamsim.scenario.door_places import misplaced_doors
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall

LEFT = Wall(name="left", start=(2.0, 4.0), end=(4.0, 4.0))
RIGHT = Wall(name="right", start=(6.0, 4.0), end=(8.0, 4.0))
PILLAR = Block(name="pillar", kind="pillar", polygon=((4.0, 6.0), (4.5, 6.0), (4.5, 6.5), (4.0, 6.5)))


def _mistakes(*leaves: tuple[tuple[float, float], tuple[float, float]]) -> list[tuple[int, str]]:
    doors = tuple(Door(name=f"door_{i}", start=start, end=end) for i, (start, end) in enumerate(leaves))
    bounds = Bounds(max=(10.0, 8.0))
    return misplaced_doors(FloorPlan(name="p", bounds=bounds, walls=(LEFT, RIGHT), blocks=(PILLAR,), doors=doors))


@pytest.mark.parametrize(
    "leaf",
    [
        ((4.0, 4.0), (6.0, 4.0)),  # from wall to wall
        ((4.0, 4.0), (5.0, 4.0)),  # one leaf of a double door
        ((5.0, 4.0), (6.0, 4.0)),  # the other, its hinge last
        ((4.09, 4.0), (5.9, 4.0)),  # with a gap under 10 cm
        ((3.5, 4.0), (6.5, 4.0)),  # its frame in the walls: 1 m of 3 m
        ((4.5, 6.2), (5.5, 6.2)),  # at a pillar
        ((10.0, 2.0), (9.0, 2.0)),  # at the border of the plan
    ],
)
def test_leaf_that_fills_a_gap_is_good(leaf) -> None:
    assert _mistakes(leaf) == []


@pytest.mark.parametrize(
    ("leaf", "angle_rad", "hit"),
    [
        (((4.0, 4.0), (5.0, 4.0)), 1.5, None),
        (((4.0, 4.0), (5.0, 4.0)), 3.1, "left"),  # back against its own wall
        (((4.5, 6.2), (5.5, 6.2)), 1.5, None),
        (((4.5, 6.0), (5.5, 6.0)), 3.1, "pillar"),
    ],
)
def test_leaf_that_swings_into_a_solid_is_reported(leaf, angle_rad, hit) -> None:
    door = Door(name="gate", start=leaf[0], end=leaf[1], motion="swing", angle_rad=angle_rad)
    plan = FloorPlan(name="p", bounds=Bounds(max=(10.0, 8.0)), walls=(LEFT, RIGHT), blocks=(PILLAR,), doors=(door,))
    assert [text.partition("swings into ")[2].split("'")[1] for _, text in misplaced_doors(plan)] == [hit] * bool(hit)


def test_leaf_off_its_wall_is_reported_with_its_distance_to_the_nearest_solid() -> None:
    assert _mistakes(((4.0, 4.0), (6.0, 4.0)), ((4.3, 4.0), (5.8, 4.5))) == [
        (1, "the leaf [4.3, 4] .. [5.8, 4.5] is not at a wall: the nearest is 0.3 m away")
    ]


@pytest.mark.parametrize("leaf", [((2.5, 4.0), (3.5, 4.0)), ((2.0, 4.05), (4.5, 4.05))])
def test_leaf_more_than_half_in_a_wall_is_reported_with_the_wall(leaf) -> None:
    ((_, text),) = _mistakes(leaf)
    assert text.endswith("lies in wall 'left'; expected a gap")


def test_length_in_walls_that_overlap_counts_once() -> None:
    bounds, door = Bounds(max=(10.0, 8.0)), Door(name="gate", start=(3.0, 4.0), end=(6.0, 7.0))
    walls = tuple(Wall(name=f"wall_{i}", start=(2.0, 3.0), end=(4.0 + i, 5.0 + i)) for i in (0.0, 0.2, 0.4))
    assert misplaced_doors(FloorPlan(name="p", bounds=bounds, walls=walls, doors=(door,))) == []  # 2.0 m of 4.2 m
    longer = (*walls, Wall(name="longer", start=(2.0, 3.0), end=(4.6, 5.6)))
    ((_, text),) = misplaced_doors(FloorPlan(name="p", bounds=bounds, walls=longer, doors=(door,)))
    assert "lies in wall 'longer'" in text


def test_leaf_across_a_wall_is_good_where_most_of_it_is_free() -> None:
    assert _mistakes(((3.0, 3.95), (3.0, 5.5))) == []


PLAN = """\
name: room
bounds: {min: [0, 0], max: [10, 8]}
walls: [{name: divider, from: [6, 0], to: [6, 5]}]
doors: [{name: gate, from: [6, 5], to: [6, 6]}]
"""


def test_plan_file_with_a_stray_door_is_rejected_with_file_key_place_and_name(tmp_path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text(PLAN.replace("[6, 5], to: [6, 6]", "[5, 5], to: [5, 6]"), encoding="utf-8")
    with pytest.raises(PlacementError) as raised:
        load_floor_plan(path)
    text = "doors.0: the leaf [5, 5] .. [5, 6] is not at a wall: the nearest is 0.9 m away (in 'gate')"
    assert str(raised.value) == f"{path}: {text}"


def test_door_moved_off_its_wall_by_an_override_is_rejected(tmp_path) -> None:
    (tmp_path / "plan.yaml").write_text(PLAN, encoding="utf-8")
    path = tmp_path / "room.yaml"
    path.write_text("name: room\nplan: plan.yaml\nrobots: {count: 1, start: [1, 1, 0]}\n", encoding="utf-8")
    assert load(path).plan.doors[0].name == "gate"
    with pytest.raises(
        PlacementError, match=r"^\S+room.yaml: plan.doors.0: the leaf \[5, 7\] .. \[6, 6\] is not at a wall"
    ):
        load(path, ["plan.doors.0.from=[5, 7]"])
