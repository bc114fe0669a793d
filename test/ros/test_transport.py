"""The transport over roscpp, tried by other clients: rospy, and sockets that speak TCPROS by hand."""

from __future__ import annotations

import gc
import math
import queue
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
import rosgraph
import rospy
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from peers import NODE, Peer, Wire, master, wait_until
from rosgraph_msgs.msg import Clock, Log
from running import TIMEOUT_S
from std_msgs.msg import Header, String, UInt32
from std_srvs.srv import Trigger, TriggerResponse
from team_peers import ROBOTS, TIME_NS, TeamPeers, body, expected_messages, make_readings, make_robots
from tf2_msgs.msg import TFMessage

from robotteamsim import _ros_transport as roscpp
from robotteamsim.geometry import PoseReading
from robotteamsim.recording import ros_messages
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.node import ParameterError, parameter, published_topics, set_parameter
from robotteamsim.ros.transport.serialization import deserialized, message_type, serialized
from robotteamsim.ros.transport.services import Service, call_service
from robotteamsim.ros.transport.topics import Output
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.readings import TeamReadings

# rospy leaves its sockets to the garbage collector, and calls what Python has renamed.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module", autouse=True)
def ros(tmp_path_factory) -> Iterator[None]:
    """A master, with this process as a node of roscpp and one of rospy."""
    with master(tmp_path_factory.mktemp("transport")):
        rosgraph.Master("/test").setParam("/use_sim_time", True)
        roscpp.start_node("transport_test", ["test", f"/remapped:={NODE}/elsewhere"])
        rospy.init_node("peer", disable_signals=True, disable_rostime=True)
        yield
        # The node of rospy lives as long as the process: after a shutdown, its server would wait for a closed socket
        # without a pause, which takes a whole processor.
        roscpp.shut_down()
    gc.collect()  # while its warnings are ignored


def publisher(topic: str, message_class: type, *, latched: bool = False) -> roscpp.Publisher:
    return roscpp.Publisher(topic, message_type(message_class), latched=latched)


def test_subscriber_of_rospy_gets_every_message_in_order():
    output = Output("/numbers", UInt32)
    peer = Peer("/numbers", UInt32)
    wait_until(lambda: output.wanted, "the subscriber")
    for number in range(1000):
        output.publish(UInt32(number))
    assert [peer.next().data for _ in range(1000)] == list(range(1000))


def test_late_subscriber_gets_the_last_message_of_a_latched_topic_once():
    output = Output("/latched", String, latched=True)
    assert output.wanted
    for text in ("first", "last"):
        output.publish(String(text))
    early = Wire("/latched", String)
    while early.next() != serialized(String("last")):
        pass  # roscpp has not yet sent what was published
    peer = Peer("/latched", String)
    message = peer.next()
    assert message.data == "last"
    assert message._connection_header["latching"] == "1"
    output.publish(String("next"))
    assert peer.next().data == "next"


def test_subscribers_that_come_while_a_latched_topic_is_published_miss_nothing():
    output = publisher("/latched_while_connecting", UInt32, latched=True)
    end = threading.Event()

    def publish() -> None:
        for number in range(1_000_000):
            output.publish(struct.pack("<I", number))
            if end.is_set():
                return

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        for _ in range(50):
            wire = Wire("/latched_while_connecting", UInt32)
            (first,) = struct.unpack("<I", wire.next())
            expected = first
            for _ in range(20):
                (number,) = struct.unpack("<I", wire.next())
                assert number in (expected, expected + 1)  # twice is allowed, left out is not
                expected = number
            wire.socket.close()
    finally:
        end.set()
        thread.join()


def test_new_subscriber_is_greeted_with_a_message_of_its_own():
    greetings = iter(("hello", "hello again"))
    output = Output("/greeting", String, greeting=lambda: String(next(greetings)))
    first = Peer("/greeting", String)
    assert first.next().data == "hello"
    assert Wire("/greeting", String).next() == serialized(String("hello again"))
    assert first.is_silent()
    output.publish(String("to all"))
    assert first.next().data == "to all"


def test_subscriber_whose_greeting_is_left_out_or_fails_gets_what_is_published_later():
    answers = iter((lambda: None, lambda: 1 / 0, lambda: String("hello")))
    output = Output("/no_greeting", String, greeting=lambda: next(answers)())
    peers = []
    for count in (1, 2):
        peers.append(Wire("/no_greeting", String))
        wait_until(lambda count=count: output.num_subscribers == count, "the subscriber")
    peers.append(Wire("/no_greeting", String))
    assert peers[2].next() == serialized(String("hello"))
    output.publish(String("to all"))
    assert [peer.next() for peer in peers] == [serialized(String("to all"))] * 3


def test_hundreds_of_subscribers_can_connect_at_once():
    outputs = [publisher(f"/many/topic_{i}", UInt32) for i in range(300)]
    uri = rosgraph.Master("/test").lookupNode(NODE)
    connected: queue.Queue[Wire] = queue.Queue()
    threads = [
        threading.Thread(target=lambda i=i: connected.put(Wire(f"/many/topic_{i}", UInt32, uri)))
        for i in range(len(outputs))
    ]
    for thread in threads:
        thread.start()
    wires = [connected.get(timeout=TIMEOUT_S) for _ in threads]
    wait_until(lambda: all(output.num_subscribers == 1 for output in outputs), "all subscribers")
    for output in outputs:
        output.publish(struct.pack("<I", 7))
    assert {wire.next() for wire in wires} == {struct.pack("<I", 7)}


def test_stuck_subscriber_blocks_nobody_and_gets_everything_later():
    output = publisher("/large", String)
    stuck, other = Wire("/large", String), Wire("/large", String)
    wait_until(lambda: output.num_subscribers == 2, "both subscribers")
    messages = [serialized(String(f"{number}" + "x" * 100_000)) for number in range(200)]
    for message in messages:
        output.publish(message)
        assert other.next() == message
    assert [stuck.next() for _ in messages] == messages


def test_clock_does_not_overtake_what_is_published_before_it():
    outputs = [publisher(f"/ordered/topic_{i}", UInt32) for i in range(50)]
    clock = publisher("/ordered/clock", UInt32, latched=True)
    wires = [Wire(f"/ordered/topic_{i}", UInt32) for i in range(len(outputs))]
    clock_wire = Wire("/ordered/clock", UInt32)
    wait_until(lambda: all(output.num_subscribers == 1 for output in (*outputs, clock)), "all subscribers")

    def publish() -> None:
        for number in range(200):
            data = struct.pack("<I", number)
            for output in outputs:
                output.publish(data)
            clock.publish(data)

    thread = threading.Thread(target=publish)
    thread.start()
    for _ in range(200):
        tick = clock_wire.next()
        assert {wire.next_that_is_there() for wire in wires} == {tick}
    thread.join()


@pytest.fixture
def robots() -> list[PlacedRobot]:
    return make_robots()


@pytest.fixture
def readings() -> TeamReadings:
    return make_readings()


@pytest.mark.parametrize("localized", [False, True])
def test_topics_of_a_team_carry_the_bytes_that_genpy_makes_of_its_readings(robots, readings, localized):
    make, team = RosTypes(), TeamPeers(robots, localized=localized)
    for time_ns in (TIME_NS - 100_000_000, TIME_NS):  # nothing is left of the step before
        team.outputs.publish(time_ns, readings)
        frames = team.tf.next()
    for i in range(ROBOTS):
        for name, message in expected_messages(make, robots, readings, i).items():
            assert body(team.latched(i, name)) == body(message), (i, name)
    expected = ros_messages.transforms(make, TIME_NS, robots, [reading.odometry for reading in readings])
    if localized:
        expected.transforms += [
            ros_messages.localization(
                make, TIME_NS, i, PoseReading.from_pose(r.ground_truth.pose @ r.odometry.pose.pose.inverse())
            )
            for i, r in enumerate(readings)
        ]
    assert serialized(frames) == serialized(expected)


def test_absent_robots_are_silent(robots, readings):
    team = TeamPeers(robots, localized=True)
    present = np.arange(ROBOTS) % 3 > 0
    team.outputs.publish(TIME_NS, readings)
    team.tf.next()
    team.outputs.publish(TIME_NS + 100_000_000, readings, present)
    assert {link.child_frame_id.partition("/")[0] for link in team.tf.next().transforms} == {
        f"robot_{i}" for i in range(ROBOTS) if present[i]
    }
    stamps_ns = [team.latched(i, "odom").header.stamp.to_nsec() for i in range(ROBOTS)]
    assert stamps_ns == [TIME_NS + (100_000_000 if here else 0) for here in present]


def test_arrays_of_the_wrong_shape_are_refused():
    topic = roscpp.OdometryTopic(["/shape/odom"], [serialized(Odometry())], latched=True)
    with pytest.raises(ValueError, match="poses must have a row of 4 adjacent numbers for each of 1 robots"):
        topic.publish(0, np.zeros((2, 4)), np.zeros((1, 3)))
    with pytest.raises(ValueError, match="twists must have a row of 3"):
        topic.publish(0, np.zeros((1, 4)), np.zeros((1, 2)))
    with pytest.raises(ValueError, match="present must have an element for each of 1 robots"):
        topic.publish(0, np.zeros((1, 4)), np.zeros((1, 3)), present=np.ones(2, bool))
    with pytest.raises(ValueError, match="nav_msgs/Odometry is truncated"):
        roscpp.OdometryTopic(["/shape/odom"], [b"short"], latched=True)


@pytest.fixture
def subscribed() -> Callable[..., tuple[roscpp.MessageQueue, rospy.Publisher]]:
    """Return a queue that subscribes to a topic, and a publisher of rospy that is connected to it."""

    def make(topic: str, message_class: type, keep: int = 0) -> tuple[roscpp.MessageQueue, rospy.Publisher]:
        messages = roscpp.MessageQueue()
        assert messages.subscribe(topic, message_type(message_class), keep) == 0
        sender = rospy.Publisher(topic, message_class, queue_size=0)
        wait_until(lambda: messages.num_publishers(0) == 1 and sender.get_num_connections() == 1, "the connection")
        return messages, sender

    return make


OTHER_PUBLISHER = """
import sys
import rospy
from std_msgs.msg import UInt32
rospy.init_node("other")
publisher = rospy.Publisher(sys.argv[1], UInt32, queue_size=10)
while not rospy.is_shutdown():
    publisher.publish(UInt32(7))
    rospy.rostime.wallsleep(0.02)
"""


def numbers(received: list[tuple[int, int, bytes]]) -> list[int]:
    return [struct.unpack("<I", data)[0] for _, _, data in received]


def taken(messages: roscpp.MessageQueue, count: int) -> list[tuple[int, int, bytes]]:
    received: list[tuple[int, int, bytes]] = []
    while len(received) < count:
        batch = messages.take(TIMEOUT_S)
        assert batch, f"{len(received)} of {count} messages came"
        received += batch
    return received


def test_queue_receives_every_message_in_order_with_its_stamp(subscribed):
    messages, sender = subscribed("/received/stamped", Header)
    assert messages.take(0.0) == []
    headers = [Header(stamp=rospy.Time(number, 5), frame_id="map") for number in range(500)]
    typed, sender_of_odometry = subscribed("/received/odometry", Odometry)
    for header in headers:
        sender_of_odometry.publish(Odometry(header=header))
        sender.publish(header)
    received = taken(typed, 500)
    assert [stamp_ns for _, stamp_ns, _ in received] == [number * 10**9 + 5 for number in range(500)]
    assert deserialized(Odometry, received[7][2]).header.stamp == rospy.Time(7, 5)
    assert [deserialized(Header, data).stamp.secs for _, _, data in taken(messages, 500)] == list(range(500))


def test_queue_drops_the_oldest_messages_beyond_those_it_keeps(subscribed):
    messages, sender = subscribed("/received/kept", UInt32, keep=3)
    ticks = roscpp.MessageQueue()
    ticks.subscribe("/received/kept", message_type(UInt32))
    for number in range(10):
        sender.publish(UInt32(number))
    taken(ticks, 10)
    assert [struct.unpack("<I", data)[0] for _, _, data in taken(messages, 3)] == [7, 8, 9]
    messages.unsubscribe()
    assert messages.is_closed


def transform(parent: str, child: str, stamp_s: float, place: tuple[float, float, float]) -> TransformStamped:
    """Return a transform whose place is x, y [m] and yaw [rad]."""
    x_m, y_m, yaw_rad = place
    link = TransformStamped(child_frame_id=child)
    link.header.frame_id, link.header.stamp = parent, rospy.Time.from_sec(stamp_s)
    link.transform.translation.x, link.transform.translation.y = x_m, y_m
    link.transform.rotation.z, link.transform.rotation.w = math.sin(yaw_rad / 2.0), math.cos(yaw_rad / 2.0)
    return link


def test_newest_transform_is_composed_of_moving_and_static_ones_until_time_jumps_back():
    listener = roscpp.TransformListener()
    moving = Output("/tf", TFMessage, latched=True)
    static = Output("/tf_static", TFMessage, latched=True)
    static.publish(TFMessage([transform("r/base_footprint", "r/base_link", 0.0, (1.0, 0.0, 0.0))]))
    pose, reason = listener.newest("map", "r/base_link")
    assert pose is None
    assert "map" in reason or "r/base_link" in reason

    def sent(stamp_s: float, y_m: float) -> tuple[int, ...] | None:
        """Publish a transform, and return the newest one as soon as it has that stamp."""
        moving.publish(TFMessage([transform("map", "r/base_footprint", stamp_s, (2.0, y_m, math.pi / 2.0))]))
        stamp_ns = round(stamp_s * 1e9)
        wait_until(lambda: (listener.newest("map", "r/base_link")[0] or (-1,))[0] == stamp_ns, f"tf at {stamp_s} s")
        return listener.newest("map", "r/base_link")[0]

    # One metre ahead of a footprint that looks along y.
    assert sent(100.0, 3.0) == pytest.approx((100 * 10**9, 2.0, 4.0, math.pi / 2.0))
    listener.clear()
    assert sent(1.0, 5.0) == pytest.approx((10**9, 2.0, 6.0, math.pi / 2.0))


def test_transform_of_static_frames_has_stamp_0():
    listener = roscpp.TransformListener()
    static = Output("/tf_static", TFMessage, latched=True)
    static.publish(TFMessage([transform("map", "fixed/base_link", 7.0, (3.0, 4.0, 0.0))]))
    wait_until(lambda: listener.newest("map", "fixed/base_link")[0] is not None, "the transform")
    assert listener.newest("map", "fixed/base_link") == ((0, 3.0, 4.0, 0.0), "")


def test_queue_for_one_publisher_ignores_a_second_one():
    messages = roscpp.MessageQueue()
    messages.subscribe("/received/owned", message_type(UInt32), one_publisher=True)
    command = (sys.executable, "-c", OTHER_PUBLISHER, "/received/owned")
    ours = rospy.Publisher("/received/owned", UInt32, queue_size=0)
    wait_until(lambda: ours.get_num_connections() == 1, "the connection")
    ours.publish(UInt32(1))
    assert numbers(taken(messages, 1)) == [1]
    with subprocess.Popen(command) as other:
        try:
            wait_until(lambda: messages.num_publishers(0) == 2, "the other publisher")
            assert messages.take(1.0) == []
            ours.publish(UInt32(2))
            assert numbers(taken(messages, 1)) == [2]
        finally:
            other.terminate()


def test_queue_that_is_closed_lets_nobody_wait():
    messages = roscpp.MessageQueue()
    messages.subscribe("/received/nothing", message_type(UInt32))
    threading.Timer(0.05, messages.close).start()
    started_s = time.monotonic()
    assert messages.take(TIMEOUT_S) == []
    assert time.monotonic() - started_s < TIMEOUT_S / 2


def test_service_answers_clients_of_rospy_at_once_though_another_call_waits():
    waiting, go = threading.Event(), threading.Event()

    def serve_slowly(_: object) -> TriggerResponse:
        waiting.set()
        assert go.wait(TIMEOUT_S)
        return TriggerResponse(success=True, message="slow")

    services = [
        Service("/slow", Trigger, serve_slowly),
        Service("/quick", Trigger, lambda _: TriggerResponse(success=True, message="ü")),
    ]
    answers: queue.Queue = queue.Queue()
    threading.Thread(target=lambda: answers.put(rospy.ServiceProxy("/slow", Trigger)())).start()
    assert waiting.wait(TIMEOUT_S)
    assert rospy.ServiceProxy("/quick", Trigger)().message == "ü"
    go.set()
    assert answers.get(timeout=TIMEOUT_S).message == "slow"
    assert len(services) == 2


def test_service_that_fails_tells_its_client_why_and_is_still_there():
    problems = iter(("no such robot",))

    def serve(_: object) -> TriggerResponse:
        if (problem := next(problems, None)) is not None:
            raise ValueError(problem)
        return TriggerResponse(success=True, message="")

    service = Service("/failing", Trigger, serve)
    client = rospy.ServiceProxy("/failing", Trigger)
    with pytest.raises(rospy.ServiceException, match="no such robot"):
        client()
    assert client().success
    del service


def test_service_of_rospy_is_called():
    server = rospy.Service("/of_rospy", Trigger, lambda _: TriggerResponse(success=True, message="answer"))
    answer = call_service("/of_rospy", Trigger, Trigger._request_class(), TIMEOUT_S)
    assert (answer.success, answer.message) == (True, "answer")
    server.shutdown()
    assert call_service("/not_there", Trigger, Trigger._request_class(), 0.1) is None


def test_parameters_have_the_type_of_their_default():
    assert parameter("~rate", 2.5) == 2.5
    set_parameter("~rate", 3)
    assert rospy.get_param(f"{NODE}/rate") == 3
    assert parameter("~rate", 2.5) == 3.0
    with pytest.raises(ParameterError, match=f"{NODE}/rate: 3; expected true or false"):
        parameter("~rate", True)


def test_log_reaches_rosout():
    peer = Peer("/rosout", Log)
    wait_until(lambda: "/rosout" in published_topics(), "/rosout")
    levels = {roscpp.Level.INFO: Log.INFO, roscpp.Level.WARNING: Log.WARN, roscpp.Level.FATAL: Log.FATAL}

    def heard() -> dict[str, int]:
        for level in levels:
            roscpp.log(level, f"a line of {level.name} with 100 %s")
        lines = {}
        while not peer.is_silent():
            message = peer.next()
            lines[message.msg] = message.level
        return lines

    expected = {f"a line of {level.name} with 100 %s": number for level, number in levels.items()}
    lines: dict[str, int] = {}

    def all_heard() -> bool:
        lines.update(heard())
        return expected.items() <= lines.items()

    wait_until(all_heard, "all lines")


def test_topics_are_remapped():
    output = Output("/remapped", String, latched=True)
    output.publish(String("here"))
    assert f"{NODE}/elsewhere" in published_topics()
    assert Peer(f"{NODE}/elsewhere", String).next().data == "here"


def test_process_is_one_node_that_does_not_subscribe_to_the_clock():
    publishers, subscribers, services = rosgraph.Master("/test").getSystemState()
    nodes = {node for group in (publishers, subscribers, services) for _, names in group for node in names}
    assert nodes == {NODE, "/peer"}
    assert not [names for topic, names in subscribers if topic == "/clock"]
    output = Output("/clock", Clock, latched=True)
    output.publish(Clock(rospy.Time(5)))
    assert Peer("/clock", Clock).next().clock == rospy.Time(5)
