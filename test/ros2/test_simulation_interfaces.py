"""Control by simulation_interfaces, the standard for simulators in ROS 2."""

from __future__ import annotations

import json
import math
import os
import re
import threading
from pathlib import Path

import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist, Vector3
from peer import MISSION
from rclpy.action import ActionClient
from running import running
from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.msg import (
    Bounds,
    EntityCategory,
    EntityFilters,
    EntityState,
    Resource,
    Result,
    SimulationState,
    SimulatorFeatures,
    TagsFilter,
)
from simulation_interfaces.srv import ResetSimulation, SetEntityState, SetSimulationState, SpawnEntity
from std_msgs.msg import Header

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

GARAGE = (*MISSION, "garage_sar", "--seed", "7", "--lockstep", "--controllers", "inside", "--speed", "0")
OK, FAILED, UNSUPPORTED = Result.RESULT_OK, Result.RESULT_OPERATION_FAILED, Result.RESULT_FEATURE_UNSUPPORTED
STOPPED, PLAYING, PAUSED = SimulationState.STATE_STOPPED, SimulationState.STATE_PLAYING, SimulationState.STATE_PAUSED
CRATE = "{kind: box, size_m: [0.6, 0.4], mass_kg: 5}"


class Standard:
    """The services of the standard, each by its name: standard.get_entities(...) returns code, message, response."""

    def __init__(self, peer):
        self.peer = peer

    def __getattr__(self, name):
        def call(**request):
            type_name = f"simulation_interfaces/{name.title().replace('_', '')}"
            response = self.peer.call(f"/simulation/{name}", type_name, **request)
            return response.result.result, response.result.error_message, response

        return call

    def state(self):
        code, _, response = self.get_simulation_state()
        assert code == OK
        return response.state.state

    def set_state(self, state):
        return self.set_simulation_state(state=SimulationState(state=state))[:2]

    def pose(self, entity):
        code, message, response = self.get_entity_state(entity=entity)
        assert code == OK, message
        return response.state.pose

    def place(self, entity, pose, **request):
        request = {"set_pose": True} | request
        return self.set_entity_state(entity=entity, state=EntityState(pose=pose), **request)[:2]

    def spawn(self, name="", pose=None, *, uri="", text="", frame="", **request):
        stamped = PoseStamped(header=Header(frame_id=frame), pose=pose or at(30.0, 5.0))
        resource = Resource(uri=uri, resource_string=text)
        return self.spawn_entity(name=name, entity_resource=resource, initial_pose=stamped, **request)

    def entities(self, **filters):
        code, message, response = self.get_entities(filters=EntityFilters(**filters))
        return response.entities if code == OK else (code, message)


def at(x, y, yaw=0.0, z=0.0):
    turn = Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    return Pose(position=Point(x=x, y=y, z=z), orientation=turn)


@pytest.fixture
def standard(tmp_path, peer):
    """A mission that is paused before its first step."""
    with running((*GARAGE, "--paused"), tmp_path) as mission:
        peer.wait_until(lambda: peer.node.count_publishers("/clock"), "the simulation")
        yield Standard(peer)
    assert "Traceback" not in mission.output


@pytest.fixture
def simulate(peer):
    """A client of the action: returns the handle of a goal, and the list of its feedbacks."""
    client = ActionClient(peer.node, SimulateSteps, "/simulation/simulate_steps")

    def send(steps, notify=lambda _: None):
        feedbacks = []

        def receive(message):
            feedbacks.append((message.feedback.completed_steps, message.feedback.remaining_steps))
            notify(message.feedback)

        assert client.wait_for_server(60.0)
        future = client.send_goal_async(SimulateSteps.Goal(steps=steps), feedback_callback=receive)
        peer.wait_until(future.done, "the goal")
        return future.result(), feedbacks

    yield send
    client.destroy()


def result_of(peer, goal):
    future = goal.get_result_async()
    peer.wait_until(future.done, "the result")
    return future.result().status, future.result().result.result


@pytest.mark.parametrize(
    ("name", "released"),
    [
        ("msg/Result", "cf43a306adff3337a0a47143d8f5689933bc70a30478f13b077dc1fe3bc5ad17"),
        ("msg/SimulatorFeatures", "8b101c8529bc0ea3dcf056078254768f39832b9ef0adaf93bd5cea96c0de3305"),
        ("srv/GetEntitiesStates", "0a76170d0c1c90e1eaf805cfab78ea801d1f82df309a28c1f0fae4b570f19754"),
        ("srv/SpawnEntity", "66860313e11009faddbfc8568e5d410d1a11607fe75eeb1308671dc0406fe3a7"),
        ("srv/StepSimulation", "913fe0653690ce6bf8f09f316e6a626747012e9fca31e26719910d417aa8565c"),
    ],
)
def test_types_have_the_hashes_of_the_released_standard(name, released):
    share = Path(os.environ["AMENT_PREFIX_PATH"], "share", "simulation_interfaces", f"{name}.json")
    hashes = {entry["type_name"]: entry["hash_string"] for entry in json.loads(share.read_text())["type_hashes"]}
    assert hashes[f"simulation_interfaces/{name}"] == f"RIHS01_{released}"


def test_services_and_the_action_are_below_the_name_of_the_node(standard, peer):
    names = (
        *("get_simulator_features", "get_simulation_state", "set_simulation_state", "reset_simulation"),
        *("step_simulation", "spawn_entity", "delete_entity", "get_entities", "get_entities_states"),
        *("get_entity_state", "set_entity_state"),
    )
    wanted = {
        f"/simulation/{name}": [f"simulation_interfaces/srv/{name.title().replace('_', '')}"] for name in names
    } | {
        "/simulation/simulate_steps/_action/send_goal": ["simulation_interfaces/action/SimulateSteps_SendGoal"],
    }
    known = peer.wait_until(
        lambda: wanted.keys() <= (types := dict(peer.node.get_service_names_and_types())).keys() and types, "services"
    )
    assert {name: known[name] for name in wanted} == wanted


def test_features_name_what_is_there(standard, peer):
    features = peer.call("/simulation/get_simulator_features", "simulation_interfaces/GetSimulatorFeatures").features
    assert SimulatorFeatures.STEP_SIMULATION_ACTION in features.features
    assert SimulatorFeatures.SPAWNING in features.features
    for missing in ("WORLD_LOADING", "ENTITY_BOUNDS_BOX", "ENTITY_TAGS", "SIMULATION_RESET_TIME", "SPAWNABLES"):
        assert getattr(SimulatorFeatures, missing) not in features.features
    assert features.spawn_formats == ["robotteamsim"]
    assert "'objects'" in features.custom_info


def test_mission_stepped_by_the_standard_has_the_hash_of_a_run_without_ros(tmp_path, peer, simulate):
    with running((*GARAGE, "--paused", "--set", "mission.time_limit_s=30"), tmp_path) as mission:
        standard = Standard(peer)
        assert standard.step_simulation()[0] == OK  # by default one
        assert standard.step_simulation(steps=149)[0] == OK
        goal, _ = simulate(149)
        assert result_of(peer, goal)[0] == GoalStatus.STATUS_SUCCEEDED
        client = peer.node.create_client(SetSimulationState, "/simulation/set_simulation_state")
        peer.wait_until(client.service_is_ready, "the service")
        client.call_async(SetSimulationState.Request(state=SimulationState(state=PLAYING)))
        assert mission.wait() == 0, mission.output
    headless = Simulation(load("garage_sar", ["run.seed=7", "mission.time_limit_s=30"])).run()
    assert headless.trajectory_hash in mission.output


def test_state_of_the_simulation_is_set_and_shown(standard):
    assert standard.state() == PAUSED
    assert standard.set_state(PAUSED) == (101, "the simulation is paused already")
    assert standard.step_simulation()[0] == OK
    assert standard.set_state(STOPPED) == (OK, "")
    assert standard.state() == STOPPED
    refused = standard.step_simulation()
    assert refused[:2] == (FAILED, "the simulation is stopped; expected paused")
    assert standard.set_state(PAUSED) == (OK, "")
    assert standard.state() == PAUSED
    stamp = standard.get_entity_state(entity="robot_0")[2].state.header.stamp
    assert (stamp.sec, stamp.nanosec) == (0, 0)
    assert standard.set_state(PLAYING) == (OK, "")
    assert standard.state() == PLAYING
    assert standard.step_simulation()[:2] == (FAILED, "the simulation is playing; expected paused")
    assert standard.set_state(PAUSED) == (OK, "")
    assert standard.set_state(SimulationState.STATE_NO_WORLD) == (UNSUPPORTED, "state: 4; expected 0 to 3")


def test_simulation_quits_with_a_response(tmp_path, peer):
    with running((*GARAGE, "--paused"), tmp_path) as mission:
        assert Standard(peer).set_state(SimulationState.STATE_QUITTING) == (OK, "")
        assert mission.wait() == 0, mission.output
    assert "Traceback" not in mission.output


def test_reset_starts_again_and_takes_away_what_was_spawned(standard):
    start = standard.pose("robot_0")
    assert standard.spawn("crate", text=CRATE)[0] == OK
    assert standard.step_simulation(steps=20)[0] == OK
    assert standard.pose("robot_0") != start
    for scope in (ResetSimulation.Request.SCOPE_TIME, ResetSimulation.Request.SCOPE_STATE):
        code, message, _ = standard.reset_simulation(scope=scope)
        assert (code, message) == (UNSUPPORTED, f"scope: {scope}; expected 255, for all")
    assert standard.reset_simulation()[0] == OK
    assert standard.pose("robot_0") == start
    assert "crate" not in standard.entities()
    assert standard.state() == PAUSED
    assert standard.step_simulation(steps=0)[:2] == (FAILED, "steps: 0; expected at least 1")


def test_action_gives_feedback_after_each_step(standard, simulate, peer):
    matched = []

    def receives_feedback():  # which the server sends to nobody until it has found the client
        goal, feedbacks = simulate(1)
        result_of(peer, goal)
        matched.append(feedbacks)
        return any(matched)

    peer.wait_until(receives_feedback, "the first feedback")
    assert standard.reset_simulation()[0] == OK
    goal, feedbacks = simulate(5)
    # The client drops feedback that comes after a result.
    peer.wait_until(lambda: len(feedbacks) == 5, "feedback of five steps")
    status, result = result_of(peer, goal)
    assert (status, result.result) == (GoalStatus.STATUS_SUCCEEDED, OK)
    assert feedbacks == [(1, 4), (2, 3), (3, 2), (4, 1), (5, 0)]
    stamp = standard.get_entity_state(entity="robot_0")[2].state.header.stamp
    assert stamp.nanosec == 500_000_000


def test_action_that_cannot_send_all_feedback_succeeds_and_counts_it(tmp_path, peer, simulate, break_every_third):
    break_every_third("rclpy.action.server", "ServerGoalHandle", "publish_feedback")
    with running((*GARAGE, "--paused"), tmp_path) as mission:
        goal, _ = simulate(7)
        status, result = result_of(peer, goal)
    assert (status, result.result) == (GoalStatus.STATUS_SUCCEEDED, OK)
    assert "/simulation/simulate_steps/_action/feedback: a message could not be sent" in mission.output
    assert "2 messages could not be sent, because receivers were too slow" in mission.output
    assert "Traceback" not in mission.output


def test_action_is_cancelled_between_two_steps(standard, simulate, peer):
    begun = threading.Event()
    goal, _ = simulate(10**6, lambda _: begun.set())
    peer.wait_until(begun.is_set, "the first step")
    cancelling = goal.cancel_goal_async()
    peer.wait_until(cancelling.done, "the answer")
    status, result = result_of(peer, goal)
    assert (status, result.result) == (GoalStatus.STATUS_CANCELED, FAILED)
    assert result.error_message.endswith(" of 1000000 steps")
    assert standard.state() == PAUSED
    assert standard.step_simulation()[0] == OK


def test_action_is_refused_unless_the_simulation_is_paused(standard, simulate, peer):
    goal, _ = simulate(0)
    status, result = result_of(peer, goal)
    assert (status, result.error_message) == (GoalStatus.STATUS_ABORTED, "steps: 0; expected at least 1")
    assert standard.set_state(PLAYING)[0] == OK
    goal, _ = simulate(3)
    status, result = result_of(peer, goal)
    assert (status, result.result) == (GoalStatus.STATUS_ABORTED, FAILED)
    assert result.error_message == "the simulation is playing; expected paused"


def test_entities_are_robots_victims_and_objects_and_filtered(standard):
    assert standard.spawn("crate", text=CRATE)[0] == OK
    robots, victims = [f"robot_{i}" for i in range(3)], [f"victim_{i}" for i in range(1, 5)]
    assert standard.entities() == [*victims, "crate", *robots]
    assert standard.entities(filter="^robot_[12]$") == ["robot_1", "robot_2"]
    humans = [EntityCategory(category=EntityCategory.CATEGORY_HUMAN)]
    assert standard.entities(categories=humans) == victims
    assert standard.entities(categories=humans, filter="3") == ["victim_3"]
    sphere = Bounds(type=Bounds.TYPE_SPHERE, points=[Vector3(x=31.0, y=5.0), Vector3(x=0.7)])
    assert standard.entities(bounds=sphere) == ["crate"]  # reaches 0.36 m from (30, 5)
    sphere.points[1].x = 0.6
    assert standard.entities(bounds=sphere) == []
    box = Bounds(type=Bounds.TYPE_BOX, points=[Vector3(), Vector3(x=1.0)])
    assert standard.entities(bounds=box)[0] == UNSUPPORTED
    assert standard.entities(tags=TagsFilter(tags=["red"])) == (UNSUPPORTED, "filters.tags: entities have no tags")
    for wrong in ("(", "a{99999999999999}", 3000 * "(" + 3000 * ")"):
        code, message = standard.entities(filter=wrong)
        assert code == FAILED
        # Long words are shortened, as in each line for users; the reason of Python follows.
        shown = r"'\({50,}\.\.\. " if len(wrong) > 400 else re.escape(f"{wrong!r}: ")
        assert re.fullmatch(rf"filters\.filter: {shown}\w[\w ,()-]+", message), message
        assert len(message) < 400


@pytest.mark.parametrize(
    ("posix", "found"),
    [
        ("robot_[[:digit:]]", "robot_0 robot_1 robot_2"),
        ("[[:alpha:]]+_1$", "victim_1 robot_1"),
        ("^[^[:space:]v]", "robot_0 robot_1 robot_2"),
        ("[[:digit:]v]_[[:digit:]]", ""),
        (r"[\d]", ""),  # in POSIX a backslash or a d
        ("[]m[]_[12-3]", "victim_1 victim_2 victim_3"),
        ("_(0|[[:alpha:]])$|m_[^1-3[:upper:]]", "victim_4 robot_0"),
    ],
)
def test_filters_are_extended_regular_expressions_of_posix(standard, posix, found):
    assert standard.entities(filter=posix) == found.split()


def test_class_of_characters_that_there_is_not_is_one_line(standard):
    for part in ("[:number:]", "[.a.]", "[=a=]"):
        code, message = standard.entities(filter=f"[{part}]")
        assert (code, message.partition(" is ")[0]) == (FAILED, f"filters.filter: '[{part}]': {part}")
        assert "expected one of alnum, alpha" in message


def test_states_are_the_true_ones_in_the_frame_of_the_map(standard, peer):
    truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
    peer.wait_until(lambda: peer.node.count_publishers("/robot_0/base_pose_ground_truth"), "the topic")
    assert standard.step_simulation(steps=30)[0] == OK
    peer.wait_until(lambda: truth and truth[-1].header.stamp.sec == 3, "the last step")
    true = truth[-1]
    code, _, response = standard.get_entities_states(filters=EntityFilters(filter="robot_0"))
    assert (code, response.entities) == (OK, ["robot_0"])
    (state,) = response.states
    assert (state.header.frame_id, state.header.stamp) == ("map", true.header.stamp)
    assert state.pose == true.pose.pose
    speed, turn = true.twist.twist.linear, state.pose.orientation
    yaw = 2.0 * math.atan2(turn.z, turn.w)
    assert math.hypot(speed.x, speed.y) > 0.1
    assert state.twist.linear.x == pytest.approx(speed.x * math.cos(yaw) - speed.y * math.sin(yaw))
    assert state.twist.linear.y == pytest.approx(speed.x * math.sin(yaw) + speed.y * math.cos(yaw))
    assert state.twist.angular.z == true.twist.twist.angular.z
    code, message, _ = standard.get_entity_state(entity="robot_9")
    assert code == Result.RESULT_NOT_FOUND
    assert "'robot_9'; expected one of victim_1" in message


def test_entities_are_placed(standard):
    assert standard.spawn("crate", text=CRATE)[0] == OK
    for name, pose in (("crate", at(32.0, 5.0, 1.0)), ("robot_1", at(34.0, 5.0, -2.0)), ("victim_1", at(36.0, 5.0))):
        assert standard.place(name, pose) == (OK, "")
        found = standard.pose(name)
        assert (found.position.x, found.position.y) == (pose.position.x, pose.position.y)
        assert found.orientation.z == pytest.approx(pose.orientation.z)


def test_entity_that_cannot_be_placed_is_refused(standard):
    invalid = SetEntityState.Response.INVALID_POSE
    for entity, pose, request, code, reason in (
        ("robot_7", at(30.0, 5.0), {}, Result.RESULT_NOT_FOUND, "entity: 'robot_7'; expected one of"),
        ("robot_1", at(-30.0, 5.0), {}, invalid, "robot_1"),
        ("robot_1", at(30.0, 5.0, z=1.0), {}, invalid, "expected one on the floor"),
        ("robot_1", at(math.nan, 5.0), {}, invalid, "expected one on the floor"),
        ("robot_1", Pose(orientation=Quaternion(w=0.0)), {}, invalid, "of length 1"),
        ("robot_1", at(30.0, 5.0), {"set_pose": False}, UNSUPPORTED, "set_pose: false; expected true"),
    ):
        refused = standard.place(entity, pose, **request)
        assert refused[0] == code
        assert reason in refused[1]


def test_velocities_and_other_frames_are_not_supported(standard):
    moving = EntityState(pose=at(30.0, 5.0), twist=Twist(linear=Vector3(x=1.0)))
    assert standard.set_entity_state(entity="robot_0", state=moving, set_pose=True)[0] == OK  # without its twist
    code, message, _ = standard.set_entity_state(entity="robot_0", state=moving, set_pose=True, set_twist=True)
    assert (code, message) == (UNSUPPORTED, "state.twist: is not 0; entities are set at rest")
    elsewhere = EntityState(header=Header(frame_id="odom"), pose=at(30.0, 5.0))
    code, message, _ = standard.set_entity_state(entity="robot_0", state=elsewhere, set_pose=True)
    assert (code, message) == (UNSUPPORTED, "frame_id: 'odom'; expected map")


def test_robot_is_deleted_and_spawned_again(standard):
    assert standard.delete_entity(entity="robot_1")[0] == OK
    assert standard.delete_entity(entity="robot_1")[0] == Result.RESULT_NOT_FOUND
    assert standard.entities(filter="robot") == ["robot_0", "robot_2"]
    taken = standard.spawn("robot_0", uri="robot")
    assert taken[:2] == (SpawnEntity.Response.NAME_NOT_UNIQUE, "name: 'robot_0'; expected an absent robot: robot_1")
    code, message, response = standard.spawn("robot_0", uri="robot", allow_renaming=True)
    assert (code, response.entity_name) == (OK, "robot_1"), message
    assert standard.pose("robot_1").position.x == 30.0
    full = standard.spawn("robot_8", at(33.0, 5.0), uri="robot", allow_renaming=True)
    assert full[:2] == (SpawnEntity.Response.NAME_INVALID, "name: 'robot_8'; expected an absent robot: none")
    assert standard.step_simulation()[0] == OK


def test_objects_are_spawned_renamed_and_deleted(standard):
    assert standard.spawn("crate", text=CRATE)[2].entity_name == "crate"
    assert standard.spawn("crate", at(32.0, 5.0), text=CRATE)[0] == SpawnEntity.Response.NAME_NOT_UNIQUE
    other = standard.spawn("crate", at(32.0, 5.0), text=CRATE, allow_renaming=True)
    assert (other[0], other[2].entity_name) == (OK, "crate_1"), other[1]
    named = "{name: drum, kind: barrel, radius_m: 0.3}"
    assert standard.spawn(pose=at(34.0, 5.0), text=named)[2].entity_name == "drum"
    assert standard.spawn(pose=at(36.0, 5.0), text=CRATE, allow_renaming=True)[2].entity_name == "box_1"
    assert standard.delete_entity(entity="crate")[0] == OK
    assert standard.entities(filter="crate|drum|box") == ["crate_1", "drum", "box_1"]
    code, message, _ = standard.delete_entity(entity="victim_1")
    assert (code, message) == (UNSUPPORTED, "entity: victim_1 is a victim; expected a robot or an object")


def test_entity_that_cannot_be_spawned_is_refused(standard):
    codes = SpawnEntity.Response
    for request, code, reason in (
        ({"text": CRATE}, codes.NAME_INVALID, "name: ''; expected a name that no entity has"),
        ({"name": "x"}, codes.NO_RESOURCE, "entity_resource: is empty"),
        ({"name": "x", "uri": "file:///x.sdf"}, codes.UNSUPPORTED_FORMAT, "'file:///x.sdf'; expected"),
        ({"name": "x", "text": "<sdf>"}, codes.RESOURCE_PARSE_ERROR, "<sdf>"),
        ({"name": "x", "text": "{kind: box"}, codes.RESOURCE_PARSE_ERROR, "resource_string"),
        ({"name": "x", "text": "{kind: box}"}, codes.RESOURCE_PARSE_ERROR, "size_m: missing"),
        ({"name": "x", "text": CRATE, "pose": at(-50.0, 5.0)}, codes.INVALID_POSE, "x"),
        ({"name": "x", "text": CRATE, "frame": "robot_0/odom"}, UNSUPPORTED, "frame_id: 'robot_0/odom'; expected map"),
        ({"name": "x", "text": CRATE, "entity_namespace": "y"}, UNSUPPORTED, "entity_namespace: 'y'; expected none"),
    ):
        refused = standard.spawn(**request)
        assert refused[0] == code, refused[1]
        assert reason in refused[1]
