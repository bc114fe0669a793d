"""Steps the simulation of a scenario and publishes its record: the node `simulation`."""

from __future__ import annotations

import itertools
import logging
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from robotteamsim import recording
from robotteamsim.analysis.runs.tables import print_totals
from robotteamsim.geometry import Pose
from robotteamsim.message_parts import RosMessage
from robotteamsim.mission import Sensed
from robotteamsim.nodes.answers import CommandsByTopic, ControllersByTopic, ControllersInside
from robotteamsim.nodes.elsewhere import RobotsElsewhere, SensorsElsewhere
from robotteamsim.nodes.gate import FairLock, Gate, Pacer
from robotteamsim.nodes.inputs import Input
from robotteamsim.nodes.motion import StepMotion, TeamOdometry
from robotteamsim.nodes.node import Node, Output, ParameterError
from robotteamsim.nodes.outputs import RadioMapOutputs, RecordOutputs, RobotOutputs, TeamOutputs, output_of
from robotteamsim.nodes.recorded import recorded_topics
from robotteamsim.nodes.requests import CHANGES, CHANGES_OF_BODIES, Change, pose_of
from robotteamsim.nodes.services import SERVICE_TIMEOUT_S, offer_command, refused
from robotteamsim.nodes.settings import SEED, Settings
from robotteamsim.nodes.stage import StageRequests
from robotteamsim.propagation import FieldMap
from robotteamsim.recording import ResultWriter, TumWriter
from robotteamsim.recording.topics import Source, Topic
from robotteamsim.recording.topics.radio import HEARD_TOPICS, RADIO_MAP
from robotteamsim.recording.topics.world import CLOCK, DOORS, LEVEL_FRAMES, MAP, level_maps
from robotteamsim.scenario.map_image import check_published_map
from robotteamsim.simulation import Observer, Simulation, StepRecord
from robotteamsim.simulation.trial import Trial
from robotteamsim.world.doors import DoorStates

logger = logging.getLogger(__name__)

TRIGGER = "std_srvs/Trigger"

START_TIMEOUT_S = 60.0
"""The simulation starts without a recorder and, without lockstep, controllers that are not ready by then [s, wall]."""
START_NS = 1_000_000
"""Time on the clock before the first step; in ROS, 0 means that there is no time yet."""
NAP_S = 0.1
"""While waiting, the node checks at this interval whether the speed has changed [s, wall]."""
PATIENCE_S = 0.02
"""Without lockstep, a step waits this long for the answers of controllers [s, wall]."""
FAREWELL_S = 0.5
"""Time for the last messages to reach recorders before the node, and with it the launch, ends [s, wall]."""
RECORDERS = {".bag": "BagWriter", ".mcap": "McapWriter"}
"""Observers by the ending of ~record, imported on first use."""
RADIO_MAP_RESOLUTION_M = 0.25
FINEST_M, COARSEST_M = 0.05, 10.0
"""Range of the resolution of requested maps; a finer map would be a message of many megabytes."""


class SteppedSimulation:
    """Steps a simulation with the decisions of the team's controllers; services change it between two steps."""

    def __init__(self, node: Node, settings: Settings, team_outputs: type[TeamOutputs] = TeamOutputs) -> None:
        """Args: team_outputs: publish what the robots sense."""
        if not settings.is_another_world:
            check_published_map(settings.scenario)
        self._node = node
        self._settings = settings
        self._stays = node.parameter("~stays", False) or not settings.mission
        out = node.parameter("~out", "")
        self._folder = Path(out).expanduser() if out else None
        self._recording = _recording(node)
        self._starts_paused = node.parameter("~paused", False)
        self._is_recorded = node.parameter("~recorded", False)  # in any case, so that it counts as known
        self._motion = _motion(node, settings)
        self._pacer = _pacer(node)
        self.gate = Gate()
        """Lets the simulation take steps."""
        if self._starts_paused:
            self.gate.pause(0.0)
        node.on_shutdown(self.gate.close)
        self._lock = FairLock()
        self._elsewhere = RobotsElsewhere(node, settings) if settings.elsewhere else None
        if self._elsewhere is not None:
            node.on_shutdown(self._elsewhere.close)
        self._controllers = self._make_controllers()
        self._simulation = self._make_simulation()
        self._last: StepRecord | None = None
        self._commands = CommandsByTopic(node, settings, settings.setup.robots)
        self._localized = _is_localized(node)
        self._team_outputs = team_outputs(node, settings, localized=self._localized)
        heard = range(settings.num_robots if settings.mission else 0)
        self._heard_outputs = RobotOutputs(node, itertools.product(heard, HEARD_TOPICS), settings)
        self._radio_maps = RadioMapOutputs(node, settings, heard)
        self._record = RecordOutputs(node, settings)
        self._begin()
        is_asked = node.parameter("~stage_requests", False)
        self._requests = StageRequests(node, self._pacer.set_speed) if is_asked else None
        self._offer_services()
        self._once: list[Output] = []
        """Of latched topics with one message."""
        if LEVEL_FRAMES.is_in(settings.scenario):
            self._publish_once(LEVEL_FRAMES)
        self._clock: Output | None = None
        if not settings.is_another_world:
            self._clock = output_of(node, CLOCK, settings)
            self._offer_world()

    @contextmanager
    def between_steps(self) -> Iterator[Simulation]:
        """Hold the simulation between two steps, to read it or to change it; its objects are published at the end.

        Raises: ValueError: the current step takes too long.
        """
        with self._lock.within(SERVICE_TIMEOUT_S):
            yield self._simulation
            self._record.publish_objects(self._simulation.world)  # a paused simulation makes no step, which would

    def make_steps(self, steps: int) -> None:
        """Take some steps while paused. Raises: ValueError: none are wanted, or not all could be taken."""
        if steps == 0:
            raise ValueError("steps: 0; expected at least 1")
        if not self.gate.step(steps):
            raise ValueError("the world is not paused, or was paused again before all steps were taken")

    def spawn_robot(self, robot_id: int, pose: Pose | None) -> None:
        """Spawn an absent robot, see `Simulation.spawn_robot`."""
        with self.between_steps() as simulation:
            simulation.spawn_robot(robot_id, pose)
            self._commands.stop(robot_id)  # of its controller before the robot left

    def serve(self) -> None:
        """Step until the mission has ended (or longer, with `~stays`), or the node is shut down."""
        self._publish_clock(START_NS)
        if isinstance(self._controllers, ControllersByTopic) and not self._settings.lockstep:
            for name in self._controllers.wait_for_all(START_TIMEOUT_S):
                logger.warning("starting without %s", name)
        if self._starts_paused:
            logger.info("paused before the first step; /simulation/resume starts it")
            self.gate.wait()  # until clients that need the first step have subscribed
        else:
            recorded = recorded_topics(self._settings) if self._is_recorded else []
            self._node.wait_for_subscribers(recorded, START_TIMEOUT_S, self.gate.sleep)
        try:
            self._serve()
        finally:
            self._trial.abandon()

    def _serve(self) -> None:
        while self.gate.wait():
            if self.gate.reset_wanted:
                self.gate.do_reset(self._reset)
                continue
            stamp_ns = self._wait_for_step()
            if not self._node.is_running():
                return
            if self.gate.reset_wanted:
                continue
            with self._lock:
                record = self._step(stamp_ns)
            has_ended = self._trial.result is not None
            self._trial.add(record)  # before others see that it has ended, so that its files are complete
            self._publish(record)
            self.gate.passed()
            if self._trial.result is not None and not has_ended and self._settings.mission:
                self._report()
                if not self._stays:
                    self._node.wait_for_shutdown(FAREWELL_S)
                    return

    def _wait_for_step(self) -> int | None:
        """Wait until the next step is due; return its stamp [ns] if the time is that of another world."""
        if self._settings.is_another_world:
            assert self._elsewhere is not None
            stamp_ns = self._elsewhere.wait(self._is_present)
            if self._elsewhere.has_jumped_back:
                logger.warning("simulated time has jumped back: the mission starts again")
                self.gate.want_reset()
            return stamp_ns
        if self._motion is None:
            self._tick(self._simulation.world.sim_time_ns)
        return None

    def _is_present(self, robot_id: int) -> bool:
        return bool(self._simulation.world.present[robot_id])

    def _step(self, stamp_ns: int | None) -> StepRecord:
        simulation = self._simulation
        if self._elsewhere is not None:
            self._elsewhere.follow(simulation.world, stamp_ns)
        commands = self._commands.at(simulation.world.sim_time_ns)
        simulation.command({i: twist for i, twist in commands.items() if self._is_present(i)})
        if self._last is None and simulation.scenario.mission.autostart:
            simulation.mission.start()  # as without ROS, before the schedule's first events
        record = self._last = simulation.step()
        for robot_id in range(self._settings.num_robots):
            if not record.is_there(robot_id):
                self._commands.stop(robot_id)
        return record

    def _publish_inputs(self, sensed: Sensed) -> None:
        """Publish what the controllers need."""
        if self._motion is not None:
            self._made = sensed  # published after the ticks of this step
            return
        self._publish_sensed(sensed)

    def _publish_sensed(self, sensed: Sensed) -> None:
        simulation = self._simulation
        self._record.publish_presence(
            sensed.sim_time_ns, sensed.present, sensed.arrivals, simulation.world, simulation.hazards.failed
        )
        self._team_outputs.publish(sensed)
        self._heard_outputs.publish(sensed)
        self._publish_clock(sensed.sim_time_ns)

    def _publish(self, record: StepRecord) -> None:
        """Publish the record of a step."""
        time_ns = record.sim_time_ns
        if self._motion is not None:
            # The step is made when it begins, so its motion is known at each tick.
            made = self._made
            self._motion.add(TeamOdometry.of(made.state), record.arrivals)
            self._tick(time_ns - self._settings.step_ns, made)
            self._publish_sensed(made)
        self._record.publish(record)
        with self._lock:
            self._record.publish_objects(self._simulation.world)
        self._radio_maps.publish(record, partial(self._radio_map, record, resolution_m=RADIO_MAP_RESOLUTION_M))
        if self._settings.mission:
            for event in record.events:
                logger.info("%.1f s: %s", event.time_s, event.detail)

    def _tick(self, from_ns: int, made: Sensed | None = None) -> None:
        """Wait for the next step, and publish the ticks of the clock up to it. Args: made: that step, if it is made."""
        ticks, step_ns = self._settings.scenario.run.physics_substeps, self._settings.step_ns
        for tick in range(1, ticks + 1):
            time_ns = from_ns + tick * step_ns // ticks
            while (delay_s := self._delay_s(time_ns)) > 0.0 and self.gate.sleep(min(delay_s, NAP_S)):
                pass
            if tick < ticks:
                if self._motion is not None and made is not None and self._motion.is_known:
                    self._team_outputs.publish_motion(time_ns, self._motion.at(tick / ticks), made.present)
                self._publish_clock(time_ns)

    def _delay_s(self, time_ns: int) -> float:
        """Return how long to wait [s, wall] until a time is due; 0 while a reset is wanted, which obeys no pace."""
        return 0.0 if self.gate.reset_wanted else self._pacer.delay_s(time_ns)

    def _patience_s(self) -> float:
        """Return how long a step waits for answers [s, wall]: not longer than until the next tick."""
        next_ns = self._simulation.world.sim_time_ns + self._settings.step_ns
        return PATIENCE_S if self._pacer.is_flat_out else min(PATIENCE_S, self._pacer.delay_s(next_ns))

    def _make_controllers(self) -> ControllersByTopic | ControllersInside:
        if self._settings.controllers == "inside":
            return ControllersInside(self._node, self._settings, self._publish_inputs)
        controllers = ControllersByTopic(self._node, self._settings, self._publish_inputs, self._patience_s)
        self._node.on_shutdown(controllers.close)
        return controllers

    def _make_simulation(self) -> Simulation:
        simulation = Simulation(self._settings.setup, controllers=self._controllers)
        if self._elsewhere is not None:
            simulation.sensors = SensorsElsewhere(simulation.sensors, self._elsewhere, simulation.world)
            if simulation.passages is not None:
                simulation.passages.elsewhere = self._settings.elsewhere
        return simulation

    def _begin(self) -> None:
        """Begin a trial, and publish its state before the first step."""
        recorders: list[Observer] = []
        if self._folder is not None:
            # mission.json is written last: if it exists, the rest is complete.
            recorders = [TumWriter(self._folder / "trajectories"), ResultWriter(self._folder)]
        if self._recording is not None:
            writer = getattr(recording, RECORDERS[self._recording.suffix])
            recorders.insert(0, writer(self._recording, localized=self._localized))
        simulation = self._simulation
        self._trial = Trial(simulation.setup, recorders)
        self._last = None
        self._record.restart()
        self._radio_maps.restart()
        self._record.publish_beginning(simulation)

    def _reset(self) -> None:
        # Before stamps jump back, which makes the controllers start again.
        self._node.change_setting(SEED, str(self._settings.scenario.run.seed))
        if self._motion is not None:
            self._motion.clear()
        if self._elsewhere is not None:
            self._elsewhere.restart()
        with self._lock:
            self._trial.abandon()
            self._controllers.restart(self._settings)
            self._simulation = self._make_simulation()
            for robot_id in range(self._settings.num_robots):
                self._commands.stop(robot_id)
            self._begin()
        self._publish_clock(START_NS)
        logger.info("the world is reset")

    def _report(self) -> None:
        result = self._trial.result
        assert result is not None
        console = Console()
        print_totals(console, result, [self._folder])  # The events were logged when they happened.
        skipped = 0 if self._elsewhere is None else self._elsewhere.skipped_steps
        if skipped:
            logger.warning(
                "%d of %d steps of the other world were skipped, because this node was late: a bag has all of them, so "
                "the hash of its trajectories differs",
                skipped,
                skipped + result.steps,
            )
        if not self._stays and self._node.last_words:
            console.print(self._node.last_words, soft_wrap=True, markup=False, highlight=False)

    def _publish_clock(self, time_ns: int) -> None:
        if self._clock is not None:
            self._clock.publish(CLOCK.message(time_ns))

    def _publish_once(self, topic: Topic) -> RosMessage:
        """Publish and return the only message of a latched topic."""
        message: RosMessage
        (message,) = topic.messages(START_NS, topic.values(Source(self._settings.setup), None))
        self._once.append(output_of(self._node, topic, self._settings))
        self._once[-1].publish(message)
        return message

    def _offer_world(self) -> None:
        """Offer what another world would offer itself: its map, time and bodies."""
        grid = self._publish_once(MAP)
        for topic in level_maps(self._settings.scenario):
            self._publish_once(topic)
        node = self._node
        node.offer("/static_map", "nav_msgs/GetMap", lambda _: {"map": grid})
        node.offer("/reset_positions", "std_srvs/Empty", self._reset_positions)
        offer_command(node, "pause", TRIGGER, self._pause)
        offer_command(node, "resume", TRIGGER, self._resume)
        offer_command(node, "step", "robotteamsim/Step", lambda request: self.make_steps(request.steps))
        offer_command(node, "reset", TRIGGER, self._restart)
        offer_command(node, "reset_seed", "robotteamsim/ResetSeed", self._reset_seed)
        offer_command(node, "set_speed", "robotteamsim/SetSpeed", lambda request: self._pacer.set_speed(request.speed))
        self._offer_changes(CHANGES_OF_BODIES)

    def _offer_services(self) -> None:
        self._offer_changes(CHANGES)
        node = self._node
        offer_command(node, "spawn_robot", "robotteamsim/SpawnRobot", self._spawn_robot)
        offer_command(node, "set_door", "robotteamsim/SetDoor", self._set_door)
        if self._settings.mission:
            node.offer("~get_radio_map", "robotteamsim/GetRadioMap", self._serve_radio_map)
            for name in ("start", "pause", "resume", "abort"):
                node.offer(f"/mission/{name}", TRIGGER, partial(self._order_mission, name))
        if self._settings.is_another_world:
            Input.of(node, DOORS, self._settings).listen(self._follow_doors)

    def _offer_changes(self, changes: Mapping[str, Change]) -> None:
        for name, change in changes.items():
            type_name = f"robotteamsim/{name.title().replace('_', '')}"
            offer_command(self._node, name, type_name, partial(self._change, change))

    def _change(self, change: Change, request: Any) -> None:
        with self.between_steps() as simulation:
            change(simulation, request)

    def _follow_doors(self, _: str, __: int, doors: DoorStates) -> None:
        """Open and close the doors that another world has opened and closed."""
        with self._lock:
            states = self._simulation.world.door_states()
            for name, closed in doors.closed().items():
                if name in states and states[name].closed != closed:
                    self._simulation.set_door(name, closed)

    def _radio_map(self, record: StepRecord, robot_id: int, resolution_m: float) -> FieldMap:
        """Return the signal of a robot where it was in a step."""
        reading = record.readings[robot_id].ground_truth
        with self._lock:
            return self._simulation.network.radio.rssi_map_dbm((reading.x_m, reading.y_m), resolution_m)

    def _serve_radio_map(self, request: Any) -> dict[str, Any]:
        robot_id, resolution_m = request.robot_id, request.resolution_m or RADIO_MAP_RESOLUTION_M
        record, problem = self._last, ""
        if not 0 <= robot_id < self._settings.num_robots:
            problem = f"robot_id: {robot_id}; expected 0 to {self._settings.num_robots - 1}"
        elif not FINEST_M <= resolution_m <= COARSEST_M:
            problem = f"resolution_m: {resolution_m:g}; expected {FINEST_M:g} to {COARSEST_M:g}, or 0"
        elif record is None:
            problem = "no step has been taken yet"
        elif not record.is_there(robot_id):
            problem = f"robot_id: {robot_id}; the robot is not present"
        if problem or record is None:
            return {"success": False, "message": problem}
        values = RADIO_MAP.values(None, self._radio_map(record, robot_id, resolution_m), robot_id)
        (message,) = RADIO_MAP.messages(record.sim_time_ns, values)
        return {"success": True, "map": message}

    def _order_mission(self, order: str, _: object) -> dict[str, Any]:
        """Start, pause, resume or abort the mission."""
        try:
            with self.between_steps() as simulation:
                mission = simulation.mission
                before = mission.status.state
                getattr(mission, order)()
                after = mission.status.state
        except ValueError as error:
            return refused(error)
        return {"success": before != after, "message": f"the mission is {after}"}

    def _pause(self, _: object) -> str:
        return "paused" if self.gate.pause(SERVICE_TIMEOUT_S) else "pausing after the current step"

    def _resume(self, _: object) -> str:
        self.gate.resume()
        return "resumed"

    def _restart(self, _: object) -> str:
        return "reset" if self.gate.reset(SERVICE_TIMEOUT_S) else "the reset is still under way"

    def _reset_seed(self, request: Any) -> str:
        settings = self._settings.with_seed(request.seed)
        _ = settings.setup  # resolved here, so that a seed without room for all is refused, and not again in the reset
        self._settings = settings
        return self._restart(request)

    def _reset_positions(self, _: object) -> dict[str, Any]:
        with self.between_steps() as simulation:
            simulation.world.reset_positions()
        return {}

    def _spawn_robot(self, request: Any) -> None:
        self.spawn_robot(request.robot_id, None if request.at_start else pose_of(request))

    def _set_door(self, request: Any) -> None:
        """Open or close a door; another world that has doors does it itself, and publishes it."""
        if self._settings.is_another_world:
            values = {"name": request.name, "closed": request.closed}
            answer = self._node.call("/world/set_door", "robotteamsim/SetDoor", values)
            if answer is not None:  # It has doors.
                if not answer.success:
                    raise ValueError(answer.message)
                return
        with self.between_steps() as simulation:
            simulation.set_door(request.name, request.closed)


def _is_localized(node: Node) -> bool:
    """Return whether tf has map -> odom of each robot."""
    localization = node.parameter("~localization", "none")
    if localization not in ("none", "ground_truth"):
        raise ParameterError(f"~localization: {localization!r}; expected none or ground_truth")
    return bool(localization == "ground_truth")


def _recording(node: Node) -> Path | None:
    """Return the file of ~record, if any."""
    name = node.parameter("~record", "")
    path = Path(name).expanduser()
    if name and path.suffix not in RECORDERS:
        raise ParameterError(f"~record: {name!r}; expected a name that ends in {' or '.join(RECORDERS)}")
    return path if name else None


def _motion(node: Node, settings: Settings) -> StepMotion | None:
    """Return the motion for odometry and tf at the rate of the clock; None: they are published per step."""
    rate = node.parameter("~odometry", "step")
    if rate not in ("step", "clock"):
        raise ParameterError(f"~odometry: {rate!r}; expected step or clock")
    if rate == "clock" and (settings.lockstep or settings.controllers != "none"):
        with_what = "lockstep" if settings.lockstep else "controllers of this package, which need one odom per scan"
        raise ParameterError(f"~odometry: clock does not work with {with_what}; expected step")
    return StepMotion() if rate == "clock" else None


def _pacer(node: Node) -> Pacer:
    speed = node.parameter("~speed", 1.0)
    try:
        return Pacer(speed)
    except ValueError as error:
        raise ParameterError(f"~speed: {error}") from None
