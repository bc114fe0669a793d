from __future__ import annotations

import math

import genpy
import msgspec
import numpy as np
import pytest
from geometry_msgs.msg import Point, Quaternion, TwistStamped, Vector3
from geometry_msgs.msg import Twist as TwistMessage
from nav_msgs.msg import Odometry
from robotteamsim.msg import Contact, Voice
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import Decision, Discovery, SwarmContext, Task
from robotteamsim.mission.status import DeliveredDiscoveries, Event, MissionStatus
from robotteamsim.network.compact import CompactLinks, LinksEncoder
from robotteamsim.network.messages import Message, NetworkState, Refusal, Traffic
from robotteamsim.propagation import FieldMap
from robotteamsim.recording import network_messages, ros_messages
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.serialization import deserialized, serialized
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.sections import Area, Laser, Robot, Victim
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading

TIME_NS = 12_300_000_000
# Numbers without a short binary form: equal only when every bit has come through.
PLACE = PoseReading(0.1 + 0.2, -1.0 / 3.0, 0.6000000000000001, 0.7999999999999999)
MOTION = Twist(0.1, -0.2, 1.0 / 7.0)
RANGES_M = np.array([0.1, 5.0, np.inf], dtype=np.float32)
BELIEVED = OdometryReading(
    PLACE, MOTION, tuple((np.arange(1.0, 7.0) / 7.0).tolist()), (0.1 + 0.2, 0.2 / 3.0, 1.0 / 3.0)
)
READING = RobotReading.of(PLACE, MOTION, BELIEVED, RANGES_M, True)


@pytest.fixture
def make() -> conversion.RosTypes:
    return conversion.RosTypes()


def sent(message: genpy.Message) -> genpy.Message:
    """Return the message as a subscriber gets it."""
    return deserialized(type(message), serialized(message))


def test_stamps_are_whole_nanoseconds(make):
    message = sent(ros_messages.header(make, 1_000_000_001, "map"))
    assert (message.stamp.secs, message.stamp.nsecs) == (1, 1)
    assert conversion.stamp_ns(sent(ros_messages.contact(make, 2**31 * 10**9 - 1, 0, True))) == 2**31 * 10**9 - 1


def test_odometry_keeps_its_bits(make):
    message = sent(ros_messages.odometry(make, TIME_NS, 1, READING.odometry))
    assert conversion.odometry_reading(message) == READING.odometry
    assert (message.header.frame_id, message.child_frame_id) == ("robot_1/odom", "robot_1/base_footprint")


def test_covariances_stand_where_x_y_and_yaw_do(make):
    message = sent(ros_messages.odometry(make, TIME_NS, 1, READING.odometry))
    pose, twist = (np.array(part.covariance).reshape(6, 6) for part in (message.pose, message.twist))
    xx, xy, x_yaw, yy, y_yaw, yaw_yaw = BELIEVED.pose_covariance
    in_plane = np.ix_([0, 1, 5], [0, 1, 5])
    np.testing.assert_array_equal(pose[in_plane], [[xx, xy, x_yaw], [xy, yy, y_yaw], [x_yaw, y_yaw, yaw_yaw]])
    np.testing.assert_array_equal(twist[in_plane], np.diag(BELIEVED.twist_variances))
    for covariance in (pose, twist):
        assert np.count_nonzero(covariance) == np.count_nonzero(covariance[in_plane])


def test_ground_truth_keeps_its_bits(make):
    message = sent(ros_messages.ground_truth(make, TIME_NS, 1, READING))
    assert conversion.odometry_reading(message) == OdometryReading(PLACE, MOTION)
    assert message.header.frame_id == "map"


def test_contact_keeps_its_angles(make):
    message = sent(ros_messages.contact(make, TIME_NS, 1, True, (-0.1, 1.0 / 3.0)))
    assert (message.in_contact, message.angles_rad) == (True, (-0.1, 1.0 / 3.0))
    assert sent(ros_messages.contact(make, TIME_NS, 1, False)).angles_rad == ()


def test_command_keeps_its_bits_and_may_be_no_number(make):
    assert conversion.read_twist(serialized(ros_messages.twist(make, MOTION))) == MOTION
    assert not conversion.read_twist(serialized(ros_messages.twist(make, Twist(float("nan"), 0.0, 0.0)))).is_finite
    answer = serialized(ros_messages.twist_stamped(make, TIME_NS, 2, MOTION))
    assert conversion.read_twist_stamped(answer) == MOTION


@pytest.mark.parametrize("frame", ["", "robot_7/odom", "ä/odom"])
def test_odometry_is_read_from_bytes_as_from_the_message(frame):
    numbers = iter((np.arange(1.0, 86.0) / 7.0).tolist())
    message = Odometry(header=Header(seq=3, stamp=genpy.Time(12, 345), frame_id=frame), child_frame_id=f"{frame}x")
    pose, twist = message.pose.pose, message.twist.twist
    pose.position = Point(next(numbers), next(numbers), next(numbers))
    pose.orientation = Quaternion(*(next(numbers) for _ in range(4)))
    message.pose.covariance = [next(numbers) for _ in range(36)]
    twist.linear, twist.angular = (Vector3(next(numbers), next(numbers), next(numbers)) for _ in range(2))
    message.twist.covariance = [next(numbers) for _ in range(36)]
    assert conversion.read_odometry(serialized(message)) == conversion.odometry_reading(message)


@pytest.mark.parametrize("intensities", [[], [1.0, 2.0, 3.0]])
def test_ranges_are_read_from_bytes_as_from_the_message(make, intensities):
    message = ros_messages.scan(make, TIME_NS, 0, Laser(beams=3), RANGES_M)
    message.intensities = intensities
    ranges_m = conversion.read_ranges_m(serialized(message))
    assert ranges_m.dtype == np.float32
    np.testing.assert_array_equal(ranges_m, RANGES_M)
    ranges_m[0] = 0.0  # a controller may write into it


def test_scan_without_beams_is_read():
    assert len(conversion.read_ranges_m(serialized(LaserScan()))) == 0


def test_scan_with_another_number_of_ranges_than_the_laser_has_beams_is_refused():
    data = serialized(LaserScan(ranges=[1.0, 2.0]))
    assert len(conversion.read_ranges_m(data, beams=2)) == 2
    with pytest.raises(ValueError, match="ranges: 2 entries; expected 3, the beams of the scenario's laser"):
        conversion.read_ranges_m(data, beams=3)


def test_bytes_that_are_too_few_are_refused():
    messages = (
        (Odometry(), conversion.read_odometry),
        (LaserScan(ranges=[1.0, 2.0]), conversion.read_ranges_m),
        (TwistMessage(), conversion.read_twist),
        (TwistStamped(), conversion.read_twist_stamped),
        (Voice(), conversion.read_voice),
        (Contact(angles_rad=[1.0]), conversion.read_contact),
    )
    for message, read in messages:
        data = serialized(message)
        for length in (0, 3, 10, 20, len(data) - 8):
            with pytest.raises(ValueError, match="is truncated"):
                read(data[:length])


def test_message_that_promises_more_numbers_than_it_has_is_refused_before_memory_is_taken():
    huge = b"\xff\xff\xff\xff"
    scan, contact = serialized(LaserScan()), serialized(Contact())
    with pytest.raises(ValueError, match="is truncated"):
        conversion.read_ranges_m(scan[:-8] + huge + scan[-4:])
    with pytest.raises(ValueError, match="is truncated"):
        conversion.read_contact(contact[:-4] + huge)


@pytest.mark.parametrize(
    "reading", [VoiceReading(12.5, True, (1.25, 1.0 / 3.0), 0.1), VoiceReading(0.0, False, (0, 0), 0)]
)
def test_voice_keeps_its_bits(make, reading):
    assert conversion.read_voice(serialized(ros_messages.voice(make, TIME_NS, reading))) == reading


@pytest.mark.parametrize(("in_contact", "angles_rad"), [(True, [-1.5, 1.0 / 3.0]), (False, [])])
def test_contact_keeps_its_bits(in_contact, angles_rad):
    message = Contact(header=Header(frame_id="robot_0/base_link"), in_contact=in_contact, angles_rad=angles_rad)
    reading = conversion.read_contact(serialized(message))
    assert (reading.in_contact, list(reading.angles_rad)) == (in_contact, angles_rad)


@pytest.mark.parametrize("odd", [math.nan, math.inf])
def test_voice_and_contact_that_are_not_finite_are_refused(odd):
    for voice in (Voice(level_db=odd), Voice(local_best_level_db=odd)):
        with pytest.raises(ValueError, match=r"level_db: (nan|inf); expected 0 to 1e\+06"):
            conversion.read_voice(serialized(voice))
    with pytest.raises(ValueError, match="expected finite numbers within 1000 km"):
        conversion.read_voice(serialized(Voice(local_best=Point(x=odd))))
    with pytest.raises(ValueError, match=r"angles_rad: (nan|inf); expected finite numbers"):
        conversion.read_contact(serialized(Contact(angles_rad=[odd])))


@pytest.mark.parametrize("odd", [-1.0, -1e300, 1e300])
def test_voice_level_that_nobody_can_hear_is_refused(odd):
    for voice in (Voice(level_db=odd), Voice(local_best_level_db=odd)):
        with pytest.raises(ValueError, match=r"level_db: .*; expected 0 to 1e\+06"):
            conversion.read_voice(serialized(voice))


def test_messages_keep_order_and_text(make):
    messages = (Message(0, -1, '{"a": 0.1}'), Message(2, 1, "ü"), Message(1, 0, ""))
    assert conversion.network_messages([sent(network_messages.network_messages(make, TIME_NS, messages))]) == list(
        messages
    )
    assert conversion.network_messages([sent(network_messages.network_messages(make, TIME_NS, ()))]) == []


def test_network_keeps_its_matrices(make):
    levels = np.array([[0.0, -80.1, -99.0], [-80.1, 0.0, -1.0 / 3.0], [-99.0, -1.0 / 3.0, 0.0]])
    linked = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], dtype=bool)
    hops = np.array([[0, 1, 2], [1, 0, 1], [2, 1, 0]], dtype=np.int32)
    traffic = Traffic(5, 2, 1, 0.3, (Refusal(0, 70_000, 65_507), Refusal(2, 65_508, 65_507)))
    network = NetworkState(levels, levels, linked, hops, np.zeros((3, 3)), 1.0, linked & (levels < -80.0), traffic)
    message = sent(network_messages.network_state(make, TIME_NS, network))
    back = conversion.network_state(message)
    for name in ("rssi_dbm", "link", "adjacency", "hop_count", "break_matrix", "endangered"):
        expected, got = getattr(network, name), getattr(back, name)
        assert got.dtype == expected.dtype, name
        np.testing.assert_array_equal(got, expected, err_msg=name)
    assert (back.fiedler_value, message.num_endangered) == (1.0, 1)
    assert back.traffic == traffic
    quiet = conversion.network_state(
        sent(network_messages.network_state(make, TIME_NS, msgspec.structs.replace(network, traffic=Traffic())))
    )
    assert quiet.traffic == Traffic()


def test_compact_links_keep_their_bits(make):
    linked = np.ones((10, 10), dtype=bool) & ~np.eye(10, dtype=bool)
    linked[3], linked[:, 3] = False, False
    levels = np.where(linked, -1.0 / 3.0 - 80.0, 0.0)
    levels[3], levels[:, 3] = -math.inf, -math.inf
    traffic = Traffic(5, 2, 1, 0.3, (Refusal(0, 70_000, 65_507),))
    hops = np.where(levels == -math.inf, -1, linked).astype(np.int32)
    network = NetworkState(levels, levels, linked, hops, np.zeros((10, 10)), 9.0, linked, traffic)
    links = LinksEncoder().encode(network)
    message = sent(network_messages.network_links(make, TIME_NS, links))
    back = conversion.network_links(message)
    for name in CompactLinks.__struct_fields__:
        np.testing.assert_array_equal(getattr(back, name), getattr(links, name), err_msg=name)
    assert (message.num_links, message.num_endangered, message.swarm_connectivity) == (36, 36, 1.0)
    assert message.adjacency[2] & 1 << 3 == 0  # row 1, robots 0 to 7
    assert message.adjacency[2] & 1 << 4


@pytest.mark.parametrize("goal_m", [(1.0, 2.0), None])
def test_decision_keeps_all_but_command_and_outbox(make, goal_m):
    decision = Decision(MOTION, (Message(0, 1, ""),), True, goal_m, 0.1, 7)
    message = sent(ros_messages.controller_status(make, TIME_NS, 3, decision))
    assert conversion.decision(message) == Decision(Twist(), (), True, goal_m, 0.1, 7)
    assert message.robot_id == 3
    adapted = Decision(context=SwarmContext(*(0.1 * i for i in range(10))))
    message = sent(ros_messages.controller_status(make, TIME_NS, 3, adapted))
    assert conversion.decision(message) == adapted
    assert message.context[0].c4 == adapted.context.c4


@pytest.mark.parametrize("task", [Task(True, 4, (18.0, 0.1), 2.0), Task()])
def test_mission_status_keeps_its_task(make, task):
    status = MissionStatus("running", "", 0.1 + 0.2, (True, False), ("waiting", "saved"), 1, 5, task)
    message = sent(ros_messages.mission_status(make, TIME_NS, "garage", status, 10.0))
    assert conversion.task(message) == task


def test_mission_status_keeps_delivered_and_undelivered_discoveries(make):
    finds = (Discovery("victim", "ann", 1, (9.0, 0.1 + 0.2), 1.0 / 3.0), Discovery("area", "east", 0, (16.0, 5.0), 7.0))
    delivered = DeliveredDiscoveries(2, 0.1 + 0.2, 1.0 / 3.0)
    status = MissionStatus("running", "", 8.0, (True,), ("saved",), -1, 0, Task(undelivered=finds), delivered)
    message = sent(ros_messages.mission_status(make, TIME_NS, "hall", status, 10.0))
    assert conversion.task(message).undelivered == finds
    assert message.discoveries_delivered == 2
    assert (message.mean_delivery_delay_s, message.max_delivery_delay_s) == (0.1 + 0.2, 1.0 / 3.0)


def test_everything_else_that_is_published_can_be_sent(make):
    field = FieldMap((0.5, 1.0), 0.25, np.array([[0.0, 12.4], [99.6, 130.0]]))
    status = MissionStatus("ended", "aborted", 1.0, (False,), ("heard",), 0, 0, Task())
    grid = OccupancyGrid((0.0, 0.0), 0.05, np.array([[0, 100, -1]], dtype=np.int8))
    picture = sent(ros_messages.field_map_picture(make, TIME_NS, field))
    assert list(picture.data) == [0, 12, 100, 100]
    values = sent(ros_messages.field_map(make, TIME_NS, field, "voice_level", "dB"))
    assert (values.width, values.height, values.data[1]) == (2, 2, pytest.approx(12.4))
    assert list(sent(ros_messages.occupancy_grid(make, TIME_NS, grid)).data) == [0, 100, -1]
    assert sent(ros_messages.clock(make, TIME_NS)).clock.to_nsec() == TIME_NS
    assert sent(ros_messages.mission_event(make, TIME_NS, Event(1.0, "end", "", -1, "over"))).robot_id == -1
    assert (
        sent(ros_messages.victims(make, TIME_NS, [Victim(name="a", position=(1.0, 2.0))], ["heard"])).victims[0].name
        == "a"
    )
    assert sent(ros_messages.areas(make, TIME_NS, [Area(name="b", center=(1.0, 2.0))], status)).areas[0].target
    assert sent(ros_messages.contact(make, TIME_NS, 0, True)).in_contact


def test_transforms_lead_from_odom_to_laser_without_leading_slashes(make):
    message = sent(ros_messages.transforms(make, TIME_NS, [Robot()], [READING.odometry]))
    message.transforms.append(sent(ros_messages.localization(make, TIME_NS, 0, PLACE)))
    links = [(link.header.frame_id, link.child_frame_id) for link in message.transforms]
    assert links == [
        ("robot_0/odom", "robot_0/base_footprint"),
        ("robot_0/base_footprint", "robot_0/base_link"),
        ("robot_0/base_link", "robot_0/base_laser_link"),
        ("map", "robot_0/odom"),
    ]
    assert {conversion.stamp_ns(link) for link in message.transforms} == {TIME_NS}
