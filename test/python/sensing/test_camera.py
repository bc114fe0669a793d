"""Cameras: what they see, and their messages."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.recording.bag_types import ROS1, ROS2, message_type
from robotteamsim.recording.topics.robots import robot_transforms
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Camera
from robotteamsim.sensing.readings import OdometryReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world.mujoco.world import MujocoWorld

pytestmark = pytest.mark.slow

PLAN = FloorPlan(name="field", bounds=Bounds(max=(20.0, 10.0)))
BOX = MovableObject(name="box", size_m=(0.4, 0.4), height_m=0.5, pose=(5.0, 5.0, 0.0))
COLOUR, DEPTH = Camera(name="colour", every_steps=1), Camera(name="depth", images="depth", every_steps=1)


def images_of(robot: PlacedRobot, *objects: MovableObject) -> tuple[np.ndarray, ...]:
    world = MujocoWorld(PLAN, [robot], Run(world="mujoco"), objects=objects)
    return tuple(RobotSensors(world, [robot], 1).read()[0].sensors.values())


def test_depth_is_the_distance_along_the_axis():
    robot = PlacedRobot(start_pose=(2.0, 5.0, 0.0), sensors=(DEPTH,))
    (depth_m,) = images_of(robot, BOX)
    assert (depth_m.shape, depth_m.dtype) == ((240, 320), np.float32)
    # The near side of the box, seen from 0.1 m ahead of base_link, in the column of its centre and its edge.
    edge_px = round(DEPTH.focal_px * 0.19 / 2.7)
    assert depth_m[120, 160] == pytest.approx(2.7, abs=0.01)
    assert depth_m[120, 160 + edge_px] == pytest.approx(2.7, abs=0.01)
    # The floor 30 rows below the axis: the camera is 0.25 m above it.
    assert depth_m[200, 20] == pytest.approx(0.25 * DEPTH.focal_px / 80.5, rel=0.01)


def test_left_of_the_camera_is_left_in_the_image_and_a_turned_camera_looks_there():
    left = BOX.model_copy(update={"pose": (5.0, 6.0, 0.0)})
    turned = DEPTH.model_copy(update={"name": "turned", "yaw_rad": math.atan2(1.0, 2.9)})
    robot = PlacedRobot(start_pose=(2.0, 5.0, 0.0), sensors=(COLOUR, turned))
    empty, with_box = images_of(robot), images_of(robot, left)
    assert with_box[0].dtype == np.uint8
    empty, with_box = [(colour, depth[..., None]) for colour, depth in (empty, with_box)]
    columns = [np.flatnonzero((one != other).any(axis=(0, 2))) for one, other in zip(empty, with_box, strict=True)]
    assert columns[0].max() < 150
    assert columns[1].mean() == pytest.approx(160, abs=8)


def test_images_are_the_same_again():
    robot = PlacedRobot(start_pose=(2.0, 5.0, 0.3), sensors=(COLOUR, DEPTH))
    first, second = images_of(robot, BOX), images_of(robot, BOX)
    assert [image.tobytes() for image in first] == [image.tobytes() for image in second]


def test_camera_takes_every_nth_image():
    robot = PlacedRobot(start_pose=(2.0, 5.0, 0.0), sensors=(COLOUR.model_copy(update={"every_steps": 3}),))
    world = MujocoWorld(PLAN, [robot], Run(world="mujoco"))
    sensors, taken = RobotSensors(world, [robot], 1), []
    for _ in range(6):
        world.step(np.zeros((1, 3)))
        taken.append(COLOUR.name in sensors.read()[0].sensors)
    assert taken == [False, False, True] * 2


@pytest.mark.parametrize("ros", [ROS1, ROS2], ids=["ROS 1", "ROS 2"])
def test_messages_have_the_image_and_the_calibration(ros):
    robot = PlacedRobot(start_pose=(2.0, 5.0, 0.0), sensors=(COLOUR, DEPTH))
    world = MujocoWorld(PLAN, [robot], Run(world="mujoco"), objects=(BOX,))
    readings = RobotSensors(world, [robot], 1).read()[0].sensors
    topics = {}
    for camera in robot.sensors:
        for name, message in camera.messages(5, 0, readings[camera.name]).items():
            kind = camera.topics[name]
            topics[name] = message_type(kind, ros).decode(message_type(kind, ros).encode(message))
    assert list(topics) == ["colour/image", "colour/camera_info", "depth/image", "depth/camera_info"]
    image, depth, info = topics["colour/image"], topics["depth/image"], topics["colour/camera_info"]
    assert (image.encoding, image.step, image.header.frame_id) == ("rgb8", 960, "robot_0/colour_optical_frame")
    assert bytes(image.data) == readings["colour"].tobytes()
    assert (depth.encoding, depth.step) == ("32FC1", 1280)
    assert np.frombuffer(bytes(depth.data), "<f4").tolist() == readings["depth"].ravel().tolist()
    assert info.k.tolist() == pytest.approx([160 / math.tan(0.6), 0, 160, 0, 160 / math.tan(0.6), 120, 0, 0, 1])


def test_point_of_known_place_is_projected_to_its_pixel():
    """From `map` by the transforms of tf and the calibration of CameraInfo; the image has the box there."""
    camera = DEPTH.model_copy(update={"yaw_rad": 0.3, "left_m": 0.05, "height_m": 0.6})
    robot = PlacedRobot(start_pose=(2.0, 4.0, 0.2), sensors=(camera,))
    (depth_m,), (empty_m,) = images_of(robot, BOX), images_of(robot)
    reading = OdometryReading(PoseReading(2.0, 4.0, math.sin(0.1), math.cos(0.1)), Twist())  # as if `odom` were `map`
    links = {link["child_frame_id"]: link for link in robot_transforms(0, 0, robot, reading)}
    info = camera.messages(0, 0, depth_m)["depth/camera_info"]
    frame, place_of_camera = info["header"]["frame_id"], np.eye(4)
    while frame in links:
        place_of_camera = matrix_of(links[frame]["transform"]) @ place_of_camera
        frame = links[frame]["header"]["frame_id"]
    assert frame == "robot_0/odom"
    for corner in (
        (4.8, 4.8, 0.5),
        (4.8, 5.2, 0.5),
        (4.8, 4.8, 0.25),
    ):  # top edge and one on the side towards the robot
        x, y, z = (np.linalg.inv(place_of_camera) @ (*corner, 1.0))[:3]
        column, row, scale = info["k"].reshape(3, 3) @ (x, y, z)
        column, row = round(column / scale), round(row / scale)
        around = depth_m[row - 2 : row + 3, column - 2 : column + 3]
        assert around.min() == pytest.approx(z, abs=0.02)
        assert (around != empty_m[row - 2 : row + 3, column - 2 : column + 3]).any()
        assert around.max() > z + 0.02  # it is on an edge


def matrix_of(transform) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat([transform["rotation"].get(axis, 0.0) for axis in "xyzw"]).as_matrix()
    matrix[:3, 3] = [transform["translation"].get(axis, 0.0) for axis in "xyz"]
    return matrix


def test_computer_that_cannot_draw_is_one_line():
    code = (
        "from robotteamsim.cli import main\n"
        "main(['run', 'garage_sar', '--set', 'run.world=mujoco', "
        "'--set', 'robots.sensors=[{kind: camera, name: front}]'])"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"MUJOCO_GL": "off"}, check=False)
    assert done.stderr.splitlines()[-1].startswith("robotteamsim: robots.sensors: no image can be drawn")
    assert "apt-get install libegl1" in done.stderr
    assert "Traceback" not in done.stderr


def test_camera_in_the_plane_is_rejected():
    with pytest.raises(ScenarioError, match=r"robots\.sensors\.0: camera 'front' needs run\.world mujoco, not box2d"):
        load("garage_sar", ["robots.sensors=[{kind: camera, name: front}]"])


DRAWS = """
import os
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation
changes = ["run.world=mujoco", "robots.sensors=[{kind: camera, name: front}]", "mission.time_limit_s=1"]
drawing = Simulation(load("tutorial_arena", changes))
drawing.run()
"""
DRAWS_IN_FORK = """
if os.fork() == 0:
    Simulation(load("tutorial_arena", changes)).run()
"""
WAITS = """
_, status = os.wait()
raise SystemExit(os.waitstatus_to_exitcode(status))
"""


def run_python(code: str) -> subprocess.CompletedProcess[str]:
    # From 3.12 on, Python warns whoever forks a process with threads, such as those of OpenGL. Here, that is the test.
    command = [sys.executable, "-W", "ignore:This process:DeprecationWarning", "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def test_forked_process_cannot_draw_and_says_so():
    done = run_python(DRAWS + DRAWS_IN_FORK + WAITS)
    assert done.returncode == 1
    reason = "no image can be drawn in a fork of a process that has drawn"
    assert done.stderr.splitlines()[-1] == f"robotteamsim.errors.CameraError: robots.sensors: {reason}"


@pytest.mark.parametrize("kept", ["", "drawing.world.close_cameras()\n", "del drawing\n"])
def test_fork_of_a_process_that_has_drawn_ends(kept):
    done = run_python(f"{DRAWS}{kept}if os.fork() == 0:\n    raise SystemExit(5)\n{WAITS}")
    assert (done.returncode, done.stderr) == (5, "")
