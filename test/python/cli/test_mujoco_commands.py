"""`plan export-mujoco`."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

from robotteamsim.cli import main
from robotteamsim.scenario import load
from robotteamsim.setup import resolve

ODD_NAME = 'objects=[{name: "<&\'>", kind: barrel, radius_m: 0.3, pose: [20, 7, 0]}]'


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _exported(name: str, *overrides: str) -> mujoco.MjModel:
    settings = [word for override in overrides for word in ("--set", override)]
    assert main(["plan", "export-mujoco", name, "--out", "out", *settings]) == 0
    return mujoco.MjModel.from_xml_path(f"out/{name}.xml")


def test_mujoco_reads_the_exported_garage(capsys):
    model = _exported("garage_sar", ODD_NAME, "robots.reserve=1")
    assert capsys.readouterr().out == "out/garage_sar.xml: 2 robots, 1 object\n"
    names = [model.body(i).name for i in range(model.nbody)]
    assert [name for name in names if "/" not in name] == [
        "world",
        "door stair_door",  # the other door is open, so it has no leaf
        "robot_0",
        "robot_1",
        "barrel <&'>",
    ]
    scenario = load("garage_sar")
    south = model.geom("wall south")
    np.testing.assert_allclose(south.size, [30.0, 0.15, 1.3])
    np.testing.assert_allclose(model.geom("floor").size[:2], [30.0, 20.0])
    for i, robot in enumerate(resolve(scenario).robots[:2]):
        np.testing.assert_allclose(model.body(f"robot_{i}").pos[:2], robot.start_pose[:2])


def test_model_is_not_replaced_without_force(refusal, capsys):
    _exported("tutorial_arena")
    capsys.readouterr()
    command = ["plan", "export-mujoco", "tutorial_arena", "--out", "out"]
    line = refusal(*command)
    assert line == "out/tutorial_arena.xml already exists; choose another name with --out, or --force replaces it"
    assert main([*command, "--force"]) == 0


def test_body_that_mujoco_refuses_is_one_line(capsys):
    light = ["--set", "robots.height_m=1e-9", "--set", "robots.mass_kg=1e-9"]
    assert main(["plan", "export-mujoco", "tutorial_arena", "--out", "out", *light]) == 2
    assert main(["run", "tutorial_arena", "--set", "run.world=mujoco", *light]) == 2
    for line in capsys.readouterr().err.splitlines():
        assert line.startswith("robotteamsim: MuJoCo rejects a robot or object (too small or too light?): ")


@pytest.mark.parametrize(
    "command", ["run tutorial_arena --set run.world=mujoco", "plan export-mujoco tutorial_arena --out out"]
)
def test_value_of_mujoco_gl_that_mujoco_refuses_is_one_line(command):
    done = subprocess.run(
        [sys.executable, "-m", "robotteamsim.cli", *command.split()],
        env={**os.environ, "MUJOCO_GL": "nonsense"},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("robotteamsim: MUJOCO_GL=nonsense: mujoco cannot be imported ")
    assert "Traceback" not in done.stderr


NO_EGL = """
import sys

class NoEgl:
    def find_spec(self, name, path=None, target=None):
        if name == "OpenGL.EGL":  # as on a bare Debian, where PyOpenGL finds no library
            raise AttributeError("'NoneType' object has no attribute 'eglQueryString'")

sys.meta_path.insert(0, NoEgl())
from robotteamsim.cli import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize(
    ("camera", "status", "says"),
    [
        ([], 0, "tutorial_arena"),
        (["--set", "robots.sensors=[{kind: camera, name: front}]"], 2, "apt-get install libegl1 libgl1-mesa-dri"),
    ],
)
def test_only_cameras_need_egl(camera, status, says):
    run = ["run", "tutorial_arena", "--set", "run.world=mujoco", "--set", "mission.time_limit_s=1", *camera]
    done = subprocess.run(
        [sys.executable, "-c", NO_EGL, *run],
        env={name: value for name, value in os.environ.items() if name != "MUJOCO_GL"},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == status, done.stderr
    assert says in (done.stderr.splitlines()[-1] if status else done.stdout)
    assert "Traceback" not in done.stderr


def test_open_leaf_that_swings_is_at_its_open_place():
    door = "{name: gate, from: [4, 0], to: [5, 0], motion: swing}"
    walls = "{name: left, from: [0, 0], to: [4, 0]}, {name: right, from: [5, 0], to: [9, 0]}"
    plan = f"plan={{name: hall, bounds: {{min: [-1, -3], max: [9, 9]}}, walls: [{walls}], doors: [{door}]}}"
    model = _exported("tutorial_arena", plan, "mission.areas=[]", "mission.victims=[]")
    leaf = model.body("door gate")
    np.testing.assert_allclose(leaf.pos, [4.0, 0.0, 0.0])
    np.testing.assert_allclose(leaf.quat, [math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)], atol=1e-6)


def test_exported_robots_rest_on_the_floor():
    model = _exported("warehouse_push")
    data = mujoco.MjData(model)
    for _ in range(200):
        mujoco.mj_step(model, data)
    heights = [data.body(f"robot_{i}").xpos[2] for i in range(3)]
    np.testing.assert_allclose(heights, 0.0, atol=0.01)


def test_scenario_without_room_is_rejected_and_leaves_nothing_behind(refusal):
    message = refusal("plan", "export-mujoco", "garage_sar", "--out", "out", "--set", "robots.start=[0, 0, 0]")
    assert message.startswith("--set: robots.start: ")
    assert list(Path().iterdir()) == []


def test_world_that_mujoco_may_start_no_threads_for_is_rejected_in_one_line(monkeypatch, capsys):
    def compile_alone(_):
        raise RuntimeError("Caught an unknown exception!")  # as where `ulimit -u` allows no thread

    monkeypatch.setattr(mujoco.MjSpec, "compile", compile_alone)
    assert main(["run", "tutorial_arena", "--quiet", "--set", "run.world=mujoco"]) == 2
    line = capsys.readouterr().err
    assert line.startswith("robotteamsim: MuJoCo cannot build the world: ")
    assert line.count("\n") == 1
