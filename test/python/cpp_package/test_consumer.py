"""A program outside of this repository builds against the C++ library and computes a map."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
BUILD = ROOT / "build"
CONSUMER = Path(__file__).parent / "consumer"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (BUILD / "CMakeCache.txt").is_file(), reason="needs the build of `make build`"),
]


def run(*command: str | Path) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return done.stdout


def map_of_consumer(folder: Path, *options: str) -> list[list[float]]:
    run("cmake", "-S", CONSUMER, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", *options)
    run("cmake", "--build", folder)
    program = next(path for path in folder.rglob("consumer") if path.is_file())
    return [[float(value) for value in row.split()] for row in run(program).splitlines()]


@pytest.mark.parametrize("by_catkin", [False, True], ids=["installed package", "catkin workspace"])
def test_consumer_computes_a_path_loss_map(tmp_path: Path, by_catkin: bool) -> None:
    if by_catkin:
        options = ["-DBY_CATKIN=ON", "-DCATKIN_ENABLE_TESTING=OFF"]
        options += [f"-DPYTHON_EXECUTABLE={sys.executable}", f"-DCMAKE_PREFIX_PATH={BUILD / 'devel'}"]
    else:
        run("cmake", "--install", BUILD, "--component", "cpp", "--prefix", tmp_path / "installed")
        options = [f"-DCMAKE_PREFIX_PATH={tmp_path / 'installed'}"]
    loss_db = map_of_consumer(tmp_path / "build", *options)
    # 40 dB + 30 log10(d), d >= 0.1 m, and the wall of 7 dB for the cells beyond it.
    beside_db = 40.0 + 30.0 * math.log10(math.sqrt(2.0)) + 7.0
    assert loss_db[0] == pytest.approx([10.0, 47.0], abs=1e-3)
    assert loss_db[1] == pytest.approx([40.0, beside_db], abs=1e-3)
