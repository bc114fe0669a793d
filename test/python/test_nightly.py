"""The targets that take long, one after the other."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]

MAKE = """#!/bin/sh
echo "made $2"
[ "$2" != bad ]
"""


def nightly(tmp_path: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    make = tmp_path / "make"
    make.write_text(MAKE)
    make.chmod(0o755)
    command = [ROOT / "setup" / "nightly.sh", *targets]
    return subprocess.run(
        command, env=os.environ | {"MAKE": str(make)}, capture_output=True, text=True, check=False, timeout=60
    )


def test_failed_target_is_in_the_table_and_the_others_run(tmp_path):
    done = nightly(tmp_path, "one", "bad", "two")
    assert [line for line in done.stdout.splitlines() if line.startswith("made")] == [
        "made one",
        "made bad",
        "made two",
    ]
    rows = [line.split()[:2] for line in done.stdout.splitlines()[-4:]]
    assert rows == [["target", "result"], ["one", "passed"], ["bad", "FAILED"], ["two", "passed"]]
    assert done.returncode == 1


def test_status_is_0_if_all_pass(tmp_path):
    assert nightly(tmp_path, "one", "two").returncode == 0


def test_nightly_has_each_target_that_make_test_leaves_out():
    makefile = (ROOT / "Makefile").read_text()
    [left_out] = re.findall(r"^test:.*; not (.*)$", makefile, re.MULTILINE)
    [run] = re.findall(r"^NIGHTLY \?= (.*)$", makefile, re.MULTILINE)
    assert run.split() == left_out.split(", ")
