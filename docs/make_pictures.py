"""Make the pictures of README and docs: run missions in ROS, stop them at a chosen step, and show them in rviz.

Needs no display, because rviz draws on a virtual one. Run by `make pictures`; takes about five minutes.
Usage: python docs/make_pictures.py [NAME...]     names of pictures without `.png`; all by default
"""

from __future__ import annotations

import math
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
from nav_msgs.msg import Odometry
from PIL import Image
from robotteamsim.msg import MissionStatus, Victims
from robotteamsim.srv import Step
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from robotteamsim.ros.nodes.rviz_view import fitted
from robotteamsim.ros.transport.settings import PARAMETERS
from robotteamsim.scenario import load

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


def orbit(x_m: float, y_m: float, distance_m: float, pitch_rad: float, yaw_rad: float) -> dict[str, Any]:
    """Return an rviz view that looks at a point of the floor; yaw 4.71 looks north."""
    return {
        "Class": "rviz/Orbit",
        "Name": "Orbit",
        "Distance": distance_m,
        "Focal Point": {"X": x_m, "Y": y_m, "Z": 0.2},
        "Near Clip Distance": 0.1,
        "Pitch": pitch_rad,
        "Yaw": yaw_rad,
        "Target Frame": "<Fixed Frame>",
    }


def from_above(x_m: float, y_m: float, pixels_per_m: float) -> dict[str, Any]:
    """Return an rviz view straight down."""
    return {
        "Class": "rviz/TopDownOrtho",
        "Name": "From above",
        "Angle": 0,
        "Scale": pixels_per_m,
        "X": x_m,
        "Y": y_m,
        "Target Frame": "<Fixed Frame>",
    }


@dataclass(frozen=True, slots=True)
class Moment:
    """A run in ROS, stopped after some steps, and the views to draw; None is the default view of rviz."""

    launch: str
    arguments: tuple[str, ...]
    steps: int
    views: dict[str, dict[str, Any] | None]
    close: str | None = None
    """Name of a close-up between the centre of the team and the nearest victim."""


MOMENTS = (
    Moment(
        "garage_sar.launch",
        ("seed:=7",),
        3051,
        {"garage_sar": None, "garage_sar_from_above": from_above(30.0, 21.0, 20.0 * FINER)},
        close="garage_sar_close",
    ),
    Moment(
        "garage_sar.launch",
        ("seed:=2", "robots:=9", "controllers:=team", "set:=control.swarms.initial=3 control.swarms.max=4"),
        900,
        {"swarms": None},
    ),
    Moment("office_manet.launch", ("seed:=3", "controllers:=team"), 1800, {"office_manet": None}),
    Moment("garage_rescue.launch", ("seed:=1", "controllers:=team"), 1900, {"garage_rescue_rviz": None}),
    Moment("office_fire.launch", ("seed:=1", "controllers:=team"), 500, {"office_fire_rviz": None}),
    Moment("warehouse_push.launch", (), 300, {"warehouse_push": None}),
    Moment("tutorial_arena.launch", (), 600, {"tutorial_arena": None}),
)


def main() -> None:
    """Write all pictures, or those of the moments with one of the given names."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    names = set(sys.argv[1:])
    chosen = [moment for moment in MOMENTS if not names or names & {*moment.views, moment.close}]
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
            take_pictures(moment, screen, scratch)


def take_pictures(moment: Moment, screen: str, scratch: Path) -> None:
    """Run to the moment and write its pictures."""
    launch = ["roslaunch", "robotteamsim", moment.launch, *RUN, *moment.arguments]
    with (
        running(launch, scratch / "launch.log"),
        running([sys.executable, str(ROOT / "scripts" / "scene")], scratch / "scene.log"),
    ):
        x_m, y_m = pause_after(moment.steps)
        views = moment.views | ({moment.close: orbit(x_m, y_m, 14.0, 0.8, 4.4)} if moment.close else {})
        for name, view in views.items():
            path = IMAGES / f"{name}.png"
            take_picture(screen, view, scratch, path, hidden=("Headline",) if name == moment.close else ())
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


def pause_after(steps: int) -> tuple[float, float]:
    """Let the mission run for some steps from its start and pause it.

    Returns: the midpoint between the centre of the team and the nearest victim [m].
    """
    rospy.wait_for_message("/scene/robots", MarkerArray, TIMEOUT_S)
    rospy.wait_for_message("/mission/status", MissionStatus, TIMEOUT_S)
    for name in ("/pause", "/reset"):  # The scene may have missed the first steps, which would shorten the trails.
        call(name, Trigger)
    call("/step", Step, steps)
    positions_m = [
        rospy.wait_for_message(f"/robot_{robot_id}/base_pose_ground_truth", Odometry, TIMEOUT_S).pose.pose.position
        for robot_id in range(rospy.get_param("/robotteamsim/robots"))
    ]
    x_m, y_m = (sum(getattr(p, axis) for p in positions_m) / len(positions_m) for axis in "xy")
    victims = rospy.wait_for_message("/mission/victims", Victims, TIMEOUT_S).victims
    nearest = min((v.position for v in victims), key=lambda p: math.dist((p.x, p.y), (x_m, y_m)))
    return (x_m + nearest.x) / 2.0, (y_m + nearest.y) / 2.0


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


def take_picture(
    screen: str, view: dict[str, Any] | None, scratch: Path, path: Path, hidden: tuple[str, ...] = ()
) -> None:
    """Show the scene without the hidden displays, wait until it no longer changes, and write a picture."""
    config = fitted(CONFIG, load(rospy.get_param(f"{PARAMETERS}/scenario")).plan.bounds)
    if view is not None:
        config["Visualization Manager"]["Views"]["Current"] = view
    for display in config["Visualization Manager"]["Displays"]:
        if display["Name"] in hidden:
            display["Enabled"] = display["Value"] = False
    width, height = (FINER * pixels for pixels in SIZE)
    config["Window Geometry"] |= {"Width": width, "Height": height}
    config_path = scratch / "view.rviz"
    config_path.write_text(yaml.safe_dump(config), encoding="utf-8")
    rviz = ["rviz", "--fullscreen", "-d", str(config_path)]
    environment = os.environ | {"DISPLAY": screen, "LIBGL_ALWAYS_SOFTWARE": "1", "QT_QPA_PLATFORM": "xcb"}
    with running(rviz, scratch / "rviz.log", env=environment):
        picture = settled_picture(screen, scratch / "screen.png")
    picture.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS).save(path, optimize=True)


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
