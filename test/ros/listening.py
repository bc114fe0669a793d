"""What the test nodes share: topics to wait for, services to call. Nothing here waits longer than TIMEOUT_S."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from geometry_msgs.msg import Twist
from robotteamsim.msg import Robots
from robotteamsim.srv import Step
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

TIMEOUT_S = 120.0
"""A busy machine may take this long for what takes a second [s, wall]."""


class Topic:
    """Keeps all messages of a topic."""

    def __init__(self, name: str, message_class: type) -> None:
        self.name = name
        self.messages: list[Any] = []
        self._changed = threading.Condition()
        self._subscriber = rospy.Subscriber(name, message_class, self._put, tcp_nodelay=True)

    def _put(self, message: Any) -> None:
        with self._changed:
            self.messages.append(message)
            self._changed.notify_all()

    def unsubscribe(self) -> None:
        """End the subscription. Until then, rospy gives later subscribers of this process the last message it has."""
        self._subscriber.unregister()

    def is_connected(self, timeout_s: float) -> bool:
        """Wait until somebody publishes it; return whether somebody does in time [s, wall]."""
        deadline_s = time.monotonic() + timeout_s
        while not self._subscriber.get_num_connections() and time.monotonic() < deadline_s:
            rospy.rostime.wallsleep(0.05)
        return self._subscriber.get_num_connections() > 0

    def wait_for_count(self, count: int) -> Sequence[Any]:
        """Wait until so many messages have come, and return them."""
        with self._changed:
            if not self._changed.wait_for(lambda: len(self.messages) >= count, timeout=TIMEOUT_S):
                raise AssertionError(f"{self.name}: {len(self.messages)} messages came, {count} were waited for")
            return tuple(self.messages)

    def wait_for(self, holds: Callable[[Any], bool], what: str) -> Any:
        """Wait for a message yet to come of which something holds, and return it."""
        return self.wait_for_after(len(self.messages), holds, what)

    def wait_for_after(self, index: int, holds: Callable[[Any], bool], what: str) -> Any:
        """Wait for a message from the index-th on of which something holds, and return it."""
        with self._changed:
            found = self._changed.wait_for(
                lambda: next((message for message in self.messages[index:] if holds(message)), None),
                timeout=TIMEOUT_S,
            )
            if found is None:
                raise AssertionError(f"{self.name}: no message with {what} came")
            return found

    def next(self) -> Any:
        """Wait for a message yet to come."""
        return self.wait_for(lambda _: True, "anything")

    def wait_for_step(self, stamp: rospy.Time, index: int = 0) -> None:
        """Wait until the newest message has the stamp of a step, and is the index-th or a later one."""
        with self._changed:
            if not self._changed.wait_for(
                lambda: len(self.messages) > index and self.messages[-1].header.stamp == stamp, timeout=TIMEOUT_S
            ):
                newest = self.messages[-1].header.stamp if self.messages else None
                raise AssertionError(f"{self.name}: the newest message is of {newest} ns; expected {stamp} ns")


def call(name: str, service_class: type, /, **fields: Any) -> Any:
    """Call a service as soon as it is there."""
    rospy.wait_for_service(name, timeout=TIMEOUT_S)
    return rospy.ServiceProxy(name, service_class)(**fields)


def send(publisher: rospy.Publisher, message: Any) -> None:
    """Publish a message and wait until all subscribers have received it.

    rospy publishes in a thread of its own, and a node reads each topic in another; on a busy machine, these may be many
    steps later than a service. A node counts a message before it reads it, so that may still be one step late.
    """
    with ExitStack() as open_until_the_end:
        master = rosgraph.Master(rospy.get_name())
        open_until_the_end.enter_context(master.handle)
        deadline_s = time.monotonic() + TIMEOUT_S
        while not (names := dict(master.getSystemState()[1]).get(publisher.name, [])) or (
            publisher.get_num_connections() < len(names)
        ):
            assert time.monotonic() < deadline_s, f"{publisher.name}: not all of {names} are connected"
            rospy.rostime.wallsleep(0.05)
        nodes = [open_until_the_end.enter_context(ServerProxy(master.lookupNode(name))) for name in names]
        counts = [_num_received(node, publisher.name) for node in nodes]
        publisher.publish(message)
        for name, node, count in zip(names, nodes, counts, strict=True):
            while _num_received(node, publisher.name) <= count:
                assert time.monotonic() < deadline_s, f"{name} did not receive the message of {publisher.name}"
                rospy.rostime.wallsleep(0.001)


def _num_received(node: ServerProxy, topic: str) -> int:
    """Return how many messages of a topic a node has received, as it says itself."""
    return num_received(node.getBusStats(rospy.get_name()), topic)


def num_received(answer: Sequence[Any], topic: str) -> int:
    """Return how many messages of a topic are in the answer of a node to getBusStats.

    rospy answers [code, text, [published, subscribed, services]] as the API says, roscpp 1.15 [published, subscribed].
    """
    follows_api = isinstance(answer[0], int)
    _, received, *_ = answer[2] if follows_api else answer
    return sum(count for _, _, count, _, _ in dict(received)[topic])


def latched_time() -> rospy.Time:
    """Return the time of a paused world.

    A node that already subscribes to a topic would get the last message that it has read, which may be an older one.
    Nodes with simulated time subscribe to the clock.
    """
    if rospy.rostime.is_wallclock():
        return rospy.wait_for_message("/clock", Clock, TIMEOUT_S).clock
    return rospy.wait_for_message("/world/robots", Robots, TIMEOUT_S).header.stamp


def pause(*topics: Topic) -> rospy.Time:
    """Pause the world, wait until topics with one message per step have caught up, and return the time.

    Each topic arrives in its own thread; otherwise the messages of one may be older than those of another.
    """
    for topic in topics:
        topic.wait_for_count(1)
    deadline_s = time.monotonic() + TIMEOUT_S
    while (answer := call("/simulation/pause", Trigger).message) != "paused":
        assert time.monotonic() < deadline_s, answer
    return _wait_for_last_step(topics, [0] * len(topics))


def catch_up(*topics: Topic) -> None:
    """Wait until topics with one message per step have the messages of all steps up to now."""
    pause(*topics)
    assert call("/simulation/resume", Trigger).success


def make_step(*topics: Topic) -> rospy.Time:
    """Let a paused world take one step, wait for its message on each topic, and return the time."""
    counts = [len(topic.messages) for topic in topics]
    assert call("/simulation/step", Step, steps=1).success
    return _wait_for_last_step(topics, counts)


def reset(*topics: Topic) -> None:
    """Reset the world and wait for the first step on each topic, so that all later messages belong to the new run."""
    pause(*topics)
    answer = call("/simulation/reset", Trigger).message
    assert answer == "reset", answer
    make_step(*topics)
    assert call("/simulation/resume", Trigger).success


def _wait_for_last_step(topics: Sequence[Topic], counts: Sequence[int]) -> rospy.Time:
    stamp = latched_time()
    for topic, count in zip(topics, counts, strict=True):
        topic.wait_for_step(stamp, count)
    return stamp


def drive(command: rospy.Publisher, twist: Twist, topic: Topic, steps: int) -> Sequence[Any]:
    """Command every other step, which is 5 Hz, and return what a topic of every step tells meanwhile.

    The world is paused in between, so that the rate does not depend on the machine.
    """
    pause(topic)
    begin = len(topic.messages)
    for _ in range(0, steps, 2):
        send(command, twist)
        call("/simulation/step", Step, steps=2)
    messages = topic.wait_for_count(begin + steps)
    call("/simulation/resume", Trigger)
    return messages[begin : begin + steps]


def speed_mps(message: Any) -> float:
    """Return the forward speed that an odometry message tells."""
    return message.twist.twist.linear.x


def place_m(message: Any) -> tuple[float, float]:
    """Return the place that an odometry message tells."""
    return message.pose.pose.position.x, message.pose.pose.position.y
