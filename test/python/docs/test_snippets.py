"""The Python of README and docs, literally as printed, and the scripts of examples/: each runs, without a warning."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
TESTS = ROOT / "test"
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SHOWN = {
    "bag_to_table": (r"robot_2: 301 poses, \d+\.\d m driven", "poses.csv"),
    "own_building": (r"4 of 4 rooms in \d+ s", "own_building.png"),
    "own_campaign": (r"30 dB: \d\.\d\d victims saved", "own_campaign.png"),
    "own_fire": (r"up to 1\d\d degC; visibility below 10 m after \d+\.\d s", "own_fire.png"),
    "own_loop": (r"<StepRecord 601: 60.1 s, ended, \d of 5 areas explored, \d of 5 victims saved>", "own_loop.html"),
    "own_network_reading": (r"\d+ to \d+ links, at most \d hops", "own_network_reading.png"),
    "own_sensor": (r"600 readings, up to \d+ ppm", "own_sensor.png"),
    "policy": (r"policy:Policy: \d areas, \d victims, \d+ m driven\nrandom_walk: ", None),
}
"""What each example prints, and the file that it writes."""

ELSEWHERE = {
    "docs/learning.md": "python/docs/test_learning_snippets.py",
    "docs/own_parts.md": "python/docs/test_own_parts.py",
    "docs/own_sensor.md": "python/docs/test_own_sensor.py",
    "docs/ros2.md": "ros2/test_templates.py",
    "docs/tutorial_controller.md": "python/docs/test_tutorial_controller.py",
    "docs/what_a_controller_sees.md": "python/docs/test_what_a_controller_sees.py",
}
"""Pages whose Python another test runs."""

ON_A_CLUSTER = "from dask_jobqueue import SLURMCluster"
"""How the only block begins that needs other machines."""


def blocks(page: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)


def run(folder: Path, *words: str) -> str:
    """Run Python in a folder without a browser; return what it prints."""
    path = os.pathsep.join((".", os.environ.get("PYTHONPATH", "")))
    env = {**os.environ, "PYTHONPATH": path, "BROWSER": "true", "MPLBACKEND": "Agg", "TRIALS": "1"}
    words = (sys.executable, "-W", "error", *words)
    done = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def command(folder: Path, *words: str) -> str:
    return run(folder, "-m", "robotteamsim", *words, "--set", "mission.time_limit_s=5")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the bag and the campaign that the pages read."""
    folder = tmp_path_factory.mktemp("snippets")
    command(folder, "run", "garage_sar", "--bag", "mission.bag")
    command(folder, "campaign", "garage_sar", "--noise", "10", "--noise", "30", "--trials", "2", "--out", "garage")
    return folder


def test_each_example_is_in_the_table_and_short() -> None:
    assert [path.stem for path in EXAMPLES] == sorted(SHOWN)
    for path in EXAMPLES:
        assert f"| [{path.name}](../examples/{path.name}) |" in PAGE
        assert 15 <= len(path.read_text(encoding="utf-8").splitlines()) <= 50
        assert not re.search(r"import _|\._[a-z]", path.read_text(encoding="utf-8"))


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_prints_and_writes_what_it_says(path: Path, tmp_path: Path) -> None:
    printed, file = SHOWN[path.stem]
    assert re.search(printed, run(tmp_path, str(path)))
    assert file is None or (tmp_path / file).stat().st_size > 5_000


def test_example_names_a_bag_that_is_missing_in_one_line(tmp_path: Path) -> None:
    words = (sys.executable, ROOT / "examples" / "bag_to_table.py", "none.bag")
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    line = "none.bag: cannot be read: No such file or directory; expected a bag\n"
    assert (done.returncode, done.stdout, done.stderr) == (2, "", line)
    assert list(tmp_path.iterdir()) == []


def test_each_page_with_python_has_a_test_that_runs_it() -> None:
    here = {"README.md", "docs/experiments.md", "docs/python.md", "docs/testing.md", "docs/viewer.md"}
    pages = ["README.md", *(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))]
    assert {page for page in pages if blocks(page)} == here | set(ELSEWHERE)
    for page, test in ELSEWHERE.items():
        assert Path(page).name in (TESTS / test).read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("page", ["docs/experiments.md", "docs/python.md", "docs/testing.md", "docs/viewer.md"])
def test_each_block_of_a_page_runs(page: str, folder: Path) -> None:
    for block in blocks(page):
        if block.startswith(ON_A_CLUSTER):
            compile(block, page, "exec")
        else:
            run(folder, "-c", block)


@pytest.mark.slow
def test_loops_of_readme_and_page_print_what_the_page_says(tmp_path: Path) -> None:
    loop, controller = blocks("README.md")
    short = loop.replace('"run.seed=7"', '"run.seed=7", "mission.time_limit_s=5"')
    assert re.fullmatch(
        r"<StepRecord 51: 5.1 s, ended, \d of 5 areas explored, \d of 5 .*>\n", run(tmp_path, "-c", short)
    )
    (tmp_path / "wanderer.py").write_text(controller, encoding="utf-8")
    assert "fault" not in command(tmp_path, "run", "garage_sar", "--set", "control.algorithm=wanderer:Wanderer")
    (printed,) = re.findall(r"prints `(<StepRecord.*?>)`", PAGE)
    assert run(tmp_path, "-c", blocks("docs/python.md")[0]) == f"{printed}\n"
