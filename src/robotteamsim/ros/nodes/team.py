"""The robots' commands for the world: in lockstep, or as they arrive."""

import logging
import time
from collections.abc import Callable, Sequence
from typing import Any

from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped

from robotteamsim.geometry import Twist
from robotteamsim.msg import FloatMap, MissionStatus
from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.nodes.commands import STOP, Answers, Commands
from robotteamsim.ros.nodes.stage import robot_topic
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.checks import reader
from robotteamsim.ros.transport.serialization import message_type
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.ros.transport.synchronizer import Channel, LockstepSynchronizer
from robotteamsim.ros.transport.topics import Input, message_queue, receive_steps
from robotteamsim.scenario.sections import PlacedRobot

FOLLOW_TIMEOUT_S = 0.02
"""As fast as possible, the world waits this long for the answers of controllers and mission [s, wall]."""
RESTART_TIMEOUT_S = 3.0
"""A reset waits this long until all have answered the last step [s, wall]."""
START_TIMEOUT_S = 60.0
"""Without lockstep, the world starts without controllers that have not started after this time [s, wall]."""
WARNING_PERIOD_S = 1.0
"""Wrong commands are reported at most once in this time [s, wall]."""
COMMANDS_KEPT = 100
"""Largest number of commands for a robot within one step; older ones are dropped."""

logger = logging.getLogger(__name__)


class _Team:
    """Commands by topic `cmd_vel`."""

    def __init__(self, settings: Settings, robots: Sequence[PlacedRobot], driven: Sequence[int]) -> None:
        """Args: driven: the robots whose topic `cmd_vel` counts."""
        self._commands = Commands([round(robot.cmd_vel_hold_s * 1e9) for robot in robots])
        self._ids = range(len(robots))
        self._driven = driven
        self._present: tuple[bool, ...] = (True,) * len(robots)
        self._warning_due_s = 0.0
        self.mission_status: Any = None
        """The last status of the mission; None if there is none yet."""
        self._queue = message_queue()
        twist = message_type(TwistMessage)
        for robot_id in driven:
            topic = robot_topic(robot_id, "cmd_vel", prefix=settings.prefix)
            self._queue.subscribe(topic, twist, COMMANDS_KEPT)

    def note_presence(self, stamp_ns: int, present: tuple[bool, ...]) -> None:
        """Set which robots are present in a step: the world does not wait for others, and drops their commands."""
        for robot_id in self._ids:
            if not present[robot_id]:
                self._commands.stop(robot_id)
        self._present = present

    def _receive(self, sim_time_ns: int, timeout_s: float) -> None:
        """Process new messages, waiting for the first one [s, wall]."""
        for index, stamp_ns, data in self._queue.take(timeout_s):
            if index < len(self._driven):
                self._take_command(self._driven[index], sim_time_ns, data)
            else:
                self._take_answer(index - len(self._driven), stamp_ns, data)

    def _take_command(self, robot_id: int, sim_time_ns: int, data: bytes) -> None:
        try:
            twist = conversion.read_twist(data)
        except ValueError as error:
            self._warn(f"{robot_name(robot_id)}: ignoring a command that cannot be read: {error}")
        else:
            self._put(robot_id, sim_time_ns, twist)

    def _take_answer(self, index: int, stamp_ns: int, data: bytes) -> None:
        """Process a message of a topic subscribed to after the commands."""

    def _put(self, robot_id: int, sim_time_ns: int, twist: Twist) -> None:
        if not self._commands.put(robot_id, sim_time_ns, twist):
            self._warn(f"{robot_name(robot_id)}: ignoring a command that is not finite")

    def _warn(self, line: str) -> None:
        if time.monotonic() >= self._warning_due_s:
            self._warning_due_s = time.monotonic() + WARNING_PERIOD_S
            logger.warning("%s", line)


class LockstepTeam(_Team):
    """Waits for the answers of all controllers and of the mission to the last step.

    A robot driven by hand takes its commands from `cmd_vel`; its controller's answers only pace the world.
    """

    def __init__(self, settings: Settings, robots: Sequence[PlacedRobot]) -> None:
        super().__init__(settings, robots, [i for i in range(len(robots)) if not settings.drives(i)])
        self._answers = {robot_id: f"/{robot_name(robot_id)}/cmd_vel_stamped" for robot_id in settings.controlled}
        inputs = [
            Input(Channel(topic, may_be_silent=True, robot_id=i), TwistStamped, conversion.read_twist_stamped)
            for i, topic in self._answers.items()
        ]
        inputs.append(Input(Channel("/mission/status"), MissionStatus))
        self._synchronizer = LockstepSynchronizer(
            [an_input.channel for an_input in inputs],
            step_ns=settings.step_ns,
            silence_limit_s=settings.silence_limit_s,
        )
        self._steps = receive_steps(self._synchronizer, inputs, settings)

    def note_presence(self, stamp_ns: int, present: tuple[bool, ...]) -> None:
        """As for all teams."""
        super().note_presence(stamp_ns, present)
        self._synchronizer.note_presence(stamp_ns, present)

    def assemble(self) -> None:
        """Do not wait: late nodes still receive the first step, and the second step waits for all."""

    def twists(self, step_index: int, sim_time_ns: int) -> list[Twist] | None:
        """Return the commands after a step, in id order; None when the node is shutting down."""
        if step_index == 0:
            return [STOP for _ in self._ids]
        step = self._steps.take()
        if step is None:
            return None
        self.mission_status = step.latest("/mission/status")
        self._receive(sim_time_ns, 0.0)
        twists = []
        for robot_id in self._ids:
            if robot_id not in self._driven:
                answer = step.latest(self._answers[robot_id])
                if answer is None:
                    self._commands.stop(robot_id)
                else:
                    self._put(robot_id, sim_time_ns, answer)
            twists.append(self._commands.at(robot_id, sim_time_ns))
        return twists

    def restart(self, sim_time_ns: int) -> None:
        """Restart with the first step; all have answered the last one."""
        self._synchronizer.restart()
        self._commands.clear()
        self.mission_status = None


class FreeTeam(_Team):
    """Uses the commands that have arrived. If `follow` is true, waits a moment for the answers to each step."""

    def __init__(self, settings: Settings, robots: Sequence[PlacedRobot], *, follow: Callable[[], bool]) -> None:
        super().__init__(settings, robots, range(len(robots)))
        self._follow = follow
        self._reads_status = settings.scenario.moves_people
        self._read_status = reader(MissionStatus, settings)
        self._controllers = {robot_id: f"/{robot_name(robot_id)}/controller" for robot_id in settings.controlled}
        self._answering: list[str] = []
        """Node by the index of its topic."""
        for robot_id, node in self._controllers.items():
            self._subscribe_answers(node, f"/{robot_name(robot_id)}/cmd_vel_stamped", TwistStamped)
        self._environment = Answers(("/environment",) if settings.mission else ())
        self._answers = Answers((*self._controllers.values(), *(("/mission",) if settings.mission else ())))
        if settings.mission:
            self._subscribe_answers("/mission", "/mission/status", MissionStatus)
            # Latched: it shows that the environment has started.
            self._subscribe_answers("/environment", "/voice_map/values", FloatMap)

    def note_presence(self, stamp_ns: int, present: tuple[bool, ...]) -> None:
        """As for all teams."""
        if present != self._present:
            self._answers.excuse(node for robot_id, node in self._controllers.items() if not present[robot_id])
        super().note_presence(stamp_ns, present)

    def assemble(self) -> None:
        """Wait until all nodes have started, up to a limit."""
        missing = self._wait_for(self._environment, 0, START_TIMEOUT_S)
        for name in missing + self._wait_for(self._answers, 0, START_TIMEOUT_S):
            logger.warning("starting without %s", name)

    def twists(self, step_index: int, sim_time_ns: int) -> list[Twist] | None:
        """Return the commands after a step, in id order; None when the node is shutting down."""
        if step_index > 0 and self._follow():
            self._wait_for(self._answers, sim_time_ns, FOLLOW_TIMEOUT_S)
        self._receive(sim_time_ns, 0.0)
        if self._queue.is_closed:
            return None
        return [self._commands.at(robot_id, sim_time_ns) for robot_id in self._ids]

    def restart(self, sim_time_ns: int) -> None:
        """Restart with the first step once all have answered the last one; only then do all see time jump back."""
        self._wait_for(self._answers, sim_time_ns, RESTART_TIMEOUT_S)
        self._answers.clear()
        self._commands.clear()
        self.mission_status = None

    def _subscribe_answers(self, node: str, topic: str, message_class: type) -> None:
        self._answering.append(node)
        self._queue.subscribe(topic, message_type(message_class))

    def _take_answer(self, index: int, stamp_ns: int, data: bytes) -> None:
        node = self._answering[index]
        if node == "/mission" and self._reads_status:
            try:
                self.mission_status = self._read_status(data)
            except ValueError as error:
                self._warn(f"/mission/status: ignoring a message that cannot be read: {error}")
        (self._environment if node == "/environment" else self._answers).put(node, stamp_ns)

    def _wait_for(self, answers: Answers, stamp_ns: int, timeout_s: float) -> list[str]:
        """Wait until a step is answered, with a timeout [s, wall]; return the nodes whose answers are missing."""
        until_s = time.monotonic() + timeout_s
        while (missing := answers.missing(stamp_ns)) and not self._queue.is_closed:
            left_s = until_s - time.monotonic()
            if left_s <= 0.0:
                return missing
            self._receive(stamp_ns, left_s)
        return []
