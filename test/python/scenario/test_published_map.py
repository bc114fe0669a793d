"""/map of plans that are map_server images, against map_server's rule written a second time."""

from __future__ import annotations

import itertools
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from robotteamsim.errors import ScenarioError
from robotteamsim.rng import stream
from robotteamsim.scenario import load, occupancy_grid
from robotteamsim.scenario.map_image import CACHED_PIXELS, check_published_map, import_map, published_map

DATA = Path(__file__).parents[2] / "data"
THRESHOLDS = [(0.65, 0.196), (0.4, 0.1), (0.5, 0.5), (0.1, 0.9), (1.0, 0.0)]
"""occupied_thresh and free_thresh: map_server also takes equal and swapped ones, 0 and 1."""


def _value(channels: list[int], negate: bool, mode: str, occupied: float, free: float) -> int:
    """Value of one pixel by map_server 1.17; channels in the order red, green, blue, alpha."""
    colours = channels[:3] if len(channels) == 4 and mode != "trinary" else channels
    mean = sum(colours) / len(colours)
    mean = 255 - mean if negate else mean
    if mode == "raw":
        return int(mean) - 256 if int(mean) > 127 else int(mean)
    occupancy = (255 - mean) / 255.0
    if occupancy > occupied:
        return 100
    if occupancy < free:
        return 0
    if mode == "trinary" or (len(channels) > 1 and channels[-1] < 1):
        return -1
    return int(1 + 98 * (occupancy - free) / (occupied - free))


def _scenario(folder: Path, image: np.ndarray, keys: str) -> Path:
    """Write an image in OpenCV's order, highest row first, its yaml and a scenario."""
    cv2.imwrite(str(folder / "room.png"), image)
    text = f"image: room.png\nresolution: 0.1\norigin: [-1, 2, 0]\n{keys}"
    (folder / "room.yaml").write_text(text, encoding="utf-8")
    file = folder / "scenario.yaml"
    file.write_text("name: s\nplan: room.yaml\nrobots: {start: [1, 4, 0]}\n", encoding="utf-8")
    return file


def _image(channels: int, rows: int = 60, columns: int = 70) -> np.ndarray:
    """Return an image with every grey, random colours, unknown pixels and a free middle."""
    shape = (rows, columns) if channels == 1 else (rows, columns, channels)
    image = stream(1, "image").integers(0, 256, shape).astype(np.uint8)
    image[10:14, :64] = np.arange(256).reshape(4, 64) if channels == 1 else np.arange(256).reshape(4, 64, 1)
    image[20:] = 254
    image[40:44, 40:60] = 205
    if channels > 1:
        image[:5, :, 0] = 0  # no blue
        image[5:9, :, -1] = 0
    return image


@pytest.mark.slow
@pytest.mark.parametrize(("channels", "mode"), [*itertools.product([1, 3, 4], ["trinary", "scale", "raw"])])
def test_map_has_the_values_of_map_server_cell_by_cell(tmp_path: Path, channels: int, mode: str) -> None:
    image = _image(channels)
    order = [0] if channels == 1 else [2, 1, 0, 3][:channels]
    for (occupied, free), negate in itertools.product(THRESHOLDS, [0, 1]):
        keys = f"mode: {mode}\nnegate: {negate}\noccupied_thresh: {occupied}\nfree_thresh: {free}\n"
        grid = published_map(load(_scenario(tmp_path, image, keys)))
        pixels = np.flipud(image).reshape(*image.shape[:2], channels)[:, :, order].tolist()
        expected = [[_value(pixel, bool(negate), mode, occupied, free) for pixel in row] for row in pixels]
        assert (grid.origin_m, grid.resolution_m, grid.cells.dtype) == ((-1.0, 2.0), 0.1, np.int8)
        np.testing.assert_array_equal(grid.cells, expected)


def test_drawn_map_has_cells_of_the_key_and_a_limit(tmp_path: Path) -> None:
    scenario = load("garage_sar", ["run.map_resolution_m=0.2"])
    check_published_map(scenario)
    assert published_map(scenario).cells.shape == (200, 300)
    file = _scenario(tmp_path, _image(1), "")
    too_fine = ["plan.bounds={min: [-1, 2], max: [599, 502]}"]
    expected = "0.05 makes a map of 12,000 x 10,000 cells, more than 100 million; expected at least 0.055"
    with pytest.raises(ScenarioError, match=f"{file}: run.map_resolution_m: {expected}$"):
        check_published_map(load(file, too_fine))
    check_published_map(load(file, [*too_fine, "run.map_resolution_m=0.055"]))


def test_map_of_a_changed_or_turned_plan_and_of_a_plan_file_is_drawn_in_cells_of_5_cm(tmp_path: Path) -> None:
    file = _scenario(tmp_path, _image(1), "")
    changed = load(file, ["plan.name=hall"])
    yaml_file = tmp_path / "room.yaml"
    yaml_file.write_text(yaml_file.read_text().replace("[-1, 2, 0]", "[-1, 2, 0.3]"), encoding="utf-8")
    for scenario in (changed, load(file), load("garage_sar")):
        np.testing.assert_array_equal(published_map(scenario).cells, occupancy_grid(scenario.plan, 0.05).cells)


def _large_map(folder: Path) -> Path:
    image = np.full((400, CACHED_PIXELS // 400 + 1), 254, np.uint8)
    image[100:110, 50:300] = 0
    _scenario(folder, image, "")
    return folder / "room.yaml"


def test_plan_of_a_large_image_comes_from_the_cache_until_its_content_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / "cache"))
    path = _large_map(tmp_path)
    plan = import_map(path)
    (file,) = (tmp_path / "cache").iterdir()
    written_ns = file.stat().st_mtime_ns
    assert import_map(path) == plan
    assert file.stat().st_mtime_ns == written_ns
    path.write_text(path.read_text().replace("resolution: 0.1", "resolution: 0.05"), encoding="utf-8")
    assert import_map(path).bounds != plan.bounds


def test_import_needs_no_cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / "file"))
    assert import_map(_large_map(tmp_path)).walls


@pytest.mark.slow
def test_processes_that_import_one_image_at_once_get_the_same_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / "cache"))
    path = _large_map(tmp_path)
    with ProcessPoolExecutor(3, mp_context=get_context("spawn")) as pool:
        plans = list(pool.map(import_map, 6 * [path]))
    assert all(plan == plans[0] for plan in plans)
    assert len(list((tmp_path / "cache").iterdir())) == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["one_r5", "cumberland", "diag_labs"])
def test_map_of_a_real_building_is_that_of_map_server_cell_by_cell(name: str) -> None:
    settings = yaml.safe_load((DATA / "maps" / f"{name}.yaml").read_text(encoding="utf-8"))
    thresholds = settings["occupied_thresh"], settings["free_thresh"]
    values = np.array([_value([grey], False, "trinary", *thresholds) for grey in range(256)], np.int8)
    image = cv2.imread(str(DATA / "maps" / settings["image"]), cv2.IMREAD_UNCHANGED)
    grid = published_map(load(DATA / "scenarios" / f"{name}.yaml"))
    np.testing.assert_array_equal(grid.cells, values[np.flipud(image)])
    assert grid.resolution_m == settings["resolution"]
