"""What other nodes of ROS 2 send: commands, and what nobody can read."""

from __future__ import annotations

import math
import sys

import pytest
from geometry_msgs.msg import Twist, TwistStamped, Vector3
from peer import ALL_LATCHED, MISSION
from rclpy.qos import QoSProfile, ReliabilityPolicy
from running import running

ARENA = (*MISSION, "tutorial_arena", "--controllers", "none", "--speed", "5")
SIMULATION = (sys.executable, "-m", "robotteamsim.ros2.simulation", "--ros-args")
FORWARD = Twist(linear=Vector3(x=0.3))


@pytest.fixture
def arena(tmp_path, peer):
    """A robot that is driven by cmd_vel."""
    with running(ARENA, tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        yield mission


def drive(peer, publisher, message, until):
    def moves():
        publisher.publish(message)
        return until()

    peer.wait_until(moves, "the motion")


def test_own_node_drives_a_robot(arena, peer):
    truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
    drive(peer, peer.node.create_publisher(Twist, "/robot_0/cmd_vel", 1), FORWARD, lambda: is_driving(truth))
    assert "Traceback" not in arena.output


def test_stamped_commands_are_obeyed_where_they_are_asked_for(tmp_path, peer):
    with running((*ARENA, "--ros-args", "-p", "stamped_cmd_vel:=true"), tmp_path):
        truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
        publisher = peer.node.create_publisher(TwistStamped, "/robot_0/cmd_vel", 1)
        drive(peer, publisher, TwistStamped(twist=FORWARD), lambda: is_driving(truth))


def test_controllers_stamp_their_commands_where_the_simulation_asks_for_it(tmp_path, peer):
    mission = (*MISSION, "garage_sar", "--robots", "1", "--speed", "5", "--ros-args", "-p", "stamped_cmd_vel:=true")
    with running(mission, tmp_path) as started:
        truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
        peer.wait_until(lambda: truth and truth[-1].twist.twist.linear.x > 0.1, "a robot that drives")
    assert "ignoring" not in started.output


def test_parameter_that_there_is_not_is_a_warning(tmp_path):
    parameters = (
        "stamped_cmd_vell:=true",
        "simulation:lockstepp:=true",
        "another_node:speed:=1.0",
        "use_sim_time:=false",
    )
    with running((*ARENA, "--ros-args", *(part for one in parameters for part in ("-p", one))), tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
    assert mission.output.count("there is no such parameter") == 2
    assert "-p stamped_cmd_vell: there is no such parameter; did you mean 'stamped_cmd_vel'?" in mission.output
    assert "-p lockstepp: there is no such parameter; did you mean 'lockstep'?" in mission.output


def test_commands_of_another_type_are_ignored_with_one_warning(tmp_path, peer):
    with running((*ARENA, "--ros-args", "-p", "stamped_cmd_vel:=true"), tmp_path) as mission:
        peer.node.create_publisher(Twist, "/robot_0/cmd_vel", 1)
        ignoring = "/robot_0/cmd_vel: ignoring geometry_msgs/msg/Twist; expected geometry_msgs/msg/TwistStamped"
        mission.wait_for(lambda line: ignoring in line and "see stamped_cmd_vel" in line, "a warning")
        step = peer.listen("/robot_0/odom", "nav_msgs/Odometry")
        peer.wait_until(lambda: step and step[-1].header.stamp.sec > step[0].header.stamp.sec + 20, "more checks")
    assert mission.output.count("ignoring") == 1


def test_only_what_is_sensed_has_parameters_of_its_quality_of_service(arena, peer):
    names = peer.call("/simulation/list_parameters", "rcl_interfaces/ListParameters").result.names
    sensed = ("base_pose_ground_truth", "base_scan", "odom")
    wanted = [f"qos_overrides./robot_0/{topic}.publisher.reliability" for topic in sensed]
    assert sorted(name for name in names if name.startswith("qos_overrides./robot_0/")) == wanted
    assert sum(name.startswith("qos_overrides.") for name in names) < 10


def is_driving(truth):
    return truth and abs(truth[-1].twist.twist.linear.x - 0.3) < 0.01


def test_own_node_drives_a_robot_of_a_mission_in_lockstep(tmp_path, peer):
    with running((*MISSION, "garage_sar", "--lockstep", "--teleop", "0", "--speed", "5"), tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry", ALL_LATCHED)
        drive(peer, peer.node.create_publisher(Twist, "/robot_0/cmd_vel", 10), FORWARD, lambda: is_driving(truth))


def test_command_that_is_not_finite_is_ignored_with_one_warning(arena, peer):
    truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
    publisher = peer.node.create_publisher(Twist, "/robot_0/cmd_vel", 10)
    bad = Twist(linear=Vector3(x=math.nan))
    drive(peer, publisher, bad, lambda: "ignoring messages that cannot be read" in arena.output)
    for _ in range(20):
        publisher.publish(bad)
    drive(peer, publisher, FORWARD, lambda: is_driving(truth))
    assert arena.output.count("ignoring messages that cannot be read") == 1
    assert "/robot_0/cmd_vel: ignoring messages that cannot be read: a command that is not finite" in arena.output


@pytest.mark.parametrize("data", [b"\x00", b"\x00\x01\x00\x00", b"\xff" * 40, b"\x00\x01\x00\x00" + b"\x07" * 9])
def test_bytes_that_are_no_message_are_ignored_with_one_warning(arena, peer, data):
    publisher = peer.node.create_publisher(Twist, "/robot_0/cmd_vel", 10)
    drive(peer, publisher, data, lambda: "ignoring messages that cannot be read" in arena.output)
    assert "Traceback" not in arena.output
    assert arena.process.poll() is None


def test_reader_may_ask_for_best_effort(arena, peer):
    profile = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    scans = peer.listen("/robot_0/base_scan", "sensor_msgs/LaserScan", profile)
    peer.wait_until(lambda: len(scans) > 3, "scans")
    assert len(scans[-1].ranges) == 181


def test_scans_are_sent_by_best_effort_on_request(tmp_path, peer):
    topic = "/robot_0/base_scan"
    override = f"qos_overrides.{topic}.publisher.reliability:=best_effort"
    with running((*SIMULATION, "-p", "scenario:=tutorial_arena", "-p", "controllers:=none", "-p", override), tmp_path):
        (info,) = peer.wait_until(lambda: peer.node.get_publishers_info_by_topic(topic), topic)
        assert info.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        (("scenario:=garage_sra",), "garage_sra"),
        ((), "scenario: is not set; expected the name or file of a scenario"),
        (("scenario:=garage_sar", "set:=voice.noise_bd=20"), "voice.noise_bd: unknown key; did you mean 'noise_db'"),
        (("scenario:=garage_sar", "controllers:=tema"), "controllers: tema; expected nodes, team, inside, none"),
        (("scenario:=garage_sar", "speed:=fast"), "speed: expected a number, such as 1.0"),
        (("scenario:=garage_sar", "speed:=-1.0"), "speed: -1; expected 0 to 1000000"),
        (("scenario:=garage_sar", "speed:=.nan"), "speed: nan; expected 0 to 1000000"),
        (
            ("scenario:=garage_sar", "qos_overrides./robot_0/odom.publisher.reliability:=besteffort"),
            "qos_overrides./robot_0/odom: ",
        ),
        (("scenario:=garage_sar", "elsewhere:=3"), "elsewhere: 3; expected 0 to 2"),
        (("scenario:=garage_sar", "elsewhere:=[0, 1]"), "elsewhere: expected text"),
        (("scenario:=garage_sar", "seed:=-1"), "seed: "),
        (
            ("scenario:=garage_sar", "set:=control.localisation=tf", "controllers:=inside"),
            "controllers: inside; expected nodes or team with control.localisation=tf",
        ),
    ],
)
def test_mistake_ends_the_simulation_with_one_line(tmp_path, settings, line):
    parameters = [part for setting in settings for part in ("-p", setting)]
    with running((*SIMULATION, *parameters), tmp_path) as node:
        assert node.wait() == 2, node.output
    assert line in node.output
    assert "Traceback" not in node.output
    assert len(node.output.splitlines()) == 1, node.output


@pytest.mark.parametrize(
    ("arguments", "environment", "line"),
    [
        (
            ("-p", "speed"),
            {},
            "simulation: failed to initialize rcl: Couldn't parse parameter override rule: '-p speed'",
        ),
        (("--params-file", "none.yaml"), {}, "simulation: failed to initialize rcl: Couldn't parse params file"),
        (("--nonsense",), {}, "simulation: "),
        ((), {"ROS_DOMAIN_ID": "x"}, "simulation: failed to initialize rcl: ROS_DOMAIN_ID is not an integral number"),
    ],
)
def test_arguments_of_ros_that_are_wrong_end_a_node_with_their_reason(
    tmp_path, monkeypatch, arguments, environment, line
):
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    with running((*SIMULATION, *arguments), tmp_path) as node:
        assert node.wait() == 2, node.output
    assert node.output.splitlines()[-1].startswith(line), node.output  # after one of rcl
    assert "Traceback" not in node.output


def test_second_simulation_in_a_domain_is_refused(arena, tmp_path, peer):
    own = (*SIMULATION, "-p", "scenario:=tutorial_arena", "-p", "controllers:=none")
    for command in (own, (*MISSION, "garage_sar")):
        with running(command, tmp_path) as second:
            assert second.wait() == 2, second.output
        (line,) = second.output.splitlines()  # no controller has started
        assert "another simulation runs in it; expected another domain" in line
