"""Frames and maps of levels in bags, and what an analysis makes of robots that go from one to another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Reader

from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.message_parts import level_frames
from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation

SCENARIO = Path(__file__).parents[2] / "data" / "scenarios" / "two_levels.yaml"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    path = tmp_path_factory.mktemp("levels") / "levels.bag"
    return path, Simulation(load(str(SCENARIO))).run([BagWriter(path)])


@pytest.fixture(scope="module")
def once(recorded: tuple[Path, Result]) -> dict[str, Any]:
    """The only message of each topic of frames and maps."""
    wanted, found = ("/tf_static", "/map", "/L1/map", "/L2/map"), {}
    with Reader(recorded[0]) as reader:
        for connection, _, data in reader.messages([one for one in reader.connections if one.topic in wanted]):
            assert connection.topic not in found
            found[connection.topic] = bag_typestore().deserialize_ros1(data, connection.msgtype)
    return found


def cells(grid: Any) -> np.ndarray:
    return np.reshape(grid.data, (grid.info.height, grid.info.width))


def test_frames_of_levels_are_at_their_origins(once):
    links = [(link.header.frame_id, link.child_frame_id) for link in once["/tf_static"].transforms]
    places = [link.transform.translation for link in once["/tf_static"].transforms]
    assert links == [("map", "L1"), ("map", "L2")]
    assert [(place.x, place.y, place.z) for place in places] == [(1.0, 1.0, 0.0), (16.0, 1.0, 0.0)]
    assert [link.transform.rotation.w for link in once["/tf_static"].transforms] == [1.0, 1.0]


@pytest.mark.parametrize(("name", "left_m"), [("L1", 0.0), ("L2", 15.0)])
def test_map_of_a_level_is_its_part_of_the_map(once, name, left_m):
    whole, part = once["/map"], once[f"/{name}/map"]
    first = round(left_m / 0.05)
    assert np.array_equal(cells(part), cells(whole)[:200, first : first + 240])
    assert set(cells(whole)[:, 240:300].ravel().tolist()) == {-1}
    assert (part.header.frame_id, part.info.origin.position.x, part.info.origin.position.y) == (name, -1.0, -1.0)


def test_mcap_file_has_them_too(tmp_path):
    path = tmp_path / "levels.mcap"
    Simulation(load(str(SCENARIO), ["mission.time_limit_s=1"])).run([McapWriter(path)])
    with BagReader([path]) as bag:
        assert {"/tf_static": "tf2_msgs/TFMessage", "/L2/map": "nav_msgs/OccupancyGrid"}.items() <= bag.topics.items()


def test_robots_that_take_a_passage_have_not_driven_it_and_nothing_is_reported(recorded):
    path, result = recorded
    run = read_run([path])
    changed = [event.robot_id for _, event in run.events if event.kind == "level_changed"]
    assert {0, 1} <= set(changed)
    assert [len(robot.track.jumps) for robot in run.robots] == [changed.count(robot) for robot in range(2)]
    totals = run_totals(run)
    assert [robot.distance_m for robot in totals.robots] == [robot.distance_m for robot in result.robots]
    assert totals.notes == ()


@pytest.mark.parametrize(
    ("names", "frames"),
    [
        (["L1", "L2"], ["L1", "L2"]),
        (["1. floor", "Café"], ["level_1__floor", "Caf_"]),
        (["map", "robot_3", "building"], ["level_map", "level_robot_3", "level_building"]),
        (["a b", "a_b", "a.b"], ["a_b", "level_a_b", "level_level_a_b"]),
    ],
)
def test_frames_have_names_that_ros_allows_and_nobody_else_has(names, frames):
    assert level_frames(names) == frames
