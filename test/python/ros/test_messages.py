"""What arrives on topics: values keep their bits, and what is wrong is refused in one line."""

from __future__ import annotations

import math
import re
from io import BytesIO
from typing import Any

import genpy
import numpy as np
import pytest
from geometry_msgs.msg import Point, Vector3
from geometry_msgs.msg import Twist as TwistMessage
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Odometry
from robotteamsim.msg import Area as AreaMessage
from robotteamsim.msg import (
    Areas,
    Assistance,
    Contact,
    ControllerStatus,
    Door,
    Doors,
    FloatMap,
    Heat,
    MissionEvent,
    MissionStatus,
    NetworkLinks,
    NetworkMessage,
    NetworkMessages,
    NetworkState,
    People,
    Person,
    Robots,
    Victims,
    Voice,
)
from robotteamsim.msg import Egress as EgressMessage
from robotteamsim.msg import PersonEgress as PersonEgressMessage
from robotteamsim.msg import Victim as VictimMessage
from sensor_msgs.msg import Illuminance, LaserScan, NavSatFix, Range

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import Decision, Discovery, SwarmContext, Task
from robotteamsim.message_parts import header, stamp_ns
from robotteamsim.mission.egress import Egress, ExitEgress, PersonEgress
from robotteamsim.mission.events import Event, MissionPaused
from robotteamsim.mission.status import DeliveredDiscoveries
from robotteamsim.mission.status import MissionStatus as Status
from robotteamsim.network.compact import LinksEncoder
from robotteamsim.network.messages import Message
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.bag_types import message_type
from robotteamsim.recording.topics import base, decisions, mission, radio, robots, world
from robotteamsim.ros.messages import message_class
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.sections import Area, Laser, Victim
from robotteamsim.scenario.sensors import Gps, HeatSensor, LightSensor, Sonar
from robotteamsim.sensing.readings import OdometryReading, VoiceReading
from robotteamsim.simulation import Simulation
from robotteamsim.world.doors import DoorState, DoorStates
from robotteamsim.world.people import PersonState

TIME_NS = 12_300_000_000
# Numbers without a short binary form: equal only when every bit has come through.
PLACE = PoseReading(0.1 + 0.2, -1.0 / 3.0, 0.6000000000000001, 0.7999999999999999)
MOTION = Twist(0.1, -0.2, 1.0 / 7.0)
RANGES_M = np.array([0.1, 5.0, np.inf], dtype=np.float32)
BELIEVED = OdometryReading(
    PLACE, MOTION, tuple((np.arange(1.0, 7.0) / 7.0).tolist()), (0.1 + 0.2, 0.2 / 3.0, 1.0 / 3.0)
)
ODD = [math.nan, math.inf, -math.inf]
GPS = Gps(datum_lat_deg=0.0, datum_lon_deg=0.0)


def serialized(message: genpy.Message) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def sent(type_name: str, message: Any) -> Any:
    """Return a message as a node of this package gets it; one of rospy gets the same."""
    of_type = message_type(type_name)
    data = of_type.encode(message)
    assert serialized(message_class(type_name)().deserialize(data)) == data
    return of_type.decode(data)


def test_stamps_are_whole_nanoseconds():
    message = sent("std_msgs/Header", header(1_000_000_001, "map"))
    assert message.stamp == 1_000_000_001
    assert stamp_ns(sent("robotteamsim/Contact", robots.contact(2**31 * 10**9 - 1, 0, True))) == 2**31 * 10**9 - 1


def test_odometry_keeps_its_bits():
    message = sent("nav_msgs/Odometry", robots.odometry(TIME_NS, 1, BELIEVED))
    assert robots.read_odometry(message) == BELIEVED
    assert (message.header.frame_id, message.child_frame_id) == ("robot_1/odom", "robot_1/base_footprint")


def test_contact_keeps_its_angles():
    message = sent("robotteamsim/Contact", robots.contact(TIME_NS, 1, True, (-0.1, 1.0 / 3.0)))
    assert (message.in_contact, message.angles_rad.tolist()) == (True, [-0.1, 1.0 / 3.0])
    assert sent("robotteamsim/Contact", robots.contact(TIME_NS, 1, False)).angles_rad.tolist() == []


def test_command_keeps_its_bits_and_is_finite():
    assert base.read_twist(sent("geometry_msgs/Twist", base.twist(MOTION))) == MOTION
    stamped = sent("geometry_msgs/TwistStamped", decisions.twist_stamped(TIME_NS, 2, MOTION))
    assert base.read_twist(stamped.twist) == MOTION
    for odd in ODD:
        with pytest.raises(ValueError, match="a command that is not finite"):
            base.read_twist(TwistMessage(linear=Vector3(x=odd)))


def test_scan_keeps_its_bits_and_has_the_beams_of_the_laser():
    scan = sent("sensor_msgs/LaserScan", robots.scan(TIME_NS, 0, Laser(beams=3), RANGES_M))
    ranges_m = robots.read_ranges_m(scan, beams=3)
    assert ranges_m.dtype == np.float32
    np.testing.assert_array_equal(ranges_m, RANGES_M)
    with pytest.raises(ValueError, match="ranges: 3 entries; expected 5, the beams of the scenario's laser"):
        robots.read_ranges_m(scan, beams=5)


def test_header_of_a_scan_means_as_many_beams_as_it_has():
    for beams in (1, 2, 181):
        scan = sent("sensor_msgs/LaserScan", robots.scan(TIME_NS, 0, Laser(beams=beams), np.zeros(beams, np.float32)))
        # As Karto counts them: slam_toolbox at a3442d2, Karto.h, LaserRangeFinder::Update.
        assert round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1 == beams
        assert scan.angle_min == np.float32(-0.5 * math.pi)


@pytest.mark.parametrize("kind", [Odometry, LaserScan, TwistMessage, Voice, Contact, Robots, NetworkMessages])
def test_bytes_that_are_too_few_are_rejected(kind):
    data = serialized(kind())
    for length in (0, 3, len(data) - 1):
        with pytest.raises(ValueError, match=f"^not a {kind._type}: "):
            message_type(kind._type).decode(data[:length])


def test_message_that_promises_more_numbers_than_it_has_is_rejected():
    data = serialized(LaserScan())
    with pytest.raises(ValueError, match=r"^not a sensor_msgs/LaserScan: "):
        message_type("sensor_msgs/LaserScan").decode(data[:-8] + b"\xff\xff\xff\xff" + data[-4:])


@pytest.mark.parametrize(
    "reading", [VoiceReading(12.5, True, (1.25, 1.0 / 3.0), 0.1), VoiceReading(0.0, False, (0, 0), 0)]
)
def test_voice_keeps_its_bits(reading):
    assert radio.read_voice(sent("robotteamsim/Voice", radio.voice(TIME_NS, reading))) == reading


def test_messages_keep_order_and_text():
    sent_messages = [Message(0, -1, '{"a": 0.1}'), Message(2, 1, "ü"), Message(1, 0, "")]
    received = sent("robotteamsim/NetworkMessages", radio.network_messages(TIME_NS, sent_messages))
    assert radio.read_network_messages(received, num_robots=3) == sent_messages


@pytest.mark.parametrize("goal_m", [(1.0, 2.0), None])
def test_decision_keeps_all_but_command_and_outbox(goal_m):
    decision = Decision(MOTION, (Message(0, 1, ""),), True, goal_m, 0.1, 7, local_best_m=goal_m, area=2)
    message = sent("robotteamsim/ControllerStatus", decisions.controller_status(TIME_NS, 3, decision))
    assert decisions.read_decision(message) == Decision(Twist(), (), True, goal_m, 0.1, 7, local_best_m=goal_m, area=2)
    assert message.robot_id == 3
    adapted = Decision(context=SwarmContext(*(0.1 * i for i in range(10))))
    message = sent("robotteamsim/ControllerStatus", decisions.controller_status(TIME_NS, 3, adapted))
    assert decisions.read_decision(message) == adapted
    assert message.context[0].c4 == adapted.context.c4


@pytest.mark.parametrize("task", [Task(True, 4, (18.0, 0.1), 2.0), Task(), Task(explored_by=(-1, 2))])
def test_mission_status_keeps_its_task(task):
    status = Status("running", "", 0.1 + 0.2, (True, False), ("waiting", "saved"), 1, 5, task)
    message = sent("robotteamsim/MissionStatus", mission.mission_status(TIME_NS, "garage", status, 10.0))
    assert mission.read_task(message, 3) == task


def test_mission_status_keeps_delivered_and_undelivered_discoveries():
    finds = (Discovery("victim", "ann", 1, (9.0, 0.1 + 0.2), 1.0 / 3.0), Discovery("area", "east", 0, (16.0, 5.0), 7.0))
    delivered = DeliveredDiscoveries(2, 0.1 + 0.2, 1.0 / 3.0)
    status = Status("running", "", 8.0, (True,), ("saved",), -1, 0, Task(undelivered=finds), delivered)
    message = sent("robotteamsim/MissionStatus", mission.mission_status(TIME_NS, "hall", status, 10.0))
    assert mission.read_task(message, 3).undelivered == finds
    assert message.discoveries_delivered == 2
    assert (message.mean_delivery_delay_s, message.max_delivery_delay_s) == (0.1 + 0.2, 1.0 / 3.0)


def test_maps_keep_their_bits():
    field = FieldMap((0.5, 1.0), 0.25, np.array([[0.0, 12.4], [math.nan, 130.0]], dtype=np.float32))
    values = base.read_field_map(sent("robotteamsim/FloatMap", base.field_map(TIME_NS, field, "voice_level", "dB")))
    grid = OccupancyGrid((0.0, -2.0), 0.5, np.array([[0, 100, -1]], dtype=np.int8))
    cells = base.read_occupancy_grid(sent("nav_msgs/OccupancyGrid", base.occupancy_grid(TIME_NS, grid)))
    assert (values.origin_m, values.resolution_m) == (field.origin_m, field.resolution_m)
    assert (cells.origin_m, cells.resolution_m) == (grid.origin_m, grid.resolution_m)
    np.testing.assert_array_equal(values.values, field.values)
    np.testing.assert_array_equal(cells.cells, grid.cells)
    loud = FieldMap((0.5, 1.0), 0.25, np.array([[12.4, 99.6, 130.0]]))
    picture = base.read_occupancy_grid(sent("nav_msgs/OccupancyGrid", base.field_map_picture(TIME_NS, loud)))
    assert picture.cells.tolist() == [[12, 100, 100]]


def test_mission_keeps_its_bits():
    status = Status("ended", "aborted", 1.0 / 3.0, (False, True), ("heard", "saved"), 1, 3, Task())
    read = mission.read_status(sent("robotteamsim/MissionStatus", mission.mission_status(TIME_NS, "hall", status, 7.5)))
    assert read == mission.PublishedStatus(
        1.0 / 3.0, "hall", "ended", "aborted", (False, True), ("heard", "saved"), 3, 7.5, None, 1
    )
    event = mission.mission_event(TIME_NS, Event(1.0, MissionPaused(), "over"))
    event = mission.read_event(sent("robotteamsim/MissionEvent", event))
    assert event == mission.PublishedEvent(1.0, "pause", "", -1, "over")
    victims = mission.victims(TIME_NS, [Victim(name="a", position=(0.1, 2.0))], ["heard"])
    victims = mission.read_victims(sent("robotteamsim/Victims", victims))
    assert victims == (mission.PublishedVictim("a", (0.1, 2.0), "heard"),)
    areas = mission.areas(TIME_NS, [Area(name=name, center=(0.1, 2.0), radius_m=1.5) for name in "bc"], status)
    first, second = mission.read_areas(sent("robotteamsim/Areas", areas))
    assert first == mission.PublishedArea("b", (0.1, 2.0), 1.5, explored=False, is_target=False)
    assert second == mission.PublishedArea("c", (0.1, 2.0), 1.5, explored=True, is_target=True)
    egress = Egress(3.5, (PersonEgress("ann", True, 0.1, 0.2, 3.0, 2.0, None, 7.5, "west"),), (ExitEgress("west"),))
    assert mission.read_egress(sent("robotteamsim/Egress", mission.egress(TIME_NS, egress))) == egress


def test_world_keeps_its_bits():
    states = DoorStates({"a": DoorState(True, 0.0), "b": DoorState(False, 0.3, "opens")})
    assert dict(world.read_doors(sent("robotteamsim/Doors", world.doors(TIME_NS, states)))) == dict(states)
    broken = Doors(doors=[Door(name="a", closed=True, opening=math.nan), Door(name="b", opening=1.2)])
    assert [state.opening for state in world.read_doors(broken).values()] == [0.0, 1.0]
    people = (PersonState("ann", (0.1, 2.0), "enclosed"),)
    assert world.read_people(sent("robotteamsim/People", world.people(TIME_NS, people))) == people
    presence = world.robots(TIME_NS, np.array([True, False]), (1, 2), roles=("robot", "firefighter"))
    presence = world.read_robots(sent("robotteamsim/Robots", presence))
    assert presence == world.TeamPresence((True, False), (1, 2), ("robot", "firefighter"))
    assert sent("rosgraph_msgs/Clock", world.clock(TIME_NS)).clock == TIME_NS
    assert sent("robotteamsim/Contact", robots.contact(TIME_NS, 0, True)).in_contact


def test_both_messages_of_a_network_have_the_same_links():
    network = Simulation(load("garage_sar", ["robots.count=4"])).step().network
    matrices = radio.read_network_state(sent("robotteamsim/NetworkState", radio.network_state(TIME_NS, network)))
    links = radio.network_links(TIME_NS, LinksEncoder().encode(network))
    links = radio.read_network_links(sent("robotteamsim/NetworkLinks", links))
    for read in (matrices, links):
        assert read.fiedler_value == network.fiedler_value
        for name in ("adjacency", "endangered", "hop_count"):
            np.testing.assert_array_equal(getattr(read, name), getattr(network, name))
    expected_dbm = np.rint(np.where(network.adjacency, network.rssi_dbm, 0.0))
    np.testing.assert_array_equal(matrices.signals_dbm, expected_dbm)


@pytest.mark.parametrize(
    ("decode", "message", "line"),
    [
        (robots.read_odometry, "Odometry", "position"),
        (
            lambda m: world.read_robots(m, 2),
            Robots(present=[1], arrivals=[1, 1]),
            "present: 1 entries; expected 2",
        ),
        (lambda m: world.read_robots(m, 2), Robots(present=[1, 1]), "arrivals: 0 entries; expected 2"),
        (robots.read_contact, Contact(angles_rad=[math.nan]), "angles_rad: nan; expected finite numbers"),
        (radio.read_voice, Voice(level_db=math.inf), "level_db: inf; expected 0 to 1e+06"),
        (radio.read_voice, Voice(local_best_level_db=-1.0), "local_best_level_db: -1; expected 0 to 1e+06"),
        (radio.read_voice, Voice(local_best=Point(x=math.nan)), "local_best: (nan, 0); expected finite numbers"),
        (Sonar(name="s").reading, Range(range=math.nan), "range: nan; expected a number"),
        (LightSensor(name="l").reading, Illuminance(illuminance=-1.0), "illuminance: -1; expected 0 to 1e+12"),
        (
            Gps(datum_lat_deg=0.0, datum_lon_deg=0.0).reading,
            NavSatFix(latitude=91.0),
            "latitude: 91; expected -90 to 90",
        ),
        (HeatSensor().reading, Heat(temperature_c=math.inf), "temperature_c: inf; expected -1e+06 to 1e+06"),
        (HeatSensor().reading, Heat(hot=[Point(x=1e7)]), "hot: 1e+07; expected -1e+06 to 1e+06"),
        (HeatSensor().reading, Heat(hot=[Point()]), "hot_c: 0 temperatures; expected 1, one for each place"),
        (world.read_robots, Robots(roles=[7]), "role 7; expected at most 2"),
        (world.read_people, People(people=[Person(position=Point(x=math.inf))]), "position: (inf, 0); expected finite"),
        (mission.read_status, MissionStatus(time_s=math.inf), "time inf; expected at most 1e+09"),
        (mission.read_event, MissionEvent(time_s=math.nan), "time nan; expected at most 1e+09"),
        (
            mission.read_victims,
            Victims(victims=[VictimMessage(position=Point(y=1e9))]),
            "position: (0, 1e+09); expected",
        ),
        (mission.read_areas, Areas(areas=[AreaMessage(radius_m=math.nan)]), "radius nan; expected at most 1e+06"),
        (
            mission.read_egress,
            EgressMessage(people=[PersonEgressMessage(gas=math.nan)]),
            "gas nan; expected at most 1e+09",
        ),
        (radio.read_network_links, NetworkLinks(num_robots=2), "rows of 0 bytes; expected 2"),
        (radio.read_network_state, NetworkState(num_robots=2), "a matrix of 0 values; expected 4"),
        (base.read_field_map, FloatMap(width=2, height=1, data=[1.0]), "map of 1 values; expected 2"),
        (
            base.read_field_map,
            FloatMap(width=1, height=1, resolution_m=1.0, data=[1e30]),
            "values up to 1e+30; expected at most 10000",
        ),
        (base.read_occupancy_grid, GridMessage(), "grid of 0 cells; expected 0"),
        (
            lambda m: mission.read_task(m, 2),
            MissionStatus(area_radius_m=math.nan),
            "area_radius_m: nan; expected 0 to 100 m",
        ),
        (
            lambda m: mission.read_task(m, 2),
            MissionStatus(area_radius_m=1e308),
            "area_radius_m: 1e+308; expected 0 to 100 m",
        ),
        (
            lambda m: mission.read_task(m, 2),
            MissionStatus(has_area=True, area_center=Point(y=math.inf)),
            "area_center: (0, inf); expected",
        ),
        (
            lambda m: mission.read_task(m, 2),
            MissionStatus(assistance=[Assistance(robot_id=2)]),
            "assistance: robot 2; expected the id of a firefighter",
        ),
        (
            decisions.read_decision,
            ControllerStatus(has_goal=True, goal=Point(x=math.nan)),
            "goal: (nan, 0); expected finite",
        ),
        (
            decisions.read_decision,
            ControllerStatus(has_local_best=True, local_best_place=Point(y=math.inf)),
            "local_best_place: (0, inf); expected finite",
        ),
        (
            lambda m: radio.read_network_messages(m, 2),
            NetworkMessages(messages=[NetworkMessage(sender=2)]),
            "a message from 2 to 0; expected ids below 2",
        ),
        (
            lambda m: radio.read_outbox(m, 1, 2),
            NetworkMessages(messages=[NetworkMessage(sender=0)]),
            "a message from 0; expected only from 1",
        ),
    ],
)
def test_impossible_numbers_are_rejected(decode, message, line):
    if message == "Odometry":
        message = Odometry()
        message.pose.pose.position.x = math.nan
    with pytest.raises(ValueError, match="^" + re.escape(line)):
        decode(message)


def test_sonar_and_scan_may_have_no_return():
    assert Sonar(name="s").reading(Range(range=math.inf)) == math.inf
    assert math.isnan(robots.read_ranges_m(LaserScan(ranges=[math.nan]), beams=1)[0])


def test_stamp_beyond_the_header_of_an_answer_is_rejected():
    message = sent("robotteamsim/Contact", {"header": header((2**32 - 1) * 10**9, "")})
    with pytest.raises(ValueError, match=r"^stamp: 4294967295 s; expected 0 to 4294967296 s$"):
        stamp_ns(message)
