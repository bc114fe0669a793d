"""With `localized`, /tf of a bag leads from the map to each robot's true place; otherwise it begins at `odom`."""

from __future__ import annotations

import cmath
from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag1 import Reader

from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

# Robot 1 leaves and comes again elsewhere; odometry drifts, so the origin moves.
SETTINGS = [
    *("robots.count=2", "run.seed=3", "mission.time_limit_s=4"),
    "schedule=[{at_s: 1, remove: 1}, {at_s: 2, spawn: 1, pose: [20, 5, 1]}]",
]
Link = tuple[complex, complex]
"""Position x + iy [m] and direction cos + i sin of a frame in its parent."""


def frame(position: Any, rotation: Any) -> Link:
    half = complex(rotation.w, rotation.z)
    return complex(position.x, position.y), half * half


def messages(path: Path, topic: str) -> dict[int, Any]:
    """Return the messages of a topic by time [ns]."""
    store = bag_typestore()
    with Reader(path) as bag:
        wanted = [connection for connection in bag.connections if connection.topic == topic]
        return {ns: store.deserialize_ros1(data, one.msgtype) for one, ns, data in bag.messages(wanted)}


@pytest.fixture(params=[True, False], ids=["localized", "not localized"])
def recorded(request, tmp_path) -> tuple[Path, bool]:
    path = tmp_path / "run.bag"
    Simulation(load("garage_sar", SETTINGS)).run([BagWriter(path, localized=request.param)])
    return path, request.param


def test_tf_of_a_localized_bag_leads_to_the_true_place_of_every_present_robot(recorded):
    path, localized = recorded
    transforms, places = messages(path, "/tf"), 0
    for robot_id in range(2):
        truths = messages(path, f"/robot_{robot_id}/base_pose_ground_truth")
        for time_ns, message in transforms.items():
            links = {each.child_frame_id: each for each in message.transforms}
            origin = links.get(f"robot_{robot_id}/odom")
            assert (origin is not None) == (localized and time_ns in truths)
            if origin is None:
                continue
            assert origin.header.frame_id == "map"
            steps = [origin, links[f"robot_{robot_id}/base_footprint"]]
            (x, turn), (dx, dturn) = (frame(one.transform.translation, one.transform.rotation) for one in steps)
            true_pose = truths[time_ns].pose.pose
            true_x, true_turn = frame(true_pose.position, true_pose.orientation)
            assert abs(x + turn * dx - true_x) < 1e-9
            assert abs(cmath.phase(turn * dturn / true_turn)) < 1e-9
            places += 1
    # 41 steps of robot 0; robot 1 is absent from 1 to 2 s, for 10 of them.
    assert places == (72 if localized else 0)
