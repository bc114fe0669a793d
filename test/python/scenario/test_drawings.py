"""Drawings as floor plans: their scale, what is no wall, gaps that become doors, and rooms without one."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image

from robotteamsim.analysis.import_picture import draw_import
from robotteamsim.cli import main
from robotteamsim.scenario import load_floor_plan
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.map_image import read_map
from robotteamsim.scenario.plan import FREE, obstacles, occupancy_grid
from robotteamsim.world.floor_parts import floor_parts, parts_without

CELL_M = 0.02
SQUARE = [(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)]
DRAWING = Path(__file__).parents[3] / "docs" / "images" / "own_building_drawing.png"
SIZE_M = (14.0, 9.0)
WALLS = (
    *(((1, 1), (12, 1)), ((1, 8), (12, 8)), ((1, 1), (1, 8)), ((12, 1), (12, 3.5)), ((12, 4.5), (12, 8))),
    *(((1, 4.5), (3, 4.5)), ((3.9, 4.5), (12, 4.5)), ((6, 1), (6, 2.5)), ((6, 3.4), (6, 6))),
    *(((6, 6.9), (6, 8)), ((9, 4.5), (9, 8))),
)
"""Two rooms above and two below, and a store at the right above without a door; all 0.2 m thick."""
DOORS = [(6.0, 2.95), (12.0, 4.0), (3.45, 4.5), (6.0, 6.45)]
"""Middles of the gaps of 0.7, 0.8, 0.7 and 0.7 m between the faces of walls."""


def pixel(x: float, y: float) -> tuple[int, int]:
    return round(x / CELL_M), round((SIZE_M[1] - y) / CELL_M)


def drawing(texts: bool) -> np.ndarray:
    """Draw the walls; texts: and letters, a dimension line, and the arc of a door."""
    image = np.full((round(SIZE_M[1] / CELL_M), round(SIZE_M[0] / CELL_M)), 255, np.uint8)
    for (x0, y0), (x1, y1) in WALLS:
        (left, top), (right, bottom) = pixel(x0 - 0.1, y1 + 0.1), pixel(x1 + 0.1, y0 - 0.1)
        cv2.rectangle(image, (left, top), (right - 1, bottom - 1), 0, -1)
    if texts:
        cv2.line(image, pixel(1, 0.4), pixel(12, 0.4), 0, 1)
        cv2.ellipse(image, pixel(3.1, 4.4), (35, 35), 0, 0, 90, 0, 2)
        for text, place, size in (("11.00", (6, 0.45), 0.6), ("LIVING", (2.5, 2.5), 1.2), ("STORE", (9.6, 6.5), 1.2)):
            cv2.putText(image, text, pixel(*place), cv2.FONT_HERSHEY_SIMPLEX, size, 0, round(2.5 * size))
    return image


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    cv2.imwrite("clean.png", drawing(texts=False))
    cv2.imwrite("house.png", drawing(texts=True))
    return tmp_path


def imported(*arguments: str) -> FloorPlan:
    Path("plan.yaml").unlink(missing_ok=True)
    assert main(["plan", "import", *arguments]) == 0
    return load_floor_plan("plan.yaml")


def free_cells(plan: FloorPlan) -> np.ndarray:
    cells: np.ndarray = occupancy_grid(plan.model_copy(update={"doors": ()}), 0.05).cells == FREE
    return cells


@pytest.mark.parametrize("scale", [("--metres-per-pixel", "0.02"), ("--measured", "50,400,600,400,11")])
def test_scale_is_a_number_or_a_measured_line(folder, scale):
    plan = imported("clean.png", *scale)
    assert (plan.bounds.min, plan.bounds.max) == ((0.0, 0.0), SIZE_M)


def test_text_dimension_lines_and_arcs_are_no_walls(folder, capsys):
    clean = free_cells(imported("clean.png", "--metres-per-pixel", "0.02"))
    everything = free_cells(imported("house.png", "--metres-per-pixel", "0.02"))
    assert np.count_nonzero(everything != clean) > 500
    rules = ("--thinnest-wall", "0.1", "--smallest-wall", "0.6")
    walls = free_cells(imported("house.png", "--metres-per-pixel", "0.02", *rules))
    # What remains of an arc where it meets a wall is as long as the thinnest wall.
    assert np.count_nonzero(walls != clean) <= 8


@pytest.mark.parametrize("turned", [False, True])
def test_gaps_become_doors_on_request(folder, capsys, turned):
    if turned:
        cv2.imwrite("clean.png", np.rot90(drawing(texts=False), -1))
    assert imported("clean.png", "--metres-per-pixel", "0.02").doors == ()
    plan = imported("clean.png", "--metres-per-pixel", "0.02", "--doors")
    middles = sorted((0.5 * np.add(door.start, door.end)).tolist() for door in plan.doors)
    expected = sorted([y, SIZE_M[0] - x] if turned else [x, y] for x, y in DOORS)
    np.testing.assert_allclose(middles, expected, atol=0.03)
    assert not any(door.closed for door in plan.doors)
    assert "4 doors" in capsys.readouterr().out.splitlines()[-1]
    assert len(imported("clean.png", "--metres-per-pixel", "0.02", "--doors", "0.75,1").doors) == 1


@pytest.mark.parametrize("width_m", [1.2, 1.5, 2.5])
def test_gap_at_the_end_of_a_corridor_becomes_a_door(folder, width_m):
    image = np.full((400, 300), 0, np.uint8)
    middle, half = 150, round(width_m / CELL_M) // 2
    image[20:190, middle - half : middle + half] = 255
    image[200:380, 20:280] = 255
    image[190:200, middle - 22 : middle + 23] = 255
    cv2.imwrite("corridor.png", image)
    (door,) = imported("corridor.png", "--metres-per-pixel", str(CELL_M), "--doors").doors
    assert door.end[0] - door.start[0] == pytest.approx(0.9)


def test_parts_of_the_floor_are_found_among_many_closets():
    closets = [
        Block(name=f"{x}_{y}", polygon=[(x, y), (x + 0.9, y), (x + 0.9, y + 0.9), (x, y + 0.9)])
        for x in range(40)
        for y in range(30)
    ]
    wall = Block(name="wall", polygon=[(0, 39.5), (40, 39.5), (40, 40), (0, 40)])
    plan = FloorPlan(name="hall", bounds=Bounds(min=(0, 0), max=(40, 60)), blocks=(*closets, wall))
    upper, lower = floor_parts(plan, 0.2)
    assert (upper.area_m2, lower.area_m2) == pytest.approx((40 * 19.8, 40 * 9.2), rel=0.01)
    assert [part.place for part in parts_without(plan, 0.2, [(20.0, 50.0)])] == [lower.place]


def test_of_many_rooms_without_a_door_ten_are_named(folder, capsys):
    image = np.full((400, 640), 255, dtype=np.uint8)  # of twelve rooms; the paper around them is outside
    for column in range(3):
        for row in range(4):
            x, y = 40 + 200 * column, 20 + 95 * row
            cv2.rectangle(image, (x, y), (x + 100 + row, y + 60), 0, 4)
    cv2.imwrite("boxes.png", image)
    imported("boxes.png", "--metres-per-pixel", "0.05")
    *named, more = capsys.readouterr().err.splitlines()
    assert len(named) == 10
    assert more == "robotteamsim: warning: no door leads from the largest part of the floor to 1 smaller part"


def test_rooms_without_a_door_are_reported_by_import_and_check(folder, capsys):
    plan = imported("clean.png", "--metres-per-pixel", "0.02", "--doors")
    _, store = floor_parts(plan, 0.2)
    # The centre of a disc of 0.2 m has 2.4 x 2.9 m in a room of 2.8 x 3.3 m.
    assert store.area_m2 == pytest.approx(2.4 * 2.9, rel=0.1)
    assert store.place == pytest.approx((10.5, 6.25), abs=0.3)
    assert parts_without(plan, 0.2, [(10.0, 6.0), (2.0, 2.0)]) == ()
    warning = capsys.readouterr().err
    assert warning.startswith("robotteamsim: warning: no door leads from the largest part of the floor to ")
    robots = "robots: {count: 1, start: [2.0, 2.0, 0.0]}"
    Path("house.yaml").write_text(f"name: house\nplan: plan.yaml\n{robots}\n", encoding="utf-8")
    assert main(["scenario", "check", "house.yaml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("house.yaml: valid: ")
    assert lines[1].startswith("house.yaml: no robot can get to ")
    assert lines[1].endswith(f" m2 around [{store.place[0]:g}, {store.place[1]:g}], not even through doors")
    assert len(lines) == 2


def test_areas_and_victims_where_no_robot_can_get_are_reported(folder, capsys):
    imported("clean.png", "--metres-per-pixel", "0.02", "--doors")
    areas = "areas: [{name: in, center: [10.5, 6.25], radius_m: 0.5}, {name: far, center: [2.0, 2.0]}]"
    victims = "victims: [{name: ann, position: [10.5, 6.25]}, {name: bob, position: [2.5, 2.0]}]"
    text = (
        f"name: house\nplan: plan.yaml\nrobots: {{count: 1, start: [2.0, 2.0, 0.0]}}\nmission: {{{areas}, {victims}}}\n"
    )
    Path("house.yaml").write_text(text, encoding="utf-8")
    capsys.readouterr()
    assert main(["scenario", "check", "house.yaml"]) == 0
    assert capsys.readouterr().out.splitlines()[1:3] == [
        "house.yaml: no robot can get to area in at [10.5, 6.25], not even through doors",
        "house.yaml: no robot can get to victim ann at [10.5, 6.25], not even through doors",
    ]


@pytest.mark.parametrize("margin_m", [0.5, 2.0, 4.0])
def test_floor_around_a_building_is_not_reported(margin_m):
    walls = [
        Wall.model_validate({"name": f"w{i}", "from": a, "to": b})
        for i, (a, b) in enumerate(itertools.pairwise(SQUARE))
    ]
    low, high = -margin_m, 10.0 + margin_m
    plan = FloorPlan(name="house", bounds=Bounds(min=(low, low), max=(high, high)), walls=tuple(walls))
    assert [part.area_m2 for part in floor_parts(plan, 0.2)] == pytest.approx([9.4**2], rel=0.02)
    assert parts_without(plan, 0.2, [(5.0, 5.0)]) == ()


def test_one_door_is_found_in_a_gap_with_ragged_ends_and_none_at_loose_objects(folder):
    image = np.full((400, 500), 255, np.uint8)
    cv2.rectangle(image, (20, 20), (480, 380), 0, 9)
    for row in range(195, 205):
        image[row, 20 : 200 + row % 3] = image[row, 252 - row % 4 : 480] = 0
    cv2.rectangle(image, (400, 60), (440, 100), 0, -1)  # a table of 0.8 m, 0.7 m from the outer wall
    cv2.circle(image, (60, 60), 15, 0, -1)  # a pillar
    cv2.putText(image, "Kitchen", (60, 300), cv2.FONT_HERSHEY_SIMPLEX, 0.8, 0, 3)
    cv2.imwrite("room.png", image)
    (door,) = imported("room.png", "--metres-per-pixel", str(CELL_M), "--doors").doors
    assert door.start == pytest.approx((200 * CELL_M, 4.0), abs=0.1)
    assert door.end[0] - door.start[0] == pytest.approx(50 * CELL_M, abs=0.1)


@pytest.mark.parametrize(
    "sizes",
    [("--doors", "0.6,1e308"), ("--doors", "600,1600"), ("--smallest-wall", "1e308"), ("--thinnest-wall", "1e308")],
)
def test_sizes_beyond_the_image_are_taken_as_its_size(folder, sizes):
    doors = imported("clean.png", "--metres-per-pixel", "0.02", *sizes).doors
    assert all(door.end[0] - door.start[0] < 12.0 for door in doors)


def test_doors_of_the_drawing_in_the_docs_are_found(folder):
    shutil.copy(DRAWING, "house.png")
    doors = imported("house.png", "--metres-per-pixel", "0.02", "--doors").doors
    assert len(doors) == 5
    assert all(0.9 < door.end[0] - door.start[0] < 1.1 for door in doors)


def test_doors_of_a_drawing_do_not_depend_on_its_pixels(folder):
    drawn = cv2.imread(str(DRAWING), cv2.IMREAD_GRAYSCALE)
    cv2.imwrite("fine.png", cv2.resize(drawn, None, fx=3.0, fy=3.0, interpolation=cv2.INTER_CUBIC))
    fine = imported("fine.png", "--measured", "0,0,2100,0,14", "--doors")
    assert len(fine.doors) == 5


def test_ink_of_a_turned_map_is_drawn_on_its_walls(folder):
    Path("map.yaml").write_text("image: clean.png\nresolution: 0.02\norigin: [1, 2, 0.5]\n", encoding="utf-8")
    plan, image = imported("map.yaml"), read_map(Path("map.yaml"))
    figure = draw_import(plan, (), image, np.zeros(image.dark.shape, dtype=bool))
    ink = next(one for one in figure.axes[0].get_images() if one.get_array()[..., 3].any())
    row, column = np.argwhere(ink.get_array()[..., 3] > 0)[0]
    left, _, low, _ = ink.get_extent()
    figure.canvas.draw()
    shown = ink.get_transform().transform((left + 0.02 * (column + 0.5), low + 0.02 * (row + 0.5)))
    assert obstacles(plan).buffer(0.02).contains(shapely.Point(figure.axes[0].transData.inverted().transform(shown)))


def test_picture_shows_what_was_taken_for_what(folder):
    rules = ("--thinnest-wall", "0.1", "--smallest-wall", "0.6", "--doors", "--png", "import.png")
    imported("house.png", "--metres-per-pixel", "0.02", *rules)
    picture = cv2.imread("import.png")
    blue, green, red = (picture[..., channel].astype(int) for channel in range(3))
    # Vermilion, for ink that is no wall, and yellow, for the store.
    assert np.count_nonzero((red > 180) & (green < 130) & (blue < 60)) > 500
    assert np.count_nonzero((red > 220) & (green > 200) & (blue < 100)) > 500


def photo(turn_deg: float, light: float, noise: float) -> np.ndarray:
    """Take a photo of the drawing: grey ink on turned paper, darker to the right and in a shadow, with noise."""
    image = drawing(texts=False)
    rows, columns = image.shape
    turn = cv2.getRotationMatrix2D((columns / 2, rows / 2), turn_deg, 1.0)
    seen = cv2.GaussianBlur(cv2.warpAffine(image, turn, (columns, rows), borderValue=255), (0, 0), 0.7) / 255.0
    y, x = np.mgrid[:rows, :columns]
    shade = (1.0 - 0.4 * x / columns) * (1.0 - 0.25 * np.exp(-(((x - 500) / 120) ** 2 + ((y - 120) / 90) ** 2)))
    grey = light * (0.25 + 0.75 * seen) * shade + np.random.default_rng(5).normal(0.0, noise, image.shape)
    return np.clip(grey, 0.0, 255.0).astype(np.uint8)


# A photo of 14 x 9 m with 4 doors: before, the shaded paper was solid.
@pytest.mark.parametrize(("turn_deg", "light", "noise"), [(0.0, 190.0, 0.0), (1.0, 190.0, 7.0), (-2.5, 240.0, 4.0)])
def test_photo_of_a_drawing_has_its_doors_and_floor(folder, capsys, turn_deg, light, noise):
    cv2.imwrite("photo.jpg", photo(turn_deg, light, noise), [cv2.IMWRITE_JPEG_QUALITY, 85])
    plan = imported("photo.jpg", "--metres-per-pixel", "0.02", "--doors")
    line = capsys.readouterr().out
    middle = 0.5 * np.array(plan.bounds.max)
    middles = sorted((0.5 * np.add(door.start, door.end) - middle).round(1).tolist() for door in plan.doors)
    expected = sorted(np.subtract(DOORS, np.multiply(0.5, SIZE_M)).tolist())
    np.testing.assert_allclose(middles, expected, atol=0.1)
    clean = imported("clean.png", "--metres-per-pixel", "0.02")
    areas = [
        shapely.box(0, 0, *one.bounds.max).difference(obstacles(one.model_copy(update={"doors": ()}))).area
        for one in (plan, clean)
    ]
    larger = np.prod(plan.bounds.max) - np.prod(clean.bounds.max)  # paper that holds the turned drawing
    assert areas[0] - larger == pytest.approx(areas[1], rel=0.03)
    turned_deg = float(line.partition("; turned by ")[2].partition(" ")[0] or 0.0)
    assert turned_deg == pytest.approx(-turn_deg, abs=0.15)
    assert " % of the pixels were neither black nor white" in line


@pytest.mark.parametrize(("turn_deg", "is_turned"), [(3.0, False), (9.0, True)])
def test_paper_that_is_turned_too_far_is_a_warning(folder, capsys, turn_deg, is_turned):
    cv2.imwrite("photo.jpg", photo(turn_deg, 190.0, 4.0))
    imported("photo.jpg", "--metres-per-pixel", "0.02")
    warned = "warning: the paper is turned by 5 degrees or more, and only so much is undone" in capsys.readouterr().err
    assert warned == is_turned


@pytest.mark.parametrize("share", [0.0, 0.2])
def test_many_grey_pixels_are_a_warning(folder, capsys, share):
    image = drawing(texts=False)
    image[: round(share * len(image))] = 150
    cv2.imwrite("grey.png", image)
    imported("grey.png", "--metres-per-pixel", "0.02")
    warned = "20 % of the pixels are neither black nor white" in capsys.readouterr().err
    assert warned == (share > 0.0)


def test_grey_paper_is_floor_and_grey_areas_of_a_drawn_map_are_not(folder, capsys):
    cv2.imwrite("grey.png", np.where(drawing(texts=False) == 255, 190, 40).astype(np.uint8))
    grey, clean = (imported(f"{name}.png", "--metres-per-pixel", "0.02") for name in ("grey", "clean"))
    assert grey.walls == clean.walls
    unknown = drawing(texts=False)
    unknown[150:250, 150:250] = 205  # gmapping's grey in a room
    cv2.imwrite("map.png", unknown)
    plan = imported("map.png", "--metres-per-pixel", "0.02")
    assert obstacles(plan).intersects(shapely.Point(3.01, 5.0))
    assert "; 3.2 % of the pixels were neither black nor white" in capsys.readouterr().out


def outer_openings() -> np.ndarray:
    """Draw two rooms: in the outer wall an entrance of 0.9 m, a gap of 1.4 m, and one of 1.4 m with two thin lines."""
    image = np.full((450, 600), 255, np.uint8)
    cv2.rectangle(image, (50, 50), (549, 399), 0, 10)
    cv2.rectangle(image, (295, 50), (304, 399), 0, -1)
    image[200:245, 290:310] = 255
    for left, width in ((100, 45), (180, 70), (400, 70)):
        image[380:420, left : left + width] = 255
    image[[395, 404], 400:470] = 0
    return image


@pytest.mark.parametrize("thinnest", [(), ("--thinnest-wall", "0.1")])
def test_gaps_and_thin_lines_in_outer_walls_become_glass(folder, capsys, thinnest):
    cv2.imwrite("open.png", outer_openings())
    plan = imported("open.png", "--metres-per-pixel", "0.02", "--windows", "0.6,2", "--doors", "0.6,1", *thinnest)
    glass = [wall for wall in plan.walls if wall.material == "glass"]
    middles = sorted((wall.start[0] + wall.end[0]) / 2 for wall in glass)
    assert middles == pytest.approx([(180 + 35) * CELL_M, (400 + 35) * CELL_M], abs=0.03)
    assert all(wall.thickness_m == pytest.approx(0.2, abs=0.05) for wall in glass)
    assert sorted(door.start[0] for door in plan.doors) == pytest.approx([100 * CELL_M, 299.5 * CELL_M], abs=0.03)
    captured = capsys.readouterr()
    assert "2 doors, 2 windows" in captured.out
    assert captured.err == ""
    assert len(parts := floor_parts(plan.model_copy(update={"doors": ()}), 0.2)) == 1, parts


def test_places_where_the_outer_wall_is_open_are_named(folder, capsys):
    cv2.imwrite("open.png", outer_openings())
    imported("open.png", "--metres-per-pixel", "0.02", "--thinnest-wall", "0.1")
    (warning,) = capsys.readouterr().err.splitlines()
    assert warning.startswith("robotteamsim: warning: the outer wall is open at ")
    places = [float(place.split(",")[0]) for place in warning.split("[")[1:]]
    assert sorted(places) == pytest.approx([122.5 * CELL_M, 215 * CELL_M, 435 * CELL_M], abs=0.1)
    imported("open.png", "--metres-per-pixel", "0.02", "--windows", "0.6,2")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["clean.png"], "clean.png: give its scale with --metres-per-pixel or --measured, or import its yaml"),
        (["map.yaml", "--metres-per-pixel", "0.1"], "map.yaml has the resolution"),
        (["clean.png", "--measured", "1,2,3,4"], "'1,2,3,4' is not X1,Y1,X2,Y2,M"),
        (["clean.png", "--measured", "1,2,1,2,4"], "expected two pixels apart from each other"),
        (
            ["clean.png", "--metres-per-pixel", "0.02", "--doors", "2,1"],
            "expected widths above 0, the smaller one first",
        ),
        (["clean.png", "--metres-per-pixel", "90"], "clean.png: resolution: 90"),
        (["none.png", "--metres-per-pixel", "0.1"], "none.png"),
        (
            ["clean.png", "--metres-per-pixel", "0.02", "--png", "clean.png"],
            "would overwrite a file that this command reads",
        ),
        (["clean.png", "--metres-per-pixel", "0.02", "--png", "x.jpg"], "'x.jpg' does not end in .png, .pdf or .svg"),
    ],
)
def test_invalid_options_are_one_line(folder, capsys, arguments, message):
    Path("map.yaml").write_text("image: clean.png\nresolution: 0.1\norigin: [0, 0, 0]\n", encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        raise SystemExit(main(["plan", "import", *arguments, "--out", "new.yaml"]))
    assert ended.value.code == 2
    line = capsys.readouterr().err.strip().splitlines()[-1]
    assert message in line
    assert not Path("new.yaml").exists()


@pytest.mark.parametrize("ink", ["black", "white"])
@pytest.mark.parametrize("mode", ["RGBA", "LA"])
def test_transparent_pixels_are_paper(folder: Path, ink: str, mode: str) -> None:
    clean = Image.open("clean.png").convert("L")
    inked = Image.new(mode, clean.size, ink)
    walls = clean.point(lambda grey: 255 - grey)
    inked.paste(Image.new(mode, clean.size, "black"), mask=walls)
    inked.putalpha(walls)
    inked.save("inked.png")
    for name in ("clean", "inked"):
        assert main(["plan", "import", f"{name}.png", "--metres-per-pixel", "0.02", "--out", f"{name}.yaml"]) == 0
    assert load_floor_plan("inked.yaml").walls == load_floor_plan("clean.yaml").walls


def test_photo_is_turned_by_its_exif_orientation(folder: Path) -> None:
    clean = Image.open("clean.png")
    exif = Image.Exif()
    exif[0x0112] = 6  # the camera was held at a right angle: viewers turn it clockwise
    clean.rotate(90, expand=True).save("photo.png", exif=exif)
    for name in ("clean", "photo"):
        assert main(["plan", "import", f"{name}.png", "--metres-per-pixel", "0.02", "--out", f"{name}.yaml"]) == 0
    assert load_floor_plan("photo.yaml").bounds == load_floor_plan("clean.yaml").bounds
    assert load_floor_plan("photo.yaml").walls == load_floor_plan("clean.yaml").walls


def test_image_without_light_pixels_is_rejected_without_words_about_a_yaml(folder: Path, capsys) -> None:
    cv2.imwrite("night.png", np.zeros((40, 40), np.uint8))
    assert main(["plan", "import", "night.png", "--metres-per-pixel", "0.02", "--out", "o.yaml"]) == 2
    assert capsys.readouterr().err == "robotteamsim: night.png: no pixel is light; expected dark walls on light paper\n"


def test_what_a_map_does_not_know_is_no_part_of_the_floor(folder: Path, capsys) -> None:
    # A map of gmapping: grey but for one building of 10 x 8 m, of which the door is unknown, too.
    image = np.full((1000, 1000), 205, np.uint8)
    image[400:560, 400:600] = 0
    image[404:556, 404:596] = 254
    cv2.imwrite("mapped.pgm", image)
    keys = "image: mapped.pgm\nresolution: 0.05\norigin: [-25, -25, 0]\n"
    Path("mapped.yaml").write_text(keys + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n", encoding="utf-8")
    assert main(["plan", "import", "mapped.yaml", "--out", "o.yaml"]) == 0
    assert capsys.readouterr().err == ""
