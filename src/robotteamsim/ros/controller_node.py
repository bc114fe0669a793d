"""The node `controller`: drives one robot. It runs in the robot's namespace, in simulation or on a real robot."""

from __future__ import annotations

from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from robotteamsim.control import make_controller
from robotteamsim.control.controller import Decision, Task
from robotteamsim.msg import Contact, ControllerStatus, MissionStatus, NetworkMessages, Voice
from robotteamsim.network.messages import Message
from robotteamsim.recording import message_fields as fields
from robotteamsim.ros import msg_conversion as conversion
from robotteamsim.ros.inbox import Channel, Step
from robotteamsim.ros.node import (
    Input,
    Output,
    ParameterError,
    Settings,
    make_inbox,
    parameter,
    read_seed,
    read_settings,
    run,
)
from robotteamsim.sensing.readings import Observation, RobotReading

GROUND_TRUTH = "base_pose_ground_truth"
STATUS = "/mission/status"


def main() -> None:
    """Run the node."""
    run("controller", lambda: ControllerNode(read_settings()).serve())


class ControllerNode:
    """Steps one robot's controller by what the robot senses and what reaches it over the network."""

    def __init__(self, settings: Settings) -> None:
        self._robot_id = parameter("~robot_id", -1)
        if not 0 <= self._robot_id < settings.num_robots:
            raise ParameterError(f"~robot_id: {self._robot_id}; wanted 0 to {settings.num_robots - 1}")
        self._settings = settings
        self._make = conversion.RosTypes()
        self._build()
        self._inbox = make_inbox(settings, self._inputs())
        latched = settings.lockstep
        self._answer = Output("cmd_vel_stamped", TwistStamped, latched=True)
        self._messages = Output("network/tx", NetworkMessages, latched=latched)
        self._status = Output("controller/status", ControllerStatus, latched=latched)
        self._command = Output("cmd_vel", TwistMessage) if settings.drives(self._robot_id) else None
        # An answer to no step yet: it says that the controller is there.
        self._answer.publish(fields.twist_stamped(self._make, 0, self._robot_id, Decision().twist))

    def serve(self) -> None:
        """Step until the node is shut down."""
        while (step := self._inbox.take()) is not None:
            if step.restarted:
                self._settings = read_seed(self._settings)
                self._build()
            self._controller.observe(self._observation(step), self._received(step), self._task_of(step))
            self._publish(step.stamp_ns, self._controller.decide())

    def _inputs(self) -> list[Input]:
        by_truth = self._settings.scenario.control.localisation == "ground_truth"
        return [
            Input(Channel("odom", needed=True), Odometry),
            Input(Channel("base_scan", needed=True), LaserScan),
            Input(Channel(GROUND_TRUTH, needed=by_truth), Odometry),
            Input(Channel("contact"), Contact),
            Input(Channel("voice", needed=True), Voice),
            Input(Channel("network/rx"), NetworkMessages),
            Input(Channel(STATUS, of_last_step=True), MissionStatus),
        ]

    def _build(self) -> None:
        self._controller = make_controller(self._robot_id, self._settings.scenario)
        self._task = Task()

    def _observation(self, step: Step) -> Observation:
        odometry = conversion.odometry_reading(step.latest("odom"))
        # A real robot that navigates by odometry has no ground truth.
        truth = step.latest(GROUND_TRUTH)
        ground_truth = odometry if truth is None else conversion.odometry_reading(truth)
        contact = step.latest("contact")
        robot = RobotReading(
            ground_truth=ground_truth.pose,
            twist=ground_truth.twist,
            odometry=odometry,
            ranges_m=conversion.ranges_m(step.latest("base_scan")),
            in_contact=contact is not None and contact.in_contact,
            contact_angles_rad=() if contact is None else tuple(contact.angles_rad),
        )
        return Observation(self._robot_id, step.stamp_ns, robot, conversion.voice_reading(step.latest("voice")))

    def _received(self, step: Step) -> list[Message]:
        return [
            received for message in step.messages["network/rx"] for received in conversion.network_messages(message)
        ]

    def _task_of(self, step: Step) -> Task:
        status = step.latest(STATUS)
        if status is not None:
            self._task = conversion.task(status)
        return self._task

    def _publish(self, time_ns: int, decision: Decision) -> None:
        make = self._make
        self._answer.publish(fields.twist_stamped(make, time_ns, self._robot_id, decision.twist))
        if self._messages.wanted:
            self._messages.publish(fields.network_messages(make, time_ns, decision.outbox))
        if self._status.wanted:
            self._status.publish(fields.controller_status(make, time_ns, self._robot_id, decision))
        if self._command is not None and self._command.wanted:
            self._command.publish(fields.twist(make, decision.twist))
