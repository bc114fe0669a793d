"""Floor plans from map_server images."""

from __future__ import annotations

import math
import runpy
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from shapely.affinity import rotate

from robotteamsim.errors import ScenarioError
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load, load_floor_plan, occupancy_grid, solids, write_floor_plan
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.map_image import import_map
from robotteamsim.scenario.plan import FREE, OCCUPIED
from robotteamsim.scenario.sections import Radio

ROOT = Path(__file__).parents[3]
MAPS = ROOT / "test" / "data" / "maps"
BENCH = runpy.run_path(str(ROOT / "bench" / "import_accuracy_bench.py"))
BUILDINGS = {"one_r5": (11.95, 12.45), "cumberland": (51.6, 37.425), "diag_labs": (50.0, 40.0)}

WHITE, GREY, BLACK = 254, 205, 0


def _write(folder: Path, image: np.ndarray, settings: str = "", name: str = "room.png") -> Path:
    """Write an image given with its lowest row first, and its yaml: cells of 0.1 m, origin (-1, 2)."""
    cv2.imwrite(str(folder / name), np.flipud(image))
    path = folder / "room.yaml"
    keys = {"image": name, "resolution": "0.1", "origin": "[-1, 2, 0]", "negate": "0"}
    keys |= {"occupied_thresh": "0.65", "free_thresh": "0.196"}
    keys |= dict(line.split(": ", 1) for line in settings.splitlines())
    path.write_text("".join(f"{key}: {value}\n" for key, value in keys.items()), encoding="utf-8")
    return path


def _room(rows: int = 40, columns: int = 60) -> np.ndarray:
    image = np.full((rows, columns), WHITE, dtype=np.uint8)
    image[[0, -1]] = image[:, [0, -1]] = BLACK
    return image


@pytest.mark.slow
@pytest.mark.parametrize(("name", "size_m"), BUILDINGS.items())
def test_real_building_is_imported_within_a_cell_of_its_image(name: str, size_m: tuple[float, float]) -> None:
    plan = import_map(MAPS / f"{name}.yaml")
    assert plan.bounds.max == size_m
    resolution_m = 0.075 if name == "cumberland" else 0.05
    image = np.flipud(cv2.imread(str(MAPS / f"{name}.png"), cv2.IMREAD_GRAYSCALE))
    occupied = occupancy_grid(plan, resolution_m).cells == OCCUPIED
    assert occupied.shape == image.shape
    near = cv2.dilate(occupied.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    deep = cv2.erode(occupied.astype(np.uint8), np.ones((5, 5), np.uint8)).astype(bool)
    black = image < 0.3 * 255
    assert np.count_nonzero(black & ~near) < 0.01 * np.count_nonzero(black)  # noise of one or two cells
    # Pockets too small for anybody are filled, all other free cells stay free.
    assert np.count_nonzero(deep & (image > 240)) * resolution_m**2 < 2.0


@pytest.mark.slow
@pytest.mark.parametrize(("angle_deg", "mean_db"), [(0.0, 0.1), (7.0, 0.15), (30.0, 0.15), (45.0, 0.15)])
def test_import_of_a_turned_plan_has_its_wall_losses(angle_deg: float, mean_db: float) -> None:
    result = BENCH["accuracy"](load_floor_plan("garage"), 0.05, angle_deg, num_points=60)
    assert result.mean_db <= mean_db
    assert result.differing_percent <= 3.0
    assert result.max_db <= 12.4  # one wall of the heaviest class


@pytest.mark.slow
@pytest.mark.parametrize("resolution_m", [0.05, 0.1])
def test_import_of_a_real_building_turned_has_its_wall_losses(resolution_m: float) -> None:
    result = BENCH["accuracy"](import_map(MAPS / "one_r5.yaml"), resolution_m, 30.0, num_points=40)
    assert result.mean_db <= 0.6
    assert result.max_db <= 12.4


def _slanted_wall(angle_deg: float, thickness_m: float) -> FloorPlan:
    dx, dy = 4.0 * math.cos(math.radians(angle_deg)), 4.0 * math.sin(math.radians(angle_deg))
    wall = Wall(name="wall", start=(5.0 - dx, 5.0 - dy), end=(5.0 + dx, 5.0 + dy), thickness_m=thickness_m)
    return FloorPlan(name="plan", bounds=Bounds(max=(10.0, 10.0)), walls=(wall,))


def _exported_and_imported(plan: FloorPlan, folder: Path, resolution_m: float = 0.05) -> FloorPlan:
    BENCH["export_map"](plan, folder, resolution_m)
    return import_map(folder / "map.yaml")


def _wall_loss_db(plan: FloorPlan, a: tuple[float, float], b: tuple[float, float]) -> float:
    empty = FloorPlan(name="empty", bounds=plan.bounds)
    return round(RadioField(plan, Radio()).path_loss_db(a, b) - RadioField(empty, Radio()).path_loss_db(a, b), 6)


@pytest.mark.parametrize("angle_deg", [0.0, 2.0, 7.0, 19.0, 45.0, 80.0])
@pytest.mark.parametrize(("thickness_m", "loss_db"), [(0.1, 3.8), (0.2, 3.8), (0.3, 3.9), (0.5, 5.7), (0.7, 12.4)])
def test_imported_wall_is_of_the_class_that_was_drawn(
    tmp_path: Path, angle_deg: float, thickness_m: float, loss_db: float
) -> None:
    plan = _exported_and_imported(_slanted_wall(angle_deg, thickness_m), tmp_path)
    across = math.radians(angle_deg + 90.0)
    for slide_m in (-3.0, -0.7, 0.0, 1.3):
        foot_m = complex(5.0, 5.0) + slide_m * complex(math.cos(across - math.pi / 2), math.sin(across - math.pi / 2))
        way_m = 1.5 * complex(math.cos(across + 0.4), math.sin(across + 0.4))
        a, b = foot_m - way_m, foot_m + way_m
        assert _wall_loss_db(plan, (a.real, a.imag), (b.real, b.imag)) == loss_db


@pytest.mark.parametrize("angle_deg", [1.0, 3.0, 7.0, 20.0, 45.0, 71.0])
def test_ray_along_an_imported_wall_has_no_loss(tmp_path: Path, angle_deg: float) -> None:
    plan = _exported_and_imported(_slanted_wall(angle_deg, 0.2), tmp_path)
    along = complex(math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg)))
    for beside_m in (0.18, -0.18):  # 8 cm from the wall
        a, b = (complex(5.0, 5.0) + slide_m * along + beside_m * 1j * along for slide_m in (-4.3, 4.3))
        assert _wall_loss_db(plan, (a.real, a.imag), (b.real, b.imag)) == 0.0


def test_wall_that_joins_a_thicker_one_keeps_its_own_class(tmp_path: Path) -> None:
    walls = (
        Wall(name="thick", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.7),
        Wall(name="thin", start=(5.0, 5.3), end=(5.0, 9.0), thickness_m=0.1),
    )
    plan = _exported_and_imported(FloorPlan(name="tee", bounds=Bounds(max=(10.0, 10.0)), walls=walls), tmp_path)
    assert _wall_loss_db(plan, (4.0, 7.0), (6.0, 7.0)) == 3.8
    assert _wall_loss_db(plan, (4.0, 4.0), (4.0, 6.0)) == 12.4
    assert _wall_loss_db(plan, (5.0, 4.0), (5.0, 9.5)) == 12.4  # through the thick one, then along the thin


@pytest.mark.slow
def test_import_drawn_again_is_the_image_that_it_came_from(tmp_path: Path) -> None:
    plan = BENCH["turned"](load_floor_plan("garage"), 20.0)
    drawn = occupancy_grid(plan, 0.05).cells == OCCUPIED
    again = occupancy_grid(_exported_and_imported(plan, tmp_path), 0.05).cells == OCCUPIED
    again[[0, -1]] = again[:, [0, -1]] = False  # the closed border of an image
    assert np.count_nonzero(drawn != again) < 0.05 * np.count_nonzero(drawn)


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILDINGS)
def test_imported_pieces_are_convex_and_do_not_overlap(name: str) -> None:
    polygons = [solid.polygon for solid in solids(import_map(MAPS / f"{name}.yaml"))]
    assert 10 < len(polygons) < 1500
    assert all(polygon.convex_hull.area - polygon.area < 1e-6 for polygon in polygons)
    assert shapely.union_all(polygons).area == pytest.approx(sum(polygon.area for polygon in polygons))


@pytest.mark.slow
def test_import_is_the_same_each_time() -> None:
    assert import_map(MAPS / "cumberland.yaml") == import_map(MAPS / "cumberland.yaml")


def test_scenario_may_name_a_map_server_yaml_as_its_plan(tmp_path: Path) -> None:
    _write(tmp_path, _room())
    scenario_file = tmp_path / "scenario.yaml"
    scenario_file.write_text("name: s\nplan: room.yaml\nrobots: {start: [1, 4, 0]}\n", encoding="utf-8")
    scenario = load(scenario_file)
    assert scenario.plan == import_map(tmp_path / "room.yaml")
    assert load(scenario_file, ["plan.name=hall"]).plan.walls == scenario.plan.walls


def test_imported_plan_is_written_and_read_back(tmp_path: Path) -> None:
    plan = import_map(MAPS / "one_r5.yaml")
    write_floor_plan(plan, tmp_path / "plan.yaml")
    assert load_floor_plan(tmp_path / "plan.yaml") == plan


def test_wall_along_the_axes_keeps_its_cells_and_its_thickness(tmp_path: Path) -> None:
    image = _room()
    image[10:13, 20:40] = BLACK
    plan = import_map(_write(tmp_path, image))
    assert (plan.bounds.min, plan.bounds.max) == ((-1.0, 2.0), (5.0, 6.0))
    (wall,) = (wall for wall in plan.walls if wall.thickness_m == 0.3)
    assert (wall.start, wall.end) == ((1.0, 3.15), (3.0, 3.15))
    np.testing.assert_array_equal(occupancy_grid(plan, 0.1).cells == OCCUPIED, image == BLACK)


def test_thick_rectangle_is_a_block(tmp_path: Path) -> None:
    image = _room()
    image[10:22, 20:32] = BLACK
    blocks = [block for block in import_map(_write(tmp_path, image)).blocks if (1.0, 3.0) in block.polygon]
    assert set(blocks[0].polygon) == {(1.0, 3.0), (2.2, 3.0), (2.2, 4.2), (1.0, 4.2)}
    assert blocks[0].thickness_m == 1.0  # anything thicker counts as this


@pytest.mark.parametrize("end", [(55, 35), (55, 17), (12, 35)])
def test_slanted_wall_becomes_few_straight_pieces_without_gaps(tmp_path: Path, end: tuple[int, int]) -> None:
    image = _room()
    cv2.line(image, (5, 5), end, BLACK, 1, cv2.LINE_8)
    plan = import_map(_write(tmp_path, image))
    slanted = [s.polygon for s in solids(plan) if s.polygon.bounds[0] > -0.9 and s.polygon.bounds[2] < 4.9]
    union = shapely.union_all(slanted)
    assert union.geom_type == "Polygon"
    assert len(slanted) <= 12
    line = shapely.LineString([(-1 + 0.1 * (x + 0.5), 2 + 0.1 * (y + 0.5)) for x, y in ((5, 5), end)])
    assert line.buffer(0.2).covers(union)


def test_pillar_of_few_cells_stays_smaller_specks_go_and_pockets_are_filled(tmp_path: Path) -> None:
    image = _room()
    image[10:12, 10:12] = BLACK
    image[20, 20:22] = BLACK
    image[25:29, 25:29] = BLACK
    image[26:28, 26:28] = WHITE  # a pocket of 0.04 m^2
    grid = occupancy_grid(import_map(_write(tmp_path, image)), 0.1)
    assert np.count_nonzero(grid.cells[5:-5, 5:-5] == OCCUPIED) == 4 + 16
    assert grid.cells[grid.cell_at(0.1, 3.1)] != FREE


def test_cells_that_touch_by_a_corner_alone_are_joined(tmp_path: Path) -> None:
    image = _room()
    image[range(10, 22), range(10, 22)] = BLACK
    solid = occupancy_grid(import_map(_write(tmp_path, image)), 0.1).cells == OCCUPIED
    a, b, c, d = solid[:-1, :-1], solid[:-1, 1:], solid[1:, :-1], solid[1:, 1:]
    assert not ((a & d & ~b & ~c) | (b & c & ~a & ~d)).any()


def test_image_without_walls_is_closed_at_its_border(tmp_path: Path) -> None:
    grid = occupancy_grid(import_map(_write(tmp_path, np.full((40, 60), WHITE, dtype=np.uint8))), 0.1)
    np.testing.assert_array_equal(grid.cells == OCCUPIED, _room() == BLACK)


def test_narrow_unknown_region_is_solid(tmp_path: Path) -> None:
    image = _room()
    image[10:15, 10:40] = GREY
    grid = occupancy_grid(import_map(_write(tmp_path, image)), 0.1)
    assert np.all(grid.cells[10:15, 10:40] == OCCUPIED)


def test_wide_unknown_region_is_a_void_behind_one_cell_of_wall(tmp_path: Path) -> None:
    image = _room()
    image[10:30, 10:40] = GREY
    grid = occupancy_grid(import_map(_write(tmp_path, image)), 0.1)
    shell = np.full((20, 30), OCCUPIED, dtype=np.int8)
    shell[1:-1, 1:-1] = FREE
    np.testing.assert_array_equal(grid.cells[10:30, 10:40], shell)


def _solid(plan: FloorPlan) -> shapely.Geometry:
    return shapely.union_all([solid.polygon for solid in solids(plan)])


def test_quarter_turn_of_the_origin_is_that_of_the_image(tmp_path: Path) -> None:
    image = _room()
    image[10:13, 20:40] = BLACK
    turned = import_map(_write(tmp_path, image, f"origin: [-1, 2, {math.pi / 2}]"))
    drawn = import_map(_write(tmp_path, image.T[:, ::-1], "origin: [-5, 2, 0]"))
    assert turned.bounds == drawn.bounds
    assert shapely.symmetric_difference(_solid(turned), _solid(drawn)).area < 1e-4
    assert {wall.thickness_m for wall in turned.walls} == {wall.thickness_m for wall in drawn.walls}


@pytest.mark.parametrize("yaw_rad", [0.5, -2.0, 1e-9])
def test_floor_of_a_turned_map_is_turned_about_its_origin_and_all_around_it_is_solid(
    tmp_path: Path, yaw_rad: float
) -> None:
    image = _room()
    image[10:13, 20:40] = BLACK
    free = shapely.difference(shapely.box(-1.0, 2.0, 5.0, 6.0), _solid(import_map(_write(tmp_path, image))))
    plan = import_map(_write(tmp_path, image, f"origin: [-1, 2, {yaw_rad}]"))
    turned = shapely.difference(shapely.box(*plan.bounds.min, *plan.bounds.max), _solid(plan))
    expected = rotate(free, yaw_rad, origin=(-1.0, 2.0), use_radians=True)
    assert shapely.symmetric_difference(turned, expected).area < 1e-4


def test_negated_image_is_read_inverted(tmp_path: Path) -> None:
    image = _room()
    image[10:13, 20:40] = BLACK
    straight = import_map(_write(tmp_path, image))
    assert import_map(_write(tmp_path, 255 - image, "negate: 1")) == straight
    # 205 of 255 is unknown either way round only as 50.
    assert import_map(_write(tmp_path, np.dstack([image] * 3))) == straight


def test_plain_text_image_and_comments_are_read(tmp_path: Path) -> None:
    path = _write(tmp_path, _room())
    straight = import_map(path)
    rows = "\n".join(" ".join(map(str, row)) for row in _room().tolist())
    (tmp_path / "room.pgm").write_text(f"P2\n# by hand\n60 40\n255\n{rows}\n", encoding="ascii")
    path.write_text(path.read_text().replace("room.png", "room.pgm  # a comment") + "mode: trinary\nextra: 1\n")
    assert import_map(path) == straight


@pytest.mark.parametrize(
    "settings",
    [
        "negate: '0'\nresolution: \"0.1\"\norigin: ['-1', '2', '0']",  # yaml-cpp converts quoted scalars
        "occupied_thresh: 0.5\nfree_thresh: 0.5",
        "occupied_thresh: 1.0\nfree_thresh: 0.0\nmode: scale",  # the usual pair of nav2's masks
    ],
)
def test_map_yaml_is_read_as_map_server_reads_it(tmp_path: Path, settings: str) -> None:
    straight = import_map(_write(tmp_path, _room()))
    assert import_map(_write(tmp_path, _room(), settings)) == straight


def test_with_swapped_thresholds_all_pixels_darker_than_the_lower_one_are_walls(tmp_path: Path) -> None:
    # map_server 1.17 compares with occupied_thresh first: grey, 0.196 of 1, is above 0.1.
    image = _room()
    image[10:20, 20:40] = GREY
    walls = np.where(image == GREY, BLACK, image)
    expected = import_map(_write(tmp_path, walls))
    assert import_map(_write(tmp_path, image, "occupied_thresh: 0.1\nfree_thresh: 0.9")) == expected


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ("image: hall.png", "image: there is no file 'hall.png'"),
        ("image: room.yaml", "image: 'room.yaml' cannot be read as an image"),
        ("origin: [0, 0]", "origin: [0, 0] is not [x, y, yaw]"),
        ("resolution: 0", "resolution: 0 is below 0.001"),
        ("negate: 2", "negate: 2 is not one of 0, 1, False, True"),
        ("mode: grey", "mode: 'grey' is not one of trinary, scale, raw"),
        ("free_thresh: 1.7", "free_thresh: 1.7 is above 1"),
        ("negate: 'no'", "negate: 'no' is not one of 0, 1, False, True"),
        ("negate: 1", "image: no cell of 'room.png' is free; is negate or free_thresh wrong?"),
    ],
)
def test_wrong_map_yaml_is_rejected_with_its_exact_message(tmp_path: Path, settings: str, message: str) -> None:
    image = _room()
    image[image == BLACK] = GREY
    path = _write(tmp_path, image, settings)
    with pytest.raises(ScenarioError) as raised:
        import_map(path)
    assert str(raised.value) == f"{path}: {message}"


def test_image_that_breaks_off_is_rejected_without_further_words(tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    path = _write(tmp_path, _room(), "image: half.pgm")
    (tmp_path / "half.pgm").write_bytes(b"P5\n60 40\n255\n" + bytes(100))
    with pytest.raises(ScenarioError, match=r"image: 'half\.pgm' cannot be read as an image$"):
        import_map(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("side", [6_000, 12_000, 40_000])
def test_image_of_too_many_pixels_is_rejected_by_its_header(tmp_path: Path, side: int) -> None:
    path = _write(tmp_path, _room(), "image: vast.pgm")
    (tmp_path / "vast.pgm").write_bytes(b"P5\n%d %d\n255\n" % (side, side))
    with pytest.raises(ScenarioError, match=r"image: 'vast.pgm' has more than 25 million pixels$"):
        import_map(path)


def test_missing_or_empty_map_yaml_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"nowhere.yaml: there is no such file"):
        import_map(tmp_path / "nowhere.yaml")
    (tmp_path / "empty.yaml").write_text("", encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"empty.yaml: file is empty; expected the yaml of a map"):
        import_map(tmp_path / "empty.yaml")
