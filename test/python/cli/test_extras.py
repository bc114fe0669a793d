"""The command line where only the core packages are installed."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]

OF_EXTRAS = (
    "PIL",
    "cv2",
    "dask",
    "distributed",
    "ezdwg",
    "ezdxf",
    "ifcopenshell",
    "imageio_ffmpeg",
    "jinja2",
    "matplotlib",
    "mujoco",
)
OF_EXTRAS += ("collada", "mapbox_earcut", "trimesh")
OF_EXTRAS += ("gymnasium", "pandas", "pettingzoo", "scipy", "statsmodels", "tornado")

WITHOUT = """
import sys
for name in {missing}:
    sys.modules[name] = None
from robotteamsim.cli import main
sys.exit(main())
"""


def run(folder: Path, *words: str, missing: Sequence[str] = OF_EXTRAS) -> subprocess.CompletedProcess[str]:
    """Run a command in a process that does not find some packages."""
    command = (sys.executable, "-c", WITHOUT.format(missing=missing), *words)
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the bag of a short mission, recorded without any extra."""
    folder = tmp_path_factory.mktemp("core_only")
    short = ("--set", "mission.time_limit_s=5", "--bag", "mission.bag", "--out", "out")
    done = run(folder, "run", "garage_sar", *short)
    assert (done.returncode, done.stderr) == (0, "")
    assert "time limit reached" in done.stdout
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("run", "office_manet", "--set", "mission.time_limit_s=2"),
        ("scenario", "show", "garage_sar"),
        ("analyse", "mission.bag"),
        ("view", "mission.bag", "--html", "mission.html"),
        ("completion", "bash"),
    ],
)
def test_command_needs_no_extra(folder: Path, words: tuple[str, ...]) -> None:
    done = run(folder, *words)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_campaign_of_one_machine_needs_no_dask(folder: Path) -> None:
    words = ("campaign", "tutorial_arena", "--trials", "2", "--set", "mission.time_limit_s=1", "--out", "here")
    missing = [name for name in OF_EXTRAS if name != "scipy"]
    done = run(folder, *words, missing=missing)
    assert done.returncode == 0
    assert "victims saved" in done.stdout
    done = run(folder, *words[:-1], "there", "--scheduler", "tls://127.0.0.1:9", missing=missing)
    assert done.returncode == 1
    assert "the extra 'cluster'" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "extra"),
    [
        (("campaign", "garage_sar", "--trials", "1", "--out", "campaign"), "campaign"),
        (("benchmark", "search", "--out", "benchmark"), "report"),
        (("field", "voice", "garage_sar", "--png", "field.png"), "report"),
        (("analyse", "mission.bag", "--png", "mission.png"), "report"),
        (("analyse", "mission.bag", "--gif", "mission.gif"), "report"),
        (("run", "garage_sar", "--set", "run.world=mujoco"), "mujoco"),
        (("plan", "export-mujoco", "garage_sar", "--out", "mujoco"), "mujoco"),
        (("plan", "export-mesh", "garage_sar", "--out", "mesh"), "mesh"),
        (("plan", "import", str(ROOT / "maps" / "garage" / "map.yaml"), "--out", "plan.yaml"), "images"),
        (("plan", "import", "house.dxf"), "dxf"),
        (("plan", "import", "house.dwg"), "dwg"),
        (("plan", "import", "house.ifc"), "ifc"),
    ],
)
def test_missing_package_of_an_extra_is_one_line_that_names_the_extra(
    folder: Path, words: tuple[str, ...], extra: str
) -> None:
    done = run(folder, *words)
    assert done.returncode == 1
    remedy = rf"it comes with the extra '{extra}' \(docs/install\.md\), or with `make setup` in a clone of the"
    line = rf"robotteamsim: this needs the Python package \w+, which is not installed: {remedy} repository\n"
    assert "Traceback" not in done.stderr
    assert re.fullmatch(line, done.stderr.splitlines(keepends=True)[-1])


@pytest.mark.slow
def test_policy_without_its_extra_is_one_line_that_names_the_extra(folder: Path) -> None:
    done = run(folder, "run", "tutorial_arena", "--set", "control.algorithm=robotteamsim.learning:PolicyController")
    remedy = "it comes with the extra 'learning' (docs/install.md), or with `make setup` in a clone of the repository"
    needs = f"this needs the Python package gymnasium, which is not installed: {remedy}"
    line = f"tutorial_arena: control.algorithm: 'robotteamsim.learning:PolicyController': {needs}"
    assert (done.returncode, done.stderr) == (2, f"robotteamsim: {line}\n")


def test_named_extras_exist() -> None:
    text = (ROOT / "src" / "robotteamsim" / "extras.py").read_text(encoding="utf-8")
    named = set(re.findall(r'": "(\w+)",', text))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert named <= set(project["optional-dependencies"])


def test_core_has_no_other_dependencies_than_those_whose_size_was_measured():
    named = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    measured = {
        "filelock",
        "msgspec",
        "nanobind-backend",
        "numpy",
        "pydantic",
        "pyyaml",
        "rich",
        "rosbags",
        "shapely",
        "shtab",
    }
    of_rosbags = {"backports.zstd"}  # which installs it anyway
    assert {re.match(r"[\w.-]+", name)[0] for name in named} == measured | of_rosbags
