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
from robotteamsim.recording.topics.beliefs import AMCL_POSE, FOUND_MAP
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.sections import Team

MAX_SCANS = 20
"""Largest number of robots whose scans are shown."""


BELIEFS = {"rviz/PoseWithCovariance": AMCL_POSE, "rviz/Map": FOUND_MAP}
"""What robots that localise themselves believe, by the displays of rviz."""
ARROW_M = {("Shaft", "Length"): 1.2, ("Shaft", "Radius"): 0.3, ("Head", "Length"): 1.2, ("Head", "Radius"): 0.7}
"""Of believed poses, in a building of the size that the views are made for."""


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
        arrow = {f"{part} {size}": scale * value for (part, size), value in ARROW_M.items()}
        for display, belief in BELIEFS.items():
            if belief.is_in(scenario):
                topic = f"/robot_{robot_id}/{belief.name}"
                shown = {"Class": display, "Name": topic, "Topic": topic, "Enabled": belief is AMCL_POSE}
                manager["Displays"].append(tint | shown | arrow)
    return settings
