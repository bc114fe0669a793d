"""Light sensors and lamps in the world of MuJoCo."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.recording.bag_types import message_type
from robotteamsim.recording.topics.robots import robot_transforms
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan
from robotteamsim.scenario.mujoco import Light, Mujoco
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Camera, LightSensor
from robotteamsim.sensing.readings import OdometryReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation.stages import ScheduleStage
from robotteamsim.world import World
from robotteamsim.world.mujoco.world import MujocoWorld

SCREEN = Door(name="screen", start=(5.0, 0.0), end=(5.0, 10.0))
PLAN = FloorPlan(name="field", bounds=Bounds(max=(20.0, 10.0)), doors=(SCREEN,))
UP, AHEAD = LightSensor(name="up", height_m=0.4), LightSensor(name="ahead", height_m=0.4, pitch_rad=0.0)
LEFT = LightSensor(name="left", height_m=0.4, pitch_rad=0.0, yaw_rad=0.5 * math.pi)
ROBOT = PlacedRobot(start_pose=(2.0, 5.0, 0.0), sensors=(UP, AHEAD, LEFT))
LAMP = Light(name="lamp", position=(6.0, 5.0), height_m=3.4, intensity_cd=100.0)


def world_of(*lights, **keys):
    return MujocoWorld(PLAN, [ROBOT], Run(world="mujoco", mujoco=Mujoco(lights=lights)), **keys)


def read_lx(world):
    return tuple(RobotSensors(world, [ROBOT], 1).read()[0].sensors.values())


def test_illuminance_follows_the_inverse_square_and_the_cosine():
    # 4 m ahead and 3 m above the sensors: 5 m away. 100 cd / 25 m^2 = 4 lx, times 3/5 and 4/5; nothing from behind.
    assert read_lx(world_of(LAMP)) == pytest.approx((2.4, 3.2, 0.0), abs=1e-9)
    twice_as_far = LAMP.model_copy(update={"position": (10.0, 5.0), "height_m": 6.4})
    assert read_lx(world_of(twice_as_far)) == pytest.approx((0.6, 0.8, 0.0), abs=1e-9)


def test_lamps_add_up_and_a_switch_takes_one_out():
    other = Light(name="other", position=(2.0, 8.0), height_m=0.4, intensity_cd=90.0, lit=False)
    world = world_of(LAMP, other)
    assert read_lx(world) == pytest.approx((2.4, 3.2, 0.0), abs=1e-9)
    world.set_light("other", True)
    assert read_lx(world) == pytest.approx((2.4, 3.2, 10.0), abs=1e-9)
    world.set_light("lamp", False)
    assert read_lx(world) == pytest.approx((0.0, 0.0, 10.0), abs=1e-9)
    world.reset()
    assert read_lx(world) == pytest.approx((2.4, 3.2, 0.0), abs=1e-9)


def test_closed_door_and_high_object_hide_a_lamp_and_a_low_object_does_not():
    world = world_of(LAMP)
    world.set_door("screen", closed=True)  # 2.1 m high; the ray is at 0.4 m + 3 m * 3/4 there
    assert read_lx(world)[1] == pytest.approx(3.2)
    low = LAMP.model_copy(update={"height_m": 2.0})
    world = world_of(low)
    bright = read_lx(world)[1]
    assert bright > 0.0
    world.set_door("screen", closed=True)
    assert read_lx(world) == (0.0, 0.0, 0.0)
    for height_m, seen in ((0.5, bright), (2.0, 0.0)):
        pile = MovableObject(name="pile", size_m=(0.2, 2.0), height_m=height_m, pose=(4.0, 5.0, 0.0))
        assert read_lx(world_of(low, objects=(pile,)))[1] == pytest.approx(seen)


def test_schedule_switches_lights():
    off = ScheduledEvent(at_s=0.3, light="lamp", lit=False)
    world, seen = world_of(LAMP), []
    schedule = ScheduleStage((off,))
    for _ in range(5):
        schedule.step(world.sim_time_ns, world)
        world.step([Twist()])
        seen.append(read_lx(world)[1] > 0.0)
    assert seen == [True, True, True, False, False]


def test_message_has_the_axis_as_x_axis_of_its_frame():
    world = world_of(LAMP)
    left_lx = read_lx(world)[2]
    message = message_type(LEFT.type_name).decode(message_type(LEFT.type_name).encode(LEFT.message(5, 0, left_lx)))
    assert (message.illuminance, message.header.frame_id) == (left_lx, "robot_0/left_link")
    assert LEFT.reading(message) == pytest.approx(left_lx)
    links = robot_transforms(0, 0, ROBOT, OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist()))
    axes = {}
    for link in links[-3:]:
        rotation = Rotation.from_quat([link["transform"]["rotation"].get(axis, 0.0) for axis in "xyzw"])
        axes[link["child_frame_id"]] = rotation.apply([1.0, 0.0, 0.0])
    assert axes["robot_0/up_link"] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert axes["robot_0/ahead_link"] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert axes["robot_0/left_link"] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)


@pytest.mark.slow
def test_camera_sees_less_in_the_dark():
    robot = ROBOT.model_copy(update={"sensors": (Camera(name="front", every_steps=1),)})
    world = MujocoWorld(PLAN, [robot], Run(world="mujoco", mujoco=Mujoco(lights=(LAMP,))))
    means = []
    for lit in (True, False, True):
        world.set_light("lamp", lit)
        means.append(float(np.mean(world.image(0, robot.sensors[0]))))
    assert means[0] == means[2]
    assert means[1] < 0.9 * means[0]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            ["robots.sensors=[{kind: light, name: up}]"],
            "robots.sensors.0: light 'up' needs run.world mujoco, not box2d",
        ),
        (["run.mujoco.lights=[{name: a, position: [4, 5]}]"], "run.mujoco.lights: need run.world mujoco, not box2d"),
        (
            ["run.world=mujoco", "run.mujoco.lights=[{name: a, position: [400, 5]}]"],
            r"run.mujoco.lights.0.position: \[400, 5\] lies outside the bounds",
        ),
        (
            ["run.world=mujoco", "run.mujoco.lights=[{name: a, position: [4, 5]}, {name: a, position: [4, 6]}]"],
            "run.mujoco.lights.1.name: 'a' is already the name of another",
        ),
        (["schedule=[{at_s: 1, light: a, lit: true}]"], "schedule.0.light: there is no light 'a'; known: none"),
        (["schedule=[{at_s: 1, light: a}]"], "schedule.0.lit: missing; expected true or false"),
    ],
    ids=["sensor in the plane", "lamp in the plane", "outside", "twice", "unknown", "no state"],
)
def test_invalid_light_is_one_line(keys, message):
    with pytest.raises(ScenarioError, match=message):
        load("garage_sar", keys)


def test_switch_of_an_unknown_light_is_one_line():
    with pytest.raises(ValueError, match=r"^unknown light 'sun'; known: lamp$"):
        world_of(LAMP).set_light("sun", True)
    with pytest.raises(ValueError, match=r"^unknown light 'sun'; known: none$"):
        World(PLAN, [ROBOT], Run()).set_light("sun", True)
