"""The node `mission`: judges the mission, reports it, and ends the launch with it."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from rich.console import Console
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

from robotteamsim.interface import Decision
from robotteamsim.mission.status import Event
from robotteamsim.msg import (
    Areas,
    Contact,
    ControllerStatus,
    Doors,
    MissionEvent,
    MissionStatus,
    NetworkMessages,
    NetworkState,
    Victims,
    Voice,
)
from robotteamsim.recording import ResultWriter, TumWriter, ros_messages
from robotteamsim.recording.table import print_result
from robotteamsim.ros.nodes.requests import problem_of_door, problem_of_noise, problem_of_victim
from robotteamsim.ros.nodes.trial import Trial
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.node import parameter, run, wait_for_shutdown
from robotteamsim.ros.transport.presence import PRESENCE, Presence
from robotteamsim.ros.transport.services import Service
from robotteamsim.ros.transport.settings import Settings, read_seed, read_settings
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.topics import Input, Output, make_synchronizer, receive_steps
from robotteamsim.sensing.readings import NOT_THERE, NOTHING_HEARD, RobotReading, VoiceReading
from robotteamsim.simulation import Observer
from robotteamsim.srv import (
    SetDoor,
    SetDoorRequest,
    SetDoorResponse,
    SetNoise,
    SetNoiseRequest,
    SetNoiseResponse,
    SetVictim,
    SetVictimRequest,
    SetVictimResponse,
)

logger = logging.getLogger(__name__)

FAREWELL_S = 0.5
"""The last messages get this long to reach recorders before the node, and with it the launch, ends [s, wall]."""
NETWORK = "/network/state"
DOORS = "/world/doors"

_NO_RANGES = np.zeros(0, dtype=np.float32)


def main() -> None:
    """Run the node."""
    run("mission", lambda: MissionNode(read_settings()).serve())


class RobotInputs:
    """The topics of one robot that the mission needs."""

    def __init__(self, robot_id: int) -> None:
        name = ros_messages.robot_name(robot_id)
        self._robot_id = robot_id
        self.ground_truth = f"/{name}/base_pose_ground_truth"
        self.contact = f"/{name}/contact"
        self.voice = f"/{name}/voice"
        self.status = f"/{name}/controller/status"

    def inputs(self, controlled: bool) -> list[Input]:
        """Return the inputs; a robot without a controller publishes no decisions."""
        mine = partial(Channel, robot_id=self._robot_id)
        inputs = [
            Input(mine(self.ground_truth, needed=True), Odometry, conversion.read_odometry),
            Input(mine(self.contact), Contact),
            Input(mine(self.voice, needed=True), Voice),
        ]
        if controlled:
            inputs.append(Input(mine(self.status, may_be_silent=True), ControllerStatus))
        return inputs

    def reading(self, step: Step) -> RobotReading:
        """Return what the mission knows of the robot's senses: no odometry of its own, and no ranges."""
        truth = step.latest(self.ground_truth)
        contact = step.latest(self.contact)
        return RobotReading(truth.pose, truth.twist, truth, _NO_RANGES, contact is not None and contact.in_contact)

    def heard(self, step: Step) -> VoiceReading:
        """Return what the robot hears."""
        return conversion.voice_reading(step.latest(self.voice))

    def decision(self, step: Step) -> Decision:
        """Return what is published of the robot's decision."""
        status = step.latest(self.status) if self.status in step.messages else None
        return Decision() if status is None else conversion.decision(status)


class MissionNode:
    """Steps the mission by what the other nodes publish; recorders observe it."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._make = conversion.RosTypes()
        self._stays = parameter("~stays", False)
        out = parameter("~out", "")
        self._folder = Path(out).expanduser() if out else None
        self._robots = [RobotInputs(robot_id) for robot_id in range(settings.num_robots)]
        base = settings.scenario.mission.base
        self._base = base
        self._base_received = "" if base is None else f"/{ros_messages.robot_name(base)}/network/rx"
        self._presence = Presence()
        self._trial_lock = threading.Lock()
        self._trial = self._begin_trial()
        inputs = self._inputs()
        self._steps = receive_steps(make_synchronizer(settings, inputs), inputs, settings)
        self._events = Output("/mission/events", MissionEvent)
        self._victims = Output("/mission/victims", Victims, latched=True)
        self._areas = Output("/mission/areas", Areas, latched=True)
        self._status = Output("/mission/status", MissionStatus, latched=True)
        self._published: tuple[Any, ...] = ()
        self._publish(0, ())
        self._offer_services()

    def serve(self) -> None:
        """Step until the mission has ended (or on, if it is to stay), or the node is shut down."""
        try:
            while (step := self._steps.take()) is not None:
                if step.restarted:
                    logger.warning(
                        "simulated time has jumped back to %.1f s: the mission starts again", step.stamp_ns / 1e9
                    )
                    with self._trial_lock:
                        self._trial.abandon()
                        self._settings = read_seed(self._settings)
                        self._trial = self._begin_trial()
                running = self._trial.result is None
                self._step(step)
                if running and self._trial.result is not None:
                    self._report()
                    if not self._stays:
                        wait_for_shutdown(FAREWELL_S)
                        return
        finally:
            self._trial.abandon()

    def _inputs(self) -> list[Input]:
        controlled = self._settings.controlled
        inputs = [an_input for i, topics in enumerate(self._robots) for an_input in topics.inputs(i in controlled)]
        doors = [Input(Channel(DOORS), Doors)] if self._settings.scenario.plan.doors else []
        base = (
            [Input(Channel(self._base_received, robot_id=self._base), NetworkMessages)] if self._base_received else []
        )
        return [*inputs, *doors, *base, PRESENCE, Input(Channel(NETWORK, needed=True), NetworkState)]

    def _begin_trial(self) -> Trial:
        recorders: list[Observer] = []
        if self._folder is not None:
            # mission.json comes last: where it is, the rest is complete.
            recorders = [TumWriter(self._folder / "trajectories"), ResultWriter(self._folder)]
        return Trial(self._settings.scenario, recorders)

    def _step(self, step: Step) -> None:
        self._presence.follow(step)
        present = self._presence.present
        robots = [(topics, self._presence.is_present(robot_id)) for robot_id, topics in enumerate(self._robots)]
        readings = tuple(topics.reading(step) if is_present else NOT_THERE for topics, is_present in robots)
        voices = tuple(topics.heard(step) if is_present else NOTHING_HEARD for topics, is_present in robots)
        decisions = tuple(topics.decision(step) if is_present else Decision() for topics, is_present in robots)
        network = conversion.network_state(step.latest(NETWORK))
        message = step.latest(DOORS) if self._settings.scenario.plan.doors else None
        doors = None if message is None else conversion.door_states(message)
        received = step.messages[self._base_received] if self._base_received else ()
        base_inbox = [received_by_base for one in received for received_by_base in conversion.network_messages(one)]
        with self._trial_lock:
            events = self._trial.step(step.stamp_ns, readings, voices, network, decisions, doors, base_inbox, present)
        self._publish(step.stamp_ns, events)

    def _publish(self, time_ns: int, events: Sequence[Event]) -> None:
        make, scenario = self._make, self._settings.scenario
        # One moment of the mission: services change it meanwhile.
        with self._trial_lock:
            mission = self._trial.mission
            status, victims, noise_db = mission.status, mission.victims, mission.noise_db
        self._status.publish(ros_messages.mission_status(make, time_ns, scenario.name, status, noise_db))
        for event in events:
            self._events.publish(ros_messages.mission_event(make, time_ns, event))
            logger.info("%.1f s: %s", event.time_s, event.detail)
        shown = (victims, status.victims, status.explored, status.target_area)
        if shown != self._published:
            self._published = shown
            self._victims.publish(ros_messages.victims(make, time_ns, victims, status.victims))
            self._areas.publish(ros_messages.areas(make, time_ns, scenario.mission.areas, status))

    def _report(self) -> None:
        result = self._trial.result
        assert result is not None
        written = [self._folder] if self._folder is not None else []
        print_result(Console(), self._settings.scenario, result, self._trial.events, written)

    def _offer_services(self) -> None:
        actions = ("start", "pause", "resume", "abort")
        self._services = (
            *(Service(f"/mission/{name}", Trigger, self._server_of(name)) for name in actions),
            Service("/mission/set_door", SetDoor, self._serve_set_door),
            Service("/mission/set_noise", SetNoise, self._serve_set_noise),
            Service("/mission/set_victim", SetVictim, self._serve_set_victim),
        )

    def _server_of(self, name: str) -> Callable[[TriggerRequest], TriggerResponse]:
        def serve(_: TriggerRequest) -> TriggerResponse:
            with self._trial_lock:
                mission = self._trial.mission
                before = mission.status.state
                getattr(mission, name)()
                after = mission.status.state
            return TriggerResponse(success=before != after, message=f"the mission is {after}")

        return serve

    def _serve_set_door(self, request: SetDoorRequest) -> SetDoorResponse:
        if problem := problem_of_door(self._settings.scenario, request.name):
            return SetDoorResponse(success=False, message=problem)
        with self._trial_lock:
            self._trial.mission.set_door(request.name, request.closed)
        return SetDoorResponse(success=True, message="")

    def _serve_set_noise(self, request: SetNoiseRequest) -> SetNoiseResponse:
        if problem := problem_of_noise(request.noise_db):
            return SetNoiseResponse(success=False, message=problem)
        with self._trial_lock:
            self._trial.mission.set_noise_db(request.noise_db)
        return SetNoiseResponse(success=True, message="")

    def _serve_set_victim(self, request: SetVictimRequest) -> SetVictimResponse:
        position_m = (request.position.x, request.position.y)
        if problem := problem_of_victim(self._settings.scenario, request.name, position_m):
            return SetVictimResponse(success=False, message=problem)
        with self._trial_lock:
            self._trial.mission.set_victim(request.name, position_m)
        return SetVictimResponse(success=True, message="")
