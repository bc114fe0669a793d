"""The launch command of docs/own_building.md, in the reader's folder."""

from __future__ import annotations

import re
import runpy
import subprocess
from pathlib import Path

from running import ROSLAUNCH, running

MAKE = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "make_own_building.py"))


def test_mission_in_the_drawn_house_runs_in_ros(tmp_path: Path) -> None:
    MAKE["prepare"](tmp_path)
    subprocess.run(MAKE["commands"]()[0], shell=True, cwd=tmp_path, check=True)
    (command,) = re.findall(r"^roslaunch (.*)$", MAKE["PAGE"].read_text(), re.MULTILINE)
    with running((*ROSLAUNCH, *command.split()), tmp_path) as program:
        assert program.wait() == 0, program.output
    assert "all areas are explored; 4/4 areas, 2/2 victims" in program.output
