"""Render the garage with a camera of Gazebo: docs/images/gazebo_garage.png.

The robots are where they are after some time of a headless mission. Needs Gazebo 11 and Xvfb; GAZEBO_CHROOT names the
Debian 11 that `make gazebo` creates, or is empty where Gazebo is on this machine.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import cv2

from robotteamsim.gazebo import export_world
from robotteamsim.scenario import load
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

ROOT = Path(__file__).parents[1]
PATH = ROOT / "docs" / "images" / "gazebo_garage.png"
SECONDS = 240.0
SIZE_PX = (1600, 900)
RENDERED_PX = (3200, 1800)
EYE = "51 0.2 7.2 0 0.38 2.3"
"""Pose of the camera: x, y, z, roll, pitch, yaw [m, rad]."""
TIMEOUT_S = 300.0

CAMERA = f"""
<model name="camera"><static>true</static><pose>{EYE}</pose><link name="link">
  <sensor name="still" type="camera"><always_on>true</always_on><update_rate>1</update_rate><camera>
    <horizontal_fov>1.0</horizontal_fov>
    <image><width>{RENDERED_PX[0]}</width><height>{RENDERED_PX[1]}</height></image>
    <clip><near>0.1</near><far>300</far></clip>
    <save enabled="true"><path>{{folder}}</path></save>
  </camera></sensor>
</link></model>"""


def scenario_after(seconds: float) -> Scenario:
    """Return the garage with the robots where they are after some time of a mission."""
    scenario = load("garage_sar", ["robots.count=3"])
    simulation = Simulation(scenario)
    while simulation.world.sim_time_ns < seconds * 1e9:
        simulation.step()
    robots = tuple(
        robot.model_copy(update={"start_pose": (pose.x_m, pose.y_m, pose.yaw_rad)})
        for robot, pose in zip(resolve(scenario).robots, simulation.world.poses(), strict=True)
    )
    return scenario.model_copy(update={"robots": robots})


def world_with_camera(scenario: Scenario, folder: Path) -> str:
    """Return the exported world with a camera and without our plugins, which need ROS."""
    root = ET.fromstring(export_world(resolve(scenario)).text)
    for parent in list(root.iter()):
        for plugin in parent.findall("plugin"):
            parent.remove(plugin)
    world = root.find("world")
    assert world is not None
    world.append(ET.fromstring(CAMERA.format(folder=folder)))
    return ET.tostring(root, encoding="unicode")


def render(world: Path, folder: Path) -> Path:
    """Run Gazebo until its camera has saved some pictures, and return one that is complete."""
    chroot = os.environ.get("GAZEBO_CHROOT")
    inside = [str(ROOT / "setup" / "gazebo-chroot.sh"), "run", chroot] if chroot else []
    software = ["env", "LIBGL_ALWAYS_SOFTWARE=1"]
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x720x24", *inside, *software, "gzserver", "--verbose", str(world)]
    gazebo = subprocess.Popen(command, start_new_session=True)
    try:
        deadline_s = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline_s and gazebo.poll() is None:
            pictures = sorted(folder.glob("*.jpg"))
            if len(pictures) > 2:
                return pictures[1]
            time.sleep(1.0)
        raise SystemExit("Gazebo has rendered nothing")
    finally:
        os.killpg(gazebo.pid, 15)
        gazebo.wait(60.0)


def main() -> None:
    """Render the picture."""
    os.environ["GAZEBO_MODEL_DATABASE_URI"] = ""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        world = folder / "garage.world"
        world.write_text(world_with_camera(scenario_after(SECONDS), folder))
        picture = cv2.imread(str(render(world, folder)))
    cv2.imwrite(str(PATH), cv2.resize(picture, SIZE_PX, interpolation=cv2.INTER_AREA))


main()
