"""What bags tell, of this simulation and of others."""

from __future__ import annotations

import math
import re
from dataclasses import fields

import numpy as np
import pytest
from rosbags.rosbag1 import Writer

from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.errors import RecordingError
from robotteamsim.message_parts import header, point
from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.bag_types import bag_typestore, message_type
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.replay.recorded_run import RecordedNetwork
from robotteamsim.recording.topics import base, world
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.simulation import Simulation

STEP_NS = 100_000_000


def odometry_samples(odometry, topic="/robot_0/odom", steps=21, **attributes):
    """A robot that drives 2 m east in 2 s."""
    for step in range(steps):
        time_ns = 10**9 + step * STEP_NS
        yield topic, "nav_msgs/Odometry", time_ns, odometry(time_ns, 0.1 * step, 0.0, **attributes)


def test_bag_of_a_run_contains_all_of_it(busy):
    run = read_run([busy.bag])
    assert [robot.name for robot in run.robots] == [f"robot_{i}" for i in range(5)]
    assert all(robot.track.source == "truth" and robot.track.is_on_map for robot in run.robots)
    assert [event.row() for _, event in run.events] == [event.row() for event in busy.events]
    assert len(run.statuses) == busy.result.steps
    assert (run.start_ns, run.end_ns) == (STEP_NS, busy.result.steps * STEP_NS)
    assert [area.name for area in run.areas] == [f"area_{i}" for i in range(1, 6)]
    assert run.grid.cells.shape == (800, 1200)
    assert run.unread == ()
    assert run_totals(run).omitted == ()


@pytest.mark.slow
def test_bag_without_matrices_has_the_same_network(tmp_path):
    schedule = "schedule=[{at_s: 0.5, remove: 2}, {at_s: 1.5, spawn: 2}]"
    networks = []
    for matrices in (True, False):
        changes = [schedule, "robots.count=5", "mission.time_limit_s=3", f"network.publish_matrices={matrices}"]
        path = tmp_path / f"{matrices}.bag"
        Simulation(load("garage_sar", changes)).run([BagWriter(path)])
        with BagReader([path]) as bag:
            assert ("/network/state" in bag.topics) == matrices
        networks.append(read_run([path]).network)
    with_matrices, without = networks
    assert (with_matrices.hop_count[10] < 0).any()
    assert without.signals_dbm is None
    for key in {key.name for key in fields(RecordedNetwork)} - {"signals_dbm"}:
        np.testing.assert_array_equal(getattr(without, key), getattr(with_matrices, key), err_msg=key)


def test_standard_topics_alone_give_paths_and_name_missing_topics(write_bag, odometry, tmp_path):
    run = read_run([write_bag(tmp_path / "real.bag", odometry_samples(odometry))])
    (robot,) = run.robots
    assert (robot.name, robot.robot_id, robot.track.source, robot.track.frame) == ("robot_0", 0, "odom", "robot_0/odom")
    assert robot.track.driven_m[-1] == pytest.approx(2.0)
    assert run_totals(run).omitted == (
        "mission, areas and victims over time: no /mission/status",
        "events: no /mission/events",
        "network: no /network/state",
        "paths on the floor plan: no transform on /tf from map to robot_0/odom of robot_0",
        "collisions: no contact of any robot",
        "time excluded: no controller/status of any robot",
        "floor plan: no /map",
    )


def test_tf_places_an_odometry_on_the_map_from_the_first_transform_on(write_bag, odometry, placed_at, tmp_path):
    moved = [("/tf", "tf2_msgs/TFMessage", t_ns, placed_at(t_ns, *place)) for t_ns, place in PLACES]
    run = read_run([write_bag(tmp_path / "real.bag", [*odometry_samples(odometry), *moved])])
    track = run.robots[0].track
    assert (track.source, track.frame) == ("odom and tf", "map")
    assert track.stamps_ns[0] == 1_500_000_000
    # Turned by a quarter to the left, 2 m east is 2 m north.
    np.testing.assert_allclose(track.poses[0], (5.0, 6.5, math.pi / 2), atol=1e-12)
    np.testing.assert_allclose(track.poses[-1], (5.5, 8.0, math.pi / 2), atol=1e-12)
    # What localisation corrects is not driven.
    assert track.driven_m[-1] == pytest.approx(2.0)


PLACES = ((1_500_000_000, (5.0, 6.0, math.pi / 2)), (2_500_000_000, (5.5, 6.0, math.pi / 2)))


def test_odometry_in_map_needs_no_tf(write_bag, odometry, tmp_path):
    run = read_run([write_bag(tmp_path / "slam.bag", odometry_samples(odometry, frame="/map"))])
    assert run.robots[0].track.is_on_map


def test_truth_wins_over_odometry(write_bag, odometry, tmp_path):
    samples = [*odometry_samples(odometry), *odometry_samples(odometry, "/robot_0/base_pose_ground_truth", steps=11)]
    (robot,) = read_run([write_bag(tmp_path / "stage.bag", samples)]).robots
    assert (robot.track.source, robot.track.driven_m[-1]) == ("truth", pytest.approx(1.0))


def test_robots_may_have_any_namespace_or_none(write_bag, odometry, tmp_path):
    topics = ("/odom", "/robot_10/odom", "/robot_2/odom", "/floor/husky/odom")
    samples = [sample for topic in topics for sample in odometry_samples(odometry, topic)]
    run = read_run([write_bag(tmp_path / "mixed.bag", samples)])
    assert [(robot.name, robot.robot_id) for robot in run.robots] == [
        ("robot", None),
        ("floor/husky", None),
        ("robot_2", 2),
        ("robot_10", 10),
    ]


def test_poses_of_a_lost_robot_are_omitted(write_bag, odometry, tmp_path):
    samples = list(odometry_samples(odometry))
    samples[5][3]["pose"]["pose"]["position"]["x"] = math.nan
    track = read_run([write_bag(tmp_path / "lost.bag", samples)]).robots[0].track
    assert len(track.stamps_ns) == 20
    assert track.driven_m[-1] == pytest.approx(2.0)


def test_topic_of_a_version_without_the_needed_attributes_is_named(odometry, tmp_path):
    path, typestore = tmp_path / "old.bag", bag_typestore()
    with Writer(path) as bag:
        kind = "nav_msgs/msg/Odometry"
        odom = bag.add_connection("/robot_0/odom", kind, typestore=typestore)
        for _, _, time_ns, message in odometry_samples(odometry):
            bag.write(odom, time_ns, message_type("nav_msgs/Odometry").encode(message))
        state = "robotteamsim/msg/NetworkState"
        network = bag.add_connection("/network/state", state, msgdef="uint32 num_robots\n", md5sum="0" * 32)
        bag.write(network, 10**9, b"\3\0\0\0")
    run = read_run([path])
    assert (run.network, run.unread) == (None, ("/network/state",))
    assert run_totals(run).omitted[0] == "/network/state: unknown type, or unknown version of the type"


def test_map_is_read_unchanged(write_bag, odometry, tmp_path):
    cells = np.array([[0, 100, -1], [0, 0, 100]], dtype=np.int8)
    grid = base.occupancy_grid(0, OccupancyGrid((-1.0, 2.0), 0.5, cells))
    samples = [("/map", "nav_msgs/OccupancyGrid", 1, grid), *odometry_samples(odometry)]
    run = read_run([write_bag(tmp_path / "map.bag", samples)])
    assert (run.grid.origin_m, run.grid.resolution_m) == ((-1.0, 2.0), 0.5)
    np.testing.assert_array_equal(run.grid.cells, cells)


def test_map_that_grows_is_read_as_it_is_in_the_end(write_bag, odometry, tmp_path):
    grids = [OccupancyGrid((0.0, 0.0), 0.5, np.full((2, size), 100, dtype=np.int8)) for size in (3, 5)]
    maps = [("/map", "nav_msgs/OccupancyGrid", t, base.occupancy_grid(t, grid)) for t, grid in enumerate(grids, 1)]
    run = read_run([write_bag(tmp_path / "slam.bag", [*maps, *odometry_samples(odometry)])])
    assert run.grid.cells.shape == (2, 5)


def test_messages_after_the_end_of_the_mission_do_not_count(write_bag, odometry, tmp_path):
    def status(time_ns, state):
        return {
            "header": header(time_ns, "map"),
            "scenario": "hall",
            "state": state,
            "end": "aborted" if state == "ended" else "",
            "time_s": (time_ns - 10**9) / 1e9,
            "explored": np.zeros(1, dtype=np.uint8),
            "explored_by": np.zeros(0, dtype=np.int32),
            "victims": ["heard"],
            "assistance": [],
            "target_area": 0,
            "endangered_links": 0,
            "noise_db": 10.0,
            "running": state == "running",
            "epoch": 0,
            "has_area": False,
            "area_center": point((0.0, 0.0)),
            "area_radius_m": 0.0,
            "has_base": True,
            "discoveries_delivered": 3,
            "mean_delivery_delay_s": 1.5,
            "max_delivery_delay_s": 2.5,
            "undelivered": [],
        }

    states = [(1_000_000_000, "running"), (2_000_000_000, "ended"), (3_000_000_000, "ended")]
    samples = [("/mission/status", "robotteamsim/MissionStatus", t, status(t, state)) for t, state in states]
    run = read_run([write_bag(tmp_path / "m.bag", [*samples, *odometry_samples(odometry)])])
    assert (run.start_ns, run.end_ns) == (1_000_000_000, 2_000_000_000)
    assert run.robots[0].track.driven_m[-1] == pytest.approx(1.0)
    mission = run_totals(run).mission
    assert mission.end == "aborted"
    assert (mission.discoveries_delivered, mission.mean_delivery_delay_s, mission.max_delivery_delay_s) == (3, 1.5, 2.5)


def test_bag_without_the_topics_is_rejected(write_bag, tmp_path):
    path = write_bag(tmp_path / "clock.bag", [("/clock", "rosgraph_msgs/Clock", 1, world.clock(1))])
    with pytest.raises(RecordingError) as refused:
        read_run([path])
    wanted = "expected odometry, poses or tf of a robot, /mission/status or /network/state"
    assert str(refused.value) == f"{path}: {wanted}; found /clock of type rosgraph_msgs/Clock"


def test_empty_bag_is_rejected(write_bag, tmp_path):
    with pytest.raises(RecordingError, match=r"/network/state; the bag is empty$"):
        read_run([write_bag(tmp_path / "empty.bag", [])])


def test_bag_of_two_runs_is_rejected(write_bag, odometry, tmp_path):
    first, second = list(odometry_samples(odometry)), list(odometry_samples(odometry))
    for _, _, _, message in second:
        message["pose"]["pose"]["position"]["y"] = 0.01  # messages with the same values would be copies
    again = [(topic, kind, time_ns + 3 * 10**9, message) for topic, kind, time_ns, message in second]
    with pytest.raises(
        RecordingError, match=r"/robot_0/odom: time goes back from 3\.0 to 1\.0 s; expected one run per"
    ):
        read_run([write_bag(tmp_path / "two.bag", [*first, *again])])


def areas_of_radius(radius_m):
    area = {
        "name": "A",
        "center": point((0, 0)),
        "radius_m": radius_m,
        "explored": False,
        "target": False,
    }
    return {"header": header(1, "map"), "areas": [area]}


def map_of_resolution(resolution_m):
    grid = OccupancyGrid((0.0, 0.0), resolution_m, np.zeros((2, 2), dtype=np.int8))
    return base.occupancy_grid(1, grid)


@pytest.mark.parametrize(
    ("topic", "kind", "message", "said"),
    [
        ("/mission/areas", "robotteamsim/Areas", areas_of_radius(math.nan), "radius nan; expected at most 1e+06"),
        ("/map", "nav_msgs/OccupancyGrid", map_of_resolution(math.inf), "resolution inf; expected at most 1e+06"),
    ],
)
def test_impossible_numbers_name_topic_and_value(write_bag, odometry, tmp_path, topic, kind, message, said):
    bag = write_bag(tmp_path / "odd.bag", [(topic, kind, 10**9, message), *odometry_samples(odometry)])
    with pytest.raises(RecordingError, match=rf"odd\.bag: {topic}: {re.escape(said)}$"):
        read_run([bag])
