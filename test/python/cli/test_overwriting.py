"""No command writes over a file that it reads, over another of its outputs, or over what a user has made."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from robotteamsim.cli import main

DATA = Path(__file__).parents[2] / "data"
WORLD = DATA / "stage" / "hall.world"
MAP = "image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n"
SCENARIO = "name: s\nplan: {plan}\nrobots: {{count: 1, start: [2, 2, 0]}}\nmission: {{time_limit_s: 0.5}}\n"
PLAN = "name: p\nbounds: {min: [0, 0], max: [9, 9]}\n"


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a map, a plan, a scenario of each, and a recorded mission in each format."""
    folder = tmp_path_factory.mktemp("inputs")
    Image.fromarray(np.full((100, 100), 254, np.uint8)).save(folder / "map.png")
    texts = {"map.yaml": MAP, "plan.yaml": PLAN}
    texts |= {"on_map.yaml": SCENARIO.format(plan="map.yaml"), "s.yaml": SCENARIO.format(plan="plan.yaml")}
    texts |= {"patrol.yaml": SCENARIO.format(plan="plan.yaml").replace("{time", "{patrol: {graph: g.graph}, time")}
    shutil.copy(DATA / "patrol" / "three.graph", folder / "g.graph")
    for name, text in texts.items():
        (folder / name).write_text(text)
    recorders = [f"--{kind}={folder}/{name}" for kind, name in (("bag", "m.bag"), ("mcap", "m.mcap"), ("out", "out"))]
    assert main(["run", str(folder / "s.yaml"), "--quiet", *recorders]) == 0
    return folder


@pytest.fixture
def _in_copy(inputs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(shutil.copytree(inputs, tmp_path / "copy"))


def contents() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in Path().rglob("*") if path.is_file()}


@pytest.mark.usefixtures("_in_copy")
@pytest.mark.parametrize(
    "command",
    [
        "view m.bag --html m.bag",
        "view m.mcap --html m.mcap",
        "view m.bag --compare m.mcap --html m.mcap",
        "view m.bag --scenario s.yaml --html s.yaml",
        "view out --html out/mission.json",
        "view s.yaml --html s.yaml",
        "view s.yaml --html plan.yaml",
        "run s.yaml --quiet --html s.yaml",
        "run s.yaml --quiet --bag s.yaml",
        "run s.yaml --quiet --bag ../copy/plan.yaml",
        "run on_map.yaml --quiet --html map.png",
        "run patrol.yaml --quiet --html g.graph",
        "view out --html out/trajectories/robot_0.tum",
        "analyse m.bag --json m.bag",
        "analyse m.bag --scenario s.yaml --json s.yaml",
        "plan render map.yaml --png map.png",
        "plan import map.yaml --out map.yaml",
        "plan import map.yaml --out o.yaml --png map.png",
        "scenario render on_map.yaml --png map.png",
        "field radio on_map.yaml --png map.png",
    ],
)
def test_file_that_a_command_reads_is_not_overwritten(refusal, command):
    before = contents()
    option, file = command.split()[-2:]
    line = refusal(*command.split())
    assert line == f"{option} {file}: would overwrite a file that this command reads; choose another file"
    assert contents() == before


@pytest.mark.usefixtures("_in_copy")
@pytest.mark.parametrize(
    ("command", "line"),
    [
        ("analyse m.bag --json x.png --png x.png", "--png x.png: would overwrite the file of --json"),
        ("run s.yaml --bag x --html ./x", "--html x: would overwrite the file of --bag"),
        ("analyse m.bag --csv o --json o/events.csv", "--json o/events.csv: would overwrite the file of --csv"),
        ("run s.yaml --bag x.mcap", "--bag x.mcap: is a name of MCAP files, which --mcap writes"),
        ("run s.yaml --out o --bag o/mission.json", "--bag o/mission.json: would overwrite the file of --out"),
        ("run s.yaml --out o --html o/trajectories/a", "--html o/trajectories/a: would be among the files of --out"),
        ("plan import map.yaml --out x.png --png x.png", "--png x.png: would overwrite the file of --out"),
        ("plan import map.yaml --out o.yaml --png no/o.png", "no/o.png: cannot be written: no is not a folder"),
        ("field radio s.yaml --png x.png --out no/x.npz", "no/x.npz: cannot be written: no is not a folder"),
        ("run s.yaml --bag no/o.bag", "no/o.bag: cannot be written: no is not a folder"),
        ("run s.yaml --html no/o.html", "no/o.html: cannot be written: no is not a folder"),
        ("run s.yaml --out o --mcap no/o.mcap", "no/o.mcap: cannot be written: no is not a folder"),
        ("view m.bag --html no/o.html", "no/o.html: cannot be written: no is not a folder"),
        ("scenario schema s.yaml", "s.yaml already exists; choose a name for JSON, such as scenario.schema.json"),
    ],
)
def test_no_output_is_written_if_one_of_them_cannot_be(refusal, command, line):
    before = contents()
    assert refusal(*command.split()).startswith(line)
    assert contents() == before
    assert not Path("o").exists()


@pytest.mark.usefixtures("_in_copy")
@pytest.mark.parametrize("name", ["plan.yaml", "hall.yaml"])
def test_imported_world_overwrites_no_plan_and_no_scenario(refusal, name):
    Path("plan.yaml").unlink()
    Path(name).write_text("mine")
    before = contents()
    line = refusal("plan", "import", WORLD, "--out", ".")
    assert line == f"{name} already exists; choose another name with --out, or --force replaces it"
    assert contents() == before


@pytest.mark.usefixtures("_in_copy")
@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("view m.bag --html o.html", "o.html"),
        ("run s.yaml --quiet --html o.html", "o.html"),
        ("run s.yaml --quiet --bag m.bag", "m.bag"),
        ("run s.yaml --quiet --mcap m.mcap", "m.mcap"),
        ("run s.yaml --quiet --out out", "out/mission.json"),
        ("run s.yaml --quiet --out out", "out/trajectories/robot_0.tum"),
    ],
)
def test_file_of_an_earlier_command_is_replaced(command, name):
    Path(name).write_text("old")
    assert main(command.split()) == 0
    assert Path(name).read_bytes() != b"old"


def test_output_that_is_a_link_is_refused_and_stays_one(tmp_path, refusal):
    link, target = tmp_path / "link.html", tmp_path / "target.html"
    target.write_text("mine")
    link.symlink_to(target)
    line = refusal("run", "tutorial_arena", "--set", "mission.time_limit_s=0.2", "--quiet", "--html", str(link))
    assert line == f"{link}: cannot be written: is a link, expected the name of the file itself"
    assert link.is_symlink()
    assert target.read_text() == "mine"


def test_name_that_is_not_utf_8_is_refused_before_anything_is_written(tmp_path, refusal, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = refusal("campaign", "\udcff.yaml", "--out", "c")
    assert line == r"\udcff.yaml: is not UTF-8; rename the file, or write the value in UTF-8"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("_in_copy")
def test_tables_do_not_overwrite_a_bag_among_them(refusal):
    shutil.copy("m.bag", "out/paths.csv")
    before = contents()
    line = refusal("analyse", "out/paths.csv", "--csv", "out")
    assert line == "--csv out/paths.csv: would overwrite a file that this command reads; choose another file"
    assert contents() == before


@pytest.mark.usefixtures("_in_copy")
@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("run s.yaml --quiet --html o.html", ".part-o.html"),
        ("run s.yaml --quiet --out out", ".part-mission.json"),
        ("analyse m.bag --json o.json", ".part-o.json"),
    ],
)
def test_file_with_the_name_of_an_incomplete_one_is_kept(command, name):
    for path in (Path(name), Path("out", name)):
        path.write_text("mine")
    assert main(command.split()) == 0
    assert Path(name).read_text() == Path("out", name).read_text() == "mine"
    assert [path.name for path in Path().rglob(".part-*")] == [name, name]


@pytest.mark.usefixtures("_in_copy")
@pytest.mark.parametrize("output", ["--bag o.bag", "--mcap o.mcap"])
def test_file_with_the_name_of_a_growing_recording_is_kept_unless_it_is_one(refusal, output):
    option, name = output.split()
    active = Path(f"{name}.active")
    command = ["run", "s.yaml", "--quiet", option, name]
    active.write_text("mine")
    assert refusal(*command) == f"{name}: cannot be written: {active} would be overwritten; move it first"
    assert active.read_text() == "mine"
    active.unlink()
    if option == "--bag":  # of a killed run
        active.write_bytes(Path("m.bag").read_bytes()[:5000])
    else:
        active.mkdir()
        (active / f"{active}.mcap").write_bytes(b"x")
    assert main(command) == 0
    assert not active.exists()
    if option == "--mcap":
        active.mkdir()
        (active / "metadata.yaml").write_text("mine")
        (active / "other").write_text("mine")
        assert "would be overwritten" in refusal(*command)
        assert (active / "metadata.yaml").read_text() == "mine"
