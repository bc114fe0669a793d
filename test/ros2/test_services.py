"""Services and parameters in ROS 2, and what they refuse."""

from __future__ import annotations

import sys

import pytest
from geometry_msgs.msg import Pose2D
from peer import ALL_LATCHED, MISSION, interface
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from running import running

from robotteamsim.scenario import load
from robotteamsim.scenario.map_image import published_map


@pytest.fixture
def paused(tmp_path, peer):
    """A mission that is paused before its first step."""
    command = (*MISSION, "garage_sar", "--seed", "7", "--controllers", "team", "--lockstep", "--paused", "--speed", "0")
    with running(command, tmp_path) as mission:
        peer.wait_until(lambda: peer.node.count_publishers("/clock"), "the simulation")
        yield mission


def step(peer, steps=1):
    answer = peer.call("/simulation/step", "robotteamsim/Step", steps=steps)
    assert answer.success, answer.message


def test_services_are_below_the_name_of_the_node(paused, peer):
    wanted = {
        *(
            f"/simulation/{name}"
            for name in ("pause", "resume", "step", "reset", "reset_seed", "set_speed", "set_noise")
        ),
        *("/mission/start", "/mission/abort", "/static_map", "/reset_positions"),
    }
    peer.wait_until(lambda: wanted <= dict(peer.node.get_service_names_and_types()).keys(), "all services")
    assert "/pause" not in dict(peer.node.get_service_names_and_types())


def test_robot_leaves_comes_back_and_is_moved(paused, peer):
    robots = peer.listen("/world/robots", "robotteamsim/Robots", ALL_LATCHED)
    truth = peer.listen("/robot_1/base_pose_ground_truth", "nav_msgs/Odometry", ALL_LATCHED)
    step(peer)
    assert peer.call("/simulation/remove_robot", "robotteamsim/RemoveRobot", robot_id=1).success
    step(peer)
    peer.wait_until(lambda: robots and list(robots[-1].present) == [True, False, True], "a team without robot 1")
    refused = peer.call("/simulation/remove_robot", "robotteamsim/RemoveRobot", robot_id=1)
    assert (refused.success, refused.message) == (False, "robot_1 is not present; it cannot be removed")
    assert peer.call("/simulation/spawn_robot", "robotteamsim/SpawnRobot", robot_id=1, at_start=True).success
    moved = peer.call("/simulation/set_pose", "robotteamsim/SetPose", robot_id=1, pose=Pose2D(x=30.0, y=5.0, theta=0.0))
    assert moved.success, moved.message
    step(peer)
    peer.wait_until(lambda: truth and abs(truth[-1].pose.pose.position.x - 30.0) < 0.2, "robot 1 at its new place")
    peer.wait_until(lambda: list(robots[-1].arrivals) == [1, 2, 1], "the second arrival of robot 1")


@pytest.mark.parametrize(
    ("name", "type_name", "request_", "reason"),
    [
        ("set_noise", "SetNoise", {"noise_db": 300.0}, "noise_db"),
        ("set_noise", "SetNoise", {"noise_db": float("nan")}, "noise_db"),
        ("set_door", "SetDoor", {"name": "gate", "closed": True}, "gate"),
        ("set_pose", "SetPose", {"robot_id": 9, "pose": Pose2D()}, "9"),
        ("set_speed", "SetSpeed", {"speed": -1.0}, "speed must be finite and >= 0, got -1"),
        ("step", "Step", {"steps": 0}, "steps: 0; expected at least 1"),
    ],
)
def test_request_that_cannot_be_carried_out_is_refused_with_the_reason(paused, peer, name, type_name, request_, reason):
    answer = peer.call(f"/simulation/{name}", f"robotteamsim/{type_name}", **request_)
    assert not answer.success
    assert reason in answer.message


def test_reset_with_another_seed_starts_controllers_and_time_again(paused, peer):
    truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry", ALL_LATCHED)

    def twenty_steps():
        del truth[:]
        for number in range(20):
            step(peer)
            peer.wait_until(lambda: len(truth) > number, "a step")  # noqa: B023
        last = truth[-1].header.stamp
        assert (last.sec, last.nanosec) == (2, 0)
        return [(message.pose.pose.position.x, message.pose.pose.position.y) for message in truth]

    first = twenty_steps()
    for seed, is_same in ((8, False), (7, True)):
        assert peer.call("/simulation/reset_seed", "robotteamsim/ResetSeed", seed=seed).success
        assert (twenty_steps() == first) == is_same
    answer = peer.call("/simulation/get_parameters", "rcl_interfaces/GetParameters", names=["seed"])
    assert answer.values[0].string_value == "7"


def test_maps_come_by_services(paused, peer):
    grid = published_map(load("garage_sar"))
    answer = peer.call("/static_map", "nav_msgs/GetMap")
    assert list(answer.map.data) == grid.cells.ravel().tolist()
    early = peer.call("/simulation/get_radio_map", "robotteamsim/GetRadioMap", robot_id=0, resolution_m=1.0)
    assert (early.success, early.message) == (False, "no step has been taken yet")
    step(peer)
    radio = peer.call("/simulation/get_radio_map", "robotteamsim/GetRadioMap", robot_id=0, resolution_m=1.0)
    assert radio.success
    assert max(radio.map.data) < 0.0
    assert len(radio.map.data) == radio.map.width * radio.map.height > 1000


def test_mission_is_aborted_once(paused, peer):
    step(peer)
    assert peer.call("/mission/abort", "std_srvs/Trigger").success
    again = peer.call("/mission/abort", "std_srvs/Trigger")
    assert not again.success


def test_parameters_show_the_settings_and_are_not_changed_from_outside(paused, peer):
    names = ["scenario", "lockstep", "speed"]
    answer = peer.call("/simulation/get_parameters", "rcl_interfaces/GetParameters", names=names)
    scenario, lockstep, speed = answer.values
    assert (scenario.string_value, lockstep.bool_value, speed.double_value) == ("garage_sar", True, 0.0)
    described = peer.call("/simulation/describe_parameters", "rcl_interfaces/DescribeParameters", names=["speed"])
    assert described.descriptors[0].floating_point_range[0].from_value == 0.0
    text = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="9")
    for name, reason in (("scenario", "read-only"), ("seed", "reset_seed")):
        wanted = [Parameter(name=name, value=text)]
        answer = peer.call("/simulation/set_parameters", "rcl_interfaces/SetParameters", parameters=wanted)
        (result,) = answer.results
        assert not result.successful
        assert reason in result.reason


def test_services_answer_while_another_waits_for_steps(tmp_path, peer):
    with running((*MISSION, "tutorial_arena", "--controllers", "none", "--paused", "--speed", "1"), tmp_path):
        service = "/simulation/step"
        client = peer.node.create_client(interface("srv", "robotteamsim/Step"), service)
        peer.wait_until(client.service_is_ready, service)
        waiting = client.call_async(client.srv_type.Request(steps=100000))
        assert peer.call("/simulation/set_speed", "robotteamsim/SetSpeed", speed=2.0).success
        peer.wait_until(lambda: peer.call("/mission/abort", "std_srvs/Trigger").success, "the end of the mission")
        assert not waiting.done()


def test_service_without_a_message_is_still_there_after_it_has_failed(tmp_path, peer):
    simulation = (sys.executable, "-m", "robotteamsim.ros2.simulation", "--ros-args", "-p", "scenario:=tutorial_arena")
    with running((*simulation, "-p", "lockstep:=true"), tmp_path) as node:  # whose controllers do not answer
        node.wait_for(lambda line: "waiting for /robot_0/" in line, "a step that waits")
        peer.call("/reset_positions", "std_srvs/Empty")
        node.wait_for(lambda line: "/reset_positions: the current step has not ended" in line, "the reason")
        assert peer.call("/simulation/set_speed", "robotteamsim/SetSpeed", speed=2.0).success
