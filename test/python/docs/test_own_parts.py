"""Importer, exporter and world of a user's own package, as docs/own_parts.md has them."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from own_package import blocks, entries, install_package, python

from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.scenario import load_floor_plan

MODULES = dict(zip(("movingai", "slippery"), blocks("python", "own_parts"), strict=True))
ROWS = ("@@@@@@", "@..TT@", "@....@", "@S.@.@", "@@@@@@")
MAP = "\n".join(["type octile", "height 5", "width 6", "map", *ROWS, ""])
MOVED = """
from robotteamsim.geometry import Twist
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

for name in ("box2d", "slippery"):
    world = Simulation(resolve(load("tutorial_arena", [f"run.world={name}"]))).world
    for _ in range(10):
        world.step([Twist(0.2)] * world.num_robots)
    print(world.twists()[0].linear_x_mps)
"""

BROKEN = """

from robotteamsim.formats import Exporter


class Taken(MovingAiExporter):
    options = {"--out": {}}


class Plain(MovingAiImporter):
    options = {"cell": {}}


class Own(MovingAiImporter):
    options = {"--cell": {"dest": "x"}}


class Other(MovingAiImporter):
    options = {"--layers": {"type": int}}


class NoSign(MovingAiImporter):
    sign = "(["


class Mute(MovingAiImporter):
    examples = ["x"]
"""

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Run]:
    """Install the package of the page, with other modules or entry points; return what runs Python with it."""
    monkeypatch.chdir(tmp_path)

    def installed(groups: Mapping[str, Mapping[str, str]] = entries("own_parts"), **modules: str) -> Run:
        environment = install_package(tmp_path, MODULES | modules, groups)
        return lambda *words: python(tmp_path, environment, *words)

    return installed


def command(run: Run, words: str) -> subprocess.CompletedProcess[str]:
    return run("-m", "robotteamsim", *words.split())


@pytest.mark.slow
def test_map_is_imported_and_exported_again(install):
    run = install()
    Path("arena.map").write_text(MAP)
    done = command(run, "plan import arena.map --cell 0.5 --out plan.yaml")
    assert (done.returncode, done.stdout) == (0, "plan.yaml: 0 walls, 9 blocks\n")
    assert done.stderr == "robotteamsim: warning: arena.map: swamp is floor\n"
    assert load_floor_plan("plan.yaml").bounds.max == (3.0, 2.5)
    done = command(run, "plan export-movingai plan.yaml --out again")
    assert (done.returncode, done.stdout) == (0, "again/plan.map: 3 rows\n")
    line = "again/plan.map already exists; choose another name with --out, or --force replaces it"
    done = command(run, "plan export-movingai plan.yaml --out again")
    assert (done.returncode, done.stderr) == (2, f"robotteamsim: {line}\n")
    done = command(run, "plan export-movingai plan.yaml --out again --cell 0.5 --force")
    assert (done.returncode, done.stdout) == (0, "again/plan.map: 5 rows\n")
    assert Path("again/plan.map").read_text() == re.sub("[TS]", lambda cell: "@."[cell[0] == "S"], MAP)


@pytest.mark.slow
def test_file_is_recognised_by_its_content_and_named_to_other_commands(install):
    run = install()
    Path("arena.txt").write_text(MAP)
    assert command(run, "plan import arena.txt").returncode == 0
    done = command(run, "run arena.txt")
    assert (done.returncode, done.stderr) == (2, "robotteamsim: arena.txt is a MovingAI map: use plan import\n")
    Path("other.txt").write_text("hello")
    done = command(run, "plan import other.txt")
    assert done.returncode == 2
    assert re.fullmatch(r"robotteamsim: other.txt: no importer reads .*; expected one of .*\.map, .*\n", done.stderr)
    done = command(run, "plan import arena.map --layers a.yaml")
    line = "robotteamsim: arena.map is a MovingAI map, for which there is no --layers\n"
    assert (done.returncode, done.stderr) == (2, line)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("cell_m = options", "1 / 0; cell_m = options", "MovingAiImporter: ZeroDivisionError: division by zero (mov"),
        ("return Imported(", "return (", "arena.map: MovingAiImporter: returns (FloorPlan("),
        (
            "blocks=tuple(blocks)), notes)",
            "blocks=tuple(blocks)), 'x')",
            "expected an Imported whose notes are a tuple",
        ),
    ],
)
def test_error_of_an_importer_is_one_line_with_its_file(install, old, new, line):
    assert old in MODULES["movingai"]
    run = install(movingai=MODULES["movingai"].replace(old, new))
    Path("arena.map").write_text(MAP)
    done = command(run, "plan import arena.map --out plan.yaml")
    assert (done.returncode, done.stdout, Path("plan.yaml").exists()) == (2, "", False)
    (said,) = done.stderr.splitlines()
    assert said.startswith("robotteamsim: arena.map: ")
    assert line in said


@pytest.mark.slow
def test_flag_of_an_importer_is_for_its_files_only(install):
    flag = MODULES["movingai"].replace("    options = CELL\n", '    options = {"--up": {"action": "store_true"}}\n', 1)
    run = install(movingai=flag)
    Path("arena.map").write_text(MAP)
    assert command(run, "plan import arena.map --up").returncode == 0
    Path("a.world").write_text("model( pose [ 1 1 0 0 ] size [ 1 1 1 ] )")
    assert command(run, "plan import a.world --out a").returncode == 0
    assert "for which there is no --up" in command(run, "plan import a.world --up --out b").stderr


@pytest.mark.slow
def test_exporter_writes_into_its_folder_only(install):
    outside = MODULES["movingai"].replace('notes=("doors', "others={'../x': ''}, notes=(\"doors")
    assert outside != MODULES["movingai"]
    run = install(movingai=outside)
    done = command(run, "plan export-movingai office --out o")
    line = "MovingAiExporter: file '../x'; expected a name without a folder"
    assert (done.returncode, done.stderr) == (2, f"robotteamsim: {line}\n")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("groups", "line"),
    [
        ({"importers": {"a": "nowhere:A"}}, "importer a of nowhere:A: ModuleNotFoundError: "),
        ({"importers": {"a": "movingai:CELL"}}, "importer a of movingai:CELL: TypeError: expected a class below "),
        ({"importers": {"stage": "movingai:MovingAiImporter"}}, "ValueError: there is another importer of this name"),
        ({"exporters": {"a": "movingai:Exporter"}}, "exporter a of movingai:Exporter: TypeError: has no help; see "),
        ({"exporters": {"a": "movingai:Taken"}}, "exporter a of movingai:Taken: ValueError: argument --out: "),
        ({"importers": {"a": "movingai:Plain"}}, "ValueError: option 'cell'; expected a name that begins with --"),
        ({"importers": {"a": "movingai:Own"}}, "ValueError: option --cell has dest; expected none"),
        ({"importers": {"a": "movingai:Other"}}, "ValueError: option --layers is that of another importer, "),
        ({"importers": {"a": "movingai:NoSign"}}, "unterminated character set at position 1"),
        ({"importers": {"a": "movingai:Mute"}}, "importer a of movingai:Mute: TypeError: examples ['x']; "),
    ],
)
def test_part_that_cannot_be_used_is_named_and_all_else_goes_on(install, groups, line):
    run = install(
        {f"robotteamsim.{group}": points for group, points in groups.items()}, movingai=MODULES["movingai"] + BROKEN
    )
    done = command(run, "plan export-stage office --out o")
    assert done.returncode == 0
    (warned,) = done.stderr.splitlines()
    assert line in warned


@pytest.mark.slow
def test_missions_and_bags_are_in_the_named_world(install):
    run = install()
    done = run("-c", MOVED)
    assert [float(speed) for speed in done.stdout.split()] == pytest.approx([0.2, 0.98 * 0.2])
    short = "--set mission.time_limit_s=3 --set run.world=slippery"
    done = command(run, f"run garage_sar --quiet --bag mission.bag {short}")
    assert (done.returncode, done.stderr) == (0, "")
    with BagReader([Path("mission.bag")]) as bag:
        assert "/robot_2/base_pose_ground_truth" in bag.topics


@pytest.mark.slow
def test_world_of_the_page_passes_the_check_and_a_wrong_one_does_not(install):
    check = "from robotteamsim.testing import check_world; check_world('slippery')"
    run = install()
    done = run("-c", check)
    assert (done.returncode, done.stderr) == (0, "")
    Path("slippery.py").write_text(MODULES["slippery"].replace("0.98", "0.8"))
    done = run("-c", check)
    assert done.returncode == 1
    assert re.search(r"^AssertionError: slippery: drives follow their commands\[forward\]: ", done.stderr, re.MULTILINE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("point", "line"),
    [
        ("nowhere:World", "run.world: own of nowhere:World: ModuleNotFoundError: No module named 'nowhere'; "),
        ("slippery:SHARE", "run.world: own of slippery:SHARE: TypeError: expected a class below "),
        ("slippery:Broken", "run.world: own of slippery:Broken: ZeroDivisionError: division by zero (slippery.py:"),
    ],
)
def test_world_that_cannot_be_made_is_one_line(install, point, line):
    broken = "class Broken(World):\n    def __init__(self, *_, **__):\n        1 / 0\n"
    run = install({"robotteamsim.worlds": {"own": point}}, slippery=MODULES["slippery"] + broken)
    done = command(run, "run garage_sar --set run.world=own")
    assert (done.returncode, done.stdout) == (2, "")
    (said,) = done.stderr.splitlines()
    assert line in said
    done = command(run, "run garage_sar --set run.world=none")
    assert (done.returncode, done.stderr) == (
        2,
        "robotteamsim: --set: run.world: 'none' is not one of box2d, mujoco, own\n",
    )
