"""Whatever goes wrong is one line and an exit status: closed and full streams, odd names, signals, our own mistakes."""

from __future__ import annotations

import fcntl
import io
import json
import os
import signal
import struct
import subprocess
import sys
import termios
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from robotteamsim.cli import main, run_command
from robotteamsim.interface import Decision
from robotteamsim.scenario.shipped import scenario_names

LINES = [sys.executable, "-m", "robotteamsim.cli"]
SHORT = ("--set", "mission.time_limit_s=2")


def _shell(command: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a shell command in which $RUN is the command line."""
    environment = {**os.environ, "RUN": " ".join(LINES), **variables}
    return subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, env=environment, check=False, timeout=120
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "ended"),
    [
        ("scenario list > /dev/full", (1, "", "robotteamsim: standard output: No space left on device\n")),
        ("scenario list >&-", (0, "", "")),
        ("run nowhere.yaml 2>&-", (2, "", "")),
    ],
    ids=["full stdout", "closed stdout", "closed stderr"],
)
def test_stream_that_is_full_or_closed_is_one_line_or_no_error(command, ended):
    done = _shell(f"$RUN {command}")
    assert (done.returncode, done.stdout, done.stderr) == ended


@pytest.mark.slow
def test_encoding_without_the_characters_is_no_error(tmp_path):
    (tmp_path / "größe.yaml").write_text("plan: garage\nname: größe\nrobots: {count: 1, start: [2, 2, 0]}\n")
    done = _shell(f"$RUN scenario check {tmp_path}/größe.yaml", PYTHONIOENCODING="ascii")
    assert done.returncode == 0
    assert "gr\\xf6\\xdfe.yaml: valid" in done.stdout


@pytest.mark.parametrize("command", ["run", "analyse", "report", "scenario check", "plan render --png /tmp/x.png"])
def test_name_that_is_too_long_is_shortened_in_one_line(refusal, command):
    line = refusal(*command.split(), "x" * 300 + ".yaml")
    assert line.startswith("x" * 80 + "...")
    assert len(line) < 200


def test_folder_that_is_gone_is_named(tmp_path, monkeypatch, refusal):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert refusal("analyse", "a.bag") == "the current folder does not exist any more"


def test_nul_in_an_argument_is_rejected(refusal):
    assert refusal("analyse", "a\0.bag") == r"a\x00.bag: contains a NUL, which no name and no value does"


def test_value_that_is_too_long_is_shortened_in_one_line(refusal):
    for option in ("--noise", "--set"):
        assert len(refusal("run", "garage_sar", option, "x y " * 100)) < 200


def test_folder_of_a_mission_is_not_a_scenario_but_can_be_viewed(refusal, tmp_path):
    (tmp_path / "mission.json").touch()
    line = refusal("run", tmp_path)
    assert line == f"{tmp_path}: is a folder of `run --out`; `robotteamsim view` shows its mission"


def test_control_characters_of_names_are_escaped(refusal):
    assert refusal("run", "a\x1b[31m\nb.yaml") == r"a\x1b[31m\nb.yaml: there is no such file"
    assert (
        refusal("run", "garage_sar", "--set", r'run.seed="\e[1m"')
        == r"--set: run.seed: '\x1b[1m' is not a whole number"
    )


def test_names_of_a_scenario_are_short_and_printable(refusal):
    line = refusal("scenario", "check", "garage_sar", "--set", r'mission.victims.0.name="\e[2J"')
    assert line == r"--set: mission.victims.0.name: '\x1b[2J' has control characters"
    line = refusal("scenario", "check", "garage_sar", "--set", f"name={'a' * 101}")
    assert line.endswith(" is longer than 100 characters")


def test_markup_in_a_name_is_plain_text(capsys):
    assert main(["run", "garage_sar", *SHORT, "--set", "name='[/red]'"]) == 0
    assert "[/red]: 3 robots" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["run", "analyse", "plan import"])
def test_symlink_loop_is_rejected_in_one_line(tmp_path, refusal, command):
    loop = tmp_path / "loop.yaml"
    loop.symlink_to(loop)
    assert "Too many levels of symbolic links" in refusal(*command.split(), loop)


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("run {}", "a.yaml"),
        ("run tutorial_arena --set plan={}", "plan.yaml"),
        ("run tutorial_arena --set mission.patrol.graph={}", "a.graph"),
        ("campaign tutorial_arena --out c --design {}", "design.yaml"),
        ("plan import map.yaml", "map.png"),
        ("plan import {}", "a.world"),
        ("analyse {}", "a.bag"),
        ("analyse {}", "a.mcap"),
        ("view .", "mission.json"),
        ("report .", "campaign.sqlite"),
    ],
)
def test_fifo_in_place_of_a_file_is_rejected_and_not_waited_for(tmp_path, monkeypatch, refusal, command, name):
    monkeypatch.chdir(tmp_path)
    Path("map.yaml").write_text("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n")
    os.mkfifo(name)
    line = refusal(*command.format(name).split())
    assert name in line
    assert any(text in line for text in ("not a regular file", "there is no file", "there is no campaign.sqlite"))


def test_damaged_image_is_one_line_without_messages_of_libpng(tmp_path, capfd):
    image = io.BytesIO()
    Image.fromarray(np.full((40, 40), 254, np.uint8)).save(image, "PNG")
    data = bytearray(image.getvalue())
    data[-30] ^= 0xFF
    (tmp_path / "map.png").write_bytes(data)
    path = tmp_path / "map.yaml"
    path.write_text("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n")
    assert main(["plan", "import", str(path), "--out", str(tmp_path / "plan.yaml")]) == 2
    assert capfd.readouterr().err == f"robotteamsim: {path}: image: 'map.png' cannot be read as an image\n"


@pytest.mark.slow
@pytest.mark.parametrize(("options", "shown"), [([], False), (["--debug"], True)])
def test_warnings_are_shown_only_on_request(options, shown):
    code = """
import sys, warnings
from robotteamsim.cli import main, run_command
from robotteamsim.interface import Decision
run_command.Simulation = lambda scenario: warnings.warn("overflow") or 1 / 0
main(["run", "garage_sar", *sys.argv[1:]])
"""
    done = subprocess.run(
        [sys.executable, "-c", code, *options], capture_output=True, text=True, check=False, timeout=120
    )
    assert ("UserWarning: overflow" in done.stderr) == shown
    assert shown or done.stderr.count("\n") == 1


def test_bag_with_a_type_that_is_no_python_is_rejected_in_one_line(tmp_path, capsys):
    types = get_typestore(Stores.ROS1_NOETIC)
    definition = types.generate_msgdef("std_msgs/msg/String")[0].replace("data", "class")
    with Writer(tmp_path / "odd.bag") as bag:
        for topic in ("/mission/status", "/mission/events"):
            connection = bag.add_connection(topic, "my_msgs/msg/Odd", msgdef=definition, md5sum="0" * 32)
            bag.write(connection, 1, b"\x01\x00\x00\x00a")
    status = main(["analyse", str(tmp_path / "odd.bag")])
    assert status in (0, 2)
    assert "Traceback" not in capsys.readouterr().err


def test_names_in_a_foreign_bag_are_printed_without_control_characters_and_markup(tmp_path, capsys):
    types = get_typestore(Stores.ROS1_NOETIC)
    with Writer(tmp_path / "odd.bag") as bag:
        for name in ("\x1b[2Jrover", "[red]rover"):
            connection = bag.add_connection(f"/{name}/odom", "nav_msgs/msg/Odometry", typestore=types)
            for time_s in (1, 2):
                # Sequence number, stamp, two empty frames, pose; then covariances and twist.
                begin = struct.pack("<5I7d", 0, time_s, 0, 0, 0, *(6 * [0.0]), 1.0)
                bag.write(connection, 10**9 * time_s, begin + bytes(8 * 78))
    assert main(["analyse", str(tmp_path / "odd.bag")]) == 0
    captured = capsys.readouterr()
    assert "\x1b" not in captured.out + captured.err
    assert "\\x1b[2Jrover" in captured.out
    assert "[red]rover" in captured.out


def test_own_mistake_is_one_line_with_its_place_and_a_traceback_on_request(monkeypatch, capsys):
    monkeypatch.setattr(run_command, "Simulation", lambda scenario: 1 / 0)
    assert main(["run", "garage_sar"]) == 1
    line = capsys.readouterr().err
    assert line.startswith("robotteamsim: internal error: ZeroDivisionError: division by zero (test_last_defence.py:")
    assert line.endswith("); --debug shows more\n")
    assert main(["run", "garage_sar", "--debug"]) == 1
    assert capsys.readouterr().err.startswith("Traceback (most recent call last):")


def test_user_mistake_has_a_traceback_only_on_request(capsys):
    assert main(["--debug", "run", "nowhere.yaml"]) == 2
    error = capsys.readouterr().err
    assert "Traceback" in error
    assert error.endswith("\nrobotteamsim: nowhere.yaml: there is no such file\n")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status", "words"),
    [(signal.SIGTERM, 143, "terminated"), (signal.SIGHUP, 129, "terminated, because the terminal was closed")],
)
def test_terminated_run_leaves_a_readable_bag_or_nothing(tmp_path, number, status, words):
    out, bag = tmp_path / "o" / "out", tmp_path / "b" / "m.bag"
    command = [*LINES, "run", "garage_sar", "--out", str(out), "--bag", str(bag), "--quiet"]
    active = bag.with_name("m.bag.active")
    bag.parent.mkdir()
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        while not (active.exists() and active.stat().st_size > 300_000):
            assert process.poll() is None
        process.send_signal(number)
        _, error = process.communicate(timeout=60)
    assert (process.returncode, error) == (status, f"robotteamsim: {words}\n")
    assert main(["analyse", str(bag)]) == 0
    assert [path.name for path in sorted(tmp_path.rglob("*"))] == ["b", "m.bag"]


@pytest.mark.slow
def test_jupyter_backend_is_not_used(tmp_path):
    picture = tmp_path / "plan.png"
    done = _shell(f"$RUN plan render garage --png {picture}", MPLBACKEND="module://matplotlib_inline.backend_inline")
    assert (done.returncode, done.stderr) == (0, "")
    assert picture.read_bytes().startswith(b"\x89PNG")


CANNOT = "class Cannot:\n    def __init__(self, robot_id, scenario):\n        raise TypeError('no wheels')\n"


def test_controller_that_cannot_be_constructed_is_an_error(tmp_path, monkeypatch, refusal):
    (tmp_path / "cannot_of_test.py").write_text(CANNOT)
    monkeypatch.syspath_prepend(tmp_path)
    line = refusal("run", "garage_sar", *SHORT, "--set", "control.algorithm=cannot_of_test:Cannot")
    assert line == (
        "garage_sar: control.algorithm: 'cannot_of_test:Cannot' cannot be constructed for robot 0: "
        "TypeError: no wheels (cannot_of_test.py:3)"
    )


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("run", Path("maps/garage/plan.yaml")), "maps/garage/plan.yaml: this is a floor plan, not a scenario"),
        (("run", Path("maps/garage/map.yaml")), "maps/garage/map.yaml: this is a floor plan, not a scenario"),
        (
            ("plan", "render", "scenarios/garage_sar.yaml", "--png", "x.png"),
            "scenarios/garage_sar.yaml: this is a scenario, not a floor plan",
        ),
        (
            ("plan", "import", "maps/garage/plan.yaml", "--out", "x.yaml"),
            "maps/garage/plan.yaml: is a floor plan already; expected the yaml of an image",
        ),
    ],
)
def test_file_of_another_kind_is_rejected_with_a_hint(refusal, monkeypatch, arguments, line):
    monkeypatch.chdir(Path(__file__).parents[3])
    assert refusal(*arguments).startswith(line)


def test_help_names_every_shipped_scenario(capsys):
    for command in ("run", "campaign", "scenario show", "field radio"):
        with pytest.raises(SystemExit) as ended:
            main(["help", *command.split()])
        assert ended.value.code == 0
        shown = " ".join(capsys.readouterr().out.split())
        assert all(name in shown for name in scenario_names())


class Reshaping:
    """A controller that gives its scan the shape, or the type, that a network wants."""

    def __init__(self, robot_id, setup):
        pass

    def step(self, observation, inbox, task):
        ranges_m = observation.robot.ranges_m
        if observation.robot_id:
            ranges_m.dtype = np.int32
        else:
            ranges_m.shape = (1, -1)
        return Decision()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Setting the:DeprecationWarning")
def test_controller_that_reshapes_its_scan_changes_no_recording(tmp_path):
    mission = ("run", "tutorial_arena", *SHORT, "--quiet", "--set", "robots.count=2")
    assert main([*mission, "--bag", str(tmp_path / "odd.bag"), "--set", f"control.algorithm={__name__}:Reshaping"]) == 0
    scans = []
    with AnyReader([tmp_path / "odd.bag"]) as reader:
        for connection, _, data in reader.messages():
            if connection.topic.endswith("base_scan"):
                scans.append(reader.deserialize(data, connection.msgtype).ranges)
    assert {scan.shape for scan in scans} == {(181,)}
    assert np.min(scans) >= 0.0
    assert np.max(scans) <= 5.0


@pytest.mark.slow
def test_no_further_thread_is_one_line(monkeypatch, capsys):
    def start(_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(run_command, "run", start)
    assert main(["run", "tutorial_arena"]) == 1
    wanted = "robotteamsim: no more threads or processes can be started; raise `ulimit -u`\n"
    assert capsys.readouterr().err == wanted


@pytest.mark.slow
def test_pipe_that_does_not_block_gets_all_of_a_long_output():
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    command = [sys.executable, "-m", "robotteamsim.cli", "scenario", "schema"]
    with subprocess.Popen(command, stdout=writer, stderr=subprocess.PIPE, text=True) as process:
        os.close(writer)
        while process.poll() is None and _num_waiting(reader) < 60_000:  # until the pipe is full
            time.sleep(0.05)
        with open(reader) as file:
            schema = file.read()
        assert (process.wait(), process.stderr.read()) == (0, "")
    assert "properties" in json.loads(schema)


def _num_waiting(reader: int) -> int:
    """Return how many bytes a pipe holds."""
    return int.from_bytes(fcntl.ioctl(reader, termios.FIONREAD, bytes(4)), sys.byteorder)


@pytest.mark.slow
def test_home_that_cannot_be_written_is_no_error(tmp_path):
    done = _shell(f"$RUN plan render garage --png {tmp_path}/p.png", HOME="/proc", MPLCONFIGDIR="/proc/none")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_signal_behind_an_error_of_a_library_is_still_a_signal(monkeypatch, capsys, number, status, word):
    def library(_):
        try:
            os.kill(os.getpid(), number)
        except KeyboardInterrupt as error:
            raise ValueError("cannot build") from error

    monkeypatch.setattr(run_command, "run", library)
    assert main(["run", "tutorial_arena"]) == status
    assert capsys.readouterr().err == f"robotteamsim: {word}\n"


@pytest.mark.slow
def test_signal_that_a_library_cannot_raise_prints_no_traceback(monkeypatch, capsys):
    class Library:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)  # its exception is ignored

    def callback(_):
        Library()
        raise ValueError("cannot build")

    monkeypatch.setattr(run_command, "run", callback)
    assert main(["run", "tutorial_arena"]) == 130
    assert capsys.readouterr().err == "robotteamsim: interrupted\n"


@pytest.mark.slow
def test_a_mission_runs_in_another_thread():
    statuses = []
    words = ["run", "tutorial_arena", "--json", "--set", "mission.time_limit_s=1"]
    thread = threading.Thread(target=lambda: statuses.append(main(words)))
    thread.start()
    thread.join()
    assert statuses == [0]


@pytest.mark.parametrize(
    "code",
    [
        pytest.param("atexit.register(interrupt)", id="after the command"),
        pytest.param(
            """
class Interrupting(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == 'robotteamsim.cli.command_line':
            interrupt()
            raise ImportError('what NumPy makes of KeyboardInterrupt')
sys.meta_path.insert(0, Interrupting())
""",
            id="before the command",
        ),
    ],
)
def test_ctrl_c_before_and_after_a_command_prints_no_traceback(tmp_path, code):
    imports = "import atexit, importlib.abc, os, signal, sys\n"
    interrupt = "def interrupt():\n    os.kill(os.getpid(), signal.SIGINT)\n"
    (tmp_path / "sitecustomize.py").write_text(imports + interrupt + code)
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}"}
    command = [sys.executable, "-m", "robotteamsim.cli", "--version"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (-signal.SIGINT, "")
