"""The nodes `controller` and `controllers`: drive one robot or the whole team, simulated or real.

The first runs in its robot's namespace; the second, in the global namespace, hosts the same class for each robot.
"""

from collections.abc import Sequence
from functools import partial

import msgspec
from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import LaserScan

from robotteamsim import _ros_transport as roscpp
from robotteamsim.control import Guard, make_controller
from robotteamsim.control.driving.localisation import body_of
from robotteamsim.geometry import Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.msg import Contact, ControllerStatus, MissionStatus, NetworkMessages, Voice
from robotteamsim.recording import network_messages, ros_messages
from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.nodes.further_inputs import FurtherInputs
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.node import ParameterError, parameter, run
from robotteamsim.ros.transport.presence import PRESENCE, Presence
from robotteamsim.ros.transport.settings import Settings, read_seed, read_settings
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.tf_pose import TfPose, Transforms
from robotteamsim.ros.transport.topics import Input, Output, make_synchronizer, receive_steps, send_enqueued
from robotteamsim.sensing.readings import RobotReading

STATUS = "/mission/status"


def main() -> None:
    """Run the node of one robot, `~robot_id`; its topics are relative."""
    run("controller", _serve_robot)


def main_of_team() -> None:
    """Run the node of all robots; their topics are in their namespaces."""
    run("controllers", _serve_team)


def _serve_robot() -> None:
    settings = read_settings()
    robot_id = parameter("~robot_id", -1)
    if not 0 <= robot_id < settings.num_robots:
        raise ParameterError(f"~robot_id: {robot_id}; expected 0 to {settings.num_robots - 1}")
    transforms = _transforms(settings)
    ControllerNode(settings, [ControllerSlot(settings, robot_id, "", transforms)], transforms).serve()


def _serve_team() -> None:
    settings = read_settings()
    transforms = _transforms(settings)
    slots = [
        ControllerSlot(settings, robot_id, f"/{robot_name(robot_id)}/", transforms)
        for robot_id in range(settings.num_robots)
    ]
    ControllerNode(settings, slots, transforms).serve()


def _transforms(settings: Settings) -> Transforms | None:
    """Return the source of the robots' poses, if that is tf."""
    return roscpp.TransformListener() if settings.scenario.control.localisation == "tf" else None


class ControllerSlot:
    """One robot's controller and its topics, each with `prefix` before its name."""

    def __init__(self, settings: Settings, robot_id: int, prefix: str, transforms: Transforms | None) -> None:
        """Args: transforms: where the robot's pose comes from; None if it comes with its topics."""
        self._robot_id = robot_id
        self._make = conversion.RosTypes()
        control = settings.scenario.control
        self._by_truth = control.localisation == "ground_truth"
        self._tf = None if transforms is None else TfPose(transforms, robot_name(robot_id), control.tf_timeout_s)
        self._odom, self._scan, self._truth = (
            f"{prefix}{name}" for name in ("odom", "base_scan", "base_pose_ground_truth")
        )
        self._contact, self._voice, self._received = (f"{prefix}{name}" for name in ("contact", "voice", "network/rx"))
        robot = body_of(robot_id, settings.scenario)
        self._beams = robot.laser.beams
        self._further = FurtherInputs(robot, prefix, settings.step_ns, robot_id, settings.scenario.fire)
        self._arrival = 1
        """Number of the robot's arrivals, including the start."""
        self.build(settings)
        latched = settings.lockstep
        self._answer = Output(f"{prefix}cmd_vel_stamped", TwistStamped, latched=True)
        self._messages = Output(f"{prefix}network/tx", NetworkMessages, latched=latched)
        self._status = Output(f"{prefix}controller/status", ControllerStatus, latched=latched)
        self._belief = Output(f"{prefix}controller/belief", OccupancyGrid, latched=True)
        self._command = Output(f"{prefix}cmd_vel", TwistMessage) if settings.drives(robot_id) else None

    @property
    def inputs(self) -> list[Input]:
        """The topics that the controller needs."""
        of_robot = partial(Channel, robot_id=self._robot_id)
        truth = Input(of_robot(self._truth, needed=self._by_truth), Odometry, conversion.read_odometry)
        return [
            Input(of_robot(self._odom, needed=True), Odometry, conversion.read_odometry),
            Input(of_robot(self._scan, needed=True), LaserScan, partial(conversion.read_ranges_m, beams=self._beams)),
            *([truth] if self._tf is None else []),
            Input(of_robot(self._contact), Contact, conversion.read_contact),
            Input(of_robot(self._voice, needed=True), Voice, conversion.read_voice),
            Input(of_robot(self._received), NetworkMessages),
            *self._further.inputs,
        ]

    def build(self, settings: Settings) -> None:
        """Create the controller, or create it again."""
        self._decision = Decision()
        if self._tf is not None:
            self._tf.restart()
        self._further.restart()
        make = partial(make_controller, self._robot_id, settings.scenario, self._arrival)
        self._controller = Guard(self._robot_id, settings.num_robots, make)

    def is_occupied(self, presence: Presence, settings: Settings) -> bool:
        """Return whether the robot is present; if it has arrived (again), its controller is created again."""
        if presence.arrivals is not None and presence.arrivals[self._robot_id] != self._arrival:
            self._arrival = presence.arrivals[self._robot_id]
            self.build(settings)
        return presence.is_present(self._robot_id)

    def announce(self) -> None:
        """Publish that the controller has started, before it answers any step."""
        self._answer.publish(ros_messages.twist_stamped(self._make, 0, self._robot_id, Decision().twist))

    def step(self, step: Step, task: Task) -> None:
        """Pass the inputs to the controller, and publish its decision; without a pose the robot stands still."""
        if self._tf is not None:
            lost = self._tf.follow(step.stamp_ns)
            if lost or self._tf.newest is None:
                standing = msgspec.structs.replace(self._decision, twist=Twist(), outbox=(), fault=lost)
                self._publish(step.stamp_ns, standing)
                return
        inbox = conversion.network_messages(step.messages[self._received])
        self._decision = self._controller.step(self._observation(step), inbox, task)
        self._publish(step.stamp_ns, self._decision)

    def _observation(self, step: Step) -> Observation:
        odometry = step.latest(self._odom)
        # A real robot that navigates by odometry or tf has no ground truth.
        ground_truth = step.latest(self._truth) or odometry
        pose = ground_truth.pose if self._tf is None else self._tf.newest
        assert pose is not None
        contact = step.latest(self._contact) or conversion.NO_CONTACT
        robot = RobotReading.of(
            ground_truth=pose,
            twist=ground_truth.twist,
            odometry=odometry,
            ranges_m=step.latest(self._scan),
            in_contact=contact.in_contact,
            contact_angles_rad=contact.angles_rad,
            further=self._further.reading(step),
        )
        return Observation(self._robot_id, step.stamp_ns, robot, step.latest(self._voice))

    def _publish(self, time_ns: int, decision: Decision) -> None:
        make = self._make
        self._answer.enqueue(ros_messages.twist_stamped(make, time_ns, self._robot_id, decision.twist))
        if self._messages.wanted:
            self._messages.enqueue(network_messages.network_messages(make, time_ns, decision.outbox))
        if self._status.wanted:
            self._status.enqueue(ros_messages.controller_status(make, time_ns, self._robot_id, decision))
        if decision.belief is not None:
            self._belief.enqueue(ros_messages.field_map_picture(make, time_ns, decision.belief))
        if self._command is not None and self._command.wanted:
            self._command.enqueue(ros_messages.twist(make, decision.twist))
        send_enqueued()


class ControllerNode:
    """Steps the controllers of its slots with the robots' readings and messages."""

    def __init__(
        self, settings: Settings, slots: Sequence[ControllerSlot], transforms: Transforms | None = None
    ) -> None:
        self._settings = settings
        self._slots = slots
        self._transforms = transforms
        self._task = Task()
        self._presence = Presence()
        status = Input(Channel(STATUS, of_last_step=True), MissionStatus)
        inputs = [*(an_input for slot in slots for an_input in slot.inputs), PRESENCE, status]
        self._steps = receive_steps(make_synchronizer(settings, inputs), inputs, settings)
        for slot in slots:
            slot.announce()

    def serve(self) -> None:
        """Step until the node is shut down."""
        while (step := self._steps.take()) is not None:
            if step.restarted:
                self._settings = read_seed(self._settings)
                self._task = Task()
                if self._transforms is not None:
                    self._transforms.clear()
                for slot in self._slots:
                    slot.build(self._settings)
            status = step.latest(STATUS)
            if status is not None:
                self._task = conversion.task(status)
            self._presence.follow(step)
            for slot in self._slots:
                if slot.is_occupied(self._presence, self._settings):
                    slot.step(step, self._task)
