"""The node `world`: moves the robots, simulates their sensors, and publishes the clock."""

import logging
import math
import threading
from collections.abc import Mapping
from functools import partial

import numpy as np
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Empty, EmptyResponse, Trigger

from robotteamsim import srv
from robotteamsim.geometry import Pose
from robotteamsim.msg import Doors, People, Robots
from robotteamsim.recording import ros_messages
from robotteamsim.ros.nodes.commands import STOP
from robotteamsim.ros.nodes.elsewhere import RobotsElsewhere
from robotteamsim.ros.nodes.gate import Gate, Pacer
from robotteamsim.ros.nodes.hazards import HazardOutputs
from robotteamsim.ros.nodes.motion import StepMotion
from robotteamsim.ros.nodes.objects import ObjectsOutput, set_object
from robotteamsim.ros.nodes.requests import check_victim
from robotteamsim.ros.nodes.stage import StageRequests
from robotteamsim.ros.nodes.team import FreeTeam, LockstepTeam
from robotteamsim.ros.nodes.team_outputs import TeamOutputs
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.node import ParameterError, on_shutdown, parameter, run, set_parameter
from robotteamsim.ros.transport.presence import ROBOTS
from robotteamsim.ros.transport.services import Service, command
from robotteamsim.ros.transport.settings import SEED, Settings, read_settings
from robotteamsim.ros.transport.topics import STALE_NS, Output, SendingPace
from robotteamsim.scenario.published_map import published_map
from robotteamsim.sensing.readings import TeamReadings
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation.hazard_stage import HazardStage
from robotteamsim.simulation.people_stage import PeopleStage
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.making import make_world
from robotteamsim.world.placement import placed_robots

logger = logging.getLogger(__name__)

SERVICE_TIMEOUT_S = 5.0
"""A service waits this long for the current step [s, wall]."""
START_NS = 1_000_000
"""Time on the clock before the first step; in ROS, 0 means that there is no time yet."""
QUIET_S = 1.0
"""The world starts when there was no new subscriber for this time [s, wall]."""
NAP_S = 0.1
"""While waiting, the world checks at this interval whether the speed has changed [s, wall]."""
MIN_STEPS_BEFORE_RESET = 2
"""In lockstep, so that all nodes see stamps jump backwards."""
MIN_NS_BEFORE_RESET = 2 * STALE_NS
"""Without lockstep: a jump by less than `STALE_NS` could be a late message, and a step has up to 1 s."""


def main() -> None:
    """Run the node."""
    run("world", lambda: WorldNode(read_settings()).serve())


class WorldNode:
    """Steps the world with the team's commands and publishes the robots' readings."""

    def __init__(self, settings: Settings) -> None:
        scenario = settings.scenario
        self._settings = settings
        self._scenario = scenario
        self._step_ns = settings.step_ns
        self._min_steps_before_reset = (
            MIN_STEPS_BEFORE_RESET if settings.lockstep else math.ceil(MIN_NS_BEFORE_RESET / settings.step_ns)
        )
        self._robots = placed_robots(scenario)
        self._make = conversion.RosTypes()
        self._gate = Gate()
        self._pacer = _pacer()
        self._starts_paused = parameter("~paused", False)
        if self._starts_paused:
            self._gate.pause(0.0)
        localization = parameter("~localization", "none")
        if localization not in ("none", "ground_truth"):
            raise ParameterError(f"~localization: {localization!r}; expected none or ground_truth")
        self._motion = _motion(settings)
        self._elsewhere = RobotsElsewhere(settings)
        self._world_lock = threading.Lock()
        self._build()
        on_shutdown(self._gate.close)
        self._team = (
            LockstepTeam(settings, self._robots)
            if settings.lockstep
            else FreeTeam(settings, self._robots, follow=lambda: self._pacer.is_flat_out)
        )
        self._pace = SendingPace()
        self._objects = ObjectsOutput()
        self._show_objects()
        # The only source of door states for environment and mission.
        self._doors = Output("/world/doors", Doors, latched=True)
        self._presence = Output(ROBOTS, Robots, latched=True)
        self._hazards = HazardOutputs(self._make) if scenario.fire is not None else None
        self._people_output = Output("/world/people", People, latched=True) if scenario.moves_people else None
        # In lockstep a late subscriber must still get the step that all nodes wait for.
        self._outputs = TeamOutputs(
            self._robots,
            latched=settings.lockstep,
            localized=localization == "ground_truth",
            prefix=settings.prefix,
        )
        self._requests = StageRequests(self._pacer.set_speed) if parameter("~stage_requests", False) else None
        self._offer_map()
        self._offer_services()
        # Of messages that wait together roscpp sends those first whose topic was advertised first, and the clock must
        # not overtake the other messages of its step.
        self._clock = Output("/clock", Clock, latched=True)

    def serve(self) -> None:
        """Step until the node is shut down."""
        self._publish_clock(START_NS)
        self._team.assemble()
        if self._starts_paused:
            self._gate.wait()  # until clients that need the first step have subscribed
        else:
            self._wait_for_subscribers()
        while self._gate.wait():
            if self._motion is None:
                self._tick(self._world.sim_time_ns)
            twists = self._team.twists(self._world.step_index, self._world.sim_time_ns)
            if twists is None:
                return
            if self._world.step_index >= self._min_steps_before_reset and self._gate.reset_wanted:
                self._reset()
                self._gate.reset_done()
                continue
            with self._world_lock:
                for robot_id in self._arrived:
                    twists[robot_id] = STOP  # its controller's last decision before the robot left
                self._arrived.clear()
                self._elsewhere.follow(self._world, twists)
                self._world.step(twists if self._fire is None else self._fire.slowed(twists))
                burns = self._fire is not None and self._fire.step()
                readings, doors = self._sensors.read(), self._world.door_states()
                present, arrivals = self._world.present, self._world.arrivals
                mishaps, loads = self._world.mishaps, self._world.loads
                self._move_people(doors)
            if self._motion is not None:
                # The step is made when it begins, so its motion is known at each tick.
                self._motion.add(readings.odometry, arrivals)
                self._tick(self._world.sim_time_ns - self._step_ns, present)
            if self._hazards is not None and self._fire is not None and burns:
                self._hazards.publish(self._world.sim_time_ns, self._fire.field)
            self._publish(readings, doors, present, arrivals, mishaps, loads)
            self._gate.passed()

    def _wait_for_subscribers(self) -> None:
        """Wait until there are no new subscribers, because a recorder must get the first step, too."""
        connected = -1
        while connected != (now_connected := self._outputs.num_subscribers):
            connected = now_connected
            self._gate.sleep(QUIET_S)

    def _move_people(self, doors: DoorStates) -> None:
        if self._people is None:
            return
        status = self._team.mission_status
        victims = () if status is None else status.victims
        assistance = () if status is None else conversion.task(status).assistance
        field = None if self._fire is None else self._fire.field
        time_ns, positions_m = self._world.sim_time_ns, self._world.positions_m()
        self._people.step(time_ns, positions_m, doors, victims, assistance, field)

    def _build(self) -> None:
        self._world = make_world(self._scenario, self._robots)
        self._arrived: set[int] = set()
        self._fire = None if self._scenario.fire is None else HazardStage(self._scenario, self._world)
        hazards = None if self._fire is None else self._fire.hazards
        self._sensors = RobotSensors(self._world, self._robots, self._scenario.run.seed, hazards)
        self._people = PeopleStage(self._scenario) if self._scenario.moves_people else None

    def _reset(self) -> None:
        self._team.restart(self._world.sim_time_ns)
        self._scenario = self._settings.scenario
        # Before stamps jump back, which makes the other nodes start again.
        set_parameter(SEED, str(self._scenario.run.seed))
        if self._motion is not None:
            self._motion.clear()
        with self._world_lock:
            self._build()
            self._objects.show(self._world)
        self._publish_clock(START_NS)
        logger.info("the world is reset")

    def _tick(self, from_ns: int, present: np.ndarray | None = None) -> None:
        """Publish the ticks of the clock up to the next step; the tick of a step follows its data."""
        ticks = self._scenario.run.physics_substeps
        for tick in range(1, ticks + 1):
            time_ns = from_ns + tick * self._step_ns // ticks
            while (delay_s := self._delay_s(time_ns)) > 0.0 and self._gate.sleep(min(delay_s, NAP_S)):
                pass
            if tick < ticks:
                if self._motion is not None and self._motion.is_known:
                    self._outputs.publish_motion(time_ns, self._motion.at(tick / ticks), present)
                self._publish_clock(time_ns)

    def _delay_s(self, time_ns: int) -> float:
        """Return how long to wait [s, wall] until a time is due; 0 while a reset is wanted, which obeys no pace."""
        return 0.0 if self._gate.reset_wanted else self._pacer.delay_s(time_ns)

    def _publish(
        self,
        readings: TeamReadings,
        doors: DoorStates,
        present: np.ndarray | None,
        arrivals: tuple[int, ...],
        mishaps: Mapping[int, Mishap],
        loads: Mapping[int, str],
    ) -> None:
        time_ns = self._world.sim_time_ns
        self._pace.wait()
        everybody = (True,) * len(arrivals)
        self._team.note_presence(time_ns, everybody if present is None else tuple(present.tolist()))
        failed = () if self._fire is None else self._fire.failed
        self._presence.publish(ros_messages.robots(self._make, time_ns, present, arrivals, mishaps, failed, loads))
        if self._scenario.plan.doors:
            self._doors.publish(ros_messages.doors(self._make, time_ns, doors))
        if self._people is not None and self._people_output is not None:
            self._people_output.publish(ros_messages.people(self._make, time_ns, self._people.states))
        self._show_objects()
        self._outputs.publish(time_ns, readings, self._elsewhere.published(present))
        self._publish_clock(time_ns)
        self._pace.mark()

    def _show_objects(self) -> None:
        with self._world_lock:
            self._objects.show(self._world)

    def _publish_clock(self, time_ns: int) -> None:
        self._clock.publish(ros_messages.clock(self._make, time_ns))

    def _offer_map(self) -> None:
        grid = ros_messages.occupancy_grid(self._make, 0, published_map(self._scenario))
        self._map = Output("/map", OccupancyGrid, latched=True)
        self._map.publish(grid)
        self._static_map = Service("/static_map", GetMap, lambda _: GetMapResponse(map=grid))

    def _offer_services(self) -> None:
        locked = partial(command, lock=self._world_lock)
        self._services = (
            command("/pause", Trigger, self._pause),
            command("/resume", Trigger, self._resume),
            command("/step", srv.Step, self._make_steps),
            command("/reset", Trigger, self._restart),
            command("/reset_seed", srv.ResetSeed, self._reset_seed),
            Service("/reset_positions", Empty, self._reset_positions),
            command("/set_speed", srv.SetSpeed, lambda request: self._pacer.set_speed(request.speed)),
            locked("/set_pose", srv.SetPose, self._set_pose),
            locked("/spawn_robot", srv.SpawnRobot, self._spawn_robot),
            locked("/remove_robot", srv.RemoveRobot, lambda request: self._world.remove_robot(request.robot_id)),
            locked("/set_object", srv.SetObject, self._set_object),
            locked("/remove_object", srv.RemoveObject, self._remove_object),
            locked("/lift_object", srv.LiftObject, self._lift_object),
            locked("/drop_object", srv.DropObject, lambda request: self._world.drop_object(request.robot_id)),
            locked("/set_light", srv.SetLight, lambda request: self._world.set_light(request.name, request.lit)),
            locked("/ignite", srv.Ignite, self._ignite),
            locked("/world/set_victim", srv.SetVictim, self._set_victim),
            locked("/world/set_door", srv.SetDoor, lambda request: self._world.set_door(request.name, request.closed)),
        )

    def _pause(self, _: object) -> str:
        return "paused" if self._gate.pause(SERVICE_TIMEOUT_S) else "pausing after the current step"

    def _resume(self, _: object) -> str:
        self._gate.resume()
        return "resumed"

    def _make_steps(self, request: srv.StepRequest) -> None:
        if request.steps == 0:
            raise ValueError("steps: 0; expected at least 1")
        if not self._gate.step(request.steps):
            raise ValueError("the world is not paused")

    def _restart(self, _: object) -> str:
        return "reset" if self._gate.reset(SERVICE_TIMEOUT_S) else "the reset is still under way"

    def _reset_seed(self, request: srv.ResetSeedRequest) -> str:
        self._settings = self._settings.with_seed(request.seed)
        return self._restart(request)

    def _reset_positions(self, _: object) -> EmptyResponse:
        with self._world_lock:
            self._world.reset_positions()
        return EmptyResponse()

    def _set_pose(self, request: srv.SetPoseRequest) -> None:
        self._world.set_pose(request.robot_id, Pose(request.pose.x, request.pose.y, request.pose.theta))

    def _spawn_robot(self, request: srv.SpawnRobotRequest) -> None:
        pose = None if request.at_start else Pose(request.pose.x, request.pose.y, request.pose.theta)
        self._world.spawn_robot(request.robot_id, pose)
        self._arrived.add(request.robot_id)

    def _ignite(self, request: srv.IgniteRequest) -> None:
        if self._fire is None:
            raise ValueError("ignite: the scenario has no section 'fire'")
        self._fire.ignite((request.position.x, request.position.y))

    def _set_object(self, request: srv.SetObjectRequest) -> None:
        set_object(self._world, request)
        self._objects.show(self._world)  # a paused world makes no step, which would publish it

    def _set_victim(self, request: srv.SetVictimRequest) -> None:
        position_m = (request.position.x, request.position.y)
        check_victim(self._scenario, request.name, position_m)
        if self._people is not None:
            self._people.place(request.name, position_m)

    def _lift_object(self, request: srv.LiftObjectRequest) -> None:
        self._world.lift_object(request.robot_id, request.name)

    def _remove_object(self, request: srv.RemoveObjectRequest) -> None:
        self._world.remove_object(request.name)
        self._objects.show(self._world)


def _motion(settings: Settings) -> StepMotion | None:
    """Return the motion for odometry and tf at the rate of the clock; None: they are published per step."""
    rate = parameter("~odometry", "step")
    if rate not in ("step", "clock"):
        raise ParameterError(f"~odometry: {rate!r}; expected step or clock")
    if rate == "clock" and (settings.lockstep or settings.controllers):
        with_what = "lockstep" if settings.lockstep else "controllers of this package, which need one odom per scan"
        raise ParameterError(f"~odometry: clock does not work with {with_what}; expected step")
    return StepMotion() if rate == "clock" else None


def _pacer() -> Pacer:
    speed = parameter("~speed", 1.0)
    try:
        return Pacer(speed)
    except ValueError as error:
        raise ParameterError(f"~speed: {error}") from None
