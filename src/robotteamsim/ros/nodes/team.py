"""Where the world gets the robots' commands from: in lockstep, or as they come."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import rospy
from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped

from robotteamsim.geometry import Twist
from robotteamsim.msg import MissionStatus
from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.nodes.commands import STOP, Answers, Commands
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.inbox import Channel, LockstepInbox
from robotteamsim.ros.transport.node import Input, Settings, make_inbox, subscribe
from robotteamsim.scenario.sections import PlacedRobot

FOLLOW_PATIENCE_S = 0.02
"""Flat out, the world waits this long for controllers and mission to follow [s, wall]."""
RESTART_PATIENCE_S = 3.0
"""A reset waits this long for all to have answered the last step [s, wall]."""
START_PATIENCE_S = 60.0
"""Out of lockstep, the world starts without controllers that are not there after this long [s, wall]."""


class _Team:
    """Commands by topic `cmd_vel`."""

    def __init__(self, robots: Sequence[PlacedRobot]) -> None:
        self._commands = Commands([round(robot.cmd_vel_hold_s * 1e9) for robot in robots])
        self._ids = range(len(robots))
        self._now_ns = 0
        self._here: tuple[bool, ...] = (True,) * len(robots)

    def note_who(self, stamp_ns: int, here: tuple[bool, ...]) -> None:
        """Take note of which robots are there in a step: nobody waits for the others, and their commands are void."""
        for robot_id in self._ids:
            if not here[robot_id]:
                self._commands.stop(robot_id)
        self._here = here

    def _listen(self, robot_id: int) -> None:
        """Take the robot's commands from its `cmd_vel`, as they come."""
        subscribe(
            f"/{robot_name(robot_id)}/cmd_vel",
            TwistMessage,
            lambda message: self._take(robot_id, self._now_ns, message),
        )

    def _take(self, robot_id: int, sim_time_ns: int, message: TwistMessage) -> None:
        if not self._commands.put(robot_id, sim_time_ns, conversion.twist(message)):
            rospy.logwarn_throttle(1.0, f"{robot_name(robot_id)}: a command that is not finite is ignored")


class LockstepTeam(_Team):
    """Waits for the answers of all controllers to the last step, and for the mission's verdict on it.

    A robot driven by hand takes its commands from `cmd_vel`; its controller's answers only pace the world.
    """

    def __init__(self, settings: Settings, robots: Sequence[PlacedRobot]) -> None:
        super().__init__(robots)
        self._answers = {robot_id: f"/{robot_name(robot_id)}/cmd_vel_stamped" for robot_id in settings.controlled}
        self._by_hand = [robot_id for robot_id in self._ids if not settings.drives(robot_id)]
        for robot_id in self._by_hand:
            self._listen(robot_id)
        inputs = [
            Input(Channel(topic, may_be_silent=True, robot_id=robot_id), TwistStamped)
            for robot_id, topic in self._answers.items()
        ]
        inputs.append(Input(Channel("/mission/status"), MissionStatus))
        inbox = make_inbox(settings, inputs)
        assert isinstance(inbox, LockstepInbox)
        self._inbox = inbox

    def note_who(self, stamp_ns: int, here: tuple[bool, ...]) -> None:
        """As for all teams."""
        super().note_who(stamp_ns, here)
        self._inbox.note_who(stamp_ns, here)

    def assemble(self) -> None:
        """Wait for nobody: who comes late gets the first step all the same, and the second one waits for all."""

    def twists(self, step_index: int, sim_time_ns: int) -> list[Twist] | None:
        """Return the commands after a step, in id order; None when the node is shutting down."""
        self._now_ns = sim_time_ns
        if step_index == 0:
            return [STOP for _ in self._ids]
        step = self._inbox.take()
        if step is None:
            return None
        twists = []
        for robot_id in self._ids:
            if robot_id not in self._by_hand:
                answer = step.latest(self._answers[robot_id])
                if answer is None:
                    self._commands.stop(robot_id)
                else:
                    self._take(robot_id, sim_time_ns, answer.twist)
            twists.append(self._commands.at(robot_id, sim_time_ns))
        return twists

    def restart(self, sim_time_ns: int) -> None:
        """Begin again with the first step; all have answered the last one."""
        self._inbox.restart()
        self._commands.clear()


class FreeTeam(_Team):
    """Takes the commands that have come. While `follow` says so, controllers and mission get a moment for each step."""

    def __init__(self, settings: Settings, robots: Sequence[PlacedRobot], *, follow: Callable[[], bool]) -> None:
        super().__init__(robots)
        self._follow = follow
        controllers = {f"/{robot_name(robot_id)}/controller": robot_id for robot_id in settings.controlled}
        self._names = {robot_id: name for name, robot_id in controllers.items()}
        self._answers = Answers((*controllers, "/mission") if settings.mission else controllers)
        self._environment = Answers(("/environment",) if settings.mission else ())
        rospy.on_shutdown(self._answers.close)
        rospy.on_shutdown(self._environment.close)
        for robot_id in self._ids:
            self._listen(robot_id)
        for name, robot_id in controllers.items():
            self._listen_to_answers(name, f"/{robot_name(robot_id)}/cmd_vel_stamped", TwistStamped)
        self._listen_to_answers("/mission", "/mission/status", MissionStatus)
        # Latched: it tells that the environment is there; what it says does not matter here.
        subscribe("/voice_map/values", rospy.AnyMsg, lambda _: self._environment.put("/environment", 0))

    def note_who(self, stamp_ns: int, here: tuple[bool, ...]) -> None:
        """As for all teams."""
        if here != self._here:
            self._answers.excuse(name for robot_id, name in self._names.items() if not here[robot_id])
        super().note_who(stamp_ns, here)

    def assemble(self) -> None:
        """Wait until all nodes are there, with patience."""
        for name in self._environment.wait_for(0, START_PATIENCE_S) + self._answers.wait_for(0, START_PATIENCE_S):
            rospy.logwarn(f"starting without {name}")

    def twists(self, step_index: int, sim_time_ns: int) -> list[Twist] | None:
        """Return the commands after a step, in id order; None when the node is shutting down."""
        self._now_ns = sim_time_ns
        if step_index > 0 and self._follow():
            self._answers.wait_for(sim_time_ns, FOLLOW_PATIENCE_S)
        return None if rospy.is_shutdown() else [self._commands.at(robot_id, sim_time_ns) for robot_id in self._ids]

    def restart(self, sim_time_ns: int) -> None:
        """Begin again with the first step, once all have answered the last one: only then do all see time jump back."""
        self._answers.wait_for(sim_time_ns, RESTART_PATIENCE_S)
        self._answers.clear()
        self._commands.clear()

    def _listen_to_answers(self, name: str, topic: str, message_class: type) -> None:
        subscribe(topic, message_class, lambda message: self._answers.put(name, conversion.stamp_ns(message)))
