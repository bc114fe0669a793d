"""The standard services of simulation_interfaces: another door to what the simulation's own services do."""

from __future__ import annotations

import itertools
import math
import re
import threading
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.msg import Bounds, EntityCategory, EntityState, Result, SimulationState, SimulatorFeatures
from simulation_interfaces.srv import ResetSimulation, SetEntityState, SetSimulationState, SpawnEntity

from robotteamsim.errors import PlacementError, RobotTeamSimError
from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.message_parts import MAP_FRAME
from robotteamsim.nodes.entities import Entity, entities, move_entity, remove_entity, robot_names
from robotteamsim.nodes.services import SERVICE_TIMEOUT_S
from robotteamsim.nodes.simulation import FAREWELL_S, SteppedSimulation
from robotteamsim.ros2.node import Ros2Node
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.yaml_text import mapping_of
from robotteamsim.simulation import Simulation
from robotteamsim.wording import printable

SERVICES = (
    *("GetSimulatorFeatures", "GetSimulationState", "SetSimulationState", "ResetSimulation", "StepSimulation"),
    *("SpawnEntity", "DeleteEntity", "GetEntities", "GetEntitiesStates", "GetEntityState", "SetEntityState"),
)
FEATURES = (
    *("SPAWNING", "SPAWNING_RESOURCE_STRING", "DELETING", "ENTITY_CATEGORIES", "ENTITY_STATE_GETTING"),
    *("ENTITY_STATE_SETTING", "SIMULATION_RESET", "SIMULATION_STATE_GETTING", "SIMULATION_STATE_SETTING"),
    *("SIMULATION_STATE_PAUSE", "STEP_SIMULATION_SINGLE", "STEP_SIMULATION_MULTIPLE", "STEP_SIMULATION_ACTION"),
)
ROBOT = "robot"
"""The uri of a robot of the team."""
SPAWNING = """SpawnEntity: uri 'robot' brings back a robot of the team; resource_string is an item of the scenario's key
'objects' in YAML, such as {kind: box, size_m: [0.6, 0.4]}""".replace("\n", " ")
STOPPED, PLAYING, PAUSED = SimulationState.STATE_STOPPED, SimulationState.STATE_PLAYING, SimulationState.STATE_PAUSED
STATES = {STOPPED: "stopped", PLAYING: "playing", PAUSED: "paused", SimulationState.STATE_QUITTING: "quitting"}
CATEGORIES = {
    "robot": EntityCategory.CATEGORY_ROBOT,
    "object": EntityCategory.CATEGORY_DYNAMIC_OBJECT,
    "victim": EntityCategory.CATEGORY_HUMAN,
}
BRACKETS = re.compile(r"\\.|\[(\^?)(\]?(?:\[[:.=][^\]]*[:.=]\]|[^\]])*)\]", re.DOTALL)
"""An escaped character, or a bracket expression of POSIX, which may begin with ] and contain [:digit:]."""
IN_BRACKETS = re.compile(r"\[([:.=][^\]]*[:.=])\]|[][\\&~|]")
"""A class of characters, or a character that Python would take for something else."""
CLASSES = {
    **{"alnum": "0-9A-Za-z", "alpha": "A-Za-z", "blank": r" \t", "cntrl": r"\x00-\x1f\x7f", "digit": "0-9"},
    **{"graph": "!-~", "lower": "a-z", "print": " -~", "punct": r"!-/:-@\[-`{-~", "space": r"\t-\r "},
    **{"upper": "A-Z", "xdigit": "0-9A-Fa-f"},
}
"""The classes of characters in the POSIX locale, as a set in Python has them."""
FLAT = 1e-6
"""Largest height [m], and component of a quaternion about a horizontal axis, of a pose on the floor."""


class RefusedError(Exception):
    """A request that is not carried out, with the standard's code for it."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(reason)
        self.code = code


def offer(node: Ros2Node, stepped: SteppedSimulation) -> None:
    """Offer the services and the action below the node's name, such as ~get_entities."""
    services = _Services(node, stepped)
    for name in SERVICES:
        method = re.sub("(?<!^)(?=[A-Z])", "_", name).lower()
        node.offer(f"~{method}", f"simulation_interfaces/{name}", partial(_answer, getattr(services, method)))
    node.offer_action("~simulate_steps", SimulateSteps, services.simulate_steps)


def _answer(serve: Callable[[Any], Mapping[str, Any] | None], request: Any) -> Mapping[str, Any]:
    try:
        values = serve(request) or {}
        return values if "features" in values else {"result": Result(result=Result.RESULT_OK), **values}
    except RefusedError as error:
        return {"result": Result(result=error.code, error_message=printable(str(error)))}
    except (ValueError, RobotTeamSimError) as error:
        return {"result": Result(result=Result.RESULT_OPERATION_FAILED, error_message=printable(str(error)))}


class _Services:
    """Carries out the requests of the services, each by the method of its name."""

    def __init__(self, node: Ros2Node, stepped: SteppedSimulation) -> None:
        self._node = node
        self._stepped = stepped
        self._has_stopped = False
        """Whether the last state that was set is that."""

    def get_simulator_features(self, _: object) -> dict[str, Any]:
        features = [getattr(SimulatorFeatures, name) for name in FEATURES]
        return {"features": SimulatorFeatures(features=features, spawn_formats=["robotteamsim"], custom_info=SPAWNING)}

    def get_simulation_state(self, _: object) -> dict[str, Any]:
        return {"state": SimulationState(state=self._state())}

    def set_simulation_state(self, request: Any) -> None:
        wanted, refused = request.state.state, SetSimulationState.Response
        if wanted not in STATES:
            raise _unsupported(f"state: {wanted}; expected {min(STATES)} to {max(STATES)}")
        if wanted == self._state():
            raise RefusedError(refused.ALREADY_IN_TARGET_STATE, f"the simulation is {STATES[wanted]} already")
        if wanted == PLAYING:
            self._stepped.gate.resume()
        elif not self._stepped.gate.pause(SERVICE_TIMEOUT_S):
            raise RefusedError(refused.STATE_TRANSITION_ERROR, "pausing after the current step, which takes long")
        if wanted == STOPPED:
            self._reset()
        self._has_stopped = wanted == STOPPED
        if wanted == SimulationState.STATE_QUITTING:
            threading.Timer(FAREWELL_S, self._node.end).start()  # after the response

    def reset_simulation(self, request: Any) -> None:
        whole = request.SCOPE_TIME | request.SCOPE_STATE | request.SCOPE_SPAWNED
        if request.scope not in (ResetSimulation.Request.SCOPE_DEFAULT, whole, request.SCOPE_ALL):
            raise _unsupported(f"scope: {request.scope}; expected {request.SCOPE_ALL}, for all")
        self._reset()

    def step_simulation(self, request: Any) -> None:
        self._step(request.steps)

    def simulate_steps(self, goal: Any, send_feedback: Callable[[Any], None]) -> Any:
        """Execute a goal of the action."""
        steps = goal.request.steps
        try:
            for done in range(1, max(steps, 1) + 1):
                self._step(min(steps, 1))
                send_feedback(SimulateSteps.Feedback(completed_steps=done, remaining_steps=steps - done))
                if done < steps and goal.is_cancel_requested:
                    goal.canceled()
                    raise ValueError(f"cancelled after {done} of {steps} steps")
        except ValueError as error:
            if goal.is_active:
                goal.abort()
            result = Result(result=Result.RESULT_OPERATION_FAILED, error_message=printable(str(error)))
            return SimulateSteps.Result(result=result)
        goal.succeed()
        return SimulateSteps.Result(result=Result(result=Result.RESULT_OK))

    def spawn_entity(self, request: Any) -> dict[str, Any]:
        refused, resource = SpawnEntity.Response, request.entity_resource
        if request.entity_namespace.strip("/") not in ("", request.name):
            raise _unsupported(f"entity_namespace: {request.entity_namespace!r}; expected none: a robot's is its name")
        invalid = getattr(refused, "INVALID_POSE", Result.RESULT_OPERATION_FAILED)  # in newer definitions
        pose = _planar(request.initial_pose.header.frame_id, request.initial_pose.pose, invalid)
        if resource.uri not in ("", ROBOT):
            reason = f"entity_resource.uri: {resource.uri!r}; expected {ROBOT} or none"
            raise RefusedError(refused.UNSUPPORTED_FORMAT, reason)
        if not resource.uri and not resource.resource_string:
            raise RefusedError(refused.NO_RESOURCE, f"entity_resource: is empty; expected uri {ROBOT} or a string")
        try:
            name = (self._spawn_robot if resource.uri else self._spawn_object)(request, pose)
        except PlacementError as error:
            raise RefusedError(invalid, str(error)) from None
        return {"entity_name": name}

    def delete_entity(self, request: Any) -> None:
        with self._stepped.between_steps() as simulation:
            if _find(simulation, request.entity).kind == "victim":
                raise _unsupported(f"entity: {request.entity} is a victim; expected a robot or an object")
            remove_entity(simulation, request.entity)

    def get_entities(self, request: Any) -> dict[str, Any]:
        return {"entities": self.get_entities_states(request)["entities"]}

    def get_entities_states(self, request: Any) -> dict[str, Any]:
        with self._stepped.between_steps() as simulation:
            holds, time_ns = _filter(request.filters), simulation.world.sim_time_ns
            chosen = {name: entity for name, entity in entities(simulation).items() if holds(name, entity)}
        return {"entities": list(chosen), "states": [_state(time_ns, entity) for entity in chosen.values()]}

    def get_entity_state(self, request: Any) -> dict[str, Any]:
        with self._stepped.between_steps() as simulation:
            return {"state": _state(simulation.world.sim_time_ns, _find(simulation, request.entity))}

    def set_entity_state(self, request: Any) -> None:
        state, invalid = request.state, SetEntityState.Response.INVALID_POSE
        # Older definitions do not have these keys: all that is given is set.
        if getattr(request, "set_twist", True) and any(map(_length, (state.twist.linear, state.twist.angular))):
            raise _unsupported("state.twist: is not 0; entities are set at rest")
        if not getattr(request, "set_pose", True):
            raise _unsupported("set_pose: false; expected true, because only poses are set")
        with self._stepped.between_steps() as simulation:
            _find(simulation, request.entity)
            pose = _planar(state.header.frame_id, state.pose, invalid)
            try:
                move_entity(simulation, request.entity, pose)
            except (ValueError, RobotTeamSimError) as error:
                raise RefusedError(invalid, str(error)) from None

    def _state(self) -> int:
        if not self._stepped.gate.is_paused:
            return int(PLAYING)
        with self._stepped.between_steps() as simulation:
            is_at_start = simulation.world.step_index == 0
        return int(STOPPED if self._has_stopped and is_at_start else PAUSED)

    def _reset(self) -> None:
        if not self._stepped.gate.reset(SERVICE_TIMEOUT_S):
            raise ValueError("the reset is still under way")

    def _step(self, steps: int) -> None:
        state = self._state()
        if state != PAUSED:
            raise ValueError(f"the simulation is {STATES[state]}; expected paused")
        self._stepped.make_steps(steps)

    def _spawn_robot(self, request: Any, pose: Pose) -> str:
        """Bring back the robot with the name in a request, or any if it may have another; return its name."""
        with self._stepped.between_steps() as simulation:
            team, there = robot_names(simulation), simulation.world.present
        absent = [name for name, is_there in zip(team, there, strict=True) if not is_there]
        name = request.name
        if name not in absent and absent and request.allow_renaming:
            name = absent[0]
        if name not in absent:
            refused = SpawnEntity.Response
            code = refused.NAME_NOT_UNIQUE if name in team else refused.NAME_INVALID
            raise RefusedError(code, f"name: {name!r}; expected an absent robot: {', '.join(absent) or 'none'}")
        self._stepped.spawn_robot(team.index(name), pose)
        return str(name)

    def _spawn_object(self, request: Any, pose: Pose) -> str:
        """Add an object; return its name."""
        refused, place = SpawnEntity.Response, "entity_resource.resource_string"
        try:
            values = mapping_of(request.entity_resource.resource_string, place, "an object")
            values |= {"name": request.name or values.get("name", ""), "pose": (pose.x_m, pose.y_m, pose.yaw_rad)}
            obj = checked(MovableObject, values, ValueError, f"{place}: ")
        except (ValueError, RobotTeamSimError) as error:
            raise RefusedError(refused.RESOURCE_PARSE_ERROR, str(error)) from None
        with self._stepped.between_steps() as simulation:
            taken = {"", *robot_names(simulation), *entities(simulation)}
            if obj.name in taken and not request.allow_renaming:
                code = refused.NAME_NOT_UNIQUE if obj.name else refused.NAME_INVALID
                raise RefusedError(code, f"name: {obj.name!r}; expected a name that no entity has")
            others = (f"{obj.name or obj.kind}_{number}" for number in itertools.count(1))
            free = next(name for name in itertools.chain([obj.name], others) if name not in taken)
            simulation.world.add_object(obj.model_copy(update={"name": free}))
        return free


def _unsupported(reason: str) -> RefusedError:
    return RefusedError(Result.RESULT_FEATURE_UNSUPPORTED, reason)


def _find(simulation: Simulation, name: str) -> Entity:
    found = entities(simulation)
    if name not in found:
        raise RefusedError(Result.RESULT_NOT_FOUND, f"entity: {name!r}; expected one of {', '.join(found)}")
    return found[name]


def _filter(filters: Any) -> Callable[[str, Entity], bool]:
    """Return whether filters hold for an entity of a name."""
    if filters.tags.tags:
        raise _unsupported("filters.tags: entities have no tags")
    points = filters.bounds.points
    if points and (filters.bounds.type != Bounds.TYPE_SPHERE or len(points) != 2):
        raise _unsupported("filters.bounds: expected a sphere: its centre, and a point whose x is the radius")
    try:
        pattern = re.compile(BRACKETS.sub(_set_of, filters.filter))
    except (re.error, OverflowError, RecursionError, ValueError) as error:
        raise ValueError(f"filters.filter: {filters.filter!r}: {error}") from None
    categories = {one.category for one in filters.categories} or CATEGORIES.values()

    def holds(name: str, entity: Entity) -> bool:
        if not pattern.search(name) or CATEGORIES[entity.kind] not in categories:
            return False
        far_m = [math.hypot(entity.pose.x_m - at.x, entity.pose.y_m - at.y, at.z) for at in points[:1]]
        return all(distance_m <= points[1].x + entity.reach_m for distance_m in far_m)

    return holds


def _set_of(found: re.Match[str]) -> str:
    """Return Python's set for a bracket expression of POSIX. Raises: ValueError: a class that there is not."""
    if found[2] is None:
        return found[0]

    def part(inner: re.Match[str]) -> str:
        if inner[1] is None:
            return f"\\{inner[0]}"  # stands for itself in POSIX, but not in Python
        if (name := inner[1].strip(":")) not in CLASSES:
            raise ValueError(f"[{inner[1]}] is not a class; expected one of {', '.join(CLASSES)}")
        return CLASSES[name]

    return f"[{found[1]}{IN_BRACKETS.sub(part, found[2])}]"


def _state(time_ns: int, entity: Entity) -> EntityState:
    """Return the state of an entity in `map`."""
    state, at, twist = EntityState(), PoseReading.from_pose(entity.pose), entity.twist
    state.header.frame_id = MAP_FRAME
    state.header.stamp.sec, state.header.stamp.nanosec = divmod(time_ns, 10**9)
    state.pose.position.x, state.pose.position.y = at.x_m, at.y_m
    state.pose.orientation.z, state.pose.orientation.w = at.qz, at.qw
    velocity = Pose(0.0, 0.0, entity.pose.yaw_rad) @ Pose(twist.linear_x_mps, twist.linear_y_mps, 0.0)
    state.twist.linear.x, state.twist.linear.y = velocity.x_m, velocity.y_m
    state.twist.angular.z = twist.angular_z_radps
    return state


def _length(vector: Any) -> float:
    return math.hypot(vector.x, vector.y, vector.z)


def _planar(frame: str, pose: Any, invalid: int) -> Pose:
    """Return a pose on the floor. Args: invalid: the standard's code for another one."""
    if frame not in ("", "world", MAP_FRAME):
        raise _unsupported(f"frame_id: {frame!r}; expected {MAP_FRAME}")
    at, turn = pose.position, pose.orientation
    if not abs(math.hypot(turn.x, turn.y, turn.z, turn.w) - 1.0) < 1e-3:
        raise RefusedError(invalid, "orientation: expected a quaternion of length 1")
    if not (math.isfinite(at.x + at.y) and max(abs(at.z), abs(turn.x), abs(turn.y)) < FLAT):
        raise RefusedError(invalid, "pose: expected one on the floor: finite x and y, z 0, turned about z only")
    return PoseReading(at.x, at.y, turn.z, turn.w).pose
