"""Make the pictures of README and docs: run missions in ROS, stop them at a chosen step, and show them in rviz.

Needs no display, because rviz draws on a virtual one. Run by `make pictures`; takes about five minutes.
Usage: python docs/make_pictures.py [NAME...]     names of pictures without `.png`; all by default
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rospy
import yaml
from PIL import Image
from robotteamsim.msg import MissionStatus
from robotteamsim.srv import Step
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from robotteamsim.ros.nodes.rviz_view import fitted, read_ros1_scenario

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
CONFIG = ROOT / "rviz" / "robotteamsim.rviz"

SIZE = (1600, 900)
FINER = 2
"""rviz draws larger by this factor; reducing the picture smooths its edges."""
RUN = ("lockstep:=true", "speed:=20", "rviz:=false", "mission_stays:=true")
TIMEOUT_S = 120.0

SCREENSHOT_PERIOD_S = 1.5
EQUAL_SCREENSHOTS = 3
"""Number of equal screenshots in a row before a picture is taken, because rviz builds the scene gradually."""
MIN_COLOURS = 200
"""Least number of colours of a complete scene; a blank screen and rviz's splash have fewer."""


@dataclass(frozen=True, slots=True)
class Moment:
    """The name of a picture, and the run in ROS that it shows, stopped after some steps.

    hidden: names of displays that it does not show.   width: of the picture [pixels].
    """

    name: str
    launch: str
    arguments: tuple[str, ...]
    steps: int
    hidden: tuple[str, ...] = ()
    width: int = SIZE[0]


MOMENTS = (
    Moment("garage_sar", "garage_sar.launch", ("seed:=7",), 3051),
    Moment(
        "swarms",
        "garage_sar.launch",
        ("seed:=2", "robots:=9", "controllers:=team", "set:=control.swarms.initial=3 control.swarms.max=4"),
        900,
    ),
    Moment("office_manet", "mission.launch", ("scenario:=office_manet", "seed:=3", "controllers:=team"), 1800),
    Moment("garage_rescue_rviz", "mission.launch", ("scenario:=garage_rescue", "seed:=1", "controllers:=team"), 1900),
    Moment("office_fire_rviz", "mission.launch", ("scenario:=office_fire", "seed:=1", "controllers:=team"), 500),
    Moment(
        "unknown_rviz",
        "mission.launch",
        ("scenario:=garage_unknown", "seed:=1", "controllers:=team"),
        600,
        hidden=("Voice",),
        width=1200,
    ),
    Moment("warehouse_push", "mission.launch", ("scenario:=warehouse_push",), 300),
    Moment("tutorial_arena", "mission.launch", ("scenario:=tutorial_arena",), 600),
)


def main() -> None:
    """Write all pictures, or those with the given names."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    names = set(sys.argv[1:])
    chosen = [moment for moment in MOMENTS if not names or moment.name in names]
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        screen = stack.enter_context(virtual_display())
        port = free_port()
        environment = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost", "PWD": str(scratch)}
        os.environ |= environment
        master = ["rosmaster", "--core", "-p", str(port)]
        stack.enter_context(running(master, scratch / "master.log"))
        wait_for_master()
        rospy.init_node("make_pictures", disable_rostime=True)
        for moment in chosen:
            take_picture(moment, screen, scratch)


def take_picture(moment: Moment, screen: str, scratch: Path) -> None:
    """Run to the moment and write its picture."""
    launch = ["roslaunch", "robotteamsim", moment.launch, *RUN, *moment.arguments]
    with running(launch, scratch / "launch.log"):
        # Then the scenario, which the scene reads, has been launched.
        rospy.wait_for_service("/simulation/pause", TIMEOUT_S)
        with running([sys.executable, str(ROOT / "scripts" / "scene")], scratch / "scene.log"):
            pause_after(moment.steps)
            path = IMAGES / f"{moment.name}.png"
            draw(screen, scratch, path, moment)
            print(f"{path.relative_to(ROOT)}: {path.stat().st_size // 1024} kB")


@contextmanager
def running(command: list[str], log: Path, **options: Any) -> Iterator[subprocess.Popen[bytes]]:
    """Run a program, and terminate it by its process id."""
    with log.open("wb") as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, **options)
        try:
            yield process
        finally:
            process.terminate()
            process.wait()


@contextmanager
def virtual_display() -> Iterator[str]:
    """Start Xvfb on a free display and yield its name."""
    width, height = (FINER * pixels for pixels in SIZE)
    reader, writer = os.pipe()
    screen = ["-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp", "-displayfd", str(writer)]
    with running(["Xvfb", *screen], Path(os.devnull), pass_fds=[writer]):
        os.close(writer)
        with os.fdopen(reader) as lines:
            yield f":{lines.readline().strip()}"


def free_port() -> int:
    """Return a free port."""
    with socket.socket() as listener:
        listener.bind(("localhost", 0))
        return int(listener.getsockname()[1])


def pause_after(steps: int) -> None:
    """Let the mission run for some steps from its start and pause it."""
    while not rospy.wait_for_message("/scene/robots", MarkerArray, TIMEOUT_S).markers:
        pass
    rospy.wait_for_message("/mission/status", MissionStatus, TIMEOUT_S)
    # The scene may have missed the first steps, which would shorten the trails.
    for name in ("/simulation/pause", "/simulation/reset"):
        call(name, Trigger)
    call("/simulation/step", Step, steps)


def call(name: str, kind: type, *arguments: Any) -> None:
    """Call a service that must succeed."""
    rospy.wait_for_service(name, TIMEOUT_S)
    answer = rospy.ServiceProxy(name, kind)(*arguments)
    if not answer.success:
        sys.exit(f"make_pictures: {name}: {answer.message}")


def wait_for_master() -> None:
    """Wait until the ROS master answers."""
    deadline_s = time.monotonic() + TIMEOUT_S
    while not master_answers():
        if time.monotonic() > deadline_s:
            sys.exit("make_pictures: the ROS master does not start")
        time.sleep(0.2)


def master_answers() -> bool:
    """Whether the ROS master answers."""
    try:
        rospy.get_master().getPid()
    except OSError:
        return False
    return True


def draw(screen: str, scratch: Path, path: Path, moment: Moment) -> None:
    """Show the scene, wait until it no longer changes, and write a picture."""
    config = fitted(CONFIG, read_ros1_scenario(rospy.get_param))
    for display in config["Visualization Manager"]["Displays"]:
        display["Enabled"] &= display["Name"] not in moment.hidden
    width, height = (FINER * pixels for pixels in SIZE)
    config["Window Geometry"] |= {"Width": width, "Height": height}
    config_path = scratch / "view.rviz"
    config_path.write_text(yaml.safe_dump(config), encoding="utf-8")
    rviz = ["rviz", "--fullscreen", "-d", str(config_path)]
    environment = os.environ | {"DISPLAY": screen, "LIBGL_ALWAYS_SOFTWARE": "1", "QT_QPA_PLATFORM": "xcb"}
    with running(rviz, scratch / "rviz.log", env=environment):
        picture = settled_picture(screen, scratch / "screen.png")
    size = moment.width, moment.width * SIZE[1] // SIZE[0]
    picture.convert("RGB").resize(size, Image.Resampling.LANCZOS).save(path, optimize=True)


def settled_picture(screen: str, path: Path) -> Image.Image:
    """Return the screen once it shows a scene that no longer changes."""
    deadline_s = time.monotonic() + TIMEOUT_S
    last, same = b"", 0
    while same < EQUAL_SCREENSHOTS:
        if time.monotonic() > deadline_s:
            sys.exit("make_pictures: the scene in rviz keeps changing")
        time.sleep(SCREENSHOT_PERIOD_S)
        subprocess.run(["import", "-display", screen, "-window", "root", str(path)], check=True)
        with Image.open(path) as grabbed:
            picture = grabbed.convert("RGB")
        drawn = len(picture.resize((160, 90)).getcolors(160 * 90) or ()) > MIN_COLOURS
        same = same + 1 if drawn and picture.tobytes() == last else 0
        last = picture.tobytes()
    return picture


if __name__ == "__main__":
    main()
