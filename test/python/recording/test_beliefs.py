"""What robots believe, as it is in bags."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from robotteamsim.geometry import Pose
from robotteamsim.interface import Estimate, Localisation
from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.recording.bag import BagMessages
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.bag_types import message_type
from robotteamsim.recording.topics.base import read_occupancy_grid
from robotteamsim.recording.topics.beliefs import localisation, particle_cloud, read_localisation, read_particle_cloud
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Observer, Simulation

UNKNOWN_GARAGE = "garage_unknown", ["robots.count=2", "run.seed=3", "mission.time_limit_s=6"]


class Kept(Observer):
    """Keeps the decisions of robot 1 by time."""

    def __init__(self):
        self.decisions = {}

    def step(self, record):
        self.decisions[record.sim_time_ns] = record.decisions[1]


@pytest.fixture(scope="module", params=[BagWriter, McapWriter], ids=["ROS 1", "ROS 2"])
def recorded(request, tmp_path_factory):
    """Return the types of a bag's topics, their messages by stamp, and the decisions of robot 1."""
    path = tmp_path_factory.mktemp("bag") / ("run.bag" if request.param is BagWriter else "run.mcap")
    kept = Kept()
    Simulation(load(*UNKNOWN_GARAGE)).run([request.param(path), kept])
    with BagReader([path]) as bag:
        names = [f"/robot_1/{name}" for name in ("amcl_pose", "localisation", "map", "odom")]
        found = {name: {} for name in [*names, "/tf"]}
        for topic, stamp_ns, message in bag.messages(found):
            found[topic][stamp_ns] = message
        return bag.topics, found, kept.decisions


def test_bag_has_what_a_robot_believes_with_the_types_of_tools(recorded):
    types, _, _ = recorded
    assert types["/robot_1/amcl_pose"] == "geometry_msgs/PoseWithCovarianceStamped"
    assert types["/robot_1/localisation"] == "robotteamsim/Localisation"
    assert types["/robot_1/map"] == "nav_msgs/OccupancyGrid"


def test_bag_of_a_mission_with_true_poses_has_no_beliefs(tmp_path):
    Simulation(load("garage_sar", ["mission.time_limit_s=1"])).run([BagWriter(tmp_path / "run.bag")])
    with BagReader([tmp_path / "run.bag"]) as bag:
        assert not {f"/robot_0/{name}" for name in ("amcl_pose", "localisation", "map")} & set(bag.topics)


def test_pose_and_state_are_in_every_step_as_the_robot_believes_them(recorded):
    _, found, decisions = recorded
    poses, states = found["/robot_1/amcl_pose"], found["/robot_1/localisation"]
    assert poses.keys() == states.keys() == decisions.keys()
    for stamp_ns, decision in decisions.items():
        (expected,) = decision.localisation.estimates
        read = read_localisation(states[stamp_ns])
        assert read.state == "tracking"
        assert read.estimates[0].covariance == expected.covariance
        for pose in (poses[stamp_ns].pose.pose, states[stamp_ns].estimates[0].pose):
            assert (pose.position.x, pose.position.y) == (expected.pose.x_m, expected.pose.y_m)
            assert 2.0 * math.atan2(pose.orientation.z, pose.orientation.w) == pytest.approx(expected.pose.yaw_rad)
    assert np.array(poses[stamp_ns].pose.covariance)[[0, 7, 35]].min() > 0.0


def test_maps_are_those_that_the_robot_shows(recorded):
    _, found, decisions = recorded
    shown = {stamp_ns: decision.found for stamp_ns, decision in decisions.items() if decision.found is not None}
    assert shown.keys() == found["/robot_1/map"].keys()
    assert len(shown) == 2
    for stamp_ns, message in found["/robot_1/map"].items():
        read, expected = read_occupancy_grid(message), shown[stamp_ns]
        np.testing.assert_array_equal(read.cells, expected.cells)
        assert read.origin_m == expected.origin_m
        assert read.resolution_m == pytest.approx(expected.resolution_m)


def test_tf_leads_to_the_believed_pose(recorded):
    _, found, decisions = recorded
    for stamp_ns, message in found["/tf"].items():
        links = {link.child_frame_id: link for link in message.transforms}
        assert links["robot_1/odom"].header.frame_id == "map"
        x, turn = 0.0, 1.0
        for name in ("odom", "base_footprint"):
            transform = links[f"robot_1/{name}"].transform
            x += turn * complex(transform.translation.x, transform.translation.y)
            turn *= complex(transform.rotation.w, transform.rotation.z) ** 2
        believed = decisions[stamp_ns].localisation.pose
        assert abs(x - complex(believed.x_m, believed.y_m)) < 1e-9
        assert abs(cmath.phase(turn / cmath.exp(1j * believed.yaw_rad))) < 1e-9


def as_rows(poses):
    return np.array([(one.x_m, one.y_m, one.yaw_rad) for one in poses])


def test_cloud_of_particles_is_around_the_believed_pose_once_a_second(tmp_path):
    settings = ["robots.count=2", "control.localisation=laser", "mission.time_limit_s=8"]
    kept, clouds, poses = Kept(), {}, {}
    Simulation(load("garage_sar", settings)).run([BagWriter(tmp_path / "run.bag"), kept])
    with BagReader([tmp_path / "run.bag"]) as bag:
        assert bag.topics["/robot_1/particlecloud"] == "geometry_msgs/PoseArray"
        for topic, stamp_ns, message in bag.messages(["/robot_1/particlecloud", "/robot_1/amcl_pose"]):
            (poses if topic.endswith("amcl_pose") else clouds)[stamp_ns] = message
    assert min(np.diff(list(clouds))) >= 10**9
    assert len(clouds) >= 6
    for stamp_ns, cloud in clouds.items():
        assert cloud.header.frame_id == "map"
        read = as_rows(read_particle_cloud(cloud))
        np.testing.assert_allclose(read, as_rows(kept.decisions[stamp_ns].particles), atol=1e-12)
        places = read[:, :2]
        pose = poses[stamp_ns].pose
        # The mean of 100 particles is this uncertain, and that of those that have moved since the last scan.
        spread_m = math.sqrt(max(pose.covariance[0], pose.covariance[7]))
        assert len(places) == 100
        mean_m = math.dist(places.mean(axis=0), (pose.pose.position.x, pose.pose.position.y))
        assert mean_m < 0.3 * spread_m + 0.005
        turn_rad = 2.0 * math.atan2(pose.pose.orientation.z, pose.pose.orientation.w)
        assert abs(cmath.phase(np.exp(1j * (read[:, 2] - turn_rad)).mean())) < 0.01


@pytest.mark.parametrize(
    ("name", "settings", "is_there"),
    [
        ("garage_sar", ("control.localisation=laser",), True),
        ("garage_sar", ("control.localisation=odometry",), False),
        ("garage_sar", (), False),
        ("garage_unknown", (), False),
    ],
)
def test_cloud_is_a_topic_of_robots_that_localise_themselves_by_laser_in_a_known_building(name, settings, is_there):
    topics = {topic.name for topic in BagMessages(resolve(load(name, list(settings)))).topics()}
    assert ("/robot_0/particlecloud" in topics) == is_there


def test_particle_at_an_impossible_place_is_rejected():
    of_type = message_type("geometry_msgs/PoseArray")
    for particle, problem in (
        (Pose(math.nan, 2.0, 0.0), r"particle: \(nan, 2\); expected finite numbers within 1000 km"),
        (Pose(1.0, 2.0, math.nan), "particle: nan; expected finite numbers"),
    ):
        with pytest.raises(ValueError, match=problem):
            read_particle_cloud(of_type.decode(of_type.encode(particle_cloud(10**8, (particle,)))))


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"state": "unsure"}, "state 'unsure'; expected tracking, lost, ambiguous"),
        ({"estimates": []}, "no estimates; expected at least one"),
        ({"x": math.nan}, r"estimate: \(nan, 2\); expected finite numbers within 1000 km"),
        ({"x": 2e6}, r"estimate: \(2e\+06, 2\); expected finite numbers within 1000 km"),
        ({"xx": math.inf}, "estimate: inf; expected finite numbers"),
    ],
)
def test_impossible_message_is_rejected(change, problem):
    covariance = (change.get("xx", 0.1), 0.0, 0.0, 0.2, 0.0, 0.01)
    estimate = Estimate(Pose(change.get("x", 1.0), 2.0, 0.5), covariance)
    values = localisation(10**8, 0, Localisation("ambiguous", (estimate,)))
    values |= {key: value for key, value in change.items() if key in values}
    of_type = message_type("robotteamsim/Localisation")
    with pytest.raises(ValueError, match=problem):
        read_localisation(of_type.decode(of_type.encode(values)))
