"""Anybody can publish anything: what is not finite, or of another number of robots, is not read."""

from __future__ import annotations

import math
import re
from types import SimpleNamespace

import pytest
from geometry_msgs.msg import Point
from nav_msgs.msg import MapMetaData, OccupancyGrid, Odometry
from robotteamsim.msg import (
    Area,
    Areas,
    Contact,
    ControllerStatus,
    Discovery,
    Door,
    Doors,
    FloatMap,
    MissionStatus,
    NetworkLinks,
    NetworkMessage,
    NetworkMessages,
    NetworkState,
    Robots,
    TeamState,
    TeamVoices,
    Victim,
    Victims,
    Voice,
)
from sensor_msgs.msg import Illuminance, LaserScan, NavSatFix, Range
from visualization_msgs.msg import Marker, MarkerArray

from robotteamsim.ros.nodes.requests import check_door, check_noise, check_victim
from robotteamsim.ros.transport.checks import outbox_reader, reader
from robotteamsim.ros.transport.msg_conversion import read_odometry, team_voices
from robotteamsim.ros.transport.serialization import serialized
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import VoiceReading

SETTINGS = SimpleNamespace(num_robots=2, scenario=load("garage_sar", ["robots.count=2"]))
DOORS = [Door(name=door.name, motion="still") for door in SETTINGS.scenario.plan.doors]
NETWORK = {
    "num_robots": 2,
    **{name: [0.0, -math.inf, -60.0, 0.0] for name in ("rssi_dbm", "link", "break_matrix")},
    **dict.fromkeys(("adjacency", "endangered"), bytes(4)),
    "hop_count": [0, 1, 1, 0],
}
LINKS = {"num_robots": 2, "present": bytes(2), "adjacency": bytes(2), "endangered": bytes(2)}
TEAM = {"poses": [3.0, 4.0, 0.0, 1.0, *4 * [math.nan]], "twists": [0.0] * 6, "in_contact": bytes(2)}
VOICES = {"level_db": [5.0, 0.0], "heard": b"\1\0", "local_best": [3.0, 4.0, math.nan, math.nan]}
VOICES["local_best_level_db"] = [6.0, 0.0]
ODD = [math.nan, math.inf, -math.inf, 1e300]


@pytest.mark.parametrize(
    "message",
    [
        Robots(present=bytes([1, 0]), arrivals=[1, 0]),
        NetworkState(**NETWORK),
        NetworkLinks(**LINKS, weakened_first=[0], weakened_second=[1], weakened_rssi_dbm=[-math.inf]),
        NetworkMessages(messages=[NetworkMessage(sender=1, receiver=-1), NetworkMessage(sender=0, receiver=1)]),
        Doors(doors=DOORS),
        Voice(),
        MissionStatus(has_area=True),
        ControllerStatus(has_goal=True),
        Range(range=math.inf),
        LaserScan(ranges=[math.inf, 1.0]),
        NavSatFix(latitude=-90.0),
        Illuminance(illuminance=0.0),
        Contact(angles_rad=[1.0]),
        FloatMap(resolution_m=0.25, width=2, height=1, data=[10.0, 0.0]),
        OccupancyGrid(info=MapMetaData(resolution=0.5, width=2, height=1), data=[100, -1]),
        Areas(areas=[Area(name="a", radius_m=1.0)]),
        Victims(victims=[Victim(name="ann", state="heard")]),
    ],
    ids=lambda message: message._type.split("/")[1],
)
def test_message_that_fits_the_scenario_is_read(message):
    assert reader(type(message), SETTINGS)(serialized(message)) == message


@pytest.mark.parametrize(
    ("message", "line"),
    [
        (Robots(present=[1], arrivals=[1, 1]), "present: 1 entries; expected 2"),
        (Robots(present=[1, 1], arrivals=[]), "arrivals: 0 entries; expected 2"),
        (Robots(present=[1, 1], arrivals=[1, 1], loads=["crate"]), "loads: 1 entries; expected 2"),
        (Robots(present=[1, 1], arrivals=[1, 1], failed_by_heat=[1]), "failed_by_heat: 1 entries; expected 2"),
        (TeamState(**TEAM | {"twists": [0.0]}), "twists: 1 entries; expected 6"),
        (TeamState(**TEAM | {"poses": [1e7, *7 * [0.0]]}), "robot 0: expected finite numbers within 1000 km"),
        (TeamState(**TEAM | {"twists": [math.inf, *5 * [0.0]]}), "robot 0: expected finite numbers within 1000 km"),
        (TeamVoices(**VOICES | {"heard": b"\0"}), "heard: 1 entries; expected 2"),
        (TeamVoices(**VOICES | {"level_db": [math.inf, 0.0]}), "level_db: inf; expected 0 to 1e+06"),
        (TeamVoices(**VOICES | {"level_db": [5.0, -5.0]}), "level_db: -5; expected 0 to 1e+06"),
        (TeamVoices(**VOICES | {"local_best_level_db": [1e300, 0.0]}), "local_best_level_db: 1e+300; expected 0 to"),
        (TeamVoices(**VOICES | {"heard": b"\1\1"}), "robot 1: local_best: (nan, nan); expected finite numbers within"),
        (NetworkState(num_robots=3), "num_robots: 3; expected 2"),
        (NetworkState(**NETWORK | {"hop_count": [0]}), "hop_count: 1 entries; expected 4"),
        (NetworkState(**NETWORK, refused_senders=[1]), "refused_bytes: 0 entries; expected 1"),
        (NetworkLinks(num_robots=1000), "num_robots: 1000; expected 2"),
        (NetworkLinks(**LINKS | {"endangered": bytes(3)}), "endangered: 3 entries; expected 2"),
        (NetworkLinks(**LINKS, weakened_first=[0]), "weakened_first: 1 entries; expected 0"),
        (
            NetworkLinks(**LINKS, weakened_first=[2], weakened_second=[1], weakened_rssi_dbm=[-81.0]),
            "weakened_first: 2; expected ids below 2",
        ),
        (NetworkMessages(messages=[NetworkMessage(sender=2)]), "a message from 2 to 0; expected ids below 2"),
        (NetworkMessages(messages=[NetworkMessage(receiver=-2)]), "a message from 0 to -2; expected ids below 2"),
        (Doors(doors=DOORS[1:]), "doors: the names differ from those of the plan"),
        (Doors(doors=[Door(name=door.name, motion="flies") for door in DOORS]), "motion: expected still, opens"),
        (Range(range=math.nan), "range: nan; expected a number"),
        (Doors(doors=[Door(name=door.name, opening=2.0) for door in DOORS]), "opening: 2; expected 0 to 1"),
        (Illuminance(illuminance=-1.0), "illuminance: -1; expected 0 to 1e+12"),
        (Illuminance(illuminance=math.inf), "illuminance: inf; expected 0 to 1e+12"),
        (NavSatFix(latitude=math.nan), "latitude: nan; expected -90 to 90"),
        (NavSatFix(position_covariance=[-1.0] + 8 * [0.0]), "position_covariance: -1; expected 0 to 1e+06"),
        (Contact(angles_rad=[math.inf]), "angles_rad: inf; expected finite numbers"),
        (LaserScan(angle_increment=math.nan), "angles: (0, nan); expected finite numbers"),
        (FloatMap(resolution_m=0.0), "resolution_m: 0; expected 0.01 to 1e+06"),
        (FloatMap(resolution_m=1.0, width=2, height=2, data=[1.0]), "data: 1 entries; expected 4"),
        (FloatMap(resolution_m=1.0, width=1, height=1, data=[math.nan]), "data: nan; expected -1e+06 to 1e+06"),
        (FloatMap(resolution_m=1.0), "data: 0 entries; expected at least one cell"),
        (OccupancyGrid(info=MapMetaData(resolution=0.5, width=2, height=2), data=[0]), "data: 1 entries; expected 4"),
        (OccupancyGrid(info=MapMetaData(resolution=0.5)), "data: 0 entries; expected at least one cell"),
        (OccupancyGrid(info=MapMetaData(width=1, height=1), data=[0]), "resolution: 0; expected 0.01 to 1e+06"),
        (Voice(level_db=-1e300), "level_db: -1e+300; expected 0 to 1e+06"),
        (Voice(local_best_level_db=math.nan), "local_best_level_db: nan; expected 0 to 1e+06"),
        (
            MarkerArray(markers=[Marker(points=[Point(x=1.0), Point(z=-1e308)])]),
            "points: (0, 0, -1e+308); expected finite numbers within 1000 km",
        ),
        (Areas(areas=[Area(radius_m=-1.0)]), "radius_m: -1; expected 0 to 1e+06"),
        (Areas(areas=[Area(), Area()]), "areas: expected unique names"),
        (Victims(victims=[Victim(state="saved")] * 2), "victims: expected unique names"),
        (
            Victims(victims=[Victim(state="lost")]),
            "state: expected one of waiting, heard, saved, located, reported, reached, carried, safe, collapsed, dead",
        ),
    ],
)
def test_message_that_does_not_fit_the_scenario_is_refused(message, line):
    with pytest.raises(ValueError, match=f"^{re.escape(line)}"):
        reader(type(message), SETTINGS)(serialized(message))


def test_pose_of_an_absent_robot_may_be_nan():
    message = reader(TeamState, SETTINGS)(serialized(TeamState(**TEAM)))
    assert message.poses[:4] == (3.0, 4.0, 0.0, 1.0)
    assert all(map(math.isnan, message.poses[4:]))


def test_voices_of_a_team_are_those_of_each_robot():
    heard = team_voices(reader(TeamVoices, SETTINGS)(serialized(TeamVoices(**VOICES))))
    assert heard[0] == VoiceReading(5.0, True, (3.0, 4.0), 6.0)
    assert not heard[1].heard


def test_robot_sends_messages_only_as_itself():
    mine, others = (serialized(NetworkMessages(messages=[NetworkMessage(sender=sender)])) for sender in (1, 0))
    read = outbox_reader(1, SETTINGS)
    assert read(mine).messages[0].sender == 1
    with pytest.raises(ValueError, match="a message from 0; expected only from 1"):
        read(others)


def test_message_of_a_run_with_another_team_and_plan_is_read_without_settings():
    for message in (Robots(present=[1], arrivals=[1]), NetworkState(**NETWORK), Doors(doors=[DOORS[0]])):
        assert reader(type(message))(serialized(message))._type == message._type
    with pytest.raises(ValueError, match="hop_count: 1 entries; expected 4"):
        reader(NetworkState)(serialized(NetworkState(**NETWORK | {"hop_count": [0]})))


@pytest.mark.parametrize("odd", ODD)
def test_place_that_is_nowhere_is_refused(odd):
    place = Point(x=odd)
    for message in (
        Voice(local_best=place),
        MissionStatus(area_center=place),
        MissionStatus(undelivered=[Discovery(position=place)]),
        ControllerStatus(has_goal=True, goal=place),
    ):
        with pytest.raises(ValueError, match="expected finite numbers within 1000 km"):
            reader(type(message), SETTINGS)(serialized(message))


@pytest.mark.parametrize("odd", ODD[:3])
def test_odometry_that_is_not_finite_is_refused(odd):
    for change in ("pose.pose.position.x", "pose.pose.orientation.w", "twist.twist.angular.z"):
        message = Odometry()
        *path, last = change.split(".")
        part = message
        for name in path:
            part = getattr(part, name)
        setattr(part, last, odd)
        with pytest.raises(ValueError, match="expected finite numbers"):
            read_odometry(serialized(message))


@pytest.mark.parametrize("odd", [math.nan, math.inf, -1.0])
def test_noise_out_of_range_is_rejected(odd):
    with pytest.raises(ValueError, match="noise_db"):
        check_noise(odd)
    check_noise(20.0)


def test_door_and_place_of_a_request_are_checked():
    scenario = SETTINGS.scenario
    with pytest.raises(ValueError, match="unknown door 'nowhere'"):
        check_door(scenario, "nowhere")
    check_door(scenario, scenario.plan.doors[0].name)
    with pytest.raises(ValueError, match=r"^set_victim: ann: position\.0: \.nan is not a finite number$"):
        check_victim(scenario, "ann", (math.nan, 1.0))
    with pytest.raises(ValueError, match=r"^set_victim: ann: position: \[100000, 1\] lies outside the plan, "):
        check_victim(scenario, "ann", (1e5, 1.0))
    check_victim(scenario, "ann", scenario.mission.victims[0].position)
