from __future__ import annotations

import io
import json
import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from rich.console import Console
from rosbags.rosbag1 import Reader

import robotteamsim
from robotteamsim import scenario
from robotteamsim.cli import main
from robotteamsim.cli.progress import working

SHORT = ("--set", "mission.time_limit_s=2")


def run(*arguments: str, folder: Path | None = None, **settings) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "robotteamsim.cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False, timeout=120, **settings)


def test_run_prints_a_table_of_what_happened(capsys):
    assert main(["run", "garage_sar", "--seed", "7", *SHORT]) == 0
    out = capsys.readouterr().out
    assert "garage_sar: 3 robots, 10 dB noise, seed 7" in out
    assert "0.0 s   mission starts: 5 areas, 4 victims, 10 dB noise" in out
    assert "time limit reached" in out
    assert "0 of 5" in out


def test_run_json_prints_one_object_with_the_result(capsys):
    assert main(["run", "garage_sar", "--json", "--noise", "20", "--robots", "2", *SHORT]) == 0
    result = json.loads(capsys.readouterr().out)
    assert len(result["trajectory_hash"]) == 64
    assert (result["areas_explored"], result["victims_saved"], result["endangered_links"]) == (0, 0, 0)
    assert (result["end"], result["time_s"], result["noise_db"]) == ("time_limit", 2.0, 20.0)
    assert len(result["robots"]) == 2


def test_quiet_run_prints_nothing(capsys):
    assert main(["run", "garage_sar", "--quiet", *SHORT]) == 0
    captured = capsys.readouterr()
    assert captured.out == captured.err == ""


def test_seed_decides_the_trajectories(capsys):
    def trajectory_hash(seed: str) -> str:
        assert main(["run", "garage_sar", "--json", "--seed", seed, *SHORT]) == 0
        return json.loads(capsys.readouterr().out)["trajectory_hash"]

    assert trajectory_hash("7") == trajectory_hash("7") != trajectory_hash("8")


@pytest.mark.slow
def test_out_and_bag_are_written(capsys, tmp_path):
    out, bag = tmp_path / "out", tmp_path / "m.bag"
    assert main(["run", "garage_sar", "--json", "--out", str(out), "--bag", str(bag), *SHORT]) == 0
    result = json.loads(capsys.readouterr().out)
    document = json.loads((out / "mission.json").read_text())
    assert document["result"]["trajectory_hash"] == result["trajectory_hash"]
    assert document["scenario"]["mission"]["time_limit_s"] == 2
    assert sorted(os.listdir(out / "trajectories")) == ["robot_0.tum", "robot_1.tum", "robot_2.tum"]
    with Reader(bag) as reader:
        assert reader.topics["/robot_2/odom"].msgcount == result["steps"]
    assert sorted(os.listdir(tmp_path)) == ["m.bag", "out"]


def test_unwritable_out_is_rejected_before_the_mission_and_leaves_no_bag(refusal, tmp_path):
    (tmp_path / "file").touch()
    bag = tmp_path / "m.bag"
    line = refusal("run", "garage_sar", "--out", str(tmp_path / "file" / "out"), "--bag", str(bag))
    assert line == f"{tmp_path}/file/out/trajectories: cannot be written: Not a directory"
    assert os.listdir(tmp_path) == ["file"]


def test_unwritable_bag_is_rejected(refusal, tmp_path):
    line = refusal("run", "garage_sar", "--bag", str(tmp_path))
    assert line == f"{tmp_path}: cannot be written: is a folder, expected a file name"


def test_devices_are_never_replaced(refusal, tmp_path):
    pipe = tmp_path / "pipe.png"
    os.mkfifo(pipe)
    wanted = f"{pipe}: cannot be written: is a device, expected a file name"
    assert refusal("run", "garage_sar", "--bag", str(pipe)) == wanted
    assert refusal("plan", "render", "garage", "--png", str(pipe)) == wanted
    assert pipe.is_fifo()


@pytest.mark.parametrize(
    ("option", "robots", "line"),
    [
        ("--bag", 1001, "m.bag: 1001 robots have too many topics for one file; expected at most 1000 (robots.count)"),
        ("--mcap", 1001, "m.mcap: 1001 robots have too many topics for one file; expected at most 1000 (robots.count)"),
        ("--html", 200, "m.html: a page of 200 robots for 600 s has up to 60 million links in all frames; "),
    ],
)
def test_file_that_would_be_too_large_is_rejected_before_the_mission(
    refusal, monkeypatch, tmp_path, option, robots, line
):
    monkeypatch.chdir(tmp_path)
    close = ("--set", "control.algorithm=random_walk", "--set", "robots.spacing_m=0.5")
    file = line.partition(":")[0]
    assert refusal("run", "garage_sar", "--robots", str(robots), *close, option, file).startswith(line)
    assert os.listdir(tmp_path) == []


def test_waiting_is_shown_on_a_terminal():
    console = Console(file=io.StringIO(), force_terminal=True, width=100)
    with working(console, "hall", "preparing"):
        pass
    assert "hall preparing 0:00:0" in re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", console.file.getvalue())


@pytest.mark.slow
def test_full_disk_ends_the_run_with_one_line_and_no_result(tmp_path):
    import resource

    done = run(
        "run",
        "garage_sar",
        "--out",
        "out",
        "--bag",
        "m.bag",
        folder=tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, 1_000_000)),
    )
    assert (done.returncode, done.stdout) == (2, "")
    wanted = "m.bag.active: cannot be written: File too large; `rosbag reindex m.bag.active` recovers what was recorded"
    assert done.stderr == f"robotteamsim: {wanted}\n"
    assert os.listdir(tmp_path) == ["m.bag.active"]


@pytest.mark.slow
def test_interrupted_run_exits_130_with_one_line_and_closes_the_bag(tmp_path):
    command = [sys.executable, "-m", "robotteamsim.cli", "run", "garage_sar", "--bag", "m.bag", "--set"]
    process = subprocess.Popen(
        [*command, "robots.count=30"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    active = tmp_path / "m.bag.active"
    while process.poll() is None and not (active.exists() and active.stat().st_size > 2_000_000):
        os.sched_yield()
    process.send_signal(signal.SIGINT)
    out, errors = process.communicate(timeout=60)
    assert (process.returncode, out, errors) == (130, "", "robotteamsim: interrupted\n")
    with Reader(tmp_path / "m.bag") as reader:
        assert reader.topics["/robot_29/odom"].msgcount > 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ["scenario", "show", "garage_sar"],
        ["run", "tutorial_arena", "--set", "mission.time_limit_s=1"],
        ["--version"],
        ["help", "run"],
    ],
    ids=["text", "table", "version", "help"],
)
def test_broken_pipe_is_silent(arguments):
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "robotteamsim.cli", *arguments]
    # With a buffer, what is written last fails only at the end.
    settings = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, env=settings, text=True, check=False)
    os.close(writer)
    assert done.stderr == ""
    assert done.returncode == 141


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "line"),
    [
        ("rnu", "no such command 'rnu'; did you mean 'run'? (see `robotteamsim --help`)"),
        ("scenario zzz", "no such command 'zzz'; expected one of check, show, render, schema, list"),
        ("completion fsh", "shell: 'fsh' is not valid; expected one of bash, zsh, fish, tcsh"),
        ("run", "the following arguments are required: SCENARIO (see `robotteamsim run --help`)"),
        ("run garage_sar --seed x", "argument --seed: 'x' is not a whole number"),
        ("run garage_sar --noise nan", "argument --noise: 'nan' is not a number"),
        ("run garage_sar --seed -1", "--seed: -1 is below 0"),
        ("run garage_sar --noise 99", "--noise: 99 is above 80"),
        (
            "run garage_sar --set control.localisation=tf",
            "--set: control.localisation: 'tf' is available only in ROS; expected ground_truth, odometry or laser",
        ),
        ("run garage_sar --robots 0", "--robots: 0 is below 1"),
        ("run garage_sar --set run.seed=-1", "--set: run.seed: -1 is below 0"),
        ("run garage_sar --set control.alfa=1", "--set: control.alfa: unknown key; did you mean 'alpha'?"),
        ("run garage_sar --set seed", "--set: 'seed' is not of the form KEY=VALUE"),
        ("run garage_sa", "garage_sa: no shipped scenario of this name; did you mean 'garage_sar'?"),
        ("run no/such.yaml", "no/such.yaml: there is no such file"),
        ("run garage_sar --set control.algorithm=rdpos", "control.algorithm: 'rdpos' is not"),
        ("plan import no.yaml --out x.yaml", "no.yaml: there is no such file"),
        (
            "field radio garage_sar",
            "no output given; use --png FILE for a picture, --out FILE.npz for the values, or both",
        ),
        ("field radio garage_sar --png x.jpg", "argument --png: 'x.jpg' does not end in .png, .pdf or .svg"),
        ("plan render garage --png x", "argument --png: 'x' does not end in .png, .pdf or .svg"),
        ("scenario render garage_sar --png x.eps", "argument --png: 'x.eps' does not end in .png, .pdf or .svg"),
        ("analyse a.bag --png x.gif", "argument --png: 'x.gif' does not end in .png, .pdf or .svg"),
        ("field radio garage_sar --out x.csv", "--out x.csv: expected a name that ends in .npz"),
        (
            "field voice garage_sar --range wide --png x.png",
            "--range: 'wide' is not valid; expected one of drawn, lowest, highest",
        ),
        ("field radio garage_sar --resolution 0 --png x.png", "--resolution 0 is outside 0.01 to 10 m"),
        (
            "field radio garage_sar --compare at=4,5 --png x.png",
            "--compare is given once; expected 2 to 9, one for each map",
        ),
        (
            "field radio garage_sar --compare at=4,5 --compare at=4 --png x.png",
            "--compare: at: '4' does not have the form X,Y",
        ),
        (
            "field radio garage_sar --compare at=4,5 --compare at=99,4 --png x.png",
            "--compare: at=99,4 lies outside the plan, [0, 0] .. [60, 40]",
        ),
        (
            "field voice garage_sar --compare range=lowest --compare range=low --png x.png",
            "--compare: range: 'low' is not valid; expected one of drawn, lowest, highest",
        ),
        (
            "field voice garage_sar --compare lowest --compare highest --png x.png",
            "--compare: 'lowest' does not have the form KEY=VALUE, such as voice.noise_db=20 or at=4,5",
        ),
        (
            "field voice garage_sar --compare voice.noise=1 --compare voice.noise=2 --png x.png",
            "--compare: voice.noise: unknown key; did you mean 'noise_db'?",
        ),
        ("field radio garage_sar --at 1 --png x.png", "argument --at: '1' does not have the form X,Y"),
        ("field voice garage_sar --at 99,1 --png x.png", "--at 99,1 lies outside the plan"),
        (
            "field voice garage_sar --set run.seed=2 --compare range=lowest --compare voice.noise_db=x --png x.png",
            "--compare: voice.noise_db: 'x'",
        ),
        (
            "field voice garage_sar --set run.seed=2 --compare range=lowest --compare voice..a=1 --png x.png",
            "--compare: 'voice..a=1' is not of the form KEY=VALUE",
        ),
        (
            "field voice garage_sar --set voice.noise=1 --compare range=lowest --compare voice.noise_db=20 --png x.png",
            "--set: voice.noise: unknown key; did you mean 'noise_db'?",
        ),
        ("plan render garage --level L2 --png x.png", "--level: garage has no level 'L2'; known: none"),
        ("plan render garage --png no/plan.png", "no/plan.png: cannot be written: no is not a folder"),
        ("run garage_sar --bag ''", "argument --bag: the name is empty (see `robotteamsim run --help`)"),
        ("campaign garage_sar --out d --scheduler ''", "argument --scheduler: the address is empty"),
        ("campaign garage_sar --out ''", "argument --out: the name is empty"),
        ("benchmark search --out /dev/null", "argument --out: '/dev/null' is not a folder"),
        ("run garage_sar --sed 7", "no such option '--sed'; did you mean '--seed'?"),
        ("campaign garage_sar --out d --worker=2", "no such option '--worker'; did you mean '--workers'"),
        ("run garage_sar twice", "'twice' is one argument too many"),
        ("run garage", "garage: this is a floor plan, not a scenario; scenarios: garage_fire, "),
        ("analyse a.bag b.bag --gif a.gif", "a film shows one bag, got 2; use --join for the parts of one recording"),
        ("analyse a.bag --gif a.gif --seconds 0.5", "--seconds 0.5 is outside 1 to 600 s"),
        ("analyse a.bag --mp4 a.gif", "--mp4 a.gif: expected a name that ends in .mp4"),
        ("analyse a.bag --gif a.mp4", "--gif a.mp4: expected a name that ends in .gif"),
        ("analyse a.bag --gif a.gif --camera 0", "--camera: needs --scenario, and --gif or --mp4"),
        ("analyse a.bag --scenario garage_sar --camera 0", "--camera: needs --scenario, and --gif or --mp4"),
        (
            "analyse 1.bag 2.bag 3.bag 4.bag 5.bag 6.bag 7.bag --png a.png",
            "--png: 7 bags do not fit side by side; expected at most 6",
        ),
        ("analyse no.bag --json no/a.json", "no/a.json: cannot be written: no is not a folder"),
        ("analyse a.bag ./a.bag", "a.bag is given twice"),
        ("run garage_sar --mcap mission.bag", "mission.bag: expected a name that ends in .mcap"),
    ],
)
def test_mistake_is_reported_in_one_line_with_exit_status_2(refusal, monkeypatch, tmp_path, command, line):
    monkeypatch.chdir(tmp_path)
    assert line in refusal(*shlex.split(command))
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("option", ["--version", "-V"])
def test_version_is_printed(capsys, option):
    with pytest.raises(SystemExit) as left:
        main([option])
    assert left.value.code == 0
    assert capsys.readouterr().out == f"robotteamsim {robotteamsim.__version__}\n"


@pytest.mark.parametrize(
    "arguments", [[], ["run"], ["scenario"], ["scenario", "show"], ["plan", "import"], ["field", "radio"]]
)
def test_help_helps(capsys, arguments):
    with pytest.raises(SystemExit) as left:
        main([*arguments, "--help"])
    assert left.value.code == 0
    assert f"usage: {' '.join(['robotteamsim', *arguments])}" in capsys.readouterr().out


def test_help_gives_examples(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    assert "robotteamsim run garage_sar --seed 7 --noise 20" in capsys.readouterr().out


@pytest.mark.slow
def test_scenario_check_summarises_valid_scenarios(capsys):
    assert main(["scenario", "check", "garage_sar"]) == 0
    assert capsys.readouterr().out == "garage_sar: valid: 3 robots, 5 areas, 4 victims in garage of 60 x 40 m\n"


@pytest.mark.slow
def test_scenario_check_takes_overrides(capsys):
    assert main(["scenario", "check", "tutorial_arena", "--set", "robots.count=2"]) == 0
    assert capsys.readouterr().out.startswith("tutorial_arena: valid: 2 robots, 4 areas, 1 victim in ")
    assert main(["scenario", "check", "tutorial_arena", "--set", "control.localisation=tf"]) == 0  # for ROS
    assert "valid" in capsys.readouterr().out
    assert main(["scenario", "check", "tutorial_arena", "--set", "robots.count=none"]) == 2
    assert capsys.readouterr().err.startswith("robotteamsim: --set: robots.count: ")


@pytest.mark.parametrize(
    ("algorithm", "message"),
    [
        ("nope", "control.algorithm: 'nope' is not known; expected one of: rdpso, "),
        ("fractions:Fraction", "control.algorithm: fractions:Fraction: TypeError: both arguments should be "),
    ],
)
def test_scenario_check_reports_unusable_controllers(capsys, algorithm, message):
    assert main(["scenario", "check", "tutorial_arena", "--set", f"control.algorithm={algorithm}"]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith(f"robotteamsim: tutorial_arena: {message}")
    assert (captured.out, captured.err.count("\n")) == ("", 1)


def test_scenario_check_reports_every_mistake_of_every_file(capsys, tmp_path):
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    first.write_text("name: a\nplan: garage\nrobots: {count: -1, start: [4, 5, 0]}\nvoice: {noise_db: 99}\n")
    second.write_text("nonsense\n")
    assert main(["scenario", "check", "garage_sar", str(first), str(second)]) == 2
    captured = capsys.readouterr()
    assert captured.out.startswith("garage_sar: valid: ")
    lines = captured.err.splitlines()
    assert len(lines) == 3
    assert all(line.startswith("robotteamsim: ") for line in lines)
    assert "first.yaml: robots.count: -1 is below 0" in captured.err
    assert "first.yaml: voice.noise_db: 99 is above 80" in captured.err
    assert "second.yaml: " in lines[2]


def test_control_characters_of_keys_are_printed_as_text(capsys, tmp_path):
    file = tmp_path / "odd.yaml"
    file.write_text('name: a\nplan: garage\n"\\e[31m": 1\n"a\\nb": 2\nzz: 3\n')
    assert main(["scenario", "check", str(file)]) == 2
    lines = capsys.readouterr().err.splitlines()
    keys = [re.fullmatch(r"robotteamsim: .*odd\.yaml: (.+): unknown key.*", line).group(1) for line in lines]
    assert keys == [r"\x1b[31m", r"a\nb", "zz"]
    assert all(line.isprintable() for line in lines)
    # That it has no team is said when its keys are right.
    file.write_text("name: a\nplan: garage\n")
    assert main(["scenario", "check", str(file)]) == 2
    assert ": robots: missing; expected a team" in capsys.readouterr().err


def test_mistake_of_many_elements_is_reported_ten_times(capsys, tmp_path):
    file = tmp_path / "many.yaml"
    walls = [{"name": f"w{i}", "from": [1, 1 + i], "to": [2, 1 + i], "thickness": 0.2} for i in range(30)]
    file.write_text(yaml.safe_dump({"name": "a", "bounds": {"min": [0, 0], "max": [40, 40]}, "walls": walls}))
    scenario_file = tmp_path / "of_it.yaml"
    scenario_file.write_text("name: a\nplan: many.yaml\nrobots: {start: [4, 5, 0]}\n")
    assert main(["scenario", "check", str(scenario_file)]) == 2
    *shown, last = capsys.readouterr().err.splitlines()
    assert len(shown) == 10
    assert shown[9].endswith("many.yaml: walls.9.thickness: unknown key; did you mean 'thickness_m'? (in 'w9')")
    assert last.endswith("many.yaml: 20 more mistakes")


@pytest.mark.slow
def test_shown_scenario_is_read_back_as_the_same(capsys, tmp_path):
    assert main(["scenario", "show", "garage_sar", "--set", "run.seed=5"]) == 0
    shown = tmp_path / "shown.yaml"
    shown.write_text(capsys.readouterr().out)
    assert scenario.load(shown) == scenario.load("garage_sar", ["run.seed=5"])


@pytest.mark.slow
def test_schema_is_printed_or_written(capsys, tmp_path):
    assert main(["scenario", "schema"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["properties"]["mission"]
    assert main(["scenario", "schema", str(tmp_path / "schema.json")]) == 0
    assert json.loads((tmp_path / "schema.json").read_text()) == printed


def test_list_has_a_line_about_each_shipped_scenario(capsys):
    assert main(["scenario", "list"]) == 0
    lines = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines()]
    assert [name for name, _ in lines] == scenario.scenario_names()
    about = dict(lines)["garage_sar"]
    assert about == "Three robots search a basement garage: five areas in order, four victims who call for help"


def test_program_alone_prints_its_help(capsys):
    with pytest.raises(SystemExit, match=r"^0$"):
        main([])
    assert capsys.readouterr().out.startswith("usage: robotteamsim")


def test_imported_map_is_a_plan_to_run_in(capsys, refusal, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    rows = ["#" * 60] + ["#" + "." * 58 + "#"] * 58 + ["#" * 60]
    pixels = bytes(0 if cell == "#" else 254 for row in rows for cell in row)
    Path("room.pgm").write_bytes(b"P5\n60 60\n255\n" + pixels)
    Path("room.yaml").write_text(
        "image: room.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    assert main(["plan", "import", "room.yaml"]) == 0
    assert capsys.readouterr().out.startswith("plan.yaml: ")
    assert yaml.safe_load(Path("plan.yaml").read_text())["bounds"]["max"] == [6.0, 6.0]
    assert "plan.yaml already exists; choose another name with --out" in refusal("plan", "import", "room.yaml")
    Path("trial.yaml").write_text("name: trial\nplan: plan.yaml\nrobots: {count: 2, start: [3, 3, 0]}\n")
    assert main(["run", "trial.yaml", "--quiet", "--set", "mission.time_limit_s=1"]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["radio", "voice"])
def test_field_picture_is_written(capsys, tmp_path, kind):
    picture = tmp_path / "field.png"
    assert main(["field", kind, "tutorial_arena", "--at", "5,2", "--png", str(picture)]) == 0
    assert capsys.readouterr().out == f"{picture}\n"
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ["radio", "--at", "-1,1", "--at", "5,5"],
        ["radio", "--loss", "--compare", "at=1,1", "--compare", "at=5,5"],
        ["voice", "--range", "lowest"],
        ["voice", "--compare", "range=lowest", "--compare", "range=highest voice.noise_db=30"],
    ],
)
def test_field_maps_are_compared_in_one_picture_and_written_as_numbers(capsys, tmp_path, arguments):
    picture, archive = tmp_path / "field.png", tmp_path / "field.npz"
    kind, *rest = arguments
    assert main(["field", kind, "tutorial_arena", *rest, "--png", str(picture), "--out", str(archive)]) == 0
    assert capsys.readouterr().out.splitlines() == [str(picture), str(archive)]
    with np.load(archive) as arrays:
        assert arrays["values"].shape[-2:] == (500, 500)
        assert arrays["values"].ndim == (3 if "--compare" in rest else 2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "name", "start"),
    [
        (["plan", "render", "garage"], "plan.png", b"\x89PNG"),
        (["scenario", "render", "garage_sar"], "scenario.SVG", b"<?xml"),
        (["plan", "render", "tutorial_arena"], "plan.pdf", b"%PDF"),
    ],
)
def test_plan_or_scenario_is_drawn_as_the_kind_of_its_suffix(capsys, tmp_path, arguments, name, start):
    picture = tmp_path / name
    assert main([*arguments, "--png", str(picture)]) == 0
    assert capsys.readouterr().out == f"{picture}\n"
    drawn = picture.read_bytes()
    assert drawn.startswith(start)
    assert main([*arguments, "--png", str(picture)]) == 0
    assert picture.read_bytes() == drawn
