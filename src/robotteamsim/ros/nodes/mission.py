"""The node `mission`: judges the mission, publishes its status, and ends the launch when it ends."""

import logging
import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

from robotteamsim import msg, srv
from robotteamsim.interface import Decision
from robotteamsim.mission.status import Event
from robotteamsim.network.compact import LinksDecoder
from robotteamsim.network.messages import NetworkState
from robotteamsim.recording import ResultWriter, TumWriter, ros_messages
from robotteamsim.recording.table import print_totals
from robotteamsim.ros.nodes.hazards import HazardInputs
from robotteamsim.ros.nodes.requests import check_door, check_noise, check_victim
from robotteamsim.ros.nodes.trial import Trial
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.checks import reader
from robotteamsim.ros.transport.node import parameter, run, wait_for_shutdown
from robotteamsim.ros.transport.presence import PRESENCE, Presence
from robotteamsim.ros.transport.services import Service, command
from robotteamsim.ros.transport.settings import Settings, read_seed, read_settings
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.team_poses import TEAM_STATE, TeamPoses, team_poses
from robotteamsim.ros.transport.topics import Input, Output, make_synchronizer, receive_steps
from robotteamsim.sensing.readings import NOT_THERE, NOTHING_HEARD, RobotReading
from robotteamsim.simulation import Observer

logger = logging.getLogger(__name__)

FAREWELL_S = 0.5
"""Time for the last messages to reach recorders before the node, and with it the launch, ends [s, wall]."""
LAST_WORDS = (
    "The mission has ended, and this ends the launch. roslaunch reports it in red, as 'REQUIRED process [mission] has "
    "died'; this is the normal end."
)
LINKS = "/network/links"
VOICES = "/environment/voices"
DOORS = "/world/doors"
PEOPLE = "/world/people"

_NO_RANGES = np.zeros(0, dtype=np.float32)


def main() -> None:
    """Run the node."""
    run("mission", lambda: MissionNode(read_settings()).serve())


class RobotInputs:
    """The topics of one robot that the mission needs."""

    def __init__(self, robot_id: int, poses: TeamPoses, settings: Settings) -> None:
        name = ros_messages.robot_name(robot_id)
        self._robot_id = robot_id
        self._poses = poses
        self._lockstep = settings.lockstep
        self._team_state = settings.team_state
        self._decision = Decision()
        self.contact = f"/{name}/contact"
        self.status = f"/{name}/controller/status"

    def inputs(self, controlled: bool) -> list[Input]:
        """Return the inputs; a robot without a controller publishes no decisions."""
        mine = partial(Channel, robot_id=self._robot_id)
        inputs = self._poses.inputs(self._robot_id)
        if not self._team_state:
            inputs.append(Input(mine(self.contact), msg.Contact, conversion.read_contact))
        if controlled:
            inputs.append(Input(mine(self.status, may_be_silent=True), msg.ControllerStatus))
        return inputs

    def reading(self, step: Step) -> RobotReading:
        """Return the readings of the robot for the mission, without odometry and ranges."""
        found = self._poses.reading(self._robot_id)
        if self._team_state:
            in_contact = bool(step.latest(TEAM_STATE).in_contact[self._robot_id])
        else:
            in_contact = (step.latest(self.contact) or conversion.NO_CONTACT).in_contact
        return RobotReading.of(found.pose, found.twist, found, _NO_RANGES, in_contact)

    def decision(self, step: Step) -> Decision:
        """Return the published part of the robot's decision; without lockstep that of the newest message."""
        status = step.latest(self.status)
        if status is not None:
            self._decision = conversion.decision(status)
        elif self._lockstep:
            self._decision = Decision()
        return self._decision

    def forget(self) -> None:
        """Forget the last decision, because the robot is absent or time has jumped back."""
        self._decision = Decision()


class MissionNode:
    """Steps the mission with the messages of the other nodes; recorders observe it."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._make = conversion.RosTypes()
        self._stays = parameter("~stays", False)
        out = parameter("~out", "")
        self._folder = Path(out).expanduser() if out else None
        self._poses = team_poses(settings)
        self._robots = [RobotInputs(robot_id, self._poses, settings) for robot_id in range(settings.num_robots)]
        base = settings.scenario.base
        self._base = base
        self._base_received = "" if base is None else f"/{ros_messages.robot_name(base)}/network/rx"
        self._presence = Presence()
        self._hazards = HazardInputs(settings)
        self._people = conversion.PeopleReader()
        self._trial_lock = threading.Lock()
        self._trial = self._begin_trial()
        inputs = self._inputs()
        self._steps = receive_steps(make_synchronizer(settings, inputs), inputs, settings)
        self._events = Output("/mission/events", msg.MissionEvent)
        self._victims = Output("/mission/victims", msg.Victims, latched=True)
        self._areas = Output("/mission/areas", msg.Areas, latched=True)
        self._status = Output("/mission/status", msg.MissionStatus, latched=True)
        self._published: tuple[Any, ...] = ()
        self._publish(0, ())
        self._offer_services()

    def serve(self) -> None:
        """Step until the mission has ended (or longer, with `~stays`), or the node is shut down."""
        skipped: Step | None = None
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
                    self._poses.restart()
                    for topics in self._robots:
                        topics.forget()
                step = step.after(skipped)
                self._presence.follow(step)
                is_located = self._poses.follow(step, self._presence)
                # `WorldPoses` may lack a robot that comes or goes: no message may be lost because of that.
                skipped = step if self._settings.team_state and not is_located else None
                if not is_located:
                    continue
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
        if self._settings.scenario.plan.doors:
            inputs.append(Input(Channel(DOORS), msg.Doors))
        if self._settings.scenario.moves_people:
            inputs.append(Input(Channel(PEOPLE), msg.People))
        if self._base_received:
            inputs.append(Input(Channel(self._base_received, robot_id=self._base), msg.NetworkMessages))
        inputs += [*self._poses.team_inputs, Input(Channel(VOICES, needed=True), msg.TeamVoices)]
        return [*inputs, *self._hazards.inputs, PRESENCE, self._links_input()]

    def _links_input(self) -> Input:
        decoder, read = LinksDecoder(), reader(msg.NetworkLinks, self._settings)

        def decode(data: bytes) -> NetworkState:
            # In the order of arrival, because a message has only the signals that are new.
            return decoder.decode(conversion.network_links(read(data)))

        return Input(Channel(LINKS, needed=True), msg.NetworkLinks, decode)

    def _begin_trial(self) -> Trial:
        recorders: list[Observer] = []
        if self._folder is not None:
            # mission.json is written last: if it exists, the rest is complete.
            recorders = [TumWriter(self._folder / "trajectories"), ResultWriter(self._folder)]
        return Trial(self._settings.placed, recorders)

    def _step(self, step: Step) -> None:
        present = self._presence.present
        robots = [(topics, self._presence.is_present(robot_id)) for robot_id, topics in enumerate(self._robots)]
        readings = tuple(topics.reading(step) if is_present else NOT_THERE for topics, is_present in robots)
        heard = conversion.team_voices(step.latest(VOICES))
        voices = tuple(
            voice if is_present else NOTHING_HEARD for voice, (_, is_present) in zip(heard, robots, strict=True)
        )
        for topics, is_present in robots:
            if not is_present:
                topics.forget()
        decisions = tuple(topics.decision(step) for topics, _ in robots)
        network = step.latest(LINKS)
        message = step.latest(DOORS)
        doors = None if message is None else conversion.door_states(message)
        message = step.latest(PEOPLE)
        people = () if message is None else self._people.of(message)
        base_inbox = conversion.network_messages(step.messages.get(self._base_received, ()))
        with self._trial_lock:
            self._trial.mission.follow_team(self._presence.mishaps, self._presence.loads)
            events = self._trial.step(
                step.stamp_ns,
                readings,
                voices,
                network,
                decisions,
                doors,
                base_inbox,
                present,
                self._hazards.field(step),
                self._presence.failed,
                people,
            )
        self._publish(step.stamp_ns, events)

    def _publish(self, time_ns: int, events: Sequence[Event]) -> None:
        make, scenario = self._make, self._settings.scenario
        # A consistent snapshot, because services may change the mission meanwhile.
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
        console = Console()
        print_totals(console, result, [self._folder])  # The events were logged when they happened.
        if not self._stays:
            console.print(LAST_WORDS, soft_wrap=True, markup=False, highlight=False)

    def _offer_services(self) -> None:
        actions = ("start", "pause", "resume", "abort")
        locked = partial(command, lock=self._trial_lock)
        self._services = (
            *(Service(f"/mission/{name}", Trigger, self._server_of(name)) for name in actions),
            locked("/mission/set_door", srv.SetDoor, self._set_door),
            locked("/mission/set_noise", srv.SetNoise, self._set_noise),
            locked("/mission/set_victim", srv.SetVictim, self._set_victim),
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

    def _set_door(self, request: srv.SetDoorRequest) -> None:
        check_door(self._settings.scenario, request.name)
        self._trial.mission.set_door(request.name, request.closed)

    def _set_noise(self, request: srv.SetNoiseRequest) -> None:
        check_noise(request.noise_db)
        self._trial.mission.set_noise_db(request.noise_db)

    def _set_victim(self, request: srv.SetVictimRequest) -> None:
        position_m = (request.position.x, request.position.y)
        check_victim(self._settings.scenario, request.name, position_m)
        self._trial.mission.set_victim(request.name, position_m)
