"""Draws the pictures of MuJoCo's garage for docs/images: three robots, and a frame of a film with a camera.

Usage: python docs/draw_mujoco.py [folder]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import mujoco
from PIL import Image

from robotteamsim.analysis.runs.film import RunFilm
from robotteamsim.analysis.runs.robot_view import RobotView
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.recording import BagWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation
from robotteamsim.world.mujoco.world import MujocoWorld

SCENARIO = ("garage_sar", ["run.world=mujoco", "run.seed=3", "mission.time_limit_s=110"])
STILL_STEPS, FRAME_S = 200, 45
WIDTH_PX, HEIGHT_PX = 1280, 720
CAMERA = {"distance": 3.2, "azimuth": 35.0, "elevation": -13.0}


def still() -> Image.Image:
    """Return the robots some time after the start."""
    simulation = Simulation(load(*SCENARIO))
    simulation.mission.start()
    for _ in range(STILL_STEPS):
        simulation.step()
    world = simulation.world
    assert isinstance(world, MujocoWorld)
    model, data = world.engine.model, world.engine.data
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH_PX, HEIGHT_PX
    model.vis.quality.shadowsize, model.vis.quality.offsamples = 8192, 8
    model.light_castshadow[:] = True
    mujoco.mj_camlight(model, data)
    camera, shown = mujoco.MjvCamera(), mujoco.MjvOption()
    shown.geomgroup[:] = 1
    camera.lookat[:] = [*world.positions_m().mean(axis=0), 0.35]
    camera.distance, camera.azimuth, camera.elevation = CAMERA["distance"], CAMERA["azimuth"], CAMERA["elevation"]
    with mujoco.Renderer(model, HEIGHT_PX, WIDTH_PX) as renderer:
        renderer.update_scene(data, camera, shown)
        return Image.fromarray(renderer.render())


def frame() -> Image.Image:
    """Return a frame of the film of a mission."""
    scenario = load(*SCENARIO)
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "garage.bag"
        Simulation(scenario).run([BagWriter(bag)])
        run = read_run([bag], layers=False)
        film = RunFilm(run, run_totals(run), scenario.plan, WIDTH_PX, RobotView(run, scenario, 0))
        return Image.fromarray(film.frame(run.start_ns + FRAME_S * 10**9))


if __name__ == "__main__":
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "images"
    still().save(out / "garage_mujoco.png", optimize=True)
    frame().save(out / "garage_mujoco_film.png", optimize=True)
