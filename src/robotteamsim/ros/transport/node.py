"""What all nodes share: how they start, read their settings, listen, speak and end."""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import rospy
from pydantic import ValidationError

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.msg import Robots
from robotteamsim.ros.transport.inbox import Channel, Inbox, LatestInbox, LockstepInbox, Step
from robotteamsim.ros.transport.msg_conversion import stamp_ns
from robotteamsim.ros.transport.packed_messages import Serialized
from robotteamsim.ros.transport.prompt_connection import accept_all_at_once, answer_all_at_once, send_promptly
from robotteamsim.ros.transport.shared_ear import hear_with_one_thread
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.problems import problems
from robotteamsim.scenario.sections import Run, Team
from robotteamsim.world.placement import check_places

PARAMETERS = "/robotteamsim"
"""Namespace of the parameters that all nodes read."""

SEED = f"{PARAMETERS}/seed"
"""The parameter by which a seed reaches all nodes; a string, as XML-RPC has integers of 32 bits only."""

WORLD_TELLS_S = 5.0
"""How long other nodes leave it to the world to tell of a mistake in the settings [s, wall]."""
NOT_SET = -1
"""Number of robots, or id of the one driven by hand, where none is given."""

NO_CONTROLLERS = "false"
HOSTED = ("per_robot", "team", NO_CONTROLLERS)
"""Where controllers run: a process for each robot, one for all, or none at all."""


class ParameterError(RobotTeamSimError):
    """A parameter of a node is missing or wrong."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What all nodes must agree on; see docs/ros_api.md for the parameters."""

    scenario: Scenario
    lockstep: bool
    controllers: bool
    teleop: int
    silence_limit_s: float
    mission: bool = True
    """Whether there are an environment and a mission to wait for."""

    @property
    def controlled(self) -> range:
        """Ids of the robots that have a controller."""
        return range(self.num_robots if self.controllers else 0)

    def with_seed(self, seed: int | str) -> Settings:
        """Return the same settings with another seed. Raises: ParameterError."""
        try:
            run = Run.model_validate(self.scenario.run.model_dump() | {"seed": seed})
        except ValidationError as error:
            raise ParameterError(str(problems(error, Run)[0])) from None
        return replace(self, scenario=self.scenario.model_copy(update={"run": run}))

    def drives(self, robot_id: int) -> bool:
        """Whether the robot's own controller drives it, and not somebody by hand."""
        return robot_id in self.controlled and robot_id != self.teleop

    @property
    def step_ns(self) -> int:
        """Length of a step [ns]."""
        return round(self.scenario.run.step_s * 1e9)

    @property
    def num_robots(self) -> int:
        """Number of robots."""
        robots = self.scenario.robots
        return robots.count if isinstance(robots, Team) else len(robots)


@dataclass(frozen=True, slots=True)
class Input:
    """A topic that a node needs, and how its inbox treats it."""

    channel: Channel
    message_class: type


ROBOTS = "/world/robots"
WHO_IS_THERE = Input(Channel(ROBOTS, tells_who=True), Robots)
"""Which robots are there; a world that does not tell has them all."""


class Attendance:
    """Which robots are there, as the world has told last."""

    def __init__(self) -> None:
        self.present: np.ndarray | None = None
        """Whether each robot is there, bool, shape (n,); None: all are. The same object until that changes."""
        self.arrivals: tuple[int, ...] | None = None
        """How often each has come; None: not told so far."""

    def follow(self, step: Step) -> None:
        """Take in what a step tells."""
        message = step.latest(ROBOTS)
        if message is None:
            return
        present = np.array(list(message.present), dtype=bool)
        if present.all():
            self.present = None
        elif self.present is None or not np.array_equal(present, self.present):
            self.present = present
        self.arrivals = tuple(message.arrivals)

    def is_there(self, robot_id: int) -> bool:
        """Whether a robot is there."""
        return self.present is None or bool(self.present[robot_id])


class Output:
    """A topic that a node publishes; no message need be built that nobody gets."""

    def __init__(
        self, topic: str, message_class: type, *, latched: bool = False, greeting: Callable[[], Any] | None = None
    ) -> None:
        """Advertise. greeting: makes what a new subscriber gets at once, or None where there is nothing to tell."""
        self._latched = latched
        # 0: unlimited. A full queue would drop a message that lockstep waits for.
        self._publisher = rospy.Publisher(topic, message_class, queue_size=0, latch=latched)
        if greeting is not None:
            self._publisher.impl.add_subscriber_listener(_Greeter(greeting, self._publisher.impl.publock))

    @property
    def wanted(self) -> bool:
        """Whether somebody gets the next message, now or (latched) later."""
        return self._latched or self.num_subscribers > 0

    @property
    def num_subscribers(self) -> int:
        """How many nodes are connected."""
        return self._publisher.get_num_connections()

    def publish(self, message: Any) -> None:
        """Send a message, unless the node is shutting down."""
        if not rospy.is_shutdown():
            self._publisher.publish(message)

    def publish_bytes(self, data: memoryview) -> None:
        """Send a message that is serialized already, with its length in front, unless the node is shutting down."""
        if rospy.is_shutdown():
            return
        implementation = self._publisher.impl
        with implementation.publock:
            if self._latched:
                implementation.latch = Serialized(bytes(data[4:]))
            for connection in implementation.connections:
                try:
                    connection.write_data(data)
                except Exception:  # Whatever it is, this subscriber is lost; the others are not.
                    connection.close()
            implementation.message_data_sent += len(data)


class _Greeter(rospy.SubscribeListener):
    """Sends every new subscriber a message of its own."""

    def __init__(self, greeting: Callable[[], Any], lock: Any) -> None:
        self._greeting = greeting
        self._lock = lock

    def peer_subscribe(self, topic_name: str, topic_publish: Callable[[Any], Any], peer_publish: Any) -> None:
        """Greet a subscriber that has come; rospy calls this from its own thread."""
        message = self._greeting()
        if message is not None and not rospy.is_shutdown():
            with self._lock:
                peer_publish(message)


def run(name: str, serve: Callable[[], None]) -> None:
    """Run a node until it is done or told to stop; a user's mistake ends it in one line and status 2."""
    # Nodes take the time from the stamps that they work on. Not listening to /clock saves each node more messages
    # than all its other topics have.
    answer_all_at_once()
    rospy.init_node(name, disable_rostime=True)
    accept_all_at_once()
    send_promptly()
    hear_with_one_thread()
    _forward_logging()
    try:
        serve()
    except RobotTeamSimError as error:
        if not rospy.is_shutdown():
            rospy.logfatal(str(error))
        sys.exit(2)
    finally:
        # rospy's threads would keep a failed node alive, and its launch with it.
        rospy.signal_shutdown(f"{name} has ended")


def read_settings() -> Settings:
    """Return the settings from the parameter server.

    Raises: ParameterError, ScenarioError. All nodes of a launch find the same mistake: the world tells of it at once,
    which ends the launch, and the others only if they are still there after a while.
    """
    try:
        return _read_settings()
    except RobotTeamSimError:
        if rospy.get_name() != "/world":
            wait_for_shutdown(WORLD_TELLS_S)
        raise


def read_seed(settings: Settings) -> Settings:
    """Return the settings with the seed of the last reset, for a node that begins anew. Raises: ParameterError."""
    text = parameter(SEED, "")
    try:
        return settings.with_seed(int(text) if text.lstrip("-").isdecimal() else text) if text else settings
    except ParameterError as error:
        raise ParameterError(f"{PARAMETERS}/{error}") from None


def wait_for_shutdown(timeout_s: float) -> None:
    """Wait until the node is told to stop, but not longer than a time [s, wall]."""
    told = threading.Event()
    rospy.on_shutdown(told.set)
    told.wait(timeout_s)


def _read_settings() -> Settings:
    name = parameter(f"{PARAMETERS}/scenario", "")
    if not name:
        raise ParameterError(f"{PARAMETERS}/scenario: is not set; wanted the name or file of a scenario")
    overrides = parameter(f"{PARAMETERS}/set", "").split()
    scenario = load(name, overrides)
    num_robots = parameter(f"{PARAMETERS}/robots", NOT_SET)
    if num_robots != NOT_SET and isinstance(scenario.robots, Team) and scenario.robots.count != num_robots:
        scenario = load(name, [*overrides, f"robots.count={num_robots}"])
    check_places(scenario)
    settings = Settings(
        scenario,
        lockstep=parameter(f"{PARAMETERS}/lockstep", False),
        controllers=_has_controllers(),
        teleop=parameter(f"{PARAMETERS}/teleop", NOT_SET),
        silence_limit_s=float(parameter(f"{PARAMETERS}/silence_limit_s", 5.0)),
        mission=parameter(f"{PARAMETERS}/mission", True),
    )
    if settings.lockstep and not settings.mission:
        raise ParameterError(f"{PARAMETERS}/lockstep: True; wanted False where there is no mission")
    if num_robots not in (NOT_SET, settings.num_robots):
        raise ParameterError(
            f"{PARAMETERS}/robots: {num_robots}; wanted {settings.num_robots}, the length of the robots' list in {name}"
        )
    if settings.teleop not in range(NOT_SET, settings.num_robots):
        raise ParameterError(f"{PARAMETERS}/teleop: {settings.teleop}; wanted 0 to {settings.num_robots - 1}")
    return read_seed(settings)


def _has_controllers() -> bool:
    """Return whether there are controllers, in whichever processes. Raises: ParameterError."""
    hosted = parameter(f"{PARAMETERS}/controllers", "per_robot")
    if hosted.lower() not in HOSTED:
        raise ParameterError(f"{PARAMETERS}/controllers: {hosted}; wanted {', '.join(HOSTED)}")
    return hosted.lower() != NO_CONTROLLERS


def parameter(name: str, default: Any) -> Any:
    """Return a parameter, of its default's type. Raises: ParameterError."""
    value = rospy.get_param(name, default)
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if isinstance(default, str) and isinstance(value, int | float):
        value = str(value)
    if type(value) is not type(default):
        raise ParameterError(f"{rospy.resolve_name(name)}: {value!r}; wanted {type(default).__name__}")
    return value


def make_inbox(settings: Settings, inputs: Iterable[Input]) -> Inbox:
    """Return an inbox that listens to all inputs, and is closed when the node shuts down."""
    inputs = list(inputs)
    channels = [an_input.channel for an_input in inputs]
    inbox: Inbox
    if settings.lockstep:
        inbox = LockstepInbox(
            channels, rospy.logwarn, step_ns=settings.step_ns, silence_limit_s=settings.silence_limit_s
        )
    else:
        inbox = LatestInbox(channels, rospy.logwarn)
    rospy.on_shutdown(inbox.close)
    for an_input in inputs:
        _listen(inbox, an_input)
    return inbox


def subscribe(topic: str, message_class: type, callback: Callable[[Any], None]) -> None:
    """Subscribe without delay and without limit."""
    rospy.Subscriber(topic, message_class, callback, tcp_nodelay=True)


def _listen(inbox: Inbox, an_input: Input) -> None:
    name = an_input.channel.name
    subscribe(name, an_input.message_class, lambda message: inbox.put(name, stamp_ns(message), message))


def _forward_logging() -> None:
    """Send what the core logs to rosout."""
    logger = logging.getLogger("robotteamsim")
    logger.addHandler(_Rosout())
    logger.propagate = False


class _Rosout(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno >= logging.ERROR:
            rospy.logerr(self.format(record))
        elif record.levelno >= logging.WARNING:
            rospy.logwarn(self.format(record))
        elif record.levelno >= logging.INFO:
            rospy.loginfo(self.format(record))
        else:
            rospy.logdebug(self.format(record))
