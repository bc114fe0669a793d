"""Totals of bags, compared with those of the run itself and with other computations."""

from __future__ import annotations

import csv
import itertools
import json
import math

import networkx
import numpy as np
import pytest

from robotteamsim.analysis.runs import totals as totals
from robotteamsim.analysis.runs.files import document, write_tables
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.mission.events import Event
from robotteamsim.mission.team_events import RobotRemoved, RobotSpawned
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.replay.recorded_run import RecordedNetwork
from robotteamsim.recording.topics import mission


@pytest.fixture(scope="module")
def run(busy):
    return read_run([busy.bag])


def test_mission_totals_are_those_of_the_run(busy, run):
    mission, result = run_totals(run).mission, busy.result
    for name in ("scenario", "noise_db", "end", "time_s", "areas_explored", "num_areas"):
        assert getattr(mission, name) == getattr(result, name)
    for name in ("victims_saved", "num_victims", "endangered_links"):
        assert getattr(mission, name) == getattr(result, name)
    assert result.endangered_links > 0


def test_robot_totals_are_those_of_the_run_to_the_bit(busy, run):
    for robot, said in zip(run_totals(run).robots, busy.result.robots, strict=True):
        assert (robot.distance_m, robot.contact_s, robot.excluded_s) == (
            said.distance_m,
            said.contact_s,
            said.excluded_s,
        )
    assert sum(robot.contact_s for robot in run_totals(run).robots) > 0.0


def test_distance_of_a_robot_that_leaves_and_returns_equals_the_result(comes_again):
    recorded, result = run_totals(read_run([comes_again.bag])), comes_again.result
    assert [robot.distance_m for robot in recorded.robots] == [robot.distance_m for robot in result.robots]
    assert 1.0 < result.robots[1].distance_m < 8.0


def test_track_breaks_where_its_robot_comes_again_and_knows_its_absences(comes_again):
    run = read_run([comes_again.bag])
    first, gone, _, reserve = (robot.track for robot in run.robots)
    assert (first.breaks, first.absences, reserve.breaks) == ([], (), [])
    (index,) = gone.breaks
    assert math.dist(gone.poses[index - 1, :2], gone.poses[index, :2]) > 10.0
    assert np.array_equal(np.flatnonzero(np.isnan(gone.line(0, len(gone.poses))[:, 0])), [index])
    assert len(gone.line(0, index)) == index
    times_s = [0.5, 4.9, 5.1, 7.9, 8.1, 9.9, 10.1]
    there = [[track.is_present(run.start_ns + round(at_s * 1e9)) for at_s in times_s] for track in (gone, reserve)]
    assert there == [[True, True, False, False, True, True, True], [False] * 6 + [True]]


def test_odometry_that_restarts_is_not_a_path_back_to_its_origin(write_bag, odometry, tmp_path):
    second_ns = 10**9
    places_m = [0.0, 1.0, 2.0, 0.0, 1.0]
    samples = [
        ("/robot_0/odom", "nav_msgs/Odometry", stamp_ns, odometry(stamp_ns, x_m, 0.0))
        for stamp_ns, x_m in zip(range(second_ns, 6 * second_ns, second_ns), places_m, strict=True)
    ]
    for stamp_ns, what in ((4 * second_ns - 1, RobotRemoved(robot_id=0)), (4 * second_ns, RobotSpawned(robot_id=0))):
        event = mission.mission_event(stamp_ns, Event(0.0, what, ""))
        samples.append(("/mission/events", "robotteamsim/MissionEvent", stamp_ns, event))
    (robot,) = read_run([write_bag(tmp_path / "odom.bag", samples)]).robots
    assert (robot.track.breaks, robot.track.driven_m.tolist()) == ([3], [0.0, 1.0, 2.0, 2.0, 3.0])


def test_hash_of_the_trajectories_is_that_of_the_run(busy, run):
    assert run_totals(run).trajectory_hash == busy.result.trajectory_hash


def test_links_that_become_endangered_are_counted_as_the_mission_counts_them(busy, run):
    assert run_totals(run).network.endangered_links == busy.result.endangered_links


def test_length_of_a_path_is_that_of_its_pieces(run):
    for robot in run.robots:
        pieces_m = [math.hypot(*(b - a)) for a, b in itertools.pairwise(robot.track.poses[:, :2])]
        assert robot.track.driven_m[-1] == pytest.approx(math.fsum(pieces_m), rel=1e-12)


def test_fiedler_values_links_hops_and_splits_are_those_of_networkx(run):
    network = run.network
    split = totals.is_split(network)
    assert 0 < np.count_nonzero(split) < len(split)
    for index in range(0, len(network.stamps_ns), 5):
        graph = networkx.from_numpy_array(network.adjacency[index])
        parts = [graph.subgraph(part) for part in networkx.connected_components(graph)]
        assert split[index] == (len(parts) > 1)
        assert totals.links(network)[index] == graph.number_of_edges()
        assert totals.max_hops(network)[index] == max(networkx.diameter(part) for part in parts)
        algebraic = np.sort(networkx.laplacian_spectrum(graph))[1]
        assert network.fiedler_value[index] == pytest.approx(algebraic, abs=1e-9)


def test_robot_that_is_absent_splits_no_team():
    together, apart = (
        np.array([[0, 1, -1], [1, 0, -1], [-1, -1, -1]]),
        np.array([[0, -1, -1], [-1, 0, -1], [-1, -1, -1]]),
    )
    hops = np.stack([together, apart]).astype(np.int32)
    network = RecordedNetwork(np.arange(2), hops == 1, np.zeros(hops.shape, bool), hops, np.zeros(2))
    assert totals.is_split(network).tolist() == [False, True]


def test_collisions_are_counted_when_they_begin():
    touches = np.array([True, True, False, False, True, False, True, True])
    assert totals.onsets(touches).tolist() == [True, False, False, False, True, False, True, False]


def test_speed_is_the_mean_of_each_second(run):
    robot = run.robots[0]
    middles_ns, speeds = totals.speeds_mps(robot)
    ten_steps_m = robot.track.driven_m[10::10] - robot.track.driven_m[:-10:10]
    np.testing.assert_allclose(speeds, ten_steps_m[: len(speeds)], rtol=1e-9)
    assert middles_ns[0] - robot.track.stamps_ns[0] == 500_000_000


def test_document_contains_totals_and_events_and_null_for_missing_values(busy, run):
    (bag,) = json.loads(json.dumps(document([run], [run_totals(run)])))["bags"]
    assert bag["mission"]["time_s"] == busy.result.time_s
    assert bag["events"][0]["kind"] == "start"
    assert bag["robots"][2]["distance_m"] == busy.result.robots[2].distance_m


def test_context_and_coefficients_of_robots_that_adapt_are_in_totals_and_tables(adapted, run, tmp_path):
    recorded = read_run([adapted.bag])
    totals_of_run = run_totals(recorded)
    write_tables(tmp_path, [recorded], [totals_of_run])
    with (tmp_path / "contexts.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["robot"] == "robot_1"]
    assert len(rows) > 150
    assert all(sum(float(row[c]) for c in ("c1", "c2", "c3", "c4")) == pytest.approx(2.0) for row in rows)
    means = totals_of_run.robots[1].context
    assert means["alpha"] == pytest.approx(np.mean([float(row["alpha"]) for row in rows]))
    (bag,) = json.loads(json.dumps(document([recorded], [totals_of_run])))["bags"]
    assert bag["robots"][1]["context"] == means
    assert [robot.context for robot in run_totals(run).robots] == [None] * 5


def test_tables_contain_every_value_over_time(busy, run, tmp_path):
    def rows(name):
        with (tmp_path / f"{name}.csv").open(newline="") as file:
            return list(csv.DictReader(file))

    written = write_tables(tmp_path, [run], [run_totals(run)])
    assert sorted(path.name for path in written) == sorted(path.name for path in tmp_path.iterdir())
    assert rows("bags")[0]["trajectory_hash"] == busy.result.trajectory_hash
    assert len(rows("robots")) == 5
    assert [row["detail"] for row in rows("events")] == [event.detail for event in busy.events]
    assert len(rows("progress")) == len(rows("network")) == busy.result.steps
    assert rows("progress")[-1]["state"] == "ended"
    assert float(rows("progress")[-1]["mission_time_s"]) == busy.result.time_s
    paths = rows("paths")
    assert len(paths) == 5 * busy.result.steps
    assert float(paths[-1]["driven_m"]) == busy.result.robots[4].distance_m
    assert min(float(row["fiedler_value"]) for row in rows("network")) == run_totals(run).network.min_fiedler_value
