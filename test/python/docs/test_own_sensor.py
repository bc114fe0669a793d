"""A sensor in a user's own package, as docs/own_sensor.md has it: in files, bags and checks, without a change here."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from own_package import SENSORS, TYPE, block, install, python

from robotteamsim.geometry import Pose
from robotteamsim.recording.bag_reader import BagReader

CHECK = """
from robotteamsim.testing import check_sensor
check_sensor({"kind": "neighbours", "name": "others"})
"""

SHOWN = """
import sys
from pathlib import Path
from robotteamsim.recording import BagWriter
from robotteamsim.recording.mcap_writer import McapWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.recorder import FrameRecorder
path, scenario = Path(sys.argv[1]), load("garage_sar", [sys.argv[2], "mission.time_limit_s=4"])
simulation = Simulation(scenario)
live = FrameRecorder(simulation.setup)
simulation.run([live, (McapWriter if path.suffix == ".mcap" else BagWriter)(path)])
for recording in (live.recording, recording_of(read_run([path]), scenario)):
    shown = [frame.sensors for frame in recording.frames if frame.sensors]
    print(len(shown), list(shown[-1]) if shown else [])
"""


class Installed:
    """A folder with the package."""

    def __init__(self, folder: Path, *args: str) -> None:
        self.folder, self.environment = folder, install(folder, *args)

    def python(self, *words: str) -> subprocess.CompletedProcess[str]:
        return python(self.folder, self.environment, *words)

    def run(self, *words: str) -> subprocess.CompletedProcess[str]:
        return self.python("-m", "robotteamsim", "run", "garage_sar", "--set", "mission.time_limit_s=3", *words)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mission.bag", "mission.mcap"])
def test_sensor_of_a_package_is_in_bags_and_files_where_the_robots_are(tmp_path, name):
    done = Installed(tmp_path).run("--set", SENSORS, f"--{name.partition('.')[2]}", name)
    assert (done.returncode, done.stderr) == (0, "")
    poses, measured = {}, {}
    with BagReader([tmp_path / name]) as bag:
        assert bag.topics["/robot_1/others"] == TYPE
        topics = {f"/robot_{i}/{topic}" for i in range(3) for topic in ("others", "base_pose_ground_truth")}
        for topic, stamp_ns, message in bag.messages(topics):
            robot_id, kind = int(topic[7]), topic.rpartition("/")[2]
            if kind == "others":
                measured[robot_id, stamp_ns] = [(pose.position.x, pose.position.y) for pose in message.poses]
                assert message.header.frame_id == f"robot_{robot_id}/others_link"
            else:
                place, turn = message.pose.pose.position, message.pose.pose.orientation
                poses[robot_id, stamp_ns] = Pose(place.x, place.y, 2.0 * np.arctan2(turn.z, turn.w))
    assert len(measured) == 3 * 31
    for (robot_id, stamp_ns), places in measured.items():
        own = poses[robot_id, stamp_ns]
        others = [poses[i, stamp_ns] for i in range(3) if i != robot_id]
        expected = [[own.inverse() @ Pose(other.x_m, other.y_m, 0.0)] for other in others]
        np.testing.assert_allclose(places, [(at.x_m, at.y_m) for (at,) in expected], atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mission.bag", "mission.mcap"])
def test_sensor_of_a_package_is_in_the_viewer_live_and_from_files(tmp_path, name):
    done = Installed(tmp_path).python("-c", SHOWN, name, SENSORS)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines() == 2 * [f"5 {3 * [{'others': '2 robots within 100 m'}]}"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        ("ValueError('x')", 0, ""),
        ("KeyError('x')", 1, "robot 0, sensor others (kind neighbours): KeyError: 'x' (neigh"),
    ],
)
def test_impossible_reading_is_not_shown_and_any_other_error_names_the_sensor(tmp_path, error, status, line):
    wrong = block("python").replace(
        "return tuple((pose.position.x", f"raise {error}\n        return tuple((pose.position.x"
    )
    done = Installed(tmp_path, wrong).python("-c", SHOWN, "mission.bag", SENSORS)
    assert done.returncode == status
    assert line in done.stderr
    assert done.stdout.splitlines()[1:] == (["0 []"] if status == 0 else [])


@pytest.mark.slow
def test_sensor_of_a_package_passes_the_check(tmp_path):
    done = Installed(tmp_path).python("-c", CHECK)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("generator.normal(0.0, self.noise_m, 2)", "np.random.rand(2)", "another reading with the same seed"),
        ("(pose.position.x, pose.position.y)", "(pose.position.y, pose.position.x)", "is another reading than that"),
        ('{"x": x_m, "y": y_m}', '{"x": round(x_m, 7), "y": y_m}', "is another reading than that"),
        ("return tuple((pose.position.x", "return list((pose.position.x", "and in its type: \\["),
        (
            "world, found = carrier.world, []",
            "world, found = carrier.world, []; world.set_pose(0, world.poses()[0] @ Pose(0.0, 0.0, 0.1))",
            "elsewhere",
        ),
    ],
)
def test_check_finds_a_mistake(tmp_path, old, new, line):
    assert old in block("python")
    done = Installed(tmp_path, block("python").replace(old, new)).python("-c", CHECK)
    assert done.returncode == 1
    assert re.search(rf"AssertionError: others, step \d+: .*{line}", done.stderr), done.stderr


@pytest.mark.slow
def test_type_of_a_sensors_own_is_read_from_the_bag(tmp_path):
    own = block("python").replace(
        '"geometry_msgs/PoseArray"', '"my_msgs/Places"\n    definitions = {"my_msgs/Places": TEXT}'
    )
    own = own.replace(
        "class Neighbours", 'TEXT = "std_msgs/Header header\\ngeometry_msgs/Pose[] poses\\n"\n\n\nclass Neighbours'
    )
    done = Installed(tmp_path, own).run("--set", SENSORS, "--bag", "mission.bag")
    assert (done.returncode, done.stderr) == (0, "")
    with BagReader([tmp_path / "mission.bag"]) as bag:
        assert bag.topics["/robot_1/others"] == "my_msgs/Places"
        assert sum(len(message.poses) for _, _, message in bag.messages({"/robot_1/others"})) == 2 * 31


@pytest.mark.slow
@pytest.mark.parametrize(
    ("entry", "line"),
    [
        (
            "neighbours = nowhere:Neighbours",
            "robotteamsim: warning: sensor neighbours of nowhere:Neighbours: ModuleN",
        ),
        ("neighbours = neighbours:np", "sensor neighbours of neighbours:np: TypeError: expected a class below "),
        ("radio = neighbours:Neighbours", "its key kind has the default 'neighbours'; expected 'radio'"),
        ("sonar = neighbours:Neighbours", "there is another sensor of this name"),
    ],
)
def test_package_that_cannot_be_used_is_named_and_all_else_goes_on(tmp_path, entry, line):
    installed = Installed(tmp_path, "", entry)
    done = installed.run()
    assert done.returncode == 0
    (warned,) = done.stderr.splitlines()
    assert line in warned
    done = installed.run("--set", SENSORS)
    assert done.returncode == 2
    assert "robots.sensors.0" in done.stderr


SENSOR = "robot 0, sensor others (kind neighbours): "
PLAIN = 'return {"header": self.header(time_ns, robot_id), "poses": poses}'
OWN = 'type_name: ClassVar[str] = "a/B"\n    definitions = {{"a/B": "{}"}}'
TYPE_LINE = 'type_name: ClassVar[str] = "geometry_msgs/PoseArray"'


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (PLAIN, "return {'pose': poses}", "/robot_0/others: geometry_msgs/PoseArray has no attribute 'pose'"),
        (PLAIN, "return poses", SENSOR + "TypeError: a message is [{"),
        (PLAIN, "return 1 / 0", SENSOR + "ZeroDivisionError: division by zero (neigh"),
        (
            "return tuple(found)",
            "raise SystemExit(3)",
            SENSOR + "SystemExit: 3 (neigh",
        ),
        (TYPE_LINE, 'type_name: ClassVar[str] = "no_msgs/Thing"', "no_msgs/Thing: no definition found; "),
        (
            TYPE_LINE,
            OWN.format("%%"),
            "sensors of kind neighbours: the ",
        ),
        (
            TYPE_LINE,
            OWN.format("a/B[] x"),
            "a/B: its definition cannot",
        ),
    ],
)
def test_mistake_in_a_sensor_is_one_line_that_names_it(tmp_path, old, new, line):
    assert old in block("python")
    done = Installed(tmp_path, block("python").replace(old, new)).run("--set", SENSORS, "--bag", "mission.bag")
    assert (done.returncode, done.stdout) == (2, "")
    (said,) = done.stderr.splitlines()
    assert line in said
    assert not (tmp_path / "mission.bag").exists()
