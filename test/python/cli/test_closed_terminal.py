"""Commands whose terminal is closed: SIGHUP comes to all of its processes, and nothing can be written to it."""

from __future__ import annotations

import fcntl
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from robotteamsim.campaign.store import STORE_NAME, read_store
from robotteamsim.cli import main, run_command
from robotteamsim.ending import ending_signals
from robotteamsim.recording import BagWriter

LINES = [sys.executable, "-m", "robotteamsim.cli"]
TIMEOUT_S = 120


@contextmanager
def on_a_terminal(*words: str) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """Run a command on a terminal of its own; yield the process, and the terminal's other end."""
    own, terminal = pty.openpty()

    def take() -> None:
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    streams = {"stdin": terminal, "stdout": terminal, "stderr": terminal}
    with subprocess.Popen([*LINES, *words], **streams, start_new_session=True, preexec_fn=take) as process:
        os.close(terminal)
        yield process, own
        process.kill()


def read_until(own: int, process: subprocess.Popen[bytes], is_enough) -> None:
    """Read what a command shows on its terminal, which would block it otherwise, until a condition holds."""
    while not is_enough():
        assert process.poll() is None
        if select.select([own], [], [], 0.05)[0]:
            os.read(own, 65536)


@pytest.mark.slow
def test_run_on_a_closed_terminal_closes_its_recordings(tmp_path):
    bag, page = tmp_path / "m.bag", tmp_path / "m.mcap"
    active = tmp_path / "m.bag.active"
    with on_a_terminal("run", "garage_sar", "--bag", str(bag), "--mcap", str(page)) as (process, own):
        read_until(own, process, lambda: active.exists() and active.stat().st_size > 300_000)
        os.close(own)
        assert process.wait(TIMEOUT_S) == 129
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m.bag", "m.mcap"]
    assert [main(["analyse", str(file)]) for file in (bag, page)] == [0, 0]


ALL = (signal.SIGHUP, signal.SIGTERM)


@pytest.mark.parametrize(("number", "status"), [(signal.SIGHUP, 129), (signal.SIGTERM, 143)])
def test_further_signals_do_not_break_the_closing_of_a_recording(tmp_path, monkeypatch, capsys, number, status):
    """Bash sends SIGHUP to its jobs when the kernel has sent it to the terminal's; `timeout` sends SIGTERM twice."""

    class Sender:
        def begin(self, setup) -> None:
            pass

        def step(self, record) -> None:
            if record.sim_time_ns == 10**9:
                signal.raise_signal(number)
                signal.raise_signal(number)

        def end(self, result) -> None:
            raise AssertionError("the mission was not ended")

        def abandon(self) -> None:
            for further in ALL:
                signal.raise_signal(further)

    class Recorder(BagWriter):
        def abandon(self) -> None:
            for further in ALL:
                signal.raise_signal(further)
            super().abandon()

    bag = tmp_path / "m.bag"
    monkeypatch.setattr(run_command, "_recorders", lambda _: [Recorder(bag), Sender()])
    before = [signal.getsignal(each) for each in ending_signals()]
    assert main(["run", "tutorial_arena", "--quiet"]) == status
    assert capsys.readouterr().err.startswith("robotteamsim: terminated")
    assert [path.name for path in tmp_path.iterdir()] == ["m.bag"]
    assert main(["analyse", str(bag)]) == 0
    assert [signal.getsignal(each) for each in ending_signals()] == before


def test_only_ctrl_c_interrupts_the_clean_up_after_a_signal(monkeypatch, capsys):
    cleaned = []

    def command(_):
        try:
            signal.raise_signal(signal.SIGHUP)
        finally:
            for further in ALL:
                signal.raise_signal(further)
            cleaned.append("files")
            signal.raise_signal(signal.SIGINT)
            cleaned.append("no more")

    monkeypatch.setattr(run_command, "run", command)
    assert main(["run", "tutorial_arena"]) == 130
    assert cleaned == ["files"]
    assert capsys.readouterr().err == "robotteamsim: interrupted\n"


def test_signal_that_a_library_has_ignored_can_be_sent_again(monkeypatch):
    class Library:
        def __del__(self):
            signal.raise_signal(signal.SIGTERM)  # its exception is ignored

    def command(_):
        Library()
        signal.raise_signal(signal.SIGTERM)
        raise AssertionError("goes on")

    monkeypatch.setattr(run_command, "run", command)
    assert main(["run", "tutorial_arena"]) == 143


def num_trials(folder: Path) -> int:
    return len(read_store(folder).outcomes)


def states_of(group: int) -> list[str]:
    """Return the states of the processes of a session that have not ended."""
    stats = [path.read_text().rpartition(") ")[2].split() for path in Path("/proc").glob("[0-9]*/stat")]
    return [state for state, _, _, session, *_ in stats if session == str(group) and state != "Z"]


@pytest.mark.slow
def test_campaign_on_a_closed_terminal_keeps_its_trials_and_ends_its_workers(tmp_path):
    out = tmp_path / "out"
    words = ["campaign", "tutorial_arena", "--out", str(out), "--trials", "500", "--workers", "1"]
    with on_a_terminal(*words) as (process, own):
        read_until(own, process, lambda: (out / STORE_NAME).exists() and num_trials(out) > 2)
        os.close(own)
        assert process.wait(TIMEOUT_S) == 129
        limit_s = time.monotonic() + TIMEOUT_S
        while states_of(process.pid):  # workers end when they notice that the command has
            assert time.monotonic() < limit_s
    assert 2 < num_trials(out) < 500


def test_under_nohup_a_closed_terminal_ends_nothing():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert ending_signals() == (signal.SIGINT, signal.SIGTERM)
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        assert ending_signals() == (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)
