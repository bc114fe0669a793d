"""Bags of other people's robots: where the paths come from, and what is reported instead of being driven."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as FolderWriter

from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.errors import RecordingError
from robotteamsim.geometry import PoseReading
from robotteamsim.message_parts import header
from robotteamsim.recording.bag_types import ROS2, bag_typestore, message_type
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.topics.base import pose

SECOND_NS = 10**9
START_NS = 1_700_000_000 * SECOND_NS
ODOMETRY, POSE, TF = "nav_msgs/Odometry", "geometry_msgs/PoseStamped", "tf2_msgs/TFMessage"
STEPS = range(101)

Sample = tuple[str, str, int, Any]


def time_ns(step: int) -> int:
    return START_NS + step * SECOND_NS // 10


@pytest.fixture
def drive(odometry):
    """A robot that drives 10 m along x in 10 s."""

    def samples(topic: str, *, late_ns: int = 0, stamp_ns: int = 0, frame: str = "odom") -> Iterator[Sample]:
        for step in STEPS:
            at_ns = time_ns(step)
            message = odometry(at_ns + stamp_ns, 0.1 * step, 0.0, frame=frame)
            yield topic, ODOMETRY, at_ns + late_ns, message

    return samples


def transform(parent: str, child: str, at_ns: int, x_m: float, y_m: float) -> Any:
    one = {
        "header": header(at_ns, parent),
        "child_frame_id": child,
        "transform": {
            "translation": {"x": x_m, "y": y_m, "z": 0.0},
            "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
        },
    }
    return {"transforms": [one]}


def placed(topic: str, child: str, x_m: float, y_m: float) -> list[Sample]:
    """map -> child at a place, from the start on."""
    return [(topic, TF, time_ns(0), transform("map", child, time_ns(0), x_m, y_m))]


def write(write_bag, path: Path, *samples: Any) -> Path:
    return write_bag(path, sorted((one for some in samples for one in some), key=lambda sample: sample[2]))


def driven_m(run: Any) -> dict[str, float]:
    return {robot.name: round(float(robot.track.driven_m[-1]), 9) for robot in run.robots}


def ends(run: Any) -> dict[str, list[tuple[float, ...]]]:
    """First and last position of each robot [m]."""
    return {
        robot.name: [tuple(np.round(robot.track.poses[index, :2], 9).tolist()) for index in (0, -1)]
        for robot in run.robots
    }


def test_each_robot_of_a_folder_is_placed_by_the_tf_of_its_namespace(drive, tmp_path):
    """As nav2 does with several robots: all call their frames map, odom and base_link."""
    bag = FolderWriter(tmp_path / "team", version=9, storage_plugin=StoragePlugin.MCAP)
    samples = [sample for k in (1, 2) for sample in drive(f"/robot{k}/odom")]
    samples += placed("/robot1/tf", "odom", 100.0, 50.0) + placed("/robot2/tf_static", "odom", 200.0, 50.0)
    connections: dict[str, Any] = {}
    with bag:
        for topic, kind, at_ns, message in sorted(samples, key=lambda sample: sample[2]):
            name = kind.replace("/", "/msg/")
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, name, typestore=bag_typestore(ROS2))
            bag.write(connections[topic], at_ns, message_type(kind, ROS2).encode(message))
    run = read_run([tmp_path / "team"])
    assert ends(run) == {"robot1": [(100.0, 50.0), (110.0, 50.0)], "robot2": [(200.0, 50.0), (210.0, 50.0)]}
    assert [robot.track.source for robot in run.robots] == ["odom and tf"] * 2


def test_frame_with_the_namespace_as_its_prefix_is_found_without_it(write_bag, drive, tmp_path):
    """This package's nodes of ROS 2 publish odometry in robot_0/odom, and robot_0/tf with odom."""
    path = write(
        write_bag,
        tmp_path / "own.bag",
        drive("/robot_0/odom", frame="robot_0/odom"),
        placed("/robot_0/tf", "odom", 5.0, 6.0),
    )
    assert ends(read_run([path])) == {"robot_0": [(5.0, 6.0), (15.0, 6.0)]}


def test_tf_of_the_robot_counts_before_that_of_the_team(write_bag, drive, tmp_path):
    tfs = placed("/tf", "odom", 1.0, 1.0), placed("/robot1/tf", "odom", 2.0, 2.0)
    path = write(write_bag, tmp_path / "both.bag", drive("/robot1/odom"), drive("/robot2/odom"), *tfs)
    assert ends(read_run([path])) == {"robot1": [(2.0, 2.0), (12.0, 2.0)], "robot2": [(1.0, 1.0), (11.0, 1.0)]}


def test_tf_of_old_programs_is_read(odometry, tmp_path):
    """tf/tfMessage, of rosserial for example, has the fields and the MD5 sum of tf2_msgs/TFMessage."""
    path, types = tmp_path / "serial.bag", bag_typestore()
    with Writer(path) as bag:
        odom = bag.add_connection("/odom", "nav_msgs/msg/Odometry", typestore=types)
        definition, md5 = types.generate_msgdef("tf2_msgs/msg/TFMessage")
        tf = bag.add_connection("/tf", "tf/msg/tfMessage", msgdef=definition, md5sum=md5)
        assert md5 == "94810edda583a504dfda3829e70d7eec"
        at_ns = time_ns(0)
        place = transform("map", "odom", at_ns, 100.0, 50.0)
        bag.write(tf, at_ns, message_type(TF).encode(place))
        for step in STEPS:
            message = odometry(time_ns(step), 0.1 * step, 0.0, frame="odom")
            bag.write(odom, time_ns(step), message_type("nav_msgs/Odometry").encode(message))
    assert ends(read_run([path])) == {"robot": [(100.0, 50.0), (110.0, 50.0)]}


def poses(topic: str, frame: str = "world") -> list[Sample]:
    return [
        (
            topic,
            POSE,
            time_ns(step),
            {
                "header": header(time_ns(step), frame),
                "pose": pose(PoseReading(0.1 * step, 0.0, 0.0, 1.0)),
            },
        )
        for step in STEPS
    ]


@pytest.mark.parametrize(
    ("topics", "names"),
    [
        (["/vrpn_client_node/robot1/pose", "/robot1/goal_pose"], ["vrpn_client_node/robot1"]),
        (["/mocap/robot10", "/mocap/robot2"], ["mocap/robot2", "mocap/robot10"]),
    ],
)
def test_poses_of_motion_capture_are_a_path(write_bag, tmp_path, topics, names):
    run = read_run([write(write_bag, tmp_path / "mocap.bag", *map(poses, topics))])
    assert driven_m(run) == dict.fromkeys(names, 10.0)
    assert {(robot.track.source, robot.track.frame) for robot in run.robots} == {("pose", "world")}


@pytest.mark.parametrize(
    ("topics", "names"),
    [
        (["/odometry/filtered"], ["robot"]),
        (["/odometry/filtered", "/odometry/gps"], ["robot"]),
        (["/robot1/odometry/filtered", "/robot2/odometry/filtered"], ["robot1", "robot2"]),
        (["/husky/odom", "/odometry/filtered"], ["husky"]),
        (["/robot1/wheel_odom", "/robot2/wheel_odom"], ["robot1", "robot2"]),
    ],
)
def test_odometry_of_another_name_is_found_by_its_type(write_bag, drive, tmp_path, topics, names):
    run = read_run([write(write_bag, tmp_path / "other.bag", *map(drive, topics), poses("/pose"))])
    assert driven_m(run) == dict.fromkeys(names, 10.0)


@pytest.mark.parametrize(
    ("topic", "child", "name"),
    [("/tf", "base_link", "robot"), ("/tf", "r1/base_footprint", "r1"), ("/r1/tf", "base_link", "r1")],
)
def test_tf_alone_is_a_path(write_bag, tmp_path, topic, child, name):
    parent = child.replace("base_link", "odom").replace("base_footprint", "odom")
    moves = [(topic, TF, time_ns(i), transform(parent, child, time_ns(i), 0.1 * i, 0.0)) for i in STEPS]
    inner = child.rpartition("/")[0] + "base_link"
    fixed = [(topic, TF, time_ns(i), transform(child, inner, time_ns(i), 9.0, 9.0)) for i in STEPS]
    run = read_run([write(write_bag, tmp_path / "tf.bag", moves, fixed, placed(topic, parent, 100.0, 50.0))])
    assert ends(run) == {name: [(100.0, 50.0), (110.0, 50.0)]}
    assert run.robots[0].track.source == "tf"


def test_topic_of_the_odometry_can_be_chosen(write_bag, drive, tmp_path):
    topics = ("/odom_wheels", "/odom_camera", "/robot1/odom")
    path = write(write_bag, tmp_path / "many.bag", *map(drive, topics), poses("/robot2/pose"))
    assert driven_m(read_run([path])) == {"robot1": 10.0}
    chosen = ["/odom_wheels", "/robot2/pose"]
    assert driven_m(read_run([path], chosen)) == {"robot": 10.0, "robot2": 10.0}
    assert list(driven_m(read_run([path], topics[:2]))) == ["odom_camera", "odom_wheels"]


def test_several_odometries_of_a_robot_ask_for_a_choice(write_bag, drive, tmp_path):
    path = write(write_bag, tmp_path / "many.bag", drive("/odom_wheels"), drive("/odom_camera"))
    with pytest.raises(RecordingError) as refused:
        read_run([path])
    several = "/odom_camera, /odom_wheels: several odometries of a robot; choose with --odometry"
    assert str(refused.value) == f"{path}: {several}"


@pytest.mark.parametrize(("topic", "why"), [("/wheels", "is not in the bag"), ("/tf", "is of type tf2_msgs/TFMessage")])
def test_topic_without_poses_is_rejected(write_bag, drive, tmp_path, topic, why):
    path = write(write_bag, tmp_path / "one.bag", drive("/odom"), placed("/tf", "odom", 1.0, 1.0))
    with pytest.raises(RecordingError) as refused:
        read_run([path], [topic])
    assert str(refused.value) == f"{path}: --odometry {topic}: {why}; expected a topic with poses: /odom"


def test_jump_of_the_odometry_is_reported_and_not_driven(write_bag, odometry, tmp_path):
    """1 m/s for 10 s; after 5 s the driver starts again, at 0. Of 100 steps of 0.1 m, one is the jump of 4.9 m."""
    samples = [
        ("/odom", ODOMETRY, time_ns(i), odometry(time_ns(i), 0.1 * (i if i < 50 else i - 50), 0.0)) for i in STEPS
    ]
    run = read_run([write_bag(tmp_path / "reset.bag", samples)])
    totals = run_totals(run)
    assert totals.robots[0].distance_m == pytest.approx(9.9)
    assert totals.robots[0].max_speed_mps == pytest.approx(1.0)
    assert run.robots[0].track.breaks == [50]
    assert totals.notes == (
        "robot: 1 jump faster than 20 m/s, the first of 4.9 m at 5.0 s: resets of the odometry, not driven",
    )


@pytest.mark.parametrize(("lost", "robots"), [(range(40, 60), ["r1", "r2"]), (STEPS, ["r1"])], ids=["some", "all"])
def test_poses_that_are_not_finite_are_reported_and_missing(write_bag, odometry, drive, tmp_path, lost, robots):
    """r2 publishes NaN in some steps, or in all: there is no distance of these."""
    samples = [
        ("/r2/odom", ODOMETRY, time_ns(i), odometry(time_ns(i), math.nan if i in lost else 0.1 * i, 0.0)) for i in STEPS
    ]
    run = read_run([write(write_bag, tmp_path / "nan.bag", drive("/r1/odom"), samples)])
    totals = run_totals(run)
    assert [robot.name for robot in run.robots] == robots
    assert totals.notes == (f"/r2/odom: {len(lost)} of 101 poses are not finite; they are left out",)
    assert [(gap.topic, gap.missing) for gap in run.gaps] == ([("/r2/odom", 20)] if len(robots) == 2 else [])


def test_stamps_that_jitter_are_not_jumps(write_bag, odometry, tmp_path):
    """A burst of late messages: 0.4 m within 1 ms of the stamps."""
    stamps_ns = [time_ns(i) if i % 10 else time_ns(i + 1) - 10**6 for i in STEPS]
    samples = [("/odom", ODOMETRY, at_ns, odometry(at_ns, 0.4 * i, 0.0)) for i, at_ns in enumerate(stamps_ns)]
    totals = run_totals(read_run([write_bag(tmp_path / "burst.bag", samples)]))
    assert (totals.robots[0].distance_m, totals.notes) == (pytest.approx(40.0), ())


@pytest.mark.parametrize("late_ns", [0, 3 * 10**8, 3 * SECOND_NS])
def test_messages_that_are_there_twice_count_once(write_bag, drive, tmp_path, late_ns):
    path = write(write_bag, tmp_path / "twice.bag", drive("/odom"), drive("/odom", late_ns=late_ns))
    totals = run_totals(read_run([path]))
    assert (totals.robots[0].distance_m, totals.duration_s) == (pytest.approx(10.0), 10.0)
    assert totals.notes == ("/odom: 101 of 202 messages are copies; each counts once",)


def test_a_few_copies_that_come_late_are_no_second_run(write_bag, drive, tmp_path):
    path = write(write_bag, tmp_path / "few.bag", drive("/odom"), list(drive("/odom", late_ns=5 * SECOND_NS))[:3])
    totals = run_totals(read_run([path]))
    assert (totals.robots[0].distance_m, totals.duration_s) == (pytest.approx(10.0), 10.0)


def test_clock_that_is_an_hour_behind_is_reported(write_bag, drive, tmp_path):
    path = write(write_bag, tmp_path / "clock.bag", drive("/r1/odom"), drive("/r2/odom", stamp_ns=-3600 * SECOND_NS))
    assert run_totals(read_run([path])).notes == (
        "/r2/odom: its clock is 3600.0 s behind that of /r1/odom, by the times of recording",
    )


def test_simulated_time_is_no_other_clock(write_bag, drive, tmp_path):
    """At twice the real time, the stamps of a robot that comes late are recorded with another difference."""
    first = list(drive("/r1/odom", stamp_ns=SECOND_NS - START_NS))
    second = [(topic, kind, at_ns + 60 * SECOND_NS, message) for topic, kind, at_ns, message in first]
    path = write(write_bag, tmp_path / "sim.bag", first, [("/r2/odom", *rest) for _, *rest in second])
    assert run_totals(read_run([path])).notes == ()


def test_poses_that_may_be_of_more_robots_are_named(drive, write_bag, tmp_path):
    samples = [*drive("/robot1/odom"), *drive("/robot2/odometry/filtered")]
    path = write(write_bag, tmp_path / "mixed.bag", samples)
    run = read_run([path])
    assert list(driven_m(run)) == ["robot1"]
    expected = "/robot2/odometry/filtered: not read, perhaps of more robots; --odometry chooses the topics"
    assert run_totals(run).notes == (expected,)
    both = read_run([path], ["/robot1/odom", "/robot2/odometry/filtered"])
    assert list(driven_m(both)) == ["robot1", "robot2"]
    assert run_totals(both).notes == ()


def test_topic_that_is_chosen_twice_is_one_robot(drive, write_bag, tmp_path):
    path = write(write_bag, tmp_path / "one.bag", drive("/robot1/odom"))
    assert driven_m(read_run([path], ["/robot1/odom"] * 2)) == {"robot1": 10.0}


def test_transforms_without_a_stamp_have_the_times_of_recording(write_bag, tmp_path):
    samples = [("/tf", TF, time_ns(step), transform("odom", "base_link", 0, 0.1 * step, 0.0)) for step in STEPS]
    totals = run_totals(read_run([write(write_bag, tmp_path / "tf.bag", samples)]))
    assert totals.duration_s == pytest.approx(10.0)
    assert totals.robots[0].mean_speed_mps == pytest.approx(1.0)


def test_robot_without_a_namespace_next_to_one_named_robot_has_the_name_of_its_topic(write_bag, drive, tmp_path):
    path = write(write_bag, tmp_path / "two.bag", drive("/odom"), drive("/robot/odom"))
    assert [robot.name for robot in read_run([path]).robots] == ["/odom", "robot"]


def test_header_with_the_stamp_0_is_named_instead_of_a_second_run(write_bag, odometry, tmp_path):
    """Stamps of a wall clock, recorded by a simulated one: without a stamp, a message counts at 0.1 s."""
    stamps_ns = [0 if i == 3 else time_ns(i) for i in range(6)]
    samples = [("/odom", ODOMETRY, 10**8, odometry(stamp_ns, 0.1, 0.0)) for stamp_ns in stamps_ns]
    path = write_bag(tmp_path / "zero.bag", samples)
    with pytest.raises(RecordingError) as refused:
        read_run([path])
    why = "a header has the stamp 0, and with the time of recording instead, time goes back from 1700000000.2 to 0.1 s"
    assert str(refused.value) == f"{path}: /odom: {why}"


def test_jump_of_motion_capture_is_no_reset_of_an_odometry(write_bag, tmp_path):
    samples = poses("/vrpn/pose")
    for _, _, _, message in samples[50:]:
        message["pose"]["position"]["x"] += 9.0
    (note,) = run_totals(read_run([write_bag(tmp_path / "mocap.bag", samples)])).notes
    assert note == (
        "vrpn: 1 jump faster than 20 m/s, the first of 9.1 m at 5.0 s: breaks in its recorded poses, not driven"
    )


TWICE = "map to odom jumps back and forth, the last time by 13.0 m, as if two robots sent it"


@pytest.mark.parametrize(
    ("second_ns", "burst", "kind"),
    [(0, 1, "tf"), (5 * 10**7, 1, "tf"), (5 * 10**7, 4, "tf"), (0, 101, "tf_static")],
    ids=["equal stamps", "in turn", "in bursts", "static"],
)
def test_two_robots_that_place_one_frame_are_reported(write_bag, drive, tmp_path, second_ns, burst, kind):
    """Both call their frame odom: one started at (1, 2), the other at (13, 7), which is 13 m away, and both drift."""
    sent = []
    for i in STEPS:
        for x_m, y_m, late_ns in ((1.0, 2.0, 0), (13.0, 7.0, second_ns)):
            if burst in (1, 101) or (i // burst % 2) == (x_m > 2.0):
                at_ns = time_ns(i) + late_ns
                message = transform("map", "odom", at_ns, x_m + 0.001 * i, y_m)
                sent += [(f"/{kind}", TF, at_ns, message)] if i == 0 or kind == "tf" else []
    run = read_run([write(write_bag, tmp_path / "two.bag", drive("/r1/odom"), drive("/r2/odom"), sent)])
    (note,) = run.notes
    advice = "paths in map are wrong; expected a frame per robot, such as robot_0/odom"
    assert note == f"/tf: {TWICE}: {advice}"


def test_localization_that_finds_its_place_is_one_robot(write_bag, drive, tmp_path):
    """It is wrong by 13 m, finds its place, loses it once and finds it again; each robot has a tf of its own."""
    wrong = {*range(20), *range(50, 55)}
    sent = [
        (topic, TF, time_ns(i), transform("map", "odom", time_ns(i), x_m + 12.0 * (i in wrong), 5.0 * (i in wrong)))
        for i in STEPS
        for topic, x_m in (("/r1/tf", 0.0), ("/r2/tf", 50.0))
    ]
    run = read_run([write(write_bag, tmp_path / "lost.bag", drive("/r1/odom"), drive("/r2/odom"), sent)])
    assert run.notes == ()


def test_robots_without_a_place_on_the_map_are_named(write_bag, drive, tmp_path):
    placed_r2 = placed("/r2/tf", "odom", 1.0, 1.0)
    path = write(write_bag, tmp_path / "r.bag", drive("/r1/odom"), drive("/r2/odom"), placed_r2)
    assert "paths on the floor plan: no transform on /tf from map to odom of r1" in run_totals(read_run([path])).omitted
