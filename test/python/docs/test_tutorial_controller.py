"""The tutorial's files, literally as printed, run headless: by place, by name, and beside a faulty teammate."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from robotteamsim.scenario import load
from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.simulation import Simulation
from robotteamsim.testing import check_controller

ROOT = Path(__file__).parents[3]
TUTORIAL = ROOT / "docs" / "tutorial_controller.md"
BLOCKS = re.findall(r"```(python|toml)\n(.*?)```", TUTORIAL.read_text(), re.DOTALL)
FILES = dict(zip(("my_controller.py", "pyproject.toml", "my_node.py"), (text for _, text in BLOCKS), strict=True))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The tutorial's Python class and its package, in a folder of their own."""
    for name in ("my_controller.py", "pyproject.toml"):
        (tmp_path / name).write_text(FILES[name])
    return tmp_path


@pytest.fixture
def on_path(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder, where Python finds the class."""
    monkeypatch.syspath_prepend(folder)
    yield folder
    sys.modules.pop("my_controller", None)


@pytest.mark.parametrize("name", FILES)
def test_template_is_the_file_that_the_tutorial_prints(name):
    assert (ROOT / "templates" / "controller" / name).read_text() == FILES[name]


def test_readme_leads_to_the_tutorial():
    assert f"({TUTORIAL.relative_to(ROOT)})" in (ROOT / "README.md").read_text()


@pytest.mark.usefixtures("on_path")
def test_tutorial_class_drives_about_and_touches_nothing_for_long():
    overrides = ["control.algorithm=my_controller:MyController", "mission.time_limit_s=60"]
    result = Simulation(load("tutorial_arena", overrides)).run()
    assert result.end == "time_limit"
    assert result.robots[0].distance_m > 10.0
    assert result.robots[0].contact_s < 6.0
    assert result.robots[0].longest_stay_s < 30.0


@pytest.mark.usefixtures("on_path")
def test_tutorial_class_keeps_the_rules_of_controllers():
    check_controller("my_controller:MyController", "garage_unknown", steps=30)


@pytest.mark.slow
@pytest.mark.usefixtures("on_path")
def test_tutorial_class_sends_heard_voices_to_its_teammates():
    simulation = Simulation(load("garage_sar", ["control.algorithm=my_controller:MyController", "voice.noise_db=0"]))
    for _ in range(1200):
        record = simulation.step()
    controllers = [guard.controller for guard in simulation.controllers.guards]
    assert any(controller.heard_of for controller in controllers)
    assert not any(decision.fault for decision in record.decisions)


@pytest.mark.slow
def test_command_line_of_the_tutorial_runs_the_class(folder):
    (command,) = re.findall(r"^PYTHONPATH=\S+ robotteamsim (run .*)$", TUTORIAL.read_text(), re.MULTILINE)
    done = run_cli(folder, *command.split(), "--set", "mission.time_limit_s=5")
    assert done.returncode == 0, done.stderr
    assert "time limit reached" in done.stdout


@pytest.mark.slow
def test_package_of_the_tutorial_installs_and_is_known_by_its_name(folder, tmp_path):
    target = tmp_path / "installed"
    pip = (sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation")
    subprocess.run((*pip, "--target", str(target), str(folder)), check=True, capture_output=True)
    shutil.rmtree(folder / "build", ignore_errors=True)
    arguments = ("run", "tutorial_arena", "--set", "mission.time_limit_s=5", "--set")
    done = run_cli(target, *arguments, "control.algorithm=mine")
    assert done.returncode == 0, done.stderr
    assert "time limit reached" in done.stdout
    done = run_cli(target, *arguments, "control.algorithm=mien")
    assert done.returncode == 2
    known = ", ".join([*ALGORITHMS, "mine"])
    line = f"'mien' is not known; expected one of: {known}, module:Class, or policy.pt; did you mean 'mine'?"
    assert " ".join(done.stderr.split()).endswith(f"tutorial_arena: control.algorithm: {line}")


@pytest.mark.usefixtures("on_path")
def test_fault_of_one_robot_is_an_event_and_the_mission_goes_on(folder):
    (folder / "faulty_of_test.py").write_text(
        "from my_controller import MyController\n\n\nclass Faulty(MyController):\n    def step(self, *inputs):\n"
        "        decision = super().step(*inputs)\n"
        "        if self.robot_id == 1 and inputs[0].sim_time_ns == 2_000_000_000:\n"
        "            1 / 0\n"
        "        return decision\n"
    )
    overrides = ["control.algorithm=faulty_of_test:Faulty", "mission.time_limit_s=10"]
    simulation = Simulation(load("garage_sar", overrides))
    events, records = [], []
    while not records or records[-1].mission.state != "ended":
        records.append(simulation.step())
        events += records[-1].events
    (failed,) = [event for event in events if event.kind == "controller_failed"]
    assert failed.robot_id == 1
    assert failed.detail == "robot 1 is stopped: ZeroDivisionError: division by zero (faulty_of_test.py:8)"
    assert records[-1].mission.end == "time_limit"
    stood = [record.decisions[1].twist for record in records if record.sim_time_ns >= 2_000_000_000]
    assert {twist.is_finite and twist.linear_x_mps == twist.angular_z_radps == 0.0 for twist in stood} == {True}
    assert records[-1].decisions[0].twist.linear_x_mps != 0.0 or records[-1].decisions[2].twist.linear_x_mps != 0.0


def run_cli(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the command line with a folder in front of Python's path."""
    path = os.pathsep.join(filter(None, (str(folder), os.environ.get("PYTHONPATH"))))
    code = "import sys; from robotteamsim.cli import main; sys.exit(main())"
    return subprocess.run(
        (sys.executable, "-c", code, *arguments),
        env=os.environ | {"PYTHONPATH": path, "COLUMNS": "200"},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
