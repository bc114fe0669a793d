"""Start, parameters, log and end of a node of ROS 2."""

from __future__ import annotations

import logging
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property, partial
from typing import Any

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import InvalidParameterTypeException, ParameterException
from rclpy.executors import MultiThreadedExecutor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.node import Node as RclpyNode
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.qos_overriding_options import InvalidQosOverridesError
from rclpy.signals import SignalHandlerOptions

from robotteamsim.ending import ending_signals
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import stamp_ns
from robotteamsim.nodes.node import KINDS, Output, ParameterError
from robotteamsim.nodes.rosout import forward_logging
from robotteamsim.nodes.shutdown import Shutdown
from robotteamsim.nodes.steps import REPORT_TIMEOUT_S
from robotteamsim.recording.bag_types import message_type
from robotteamsim.ros2.arguments import given_parameters
from robotteamsim.ros2.topics import Ros2Output, Sender, StampedOutput, filled, installed, interface, quality
from robotteamsim.scenario.problems import suggestion
from robotteamsim.wording import counted

SIMULATION = "/simulation"
"""The node whose parameters all nodes of a launch share."""
CALL_TIMEOUT_S = 10.0
"""A call of a service that is there waits this long for the response [s, wall]."""
ANSWER_S = 2.0
"""A parameter is asked for again after this time, because answers to clients not yet discovered are lost [s, wall]."""
WAIT_S = 0.2
"""Interval of checks whether a service is there [s, wall]."""
SERVICES_AT_ONCE = 8
"""So many requests are served at the same time."""
SPIN_S = 0.1
"""A node that waits for topics and requests looks so often whether it should end [s, wall]."""
QUIET_S = 1.0
"""The simulation starts when there was no new subscriber for this time [s, wall]."""
FASTEST = 1e6
"""Largest speed, times real time."""
TYPES_S = 2.0
"""Interval of checks for publishers whose messages have another type than the node reads [s, wall]."""
TWIST = "geometry_msgs/Twist"
LATEST_S = 2**31
"""A header has 31 bits for the seconds."""

logger = logging.getLogger(__name__)


def run(name: str, serve: Callable[[Ros2Node], None], *, owns_settings: bool = False) -> None:
    """Run a node until it is done or shut down; a user's mistake ends it with one line and status 2.

    Args: owns_settings: whether the settings that all nodes share are parameters of this one.
    """
    shutdown = Shutdown()
    for number in ending_signals():
        signal.signal(number, lambda *_: shutdown.begin())
    try:
        rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
        node = Ros2Node(name, shutdown, owns_settings=owns_settings)
    except RuntimeError as error:  # RCLError and others, which have no public names
        sys.stderr.write(f"{name}: {str(error).partition(', at ')[0]}\n")
        sys.exit(2)
    forward_logging(
        (
            # rclpy allows one level for each line of code that logs.
            (logging.CRITICAL, lambda text: node.log.fatal(text)),
            (logging.ERROR, lambda text: node.log.error(text)),
            (logging.WARNING, lambda text: node.log.warning(text)),
            (logging.INFO, lambda text: node.log.info(text)),
        )
    )
    _log_lost_answers()
    try:
        with shutdown.after_mistakes():
            serve(node)
    finally:
        shutdown.begin()
        node.close()
        rclpy.try_shutdown()


class Ros2Node:
    """A `Node` of ROS 2.

    It consists of three, so that none waits for another: services may wait for a step, a step for topics, and those who
    publish them for parameters. Only the one with the parameters and outputs is not hidden.
    """

    last_words = ""

    def __init__(self, name: str, shutdown: Shutdown, *, owns_settings: bool) -> None:
        """Args: owns_settings: whether the settings that all nodes share are parameters of this one."""
        self._owns_settings = owns_settings
        self._shutdown = shutdown
        self._node = RclpyNode(name)
        self._inputs, self._services = (
            RclpyNode(f"_{name}_{part}", start_parameter_services=False, enable_rosout=False)
            for part in ("inputs", "services")
        )
        self._at_once = ReentrantCallbackGroup()
        self._outputs: list[Ros2Output] = []
        self._feedbacks: list[Sender] = []
        self._actions: list[ActionServer] = []
        self._read: dict[str, str] = {}
        """The types of topics that are read, in rclpy's form, unless there was a warning."""
        self._changing: str | None = None
        self._threads: list[threading.Thread] = []
        self.wait_for_shutdown = shutdown.wait
        self.on_shutdown = shutdown.call
        self.end = shutdown.begin
        if not owns_settings:
            self.spin()

    def is_running(self) -> bool:
        """As for all nodes."""
        return not self._shutdown.wait(0.0)

    def spin(self) -> None:
        """Begin to serve: from now on the node answers. A node that owns settings calls this itself."""
        if self._owns_settings:
            self.setting("stamped_cmd_vel", False)  # controllers ask for it
        self._node.add_on_set_parameters_callback(self._judge)
        self._inputs.create_timer(TYPES_S, self._warn_of_types, clock=Clock(clock_type=ClockType.STEADY_TIME))
        executors = EventsExecutor(), EventsExecutor(), MultiThreadedExecutor(SERVICES_AT_ONCE)
        for node, executor in zip((self._node, self._inputs, self._services), executors, strict=True):
            executor.add_node(node)
            self._threads.append(threading.Thread(target=self._spin, args=(executor,), daemon=True))
            self._threads[-1].start()

    def close(self) -> None:
        """End all threads, and leave the network."""
        for thread in self._threads:
            thread.join(CALL_TIMEOUT_S)
        failed = sum(sender.failed for sender in (*(output.sender for output in self._outputs), *self._feedbacks))
        if failed:
            logger.warning("%s could not be sent, because receivers were too slow", counted(failed, "message"))
        for action in self._actions:
            action.destroy()
        for node in (self._services, self._inputs, self._node):
            node.destroy_node()

    @property
    def log(self) -> Any:
        """The logger of rclpy, whose lines go to the console and to /rosout."""
        return self._node.get_logger()

    def setting_name(self, key: str) -> str:
        """As for all nodes."""
        return key if self._has_settings() else f"{SIMULATION} {key}"

    def setting(self, key: str, default: Any) -> Any:
        """As for all nodes; a parameter of the simulation, for which other nodes without a `scenario` wait."""
        return self.parameter(key, default) if self._has_settings() else self._setting_of_simulation(key, default)

    def _has_settings(self) -> bool:
        return self._owns_settings or bool(self.parameter("scenario", ""))

    def parameter(self, name: str, default: Any) -> Any:
        """As for all nodes."""
        key = name.strip("~/")
        if name.startswith("/") and not self._has_settings():
            return self._setting_of_simulation(key, default)
        if self._node.has_parameter(key):
            return _as_text(key, self._node.get_parameter(key).value, default)
        is_text = isinstance(default, str)
        try:
            typed = ParameterDescriptor(dynamic_typing=is_text)
            value = _as_text(key, self._node.declare_parameter(key, default, typed).value, default)
        except InvalidParameterTypeException:
            example = f", such as {default}" if isinstance(default, float) else ""
            raise ParameterError(f"{key}: expected {KINDS[type(default)]}{example}") from None
        ranges = [FloatingPointRange(from_value=0.0, to_value=FASTEST)] if key == "speed" else []
        if ranges and not 0.0 <= value <= FASTEST:
            raise ParameterError(f"{key}: {value:g}; expected 0 to {FASTEST:.0f}")
        kind = self._node.get_parameter(key).type_.value
        descriptor = ParameterDescriptor(
            type=kind, read_only=key != "seed", floating_point_range=ranges, dynamic_typing=is_text
        )
        self._node.set_descriptor(key, descriptor)
        return value

    @cached_property
    def _stamps_commands(self) -> bool:
        """Whether `cmd_vel` is a TwistStamped."""
        return bool(self.setting("stamped_cmd_vel", False))

    def warn_of_unknown_parameters(self) -> None:
        """Warn of what the command line of the simulation sets, but the simulation has not read by now."""
        known = self._node.list_parameters([], 0).names
        for name in given_parameters(sys.argv):
            if name not in known:
                logger.warning("-p %s: there is no such parameter%s", name, suggestion(name, known))

    def change_setting(self, key: str, value: str) -> None:
        """As for all nodes."""
        self._changing = key
        self._node.set_parameters([Parameter(key, value=value)])
        self._changing = None

    def output(self, topic: str, type_name: str, *, latched: bool = False) -> Output:
        """As for all nodes. Raises: ParameterError: its type is not installed, or `qos_overrides` has a wrong value."""
        is_stamped = type_name == TWIST and self._stamps_commands
        type_name = f"{TWIST}Stamped" if is_stamped else type_name
        try:
            self._outputs.append(Ros2Output(self._node, self._full(topic), type_name, latched=latched))
        except (InvalidQosOverridesError, ParameterException, RuntimeError) as error:
            raise ParameterError(f"qos_overrides.{topic}: {error}") from None
        return StampedOutput(self._outputs[-1]) if is_stamped else self._outputs[-1]

    def listen(
        self,
        topic: str,
        type_name: str,
        receive: Callable[[bytes], None],
        *,
        latched: bool = False,
        lossy: bool = False,
        queue_size: int | None = None,
    ) -> None:
        """As for all nodes. A latched topic is received from latching publishers only."""
        profile = quality(latched=latched, lossy=lossy, queue_size=queue_size)
        if type_name == TWIST and self._stamps_commands:
            type_name, receive = f"{TWIST}Stamped", self._unstamped(receive)
        # rclpy inspects the signature, which functions in C need not have.
        self._inputs.create_subscription(
            interface("msg", type_name), topic, lambda data: receive(data), profile, raw=True
        )
        self._read[topic] = type_name.replace("/", "/msg/")

    def _warn_of_types(self) -> None:
        """Warn once of each topic that has a publisher with messages of another type, which do not arrive."""
        found = dict(self._node.get_topic_names_and_types())
        for topic, type_name in list(self._read.items()):
            if len(found.get(topic, ())) > 1:
                sent = {info.topic_type for info in self._node.get_publishers_info_by_topic(topic)} - {type_name}
                if sent:
                    del self._read[topic]
                    hint = ", see stamped_cmd_vel" if TWIST.partition("/")[2] in type_name else ""
                    logger.warning("%s: ignoring %s; expected %s%s", topic, ", ".join(sent), type_name, hint)

    def _unstamped(self, receive: Callable[[bytes], None]) -> Callable[[bytes], None]:
        """Return a receiver of TwistStamped that passes on what it takes for a Twist."""

        def unstamp(data: bytes) -> None:
            try:
                _, message = self.read(f"{TWIST}Stamped", data)
            except ValueError:
                receive(data)  # reports it
            else:
                twist = {"linear": vars(message.twist.linear), "angular": vars(message.twist.angular)}
                receive(message_type(TWIST, installed()).encode(twist))

        return unstamp

    def read(self, type_name: str, data: bytes) -> tuple[int, Any]:
        """As for all nodes."""
        message = message_type(type_name, installed()).decode(data)
        return stamp_ns(message, LATEST_S), message

    def offer(self, name: str, type_name: str, serve: Callable[[Any], Mapping[str, Any]]) -> None:
        """As for all nodes."""

        def respond(request: Any, response: Any) -> Any:
            try:
                return filled(response, serve(request))
            except (ValueError, RobotTeamSimError) as error:  # of a service that has no message for it
                logger.error("%s: %s", name, error)
                return response

        # A service that waits for steps does not keep others from ending the wait.
        self._services.create_service(
            interface("srv", type_name), self._full(name), respond, callback_group=self._at_once
        )

    def offer_action(self, name: str, action: Any, execute: Callable[[Any, Callable[[Any], None]], Any]) -> None:
        """Offer an action whose goals can be cancelled.

        Args: execute: returns the result of a goal; it gets the goal's handle, and what sends feedback.
        """
        feedback = Sender(f"{self._full(name)}/_action/feedback")
        self._feedbacks.append(feedback)
        self._actions.append(
            ActionServer(
                self._services,
                action,
                self._full(name),
                lambda goal: execute(goal, partial(feedback.send, goal.publish_feedback)),
                callback_group=self._at_once,
                cancel_callback=lambda _: CancelResponse.ACCEPT,
            )
        )

    def _full(self, name: str) -> str:
        return name.replace("~", f"{self._node.get_fully_qualified_name()}/")

    def call(self, name: str, type_name: str, request: Mapping[str, Any]) -> Any:
        """As for all nodes."""
        return self._call(name, type_name, request, CALL_TIMEOUT_S)

    def _call(self, name: str, type_name: str, request: Mapping[str, Any], timeout_s: float) -> Any:
        """Return the response; None if the service is not there, or none came in this time."""
        service = interface("srv", type_name)
        client = self._inputs.create_client(service, name)
        try:
            if not client.wait_for_service(WAIT_S):
                return None
            answered = threading.Event()
            future = client.call_async(service.Request(**request))
            future.add_done_callback(lambda _: answered.set())
            deadline_s = time.monotonic() + timeout_s
            while not answered.wait(WAIT_S):
                if not self.is_running() or time.monotonic() > deadline_s:
                    return None
            return future.result()
        finally:
            self._inputs.destroy_client(client)

    def topics(self) -> Collection[str]:
        """As for all nodes."""
        return [name for name, _ in self._node.get_topic_names_and_types()]

    def wait_for_subscribers(self, recorded: Sequence[str], timeout_s: float, sleep: Callable[[float], object]) -> None:
        """As for all nodes; recorders are subscribers as others are."""
        known, waited_s = -1, 0.0
        while known != (now_known := sum(output.receivers for output in self._outputs)) and waited_s < timeout_s:
            known = now_known
            sleep(QUIET_S)
            waited_s += QUIET_S

    def _spin(self, executor: Any) -> None:
        # EventsExecutor.spin() without a timeout waits busily in rclpy 7.1.
        try:
            while self.is_running():
                executor.spin_once(timeout_sec=SPIN_S)
        finally:  # also after an unexpected exception: a node that answers nobody should end
            self._shutdown.begin()
            executor.shutdown()

    def _setting_of_simulation(self, key: str, default: Any) -> Any:
        begin_s, reported = time.monotonic(), False
        while self.is_running():
            answer = self._call(
                f"{SIMULATION}/get_parameters", "rcl_interfaces/GetParameters", {"names": [key]}, ANSWER_S
            )
            if answer is not None:
                value = parameter_value_to_python(answer.values[0]) if answer.values else None
                return default if value is None else _as_text(key, value, default)
            if not reported and time.monotonic() - begin_s > REPORT_TIMEOUT_S:
                logger.warning("waiting for the node %s", SIMULATION)
                reported = True
        return default

    def _judge(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Refuse changes from outside: all nodes would have to follow at the same step."""
        for parameter in parameters:
            if parameter.name == "seed" and self._changing != "seed":
                reason = "call the service ~/reset_seed instead, which starts all nodes again"
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)


def _log_lost_answers() -> None:
    """Have rclpy's warning of a response that cannot be sent in the log, without the line of its source."""
    show = warnings.showwarning

    def shown(message: Warning | str, *where: Any, **more: Any) -> None:
        if (text := str(message)).startswith("failed to send response"):
            logger.warning("%s", text.partition(", at ")[0])
        else:
            show(message, *where, **more)

    warnings.showwarning = shown


def _as_text(key: str, value: Any, default: Any) -> Any:
    """Return a parameter, as text if its default is: a text of digits is a number for ROS. Raises: ParameterError."""
    if isinstance(default, str) and not isinstance(value, str | int | float):
        raise ParameterError(f"{key}: expected {KINDS[str]}")
    return str(value) if isinstance(default, str) else value
