"""A mission on two levels in ROS 2."""

from __future__ import annotations

from pathlib import Path

from peer import ALL_LATCHED, MISSION
from running import running

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

SCENARIO = str(Path(__file__).parents[1] / "data" / "scenarios" / "two_levels.yaml")


def test_mission_in_lockstep_has_the_hash_of_a_run_without_ros(tmp_path):
    with running((*MISSION, SCENARIO, "--seed", "7", "--speed", "0", "--lockstep"), tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    assert Simulation(load(SCENARIO, ["run.seed=7"])).run().trajectory_hash in mission.output
    assert "robot 0 is on level L2" in mission.output


def test_levels_have_frames_and_maps_and_a_service_between_them(tmp_path, peer):
    command = (*MISSION, SCENARIO, "--controllers", "inside", "--paused", "--speed", "0")
    with running(command, tmp_path):
        peer.wait_until(lambda: peer.node.count_publishers("/clock"), "the simulation")
        frames = peer.listen("/tf_static", "tf2_msgs/TFMessage", ALL_LATCHED)
        maps = [peer.listen(f"/{name}/map", "nav_msgs/OccupancyGrid", ALL_LATCHED) for name in ("L1", "L2")]
        peer.wait_until(lambda: frames and all(maps), "latched messages")
        links = [(link.header.frame_id, link.child_frame_id) for link in frames[0].transforms]
        assert links == [("map", "L1"), ("map", "L2")]
        assert [message.header.frame_id for (message,) in maps] == ["L1", "L2"]
        service, type_name = "/simulation/take_passage", "robotteamsim/TakePassage"
        refused = peer.call(service, type_name, robot_id=0, level="L1")
        assert (refused.success, refused.message) == (False, "take_passage: robot 0 is on level L1 already")
        assert peer.call(service, type_name, robot_id=0, level="L2").success
