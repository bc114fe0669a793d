"""The exported worlds are valid for sdformat, the library with which Gazebo reads them."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from robotteamsim.gazebo import export_world
from robotteamsim.scenario import load
from robotteamsim.setup import resolve

pytestmark = pytest.mark.slow

CHECKER = Path(__file__).parent / "sdf_checker"


@pytest.fixture(scope="module")
def checker(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compile the program that loads files with sdformat."""
    build = tmp_path_factory.mktemp("sdf_checker")
    for command in (["cmake", "-S", CHECKER, "-B", build], ["cmake", "--build", build]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return build / "sdf_checker"


def _check(checker: Path, text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    file = folder / "a.world"
    file.write_text(text, encoding="utf-8")
    return subprocess.run([checker, file], capture_output=True, text=True, check=False, env={"HOME": str(folder)})


ODD_NAMES = (
    "objects=[{name: 'a::b', size_m: [0.5, 0.5], pose: [2, 2, 0]},"
    " {name: __model__, size_m: [0.5, 0.5], pose: [4, 4, 0]},"
    " {name: \"<&'>\", kind: barrel, radius_m: 0.3, pose: [5, 5, 0]}, {name: '', size_m: [0.5, 0.5], pose: [0, 0, 0]}]"
)
HEXAGON = "[[0.3, 0.0], [0.15, 0.25], [-0.15, 0.25], [-0.3, 0.0], [-0.15, -0.25], [0.15, -0.25]]"


@pytest.mark.parametrize("drive", ["velocity", "wheels"])
@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("garage_sar", ["robots.laser.noise_m=0.02"]),
        ("warehouse_push", []),
        ("isr_floor_0_sar", [f"robots.footprint_m={HEXAGON}"]),
        ("tutorial_arena", [ODD_NAMES]),
    ],
)
def test_exported_world_is_valid(checker, tmp_path, name, overrides, drive):
    done = _check(checker, export_world(resolve(load(name, overrides)), drive).text, tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_exported_doors_and_absent_robots_are_valid(checker, tmp_path):
    garage = load("garage_sar", ["robots.reserve=1"])
    motions = ({"motion": "swing", "angle_rad": -1.2}, {"motion": "slide"})
    doors = (door.model_copy(update=motion) for door, motion in zip(garage.plan.doors, motions, strict=True))
    export = export_world(
        resolve(garage.model_copy(update={"plan": garage.plan.model_copy(update={"doors": tuple(doors)})}))
    )
    for text in (export.text, export.others["robot_2.sdf"]):
        done = _check(checker, text, tmp_path)
        assert (done.returncode, done.stderr) == (0, "")


def test_checker_rejects_a_world_with_a_wrong_element(checker, tmp_path):
    world = export_world(resolve(load("tutorial_arena"))).text
    for wrong in (
        world.replace("<mass>", "<weight>").replace("</mass>", "</weight>"),
        world.replace("<size>", "<size>x"),
    ):
        assert _check(checker, wrong, tmp_path).returncode != 0
