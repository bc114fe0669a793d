"""The node `environment`: simulates voices and the radio network."""

import logging
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from nav_msgs.msg import OccupancyGrid

from robotteamsim import srv
from robotteamsim.mission.status import SILENT
from robotteamsim.msg import (
    Doors,
    FloatMap,
    MissionStatus,
    NetworkLinks,
    NetworkMessages,
    NetworkState,
    People,
    TeamVoices,
    Voice,
)
from robotteamsim.network.compact import LinksEncoder
from robotteamsim.network.messages import NetworkState as Network
from robotteamsim.propagation import FieldMap
from robotteamsim.recording import network_messages, ros_messages
from robotteamsim.ros.nodes.requests import check_noise, check_victim
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.checks import outbox_reader
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.node import run
from robotteamsim.ros.transport.presence import PRESENCE, Presence
from robotteamsim.ros.transport.services import Service, call_service, command
from robotteamsim.ros.transport.settings import Settings, read_seed, read_settings
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.team_poses import team_poses
from robotteamsim.ros.transport.topics import Input, Output, make_synchronizer, receive_steps, send_enqueued
from robotteamsim.sensing.readings import NOT_THERE
from robotteamsim.simulation.environment import Environment

logger = logging.getLogger(__name__)

STATUS = "/mission/status"
DOORS = "/world/doors"
PEOPLE = "/world/people"
RADIO_MAP_RESOLUTION_M = 0.25
FINEST_M, COARSEST_M = 0.05, 10.0
"""Range of the resolution of requested maps; a finer map would be a message of many megabytes."""
RADIO_MAP_PERIOD_NS = 10**9
NODE_TIMEOUT_S = 2.0
"""Timeout of another node's service [s, wall]."""


def main() -> None:
    """Run the node."""
    run("environment", lambda: EnvironmentNode(read_settings()).serve())


class RadioMaps:
    """The signal of one robot over the floor; expensive, so only for subscribers, on subscription and once a second."""

    def __init__(self, robot_name: str, make: RosTypes, now: Callable[[], tuple[int, FieldMap] | None]) -> None:
        """Advertise the maps. now: returns stamp [ns] and map of the last step, for late subscribers; None: no map."""
        self._now = now
        topic = f"/{robot_name}/radio_map"
        picture = partial(ros_messages.radio_map_picture, make)
        values = partial(ros_messages.field_map, make, quantity="rssi", unit="dBm")
        self._outputs = (
            (Output(topic, OccupancyGrid, greeting=partial(self._greeting, picture)), picture),
            (Output(f"{topic}/values", FloatMap, greeting=partial(self._greeting, values)), values),
        )
        self._due_ns = 0

    def publish(self, time_ns: int, position_m: tuple[float, float], environment: Environment) -> None:
        """Publish the maps, if they are due and have subscribers."""
        if time_ns < self._due_ns or not any(output.wanted for output, _ in self._outputs):
            return
        self._due_ns = time_ns + RADIO_MAP_PERIOD_NS
        radio_map = environment.radio_map(position_m, RADIO_MAP_RESOLUTION_M)
        for output, message_of in self._outputs:
            output.publish(message_of(time_ns, radio_map))

    def restart(self) -> None:
        """Restart with the first step."""
        self._due_ns = 0

    def _greeting(self, message_of: Callable[[int, FieldMap], Any]) -> Any:
        now = self._now()
        return None if now is None else message_of(*now)


class EnvironmentNode:
    """Steps voices and network with the robots' true positions; serves changes of doors, noise and victims."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._make = RosTypes()
        self._environment_lock = threading.Lock()
        names = [f"/{ros_messages.robot_name(robot_id)}" for robot_id in range(settings.num_robots)]
        self._poses = team_poses(settings)
        self._sent = [f"{name}/network/tx" for name in names]
        latched = settings.lockstep
        self._voices = [Output(f"{name}/voice", Voice, latched=latched) for name in names]
        self._team_voices = Output("/environment/voices", TeamVoices, latched=latched)
        self._received = [Output(f"{name}/network/rx", NetworkMessages, latched=latched) for name in names]
        self._links = Output("/network/links", NetworkLinks, latched=latched)
        has_matrices = settings.scenario.network.publish_matrices
        self._matrices = Output("/network/state", NetworkState, latched=latched) if has_matrices else None
        self._voice_picture = Output("/voice_map", OccupancyGrid, latched=True)
        self._voice_map = Output("/voice_map/values", FloatMap, latched=True)
        self._presence = Presence()
        self._last_step: tuple[int, list[tuple[float, float]]] | None = None
        self._radio_maps = [
            RadioMaps(ros_messages.robot_name(robot_id), self._make, partial(self._radio_map_now, robot_id))
            for robot_id in range(settings.num_robots)
        ]
        self._build()
        self._publish_voice_map(0)
        inputs = self._inputs()
        self._steps = receive_steps(make_synchronizer(settings, inputs), inputs, settings)
        self._services = (
            Service("/get_radio_map", srv.GetRadioMap, self._serve_get_radio_map),
            command("/set_door", srv.SetDoor, self._set_door),
            command("/set_noise", srv.SetNoise, self._set_noise),
            command("/set_victim", srv.SetVictim, self._set_victim),
        )

    def serve(self) -> None:
        """Step until the node is shut down."""
        skipped: Step | None = None
        while (step := self._steps.take()) is not None:
            if step.restarted:
                with self._environment_lock:
                    self._settings = read_seed(self._settings)
                    self._build()
                self._poses.restart()
            step = step.after(skipped)
            self._presence.follow(step)
            is_located = self._poses.follow(step, self._presence)
            # `WorldPoses` may lack a robot that comes or goes: no message may be lost because of that.
            skipped = step if self._settings.team_state and not is_located else None
            for line in self._poses.newly_lost():
                logger.warning("%s", line)
            if is_located:
                self._step(step)

    def _inputs(self) -> list[Input]:
        poses = [an_input for robot_id in range(self._settings.num_robots) for an_input in self._poses.inputs(robot_id)]
        poses += self._poses.team_inputs
        controlled = self._settings.controlled
        sent = [
            Input(
                Channel(topic, of_last_step=True, may_be_silent=True, robot_id=robot_id),
                NetworkMessages,
                outbox_reader(robot_id, self._settings),
            )
            for robot_id, topic in enumerate(self._sent)
            if robot_id in controlled or not self._settings.lockstep
        ]
        doors = [Input(Channel(DOORS), Doors)] if self._settings.scenario.plan.doors else []
        people = [Input(Channel(PEOPLE), People)] if self._settings.scenario.moves_people else []
        return [*poses, *sent, *doors, *people, PRESENCE, Input(Channel(STATUS, of_last_step=True), MissionStatus)]

    def _build(self) -> None:
        self._environment = Environment(self._settings.placed)
        self._encoder = LinksEncoder()
        self._silent: tuple[str, ...] = ()
        self._people = conversion.PeopleReader()
        self._published_changes = -1
        self._last_step = None
        for radio_maps in self._radio_maps:
            radio_maps.restart()

    def _step(self, step: Step) -> None:
        is_present = self._presence.is_present
        places = [
            self._poses.reading(robot_id).pose if is_present(robot_id) else NOT_THERE.ground_truth
            for robot_id in range(self._settings.num_robots)
        ]
        positions_m = np.array([(place.x_m, place.y_m) for place in places])
        outboxes = [conversion.network_messages(step.messages.get(topic, ())) for topic in self._sent]
        with self._environment_lock:
            doors = step.latest(DOORS)
            if doors is not None:
                self._environment.follow_doors(conversion.door_states(doors))
            status = step.latest(STATUS)
            if status is not None:
                states = zip(self._environment.victim_names(), status.victims, strict=False)
                self._silent = tuple(name for name, state in states if state in SILENT)
            people = step.latest(PEOPLE)
            if people is not None:
                self._environment.follow_people(self._people.of(people))
            self._environment.advance_to(step.stamp_ns)
            voices, network, inboxes = self._environment.step(
                positions_m, outboxes, self._silent, self._presence.present
            )
        make, time_ns = self._make, step.stamp_ns
        for robot_id, (output, voice) in enumerate(zip(self._voices, voices, strict=True)):
            if is_present(robot_id) and output.wanted:
                output.enqueue(ros_messages.voice(make, time_ns, voice))
        for robot_id, (output, inbox) in enumerate(zip(self._received, inboxes, strict=True)):
            if is_present(robot_id) and output.wanted:
                output.enqueue(network_messages.network_messages(make, time_ns, inbox))
        if self._team_voices.wanted:
            self._team_voices.enqueue(ros_messages.team_voices(make, time_ns, voices))
        self._publish_network(time_ns, network)
        send_enqueued()
        self._publish_voice_map(time_ns)
        with self._environment_lock:
            self._last_step = time_ns, [(place.x_m, place.y_m) for place in places]
            for robot_id, (radio_maps, place) in enumerate(zip(self._radio_maps, places, strict=True)):
                if not is_present(robot_id):
                    continue
                radio_maps.publish(time_ns, (place.x_m, place.y_m), self._environment)

    def _publish_network(self, time_ns: int, network: Network) -> None:
        if self._links.wanted:
            # Not without a receiver: a message has the pairs that have weakened since the last one.
            links = self._encoder.encode(network)
            self._links.publish(network_messages.network_links(self._make, time_ns, links))
        if self._matrices is not None and self._matrices.wanted:
            self._matrices.publish(network_messages.network_state(self._make, time_ns, network))

    def _publish_voice_map(self, time_ns: int) -> None:
        with self._environment_lock:
            changes = self._environment.voice.changes
            if changes == self._published_changes:
                return
            self._published_changes = changes
            voice_map = self._environment.voice_map()
        self._voice_picture.publish(ros_messages.field_map_picture(self._make, time_ns, voice_map))
        self._voice_map.publish(ros_messages.field_map(self._make, time_ns, voice_map, "voice_level", "dB"))

    def _radio_map_now(self, robot_id: int) -> tuple[int, FieldMap] | None:
        """Return stamp [ns] and radio map of a robot in the last step; None if there is no step or no robot."""
        with self._environment_lock:
            if self._last_step is None or not self._presence.is_present(robot_id):
                return None
            time_ns, positions_m = self._last_step
            return time_ns, self._environment.radio_map(positions_m[robot_id], RADIO_MAP_RESOLUTION_M)

    def _serve_get_radio_map(self, request: srv.GetRadioMapRequest) -> srv.GetRadioMapResponse:
        resolution_m = request.resolution_m or RADIO_MAP_RESOLUTION_M
        with self._environment_lock:
            problem = self._problem_of(request.robot_id, resolution_m)
            if problem or self._last_step is None:
                return srv.GetRadioMapResponse(success=False, message=problem)
            time_ns, positions_m = self._last_step
            radio_map = self._environment.radio_map(positions_m[request.robot_id], resolution_m)
        message = ros_messages.field_map(self._make, time_ns, radio_map, "rssi", "dBm")
        return srv.GetRadioMapResponse(success=True, map=message)

    def _problem_of(self, robot_id: int, resolution_m: float) -> str:
        """Return why there is no such radio map; empty if there is one."""
        if not 0 <= robot_id < self._settings.num_robots:
            return f"robot_id: {robot_id}; expected 0 to {self._settings.num_robots - 1}"
        if not FINEST_M <= resolution_m <= COARSEST_M:
            return f"resolution_m: {resolution_m:g}; expected {FINEST_M:g} to {COARSEST_M:g}, or 0"
        if not self._presence.is_present(robot_id):
            return f"robot_id: {robot_id}; the robot is not present"
        return "" if self._last_step else "no step has been taken yet"

    def _set_door(self, request: srv.SetDoorRequest) -> None:
        """Let the world set a door and publish it; if the world has no doors, set it here and in the mission."""
        answer = _passed_on("/world/set_door", srv.SetDoor, request)
        if answer is None:
            with self._environment_lock:
                self._environment.set_door(request.name, request.closed)
            _passed_on("/mission/set_door", srv.SetDoor, request)
        elif not answer.success:
            raise ValueError(answer.message)

    def _set_noise(self, request: srv.SetNoiseRequest) -> None:
        check_noise(request.noise_db)
        with self._environment_lock:
            self._environment.set_noise_db(request.noise_db)
        _passed_on("/mission/set_noise", srv.SetNoise, request)

    def _set_victim(self, request: srv.SetVictimRequest) -> None:
        position_m = (request.position.x, request.position.y)
        check_victim(self._settings.scenario, request.name, position_m)
        with self._environment_lock:
            self._environment.set_victim(request.name, position_m)
        if self._settings.scenario.moves_people:
            _passed_on("/world/set_victim", srv.SetVictim, request)
        _passed_on("/mission/set_victim", srv.SetVictim, request)


def _passed_on(service: str, service_class: Any, request: Any) -> Any | None:
    """Forward a change to another node and return its answer; None if it does not answer."""
    answer = call_service(service, service_class, request, NODE_TIMEOUT_S)
    if answer is None:
        logger.warning("%s does not answer", service)
    return answer
