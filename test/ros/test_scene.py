"""The node `scene` draws a bag, and rviz shows it: on a virtual display, with a master of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image
from running import TIMEOUT_S, environment, wait_for_port

from robotteamsim import palette
from robotteamsim.nodes.scene.building import FLOOR
from robotteamsim.nodes.scene.team import robot_colour
from robotteamsim.recording import BagWriter
from robotteamsim.ros.nodes.rviz_view import fitted
from robotteamsim.scenario import Bounds, load
from robotteamsim.simulation import Simulation

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 1600, 900

LISTENER = """
import json, sys
import rospy
from visualization_msgs.msg import MarkerArray

rospy.init_node("listener", anonymous=True, disable_rostime=True)
markers = {topic: rospy.wait_for_message(topic, MarkerArray, 300.0).markers for topic in sys.argv[1:]}
print(json.dumps({
    topic: [[m.ns, m.id, m.action, m.header.frame_id] for m in of_topic] for topic, of_topic in markers.items()
}))
"""

LEAVING = """
import json, queue
import rospy
from robotteamsim.msg import Robots
from visualization_msgs.msg import Marker, MarkerArray

shown, deleted, heard = set(), set(), queue.Queue()

def look_until(robots):
    while sorted(number for name, number in shown if name == "bodies") != robots:
        for marker in heard.get(timeout=300.0).markers:
            key = marker.ns, marker.id
            if marker.action == Marker.DELETEALL:
                shown.clear()
            elif marker.action == Marker.DELETE:
                shown.discard(key)
                deleted.add(key)
            else:
                shown.add(key)
    return sorted(shown)

rospy.init_node("leaving", anonymous=True, disable_rostime=True)
who = rospy.Publisher("/world/robots", Robots, queue_size=1, latch=True)
rospy.Subscriber("/scene/robots", MarkerArray, heard.put)
before = look_until([0, 1, 2])
deleted.clear()
who.publish(Robots(present=[1, 0, 1], arrivals=[1, 1, 1]))
while_away, gone = look_until([0, 2]), sorted(deleted)
who.publish(Robots(present=[1, 1, 1], arrivals=[1, 2, 1]))
print(json.dumps([before, while_away, gone, look_until([0, 1, 2])]))
"""


@contextmanager
def running(command: list[str], variables: dict[str, str], **options: object) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(command, env=variables, stdout=subprocess.DEVNULL, **options)
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


@pytest.fixture(scope="module")
def bag(tmp_path_factory) -> Path:
    """Two seconds of a garage mission, recorded without ROS."""
    path = tmp_path_factory.mktemp("scene") / "garage.bag"
    Simulation(load("garage_sar", ["mission.time_limit_s=2.0"])).run([BagWriter(path)])
    return path


@pytest.fixture(scope="module")
def master(bag) -> Iterator[dict[str, str]]:
    """The environment of a master on which the scene of the played bag is on show."""
    variables = environment(bag.parent)
    port = int(variables["ROS_MASTER_URI"].rpartition(":")[2])
    with running(["rosmaster", "--core", "-p", str(port)], variables):
        wait_for_port(port)
        subprocess.run(["rosparam", "set", "/robotteamsim/scenario", "garage_sar"], env=variables, check=True)
        with running([sys.executable, str(ROOT / "scripts" / "scene")], variables):
            listen(variables, "/scene/building")
            subprocess.run(["rosbag", "play", "-q", "--clock", str(bag)], env=variables, check=True, timeout=TIMEOUT_S)
            yield variables


def listen(variables: dict[str, str], *topics: str) -> dict[str, list[tuple[str, int, int, str]]]:
    """Return namespace, id, action and frame of the markers that a late listener gets."""
    command = [sys.executable, "-c", LISTENER, *topics]
    answer = subprocess.run(command, env=variables, check=True, capture_output=True, timeout=TIMEOUT_S)
    return json.loads(answer.stdout)


def test_late_listener_gets_the_whole_scene_of_a_bag_that_has_ended(master):
    layers = ("building", "doors", "voice", "areas", "victims", "robots", "links", "headline")
    scene = listen(master, *(f"/scene/{layer}" for layer in layers))
    drawn = {topic: {ns for ns, _, action, _ in markers if action == 0} for topic, markers in scene.items()}
    assert drawn["/scene/building"] == {"floor", "walls"}
    assert drawn["/scene/headline"] == {"headline", "legend", "legend_words"}
    assert drawn["/scene/voice"] == {"voice"}
    assert drawn["/scene/links"] == {"links"}
    assert drawn["/scene/robots"] >= {"bodies", "decks", "robot_ids"}
    bodies = [key for key in scene["/scene/robots"] if key[0] == "bodies"]
    assert [robot_id for _, robot_id, _, _ in bodies] == [0, 1, 2]
    assert {frame for markers in scene.values() for _, _, _, frame in markers} == {"map"}


def test_markers_of_a_robot_that_leaves_are_deleted_and_come_back_with_it(master):
    command = [sys.executable, "-c", LEAVING]
    answer = subprocess.run(command, env=master, check=True, capture_output=True, timeout=TIMEOUT_S)
    before, while_away, deleted, after = json.loads(answer.stdout)
    assert {tuple(key) for key in before} == {tuple(key) for key in while_away + deleted}
    assert not any(key in while_away for key in deleted)
    assert {name for name, _ in before} == {name for name, _ in deleted}
    assert after == before


@pytest.mark.parametrize(
    ("corner", "scale"), [((60.0, 40.0), 1.0), ((30.0, 20.0), 0.5), ((12.0, 40.0), 1.0), ((120.0, 10.0), 2.0)]
)
def test_view_is_far_enough_for_the_whole_building(corner, scale):
    config, scenario = ROOT / "rviz" / "robotteamsim.rviz", load("tutorial_arena")
    plan = scenario.plan.model_copy(update={"bounds": Bounds(max=corner)})
    scenario = scenario.model_copy(update={"plan": plan})
    before, after = (
        {view["Name"]: view for view in (views["Current"], *views["Saved"])}
        for views in (
            settings["Visualization Manager"]["Views"]
            for settings in (yaml.safe_load(config.read_text()), fitted(config, scenario))
        )
    )
    assert after["Current View"]["Distance"] == scale * before["Current View"]["Distance"]
    assert after["From above"]["Scale"] == before["From above"]["Scale"] / scale


def test_window_fits_a_screen_of_1280_x_800_with_a_title_and_a_panel():
    config = fitted(ROOT / "rviz" / "robotteamsim.rviz", load("garage_sar"))["Window Geometry"]
    assert config["Width"] <= 1280
    assert config["Height"] <= 800 - 2 * 40


def test_rviz_shows_the_scans_of_each_robot_in_its_colour():
    config = ROOT / "rviz" / "robotteamsim.rviz"
    displays = fitted(config, load("warehouse_push"))["Visualization Manager"]["Displays"]
    of_robots = {
        display["Topic"]: display for display in displays if display["Class"] in ("rviz/LaserScan", "rviz/Range")
    }
    assert {"/robot_0/base_scan", "/robot_1/base_scan"} <= of_robots.keys()
    red, green, blue = (round(255.0 * part) for part in robot_colour(1)[:3])
    assert of_robots["/robot_1/base_scan"]["Color"] == f"{red}; {green}; {blue}"


def test_rviz_shows_the_beliefs_of_robots_that_localise_themselves_alone():
    config = ROOT / "rviz" / "robotteamsim.rviz"
    topics = {}
    for name, settings in (("office_unknown", []), ("garage_sar", []), ("garage_sar", ["control.localisation=laser"])):
        displays = fitted(config, load(name, settings))["Visualization Manager"]["Displays"]
        topics[name + "_by_laser" * bool(settings)] = {one.get("Topic"): one["Class"] for one in displays}
    assert topics["office_unknown"]["/robot_3/amcl_pose"] == "rviz/PoseWithCovariance"
    assert topics["office_unknown"]["/robot_3/map"] == "rviz/Map"
    assert topics["garage_sar_by_laser"]["/robot_1/particlecloud"] == "rviz/PoseArray"
    beliefs = {f"/robot_0/{name}" for name in ("amcl_pose", "map", "particlecloud")}
    assert not beliefs & topics["garage_sar"].keys()
    assert "/robot_0/particlecloud" not in topics["office_unknown"]


def grab(display: str) -> np.ndarray:
    """Return the screen, shape (height, width, 3)."""
    command = ["import", "-display", display, "-window", "root", "-depth", "8", "rgb:-"]
    data = subprocess.run(command, check=True, capture_output=True, timeout=TIMEOUT_S).stdout
    return np.frombuffer(data, dtype=np.uint8).reshape(HEIGHT, WIDTH, 3)


def near(picture: np.ndarray, tint: tuple[float, ...]) -> int:
    """Return how many pixels have nearly this colour."""
    return int((np.abs(picture - 255.0 * np.array(tint[:3])).max(axis=2) < 12).sum())


def test_rviz_is_announced_before_its_window_appears(master, tmp_path):
    rviz = tmp_path / "rviz"
    rviz.write_text('#!/bin/sh\necho "rviz $1"\n')
    rviz.chmod(0o755)
    command = [sys.executable, str(ROOT / "scripts" / "rviz_view")]
    settings = master | {"PATH": f"{tmp_path}:{master['PATH']}", "DISPLAY": ":99"}
    answer = subprocess.run(command, env=settings, check=True, capture_output=True, timeout=TIMEOUT_S)
    assert answer.stdout.decode().splitlines() == [
        "rviz_view: rviz starts; without a graphics card, its window takes some 20 s to appear",
        "rviz -d",
    ]


def test_rviz_needs_a_display_and_has_help(master):
    command = [sys.executable, str(ROOT / "scripts" / "rviz_view")]
    without = {name: value for name, value in master.items() if name != "DISPLAY"}
    answer = subprocess.run(command, env=without, check=False, capture_output=True, text=True, timeout=TIMEOUT_S)
    line = "rviz_view: there is no display (DISPLAY is not set); `robotteamsim view` needs none\n"
    assert (answer.returncode, answer.stdout, answer.stderr) == (1, "", line)
    help_text = subprocess.run([*command, "--help"], env=without, check=True, capture_output=True, timeout=TIMEOUT_S)
    assert help_text.stdout.startswith(b"usage: rosrun robotteamsim rviz_view")


def test_rviz_shows_floor_walls_and_robots(master, tmp_path):
    reader, writer = os.pipe()
    screen = ["-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-nolisten", "tcp", "-displayfd", str(writer)]
    with running(["Xvfb", *screen], master, pass_fds=[writer], stderr=subprocess.DEVNULL):
        os.close(writer)
        with os.fdopen(reader) as lines:
            display = f":{lines.readline().strip()}"
        rviz = [sys.executable, str(ROOT / "scripts" / "rviz_view")]
        with running(
            rviz, master | {"DISPLAY": display, "LIBGL_ALWAYS_SOFTWARE": "1"}, stderr=subprocess.DEVNULL
        ) as process:
            deadline_s = time.monotonic() + TIMEOUT_S
            wanted = {
                "floor": (FLOOR, 100_000),
                "walls": (palette.rgb(palette.LIT_SOLIDS["wall"]), 3_000),
                "robot 0": (robot_colour(0), 30),
            }
            missing = list(wanted)
            while missing and time.monotonic() < deadline_s:
                assert process.poll() is None, "rviz has died"
                picture = grab(display)
                missing = [name for name, (tint, pixels) in wanted.items() if near(picture, tint) < pixels]
            Image.fromarray(picture).save(tmp_path / "rviz.png")
            assert not missing, f"see {tmp_path / 'rviz.png'}"
