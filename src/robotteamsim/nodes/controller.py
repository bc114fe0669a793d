"""Drives one robot or the whole team, simulated or real: the nodes `controller` and `controllers`."""

import logging
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import msgspec

from robotteamsim.control import Guard, make_controller
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.message_parts import robot_name
from robotteamsim.network.messages import Message
from robotteamsim.nodes.inputs import Input, RobotInputs
from robotteamsim.nodes.node import Node, ParameterError
from robotteamsim.nodes.outputs import Decided, decision_outputs
from robotteamsim.nodes.scan_check import ScanCheck
from robotteamsim.nodes.settings import OTHERS_REPORT_S, Settings, read_seed, read_settings
from robotteamsim.nodes.steps import Step, Steps
from robotteamsim.nodes.tf_pose import TfPose
from robotteamsim.nodes.transforms import Transforms
from robotteamsim.recording.topics.decisions import STAMPED_COMMAND
from robotteamsim.recording.topics.mission import MISSION_STATUS
from robotteamsim.recording.topics.radio import INBOX, VOICE
from robotteamsim.recording.topics.world import ROBOTS, TeamPresence
from robotteamsim.sensing.readings import RobotReading

logger = logging.getLogger(__name__)


def serve_robot(node: Node) -> None:
    """Drive one robot, `~robot_id`, until the node is shut down. Raises: ParameterError, ScenarioError."""
    settings = read_settings(node)
    robot_id = node.parameter("~robot_id", -1)
    if not 0 <= robot_id < settings.num_robots:
        raise ParameterError(f"~robot_id: {robot_id}; expected 0 to {settings.num_robots - 1}")
    try:
        controller = TeamController(node, settings, [robot_id])
    except RobotTeamSimError:
        if robot_id > 0:  # the same mistake for robot 0 is reported at once, and ends the launch
            node.wait_for_shutdown(OTHERS_REPORT_S)
        raise
    controller.serve()


def serve_team(node: Node) -> None:
    """Drive all robots until the node is shut down. Raises: ParameterError, ScenarioError."""
    settings = read_settings(node)
    TeamController(node, settings, range(settings.num_robots)).serve()


class ControllerSlot:
    """One robot's controller and its topics."""

    def __init__(self, node: Node, settings: Settings, robot_id: int, transforms: Transforms | None) -> None:
        """Args: transforms: where the robot's pose comes from; None if it comes with its topics."""
        self.robot_id = robot_id
        control = settings.scenario.control
        self._tf = None if transforms is None else TfPose(transforms.newest, robot_name(robot_id), control.tf_timeout_s)
        self._scan_check: ScanCheck | None = None
        if self._tf is not None:
            laser = settings.setup.robots[robot_id].laser
            smoke = settings.scenario.fire is not None
            self._scan_check = ScanCheck(robot_name(robot_id), settings.scenario.plan, laser, smoke)
        self._sensors = RobotInputs(node, settings, robot_id)
        self._voice, self._received = (Input.of(node, topic, settings, robot_id) for topic in (VOICE, INBOX))
        self._outputs = decision_outputs(node, settings, [robot_id])
        self._arrival = 1
        """Number of the robot's arrivals, including the start."""
        sensors = self._sensors
        is_elsewhere = robot_id in settings.elsewhere
        truth = () if self._tf is not None else (sensors.truth,)
        own = [sensors.odometry, sensors.scan, *truth]
        others = [sensors.contact, *sensors.additional]
        self.of_step = [self._voice, self._received, *([] if is_elsewhere else [*own, *others])]
        """Topics with the stamps of the steps."""
        self.newest = [*own, *others] if is_elsewhere else []
        """Topics of another world, with stamps of their own."""
        needs_truth = control.localisation == "ground_truth"
        self.needed = [one.topic for one in own if is_elsewhere and (needs_truth or one is not sensors.truth)]
        """Those among them that each step needs."""
        self.build(settings)

    def announce(self) -> None:
        """Publish that the controller has started, before it answers any step."""
        begin = Decided(0, {self.robot_id: True}, {self.robot_id: Decision()}, {})
        self._outputs.publish(begin, only=STAMPED_COMMAND)

    def build(self, settings: Settings) -> None:
        """Create the controller, or create it again."""
        self._decision = Decision()
        if self._tf is not None:
            self._tf.restart()
        if self._scan_check is not None:
            self._scan_check.restart()
        make = partial(make_controller, self.robot_id, settings.setup, self._arrival)
        self._controller = Guard(self.robot_id, settings.num_robots, make)

    def is_occupied(self, presence: TeamPresence, settings: Settings) -> bool:
        """Return whether the robot is present; if it has arrived (again), its controller is created again."""
        arrivals = presence.arrivals[self.robot_id]
        if presence.present[self.robot_id] and arrivals != self._arrival:
            self._arrival = arrivals
            self.build(settings)
        return presence.present[self.robot_id]

    def step(self, step: Step, values: Mapping[str, Any], task: Task) -> None:
        """Pass the inputs to the controller, and publish its decision; without a pose the robot stands still."""
        pose: PoseReading | None = None
        if self._tf is not None:
            lost = self._tf.follow(step.stamp_ns)
            pose = self._tf.newest
            if lost or pose is None:
                standing = msgspec.structs.replace(self._decision, twist=Twist(), outbox=(), fault=lost)
                self._publish(step.stamp_ns, standing, None)
                return
        reading = self._sensors.reading(values, pose)
        if self._scan_check is not None and pose is not None:
            line = self._scan_check.follow(step.stamp_ns, pose, reading.ranges_m)
            if line:
                logger.warning("%s", line)
        observation = Observation(self.robot_id, step.stamp_ns, reading, values[self._voice.topic])
        self._decision = self._controller.step(observation, self._inbox(step), task)
        self._publish(step.stamp_ns, self._decision, reading)

    def _publish(self, stamp_ns: int, decision: Decision, reading: RobotReading | None) -> None:
        i = self.robot_id
        self._outputs.publish(Decided(stamp_ns, {i: True}, {i: decision}, {} if reading is None else {i: reading}))

    def _inbox(self, step: Step) -> list[Message]:
        topic = self._received.topic
        return [message for values in step.each for message in values.get(topic, ())]


class TeamController:
    """Steps the controllers of its slots with the robots' readings and messages."""

    def __init__(self, node: Node, settings: Settings, robot_ids: Sequence[int]) -> None:
        self._node = node
        self._settings = settings
        self._transforms = Transforms(node) if settings.by_tf else None
        self._slots = [ControllerSlot(node, settings, robot_id, self._transforms) for robot_id in robot_ids]
        self._newest: dict[str, Any] = {}
        self._task = Task()
        self._steps = Steps(ROBOTS.name, self._missing, logger.warning)
        node.on_shutdown(self._steps.close)
        Input.of(node, ROBOTS, settings).listen(self._steps.add)
        Input.of(node, MISSION_STATUS, settings).listen(self._add_task)
        for slot in self._slots:
            for one in slot.of_step:
                one.listen(self._steps.add)
            for one in slot.newest:
                one.listen(self._keep)
        for slot in self._slots:
            slot.announce()

    def serve(self) -> None:
        """Step until the node is shut down."""
        while (step := self._steps.take()) is not None:
            if step.restarted:
                self._settings = read_seed(self._node, self._settings)
                if self._transforms is not None:
                    self._transforms.clear()
                for slot in self._slots:
                    slot.build(self._settings)
            if self._settings.lockstep:
                self._task = step.values.get(MISSION_STATUS.name, Task())
            values = {**self._newest, **step.values}
            for slot in self._slots:
                if slot.is_occupied(step.values[ROBOTS.name], self._settings):
                    slot.step(step, values, self._task)

    def _missing(self, stamp_ns: int, values: Mapping[str, Any]) -> list[str]:
        presence: TeamPresence | None = values.get(ROBOTS.name)
        if presence is None:
            return [ROBOTS.name]
        missing = [
            one.topic
            for slot in self._slots
            if presence.present[slot.robot_id]
            for one in slot.of_step
            if one.topic not in values and one.is_due(stamp_ns)
        ]
        missing += [topic for slot in self._slots for topic in slot.needed if topic not in self._newest]
        # The task is that of the step before.
        if self._settings.lockstep and stamp_ns > self._settings.step_ns and MISSION_STATUS.name not in values:
            missing.append(MISSION_STATUS.name)
        return missing

    def _add_task(self, topic: str, stamp_ns: int, value: Any) -> None:
        if self._settings.lockstep:
            self._steps.add(topic, stamp_ns + self._settings.step_ns, value)
        else:
            self._task = value

    def _keep(self, topic: str, stamp_ns: int, value: Any) -> None:
        self._newest[topic] = value
