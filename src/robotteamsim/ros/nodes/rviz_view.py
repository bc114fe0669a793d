"""Starts rviz with a view that just fits the building of the run, and with the robots' scans."""

import os
import sys
from pathlib import Path
from typing import Any

import rospkg
import rospy
import yaml

from robotteamsim import palette
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.nodes.launched import read_ros1_scenario
from robotteamsim.nodes.scene.shapes import unit
from robotteamsim.recording.topics.base import Topic
from robotteamsim.recording.topics.beliefs import AMCL_POSE, FOUND_MAP, PARTICLES
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.sections import Team

MAX_SCANS = 20
"""Largest number of robots whose scans are shown."""


BELIEFS: tuple[tuple[str, Topic, dict[str, Any]], ...] = (
    ("Map of robot {}", FOUND_MAP, {"Class": "rviz/Map", "Enabled": False, "Alpha": 0.4}),
    ("Particles of robot {}", PARTICLES, {"Class": "rviz/PoseArray", "Shape": "Arrow (Flat)", "Alpha": 0.6}),
    ("Pose believed by robot {}", AMCL_POSE, {"Class": "rviz/PoseWithCovariance"}),
)
"""What robots that localise themselves believe, as displays of rviz; the team's maps are one display of the scene."""
ARROW_M = {
    AMCL_POSE: {"Shaft Length": 1.2, "Shaft Radius": 0.3, "Head Length": 1.2, "Head Radius": 0.7},
    PARTICLES: {"Arrow Length": 1.6},
}
"""Sizes of arrows, in a building of the size that the views are made for."""


def main() -> None:
    """Replace this process by rviz, with the same arguments; the view is written to the folder of logs."""
    if {"-h", "--help"} & set(sys.argv[1:]):
        sys.stdout.write(f"usage: rosrun robotteamsim rviz_view [arguments of rviz]\n\n{__doc__}\n")
        return
    if not os.environ.get("DISPLAY"):
        sys.stderr.write("rviz_view: there is no display (DISPLAY is not set); `robotteamsim view` needs none\n")
        sys.exit(1)
    config = Path(rospkg.RosPack().get_path("robotteamsim"), "rviz", "robotteamsim.rviz")
    try:
        settings, folder = fitted(config, read_ros1_scenario(rospy.get_param)), Path(rospkg.get_log_dir())
        folder.mkdir(parents=True, exist_ok=True)
        config = folder / f"robotteamsim-{os.getpid()}.rviz"
        config.write_text(yaml.safe_dump(settings), encoding="utf-8")
    except ConnectionRefusedError:
        sys.stderr.write("rviz_view: the view is not fitted to the building: no mission runs\n")
    except (RobotTeamSimError, OSError) as error:  # The world reports mistakes; rviz shows what it can.
        sys.stderr.write(f"rviz_view: the view is not fitted to the building: {error}\n")
    sys.stdout.write("rviz_view: rviz starts; without a graphics card, its window takes some 20 s to appear\n")
    sys.stdout.flush()
    os.execvp("rviz", ["rviz", "-d", str(config), *sys.argv[1:]])


def fitted(config: Path, scenario: Scenario) -> dict[str, Any]:
    """Return rviz's settings with views from where the building just fits, and what robots measure and believe."""
    settings: dict[str, Any] = yaml.safe_load(config.read_text(encoding="utf-8"))
    scale = unit(scenario.plan.bounds)
    manager = settings["Visualization Manager"]
    views = manager["Views"]
    for view in (views["Current"], *views["Saved"]):
        for key, factor in (("Distance", scale), ("Scale", 1.0 / scale)):
            if key in view:
                view[key] *= factor
    views["Current"]["Focal Point"]["Y"] *= scale
    team = scenario.robots
    robots = [team] * team.count if isinstance(team, Team) else team
    for robot_id, robot in enumerate(robots[:MAX_SCANS]):
        red, green, blue = (round(255.0 * part) for part in palette.rgb(palette.robot_colour(robot_id)))
        tint: dict[str, Any] = {"Color": f"{red}; {green}; {blue}", "Enabled": True}
        scan: dict[str, Any] = {"Class": "rviz/LaserScan", "Color Transformer": "FlatColor", "Style": "Points"}
        scan |= tint | {"Size (Pixels)": 4, "Queue Size": 1, "Selectable": False}
        sonar = tint | {"Class": "rviz/Range", "Alpha": 0.3, "Queue Size": 1}
        lasers = ["base_scan", *(sensor.name for sensor in robot.sensors if sensor.kind == "laser")]
        for kind, names in (
            (scan, lasers),
            (sonar, [sensor.name for sensor in robot.sensors if sensor.kind == "sonar"]),
        ):
            topics = [f"/robot_{robot_id}/{name}" for name in names]
            manager["Displays"] += [kind | {"Name": topic, "Topic": topic} for topic in topics]
        for name, belief, display in BELIEFS:
            if belief.is_in(scenario):
                arrow = {key: scale * size_m for key, size_m in ARROW_M.get(belief, {}).items()}
                shown = {"Name": name.format(robot_id), "Topic": f"/robot_{robot_id}/{belief.name}"}
                manager["Displays"].append(tint | display | shown | arrow)
    return settings
