"""The palette: distinct for colour-blind sight, too, and the only place with colours."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml
from matplotlib.colors import CSS4_COLORS

from robotteamsim import palette

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [path for top in ("src", "docs", "bench", "templates") for path in (ROOT / top).rglob("*.py")]
PAGES = [
    path
    for path in (ROOT / "src").rglob("*")
    if path.suffix in {".html", ".css", ".js"} and path.name != "three.min.js"  # a library
]
CODE = re.compile(r"(?<!&)#(?:[0-9a-fA-F]{3,4}){1,2}\b")
WORD = re.compile(rf'"({"|".join(CSS4_COLORS)})"|: *({"|".join(CSS4_COLORS)});|\b((?:rgb|hsl)a?\()')
COLOURED = re.compile(r"(\w*color|\w*colors|c|foreground|fill)$")

# Linear RGB as seen with severe anomalies (Machado, Oliveira and Fernandes 2009, Table 1).
SIGHTS = {
    "normal": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def oklab(code: str, sight: str) -> np.ndarray:
    """Return lightness and two colour axes (Ottosson 2020); just noticeable differences are near 0.02."""
    rgb = np.array(palette.rgb(code))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    red, green, blue = np.clip(np.array(SIGHTS[sight]) @ linear, 0.0, 1.0)
    long = np.cbrt(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue)
    middle = np.cbrt(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue)
    short = np.cbrt(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue)
    return np.array(
        [
            0.2104542553 * long + 0.7936177850 * middle - 0.0040720468 * short,
            1.9779984951 * long - 2.4285922050 * middle + 0.4505937099 * short,
            0.0259040371 * long + 0.7827717662 * middle - 0.8086757660 * short,
        ]
    )


def closest(codes: list[str], sight: str) -> float:
    return min(float(np.linalg.norm(oklab(a, sight) - oklab(b, sight))) for a, b in itertools.combinations(codes, 2))


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize(
    "codes",
    [
        [palette.robot_colour(index) for index in range(10)],
        list(palette.VICTIMS.values()),
        [palette.STRONG_LINK, palette.WEAK_LINK, palette.ENDANGERED_LINK, palette.RELAYED],
        [palette.OURS, palette.THEIRS],
    ],
    ids=["robots", "victims", "links", "missions"],
)
def test_colours_of_one_kind_differ_for_every_sight(codes, sight):
    assert closest(codes, sight) > 0.06


@pytest.mark.parametrize("floor", [palette.FLOOR, palette.DARK_FLOOR])
def test_robots_contrast_with_light_and_dark_floors(floor):
    assert min(np.linalg.norm(oklab(code, "normal") - oklab(floor, "normal")) for code in palette.ROBOTS) > 0.15


def test_thirty_robots_have_thirty_colours_that_repeat_after_them():
    assert len({palette.robot_colour(index) for index in range(30)}) == 30
    assert palette.robot_colour(30) == palette.robot_colour(0)


def test_texts_are_dark_on_bright_colours_and_white_on_dark_ones():
    assert palette.text_on(palette.YELLOW) == palette.text_on(palette.SKY_BLUE) == palette.INK
    assert palette.text_on(palette.BLUE) == palette.text_on(palette.BLACK) == palette.WHITE


def test_mixture_lies_between_both_colours():
    assert palette.mixed("#000000", "#ffffff", 0.5) == "#808080"
    assert palette.mixed(palette.BLUE, palette.WHITE, 0.0) == palette.BLUE


def test_style_sheet_names_every_victim_and_robot_colour():
    declared = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", palette.css()))
    assert declared["saved"] == palette.SAVED
    assert [declared[f"robot-{index}"] for index in range(10)] == [palette.robot_colour(index) for index in range(10)]


def named_colours(path: Path) -> Iterator[str]:
    """Yield words given for a colour, such as color="white"; a variable is no word."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            for keyword in node.keywords:
                value = keyword.value
                is_word = isinstance(value, ast.Constant) and isinstance(value.value, str) and value.value != "none"
                if keyword.arg and COLOURED.match(keyword.arg) and is_word:
                    yield value.value


@pytest.mark.slow
def test_colours_are_written_in_the_palette_and_nowhere_else():
    files = [path for path in [*SOURCES, *PAGES] if path.name != "palette.py"]
    codes = {str(path): CODE.findall(path.read_text(encoding="utf-8")) for path in files}
    words = {str(path): list(named_colours(path)) for path in SOURCES}
    words |= {str(path): WORD.findall(path.read_text(encoding="utf-8")) for path in PAGES}
    assert {path: found for path, found in codes.items() if found} == {}
    assert {path: found for path, found in words.items() if found} == {}


def test_rviz_has_the_background_of_the_palette():
    config = yaml.safe_load((ROOT / "rviz" / "robotteamsim.rviz").read_text(encoding="utf-8"))
    written = config["Visualization Manager"]["Global Options"]["Background Color"]
    assert [int(part) / 255.0 for part in written.split(";")] == pytest.approx(palette.rgb(palette.BACKGROUND))
