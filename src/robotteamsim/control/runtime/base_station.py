"""Delivery of discoveries to the base or command centre, for all controllers."""

from collections.abc import Sequence

import msgspec

from robotteamsim.interface import EVERYBODY, Controller, Decision, Discovery, Message, Observation, Task
from robotteamsim.interface.discovery import Kind, acknowledged_in, acknowledgement, announced_in, announcement
from robotteamsim.scenario.scenario import Scenario


def with_base(controller: Controller, robot_id: int, scenario: Scenario) -> Controller:
    """Return the controller of a robot in a scenario that has a base, with what it lacks of the deliveries.

    A class with a true `announces_victims` announces victims itself; only areas are announced for it. For all other
    classes, and with firefighters, areas and victims are announced.

    Args: controller: of the base, see `controls_base`; or of a robot.
    """
    announces_victims = scenario.firefighters is None and announces(controller)
    if announces_victims and not scenario.mission.areas:
        return controller
    if robot_id == scenario.base:
        return Acknowledger(controller, robot_id)
    return Announcer(controller, robot_id, scenario, ("area",) if announces_victims else ("area", "victim"))


def controls_base(controller: object, scenario: Scenario) -> bool:
    """Whether a class of controllers also controls the base, which otherwise stands still.

    With firefighters, the base is the command centre, whose controller sends orders.
    """
    return scenario.firefighters is not None or announces(controller)


def announces(controller: object) -> bool:
    """Whether a controller, or a class of controllers, announces victims itself."""
    return bool(getattr(controller, "announces_victims", False))


class StandingBase:
    """The controller of a base that stands still; its radio forwards messages like any other."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the decision to stand still."""
        return Decision()


class Acknowledger:
    """Runs the base's controller, and broadcasts an acknowledgement of each announcement that the base receives.

    Acknowledgements travel over the network, too, and may be lost.
    """

    def __init__(self, controller: Controller, robot_id: int) -> None:
        self.controller = controller
        self._robot_id = robot_id

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision, with an acknowledgement of each discovery announced in this step."""
        decision = self.controller.step(observation, inbox, task)
        announced = [found for message in inbox for found in announced_in(message.payload)] if task.running else []
        received = list(dict.fromkeys((found.kind, found.name) for found in announced if found.name))
        # The guard reports a result that is not a Decision.
        if not received or not isinstance(decision, Decision):
            return decision
        answers = [Message(self._robot_id, EVERYBODY, acknowledgement(kind, name)) for kind, name in received]
        return msgspec.structs.replace(decision, outbox=(*decision.outbox, *answers))


class Announcer:
    """Runs a robot's controller, and announces the robot's discoveries to the base.

    A discovery is announced in the first step whose task lists it as undelivered, and then every `control.iteration_s`
    until the base's acknowledgement arrives. Both travel over the network.
    """

    def __init__(self, controller: Controller, robot_id: int, scenario: Scenario, kinds: Sequence[Kind]) -> None:
        """Args: kinds: of the discoveries to announce."""
        assert scenario.base is not None, "announcements need a receiver"
        self.controller = controller
        self._robot_id, self._base, self._kinds = robot_id, scenario.base, kinds
        self._period_ns = round(scenario.control.iteration_s * 1e9)
        self._undelivered: tuple[Discovery, ...] = ()
        self._due_ns: dict[Discovery, int] = {}
        """The robot's unacknowledged discoveries, and the time of their next announcement [ns]."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision, with the announcements that are due."""
        names = [acknowledged_in(message.payload) for message in inbox]
        if any(names):  # controllers never see acknowledgements
            inbox = [message for message, name in zip(inbox, names, strict=True) if name is None]
        decision = self.controller.step(observation, inbox, task)
        time_ns = observation.sim_time_ns
        if task.undelivered != self._undelivered:
            new = [found for found in task.undelivered if found not in self._undelivered]
            self._undelivered = task.undelivered
            own = [found for found in new if found.robot_id == self._robot_id and found.kind in self._kinds]
            self._due_ns |= dict.fromkeys(own, time_ns)
        self._due_ns = {found: due for found, due in self._due_ns.items() if (found.kind, found.name) not in names}
        due = [found for found, due_ns in self._due_ns.items() if due_ns <= time_ns]
        # The guard reports a result that is not a Decision.
        if not due or not task.running or not isinstance(decision, Decision):
            return decision
        self._due_ns |= dict.fromkeys(due, time_ns + self._period_ns)
        announced = [Message(self._robot_id, self._base, announcement(found)) for found in due]
        return msgspec.structs.replace(decision, outbox=(*decision.outbox, *announced))
