from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from msgspec.structs import astuple

from robotteamsim import scenario
from robotteamsim.errors import PlacementError, RecordingError, ScenarioError
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Task
from robotteamsim.network.messages import EVERYBODY, Message, NetworkState
from robotteamsim.scenario import sections
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading, state_of
from robotteamsim.simulation import Simulation, TrajectoryHash, simulation
from robotteamsim.world.contract import NO_OBJECTS, ObjectStates
from robotteamsim.world.doors import DoorStates


class FakeParts:
    """Stands in for all stages of a loop of two robots, and notes who was called with what."""

    def __init__(self) -> None:
        self.calls: list[tuple] = []
        self.step_index = 0
        self.num_robots = 2

    @property
    def sim_time_ns(self) -> int:
        return self.step_index * 100_000_000

    @property
    def names(self) -> list[str]:
        return [call[0] for call in self.calls]

    def world(self, scenario, robots) -> FakeWorld:
        return FakeWorld(self)

    def sensors(self, world, robots, seed, hazards) -> FakeSensors:
        return FakeSensors(self)

    def hearing(self, loaded) -> FakeHearing:
        return FakeHearing(self)

    def network(self, loaded, world) -> FakeNetwork:
        return FakeNetwork(self)

    def controller(self, robot_id, loaded, arrival) -> FakeController:
        return FakeController(self, robot_id)


@dataclasses.dataclass
class FakeWorld:
    parts: FakeParts
    num_robots: int = 2
    team_version: int = 0
    present: np.ndarray = dataclasses.field(default_factory=lambda: np.ones(2, dtype=bool))
    arrivals: tuple[int, ...] = (1, 1)
    mishaps: dict[int, str] = dataclasses.field(default_factory=dict)
    loads: dict[int, str] = dataclasses.field(default_factory=dict)

    @property
    def step_index(self) -> int:
        return self.parts.step_index

    @property
    def sim_time_ns(self) -> int:
        return self.parts.sim_time_ns

    def door_states(self) -> DoorStates:
        return DoorStates()

    def object_states(self) -> ObjectStates:
        return NO_OBJECTS

    def step(self, twists) -> None:
        self.parts.step_index += 1
        self.parts.calls.append(("world", [twist.linear_x_mps for twist in twists]))


@dataclasses.dataclass
class FakeSensors:
    parts: FakeParts

    def read(self):
        self.parts.calls.append(("sensors",))
        pose = PoseReading(3.0 + self.parts.step_index, 5.0, 0.0, 1.0)
        still = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())
        ranges_m = np.ones(3, np.float32)
        robots = [RobotReading(pose, Twist(0.5), still, ranges_m, in_contact=False)] * 2
        return state_of(robots, [VoiceReading(0.0, False, (3.0, 5.0), 0.0)] * 2)


class FakeVoices:
    @staticmethod
    def speaker(place_m):
        return None


@dataclasses.dataclass
class FakeHearing:
    parts: FakeParts
    sensor = FakeVoices()
    new_map: None = None

    def step(self, state, moved, silent):
        assert not moved
        self.parts.calls.append(("hearing", tuple(silent)))


@dataclasses.dataclass
class FakeNetwork:
    parts: FakeParts

    def step(self, state, outboxes):
        self.parts.calls.append(("network", [[m.payload for m in outbox] for outbox in outboxes]))
        none = np.zeros((2, 2), bool)
        numbers = {"rssi_dbm": np.zeros((2, 2)), "hop_count": np.zeros((2, 2), np.int32)}
        state.put_links(adjacency=none, endangered=none, fiedler_value=0.0, version=1, **numbers)
        return NetworkState(state), [tuple(m for outbox in outboxes for m in outbox if m.sender != i) for i in range(2)]


class FakeController:
    def __init__(self, parts: FakeParts, robot_id: int) -> None:
        self.parts, self.robot_id = parts, robot_id

    def step(self, observation, inbox, task) -> Decision:
        assert observation.robot_id == self.robot_id
        assert observation.sim_time_ns == self.parts.sim_time_ns
        self.parts.calls.append((f"controller {self.robot_id}", [m.payload for m in inbox], task))
        step = self.parts.step_index
        message = Message(self.robot_id, EVERYBODY, f"step {step} of {self.robot_id}")
        return Decision(Twist(step + 0.1 * self.robot_id), outbox=(message,))


@pytest.fixture
def parts(monkeypatch) -> FakeParts:
    fakes = FakeParts()
    monkeypatch.setattr(simulation, "make_world", fakes.world)
    monkeypatch.setattr(simulation, "RobotSensors", fakes.sensors)
    monkeypatch.setattr(simulation, "HearingStage", fakes.hearing)
    monkeypatch.setattr(simulation, "NetworkStage", fakes.network)
    monkeypatch.setattr("robotteamsim.simulation.controllers.make_controller", fakes.controller)
    return fakes


def test_stages_follow_the_story(parts, hall_scenario):
    Simulation(hall_scenario()).step()
    assert parts.names == [
        "world",
        "sensors",
        "hearing",
        "network",
        "controller 0",
        "controller 1",
    ]


def test_first_step_moves_nobody_delivers_nothing_and_has_no_task(parts, hall_scenario):
    Simulation(hall_scenario()).step()
    calls = {call[0]: call[1:] for call in parts.calls}
    assert calls["world"] == ([0.0, 0.0],)
    assert calls["hearing"] == ((),)
    assert calls["network"] == ([[], []],)
    assert calls["controller 0"] == ([], Task())


def test_twists_messages_and_task_are_those_of_the_step_before(parts, hall_scenario):
    loop = Simulation(hall_scenario())
    first = loop.step()
    parts.calls.clear()
    second = loop.step()
    calls = {call[0]: call[1:] for call in parts.calls}
    assert calls["world"] == ([1.0, 1.1],)
    assert calls["network"][0] == [["step 1 of 0"], ["step 1 of 1"]]
    assert calls["controller 1"] == (["step 1 of 0"], first.mission.task)
    assert first.mission.task.running
    assert second.inboxes[1][0] is first.decisions[0].outbox[0]


def test_saved_victims_are_silent_from_the_next_step_on(parts, hall_scenario):
    loop = Simulation(
        hall_scenario(mission=sections.Mission(victims=(sections.Victim(name="eve", position=(4.0, 5.0)),)))
    )
    assert loop.step().mission.victims == ("saved",)
    parts.calls.clear()
    loop.step()
    assert parts.calls[2] == ("hearing", ("eve",))


def test_victim_outside_the_plan_is_rejected_with_the_override_that_put_them_there():
    loaded = scenario.load("garage_sar", ["mission.victims.0.position=[99, 5]"])
    with pytest.raises(PlacementError, match=r"^--set: mission\.victims\.0\.position: \[99, 5\] lies outside the plan"):
        Simulation(loaded)


@pytest.mark.parametrize(
    ("position_m", "reason"),
    [
        ((float("nan"), 1.0), r"position\.0: \.nan is not a finite number$"),
        ((1e5, 1.0), r"position: \[100000, 1\] lies outside the plan, "),
    ],
)
def test_victim_at_an_impossible_place_is_rejected(position_m, reason):
    with pytest.raises(ValueError, match=rf"^set_victim: ann: {reason}"):
        Simulation(scenario.load("garage_sar")).set_victim("ann", position_m)


def test_name_of_a_victim_that_cannot_be_is_shown_in_one_line():
    with pytest.raises(ValueError, match=r"^set_victim: a\\nb: name: 'a b' has control characters$"):
        Simulation(scenario.load("garage_sar")).set_victim("a\nb", (1.0, 1.0))


@pytest.mark.parametrize("noise_db", [float("nan"), float("inf"), -1.0, 99.0])
def test_noise_out_of_range_is_rejected(noise_db, hall_scenario):
    with pytest.raises(ValueError, match="noise_db"):
        Simulation(hall_scenario()).set_noise_db(noise_db)


def test_voice_map_is_recorded_when_it_changes(hall_scenario):
    loop = Simulation(hall_scenario())
    assert loop.step().voice_map is not None
    assert loop.step().voice_map is None
    loop.set_noise_db(20.0)
    assert loop.step().voice_map is not None


class Witness:
    """An observer that notes what it is told, and may fail at a step or at the end."""

    def __init__(self, fails_at: int | str | None = None) -> None:
        self.told: list[str] = []
        self.fails_at = fails_at
        self.records = []

    def begin(self, loaded) -> None:
        self.told.append("begin")

    def step(self, record) -> None:
        self.records.append(record)
        if self.fails_at == record.step_index:
            raise RecordingError("the disk is full")

    def end(self, result) -> None:
        if self.fails_at == "end":
            raise RecordingError("the disk is full")
        self.told.append("end")

    def abandon(self) -> None:
        self.told.append("abandon")


def short(hall_scenario, seed: int = 1, steps: int = 20) -> scenario.Scenario:
    loaded = hall_scenario(seed)
    mission = loaded.mission.model_copy(update={"time_limit_s": 0.1 * steps})
    return loaded.model_copy(update={"mission": mission})


def test_run_gives_observers_every_step_until_the_mission_ends(hall_scenario):
    witness = Witness()
    result = Simulation(short(hall_scenario)).run([witness])
    assert witness.told == ["begin", "end"]
    assert [record.step_index for record in witness.records] == list(range(1, 22))
    assert [record.mission.state for record in witness.records].index("ended") == 20
    assert (result.end, result.steps, result.time_s, result.sim_time_s) == ("time_limit", 21, 2.0, 2.1)


def test_mission_without_autostart_is_started_by_run(hall_scenario):
    loaded = short(hall_scenario)
    mission = loaded.mission.model_copy(update={"autostart": False})
    waiting = loaded.model_copy(update={"mission": mission})
    assert Simulation(waiting).run().trajectory_hash == Simulation(loaded).run().trajectory_hash


def test_name_is_not_simulated():
    with pytest.raises(
        ScenarioError, match=r"^Simulation: 'garage_sar' is not a Scenario; robotteamsim\.load returns one$"
    ):
        Simulation("garage_sar")


def test_mission_that_has_ended_is_not_run_again(hall_scenario):
    simulation = Simulation(short(hall_scenario))
    simulation.run()
    witness = Witness()
    with pytest.raises(ValueError, match=r"^run: the mission has ended; make another Simulation$"):
        simulation.run([witness])
    assert witness.told == []


def test_robot_obeys_a_command_in_the_next_step(hall_scenario):
    simulation = Simulation(short(hall_scenario))
    simulation.command({0: Twist(0.5)})
    simulation.step()
    assert simulation.world.twists()[0].linear_x_mps > 0.0


@pytest.mark.parametrize(
    ("twists", "message"),
    [
        ({99: Twist()}, r"command: there is no robot 99, only 0 to \d$"),
        ({-1: Twist()}, "command: there is no robot -1, "),
        ({"0": Twist()}, "command: there is no robot '0', "),
        ({0: Twist(math.nan)}, r"command: robot 0: Twist\(linear_x_mps=nan, .*; expected a Twist of finite numbers$"),
        ({0: None}, "command: robot 0: None; expected a Twist of finite numbers"),
    ],
)
def test_command_that_no_robot_can_obey_is_rejected_at_once(hall_scenario, twists, message):
    simulation = Simulation(short(hall_scenario))
    with pytest.raises(ValueError, match=message):
        simulation.command(twists)
    simulation.step()


def test_command_for_a_robot_that_was_removed_is_rejected_until_it_is_back(hall_scenario):
    simulation = Simulation(short(hall_scenario))
    simulation.remove_robot(1)
    with pytest.raises(ValueError, match=r"^command: robot 1 is absent; record.is_there\(1\) says so$"):
        simulation.command({0: Twist(0.5), 1: Twist(0.5)})
    assert not simulation.step().is_there(1)
    simulation.spawn_robot(1)
    simulation.command({1: Twist(0.5)})
    assert simulation.step().is_there(1)
    assert simulation.world.twists()[1].linear_x_mps > 0.0


@pytest.mark.parametrize(
    ("do", "message"),
    [
        (lambda simulation: simulation.run([None]), "run: None is not an Observer; expected a list of them"),
        (lambda simulation: simulation.run(5), "run: 5 is not an Observer; expected a list of them"),
        (lambda simulation: simulation.command(None), "command: None; expected a Twist by robot"),
        (lambda simulation: simulation.command({0: Twist("a")}), r"command: robot 0: Twist\(linear_x_mps='a', "),
        (lambda simulation: simulation.spawn_robot(None), "robot_id must be in 0..1, got None"),
        (lambda simulation: simulation.spawn_robot(1.0), "robot_id must be in 0..1, got 1.0"),
        (lambda simulation: simulation.spawn_robot(1, (3, 3, 0)), r"robot_1: pose: \(3, 3, 0\); expected a Pose"),
        (lambda simulation: simulation.spawn_robot(1, Pose("a", 3, 0)), r"robot_1: pose must be finite, got Pose\("),
        (lambda simulation: simulation.drop_object("a"), "robot_id must be in 0..1, got 'a'"),
        (lambda simulation: simulation.set_door([], closed=True), r"unknown door '\[\]'; known: "),
        (lambda simulation: simulation.set_noise_db(np.zeros(2)), r"noise_db: array\(\[0., 0.\]\) is not a number"),
        (lambda simulation: simulation.decide(None), "decide: None; expected what sense returns"),
    ],
)
def test_value_of_another_kind_is_a_value_error_of_one_line(hall_scenario, do, message):
    simulation = Simulation(short(hall_scenario))
    simulation.remove_robot(1)
    with pytest.raises(ValueError, match=f"^{message}"):
        do(simulation)


def test_observer_that_pauses_the_mission_is_rejected(hall_scenario):
    simulation = Simulation(short(hall_scenario))
    observer = Witness()
    observer.step = lambda record: simulation.mission.pause()
    with pytest.raises(ValueError, match=r"^run: an observer has paused the mission; expected"):
        simulation.run([observer])


def test_observers_that_come_later_are_not_asked(hall_scenario):
    observers = [Witness()]
    observers[0].begin = lambda setup: observers.append(Witness())
    Simulation(short(hall_scenario)).run(observers)
    assert [len(observer.records) > 0 for observer in observers] == [True, False]


def test_observers_abandon_when_one_of_them_fails(hall_scenario):
    good, bad = Witness(), Witness(fails_at=3)
    with pytest.raises(RecordingError, match="the disk is full"):
        Simulation(short(hall_scenario)).run([good, bad])
    assert good.told == bad.told == ["begin", "abandon"]
    assert len(good.records) == 3


def test_observer_that_has_ended_is_not_asked_to_abandon(hall_scenario):
    good, bad, last = Witness(), Witness(fails_at="end"), Witness()
    with pytest.raises(RecordingError):
        Simulation(short(hall_scenario)).run([good, bad, last])
    assert good.told == ["begin", "end"]
    assert bad.told == last.told == ["begin", "abandon"]


def test_equal_seeds_give_equal_trajectories_and_others_do_not(hall_scenario):
    hashes = [Simulation(short(hall_scenario, seed, steps=50)).run().trajectory_hash for seed in (7, 7, 8)]
    assert hashes[0] == hashes[1]
    assert hashes[0] != hashes[2]


@pytest.mark.slow
@pytest.mark.parametrize(
    "switch", ["communication.gated=false", "rule_out_places=false", "navigation=straight", "memory_of=commands"]
)
def test_each_addition_to_rdpso_that_is_switched_off_changes_the_mission(switch):
    def driven(*keys: str) -> str:
        limits = ["run.seed=7", "mission.time_limit_s=100"]  # the first place is ruled out after 20 s
        return Simulation(scenario.load("garage_sar", [*limits, *keys])).run().trajectory_hash

    assert driven(f"control.{switch}") != driven()


def test_observers_do_not_change_the_trajectories(hall_scenario):
    alone = Simulation(short(hall_scenario)).run()
    watched = Simulation(short(hall_scenario)).run([Witness()])
    assert alone.trajectory_hash == watched.trajectory_hash


def test_result_hash_is_that_of_the_recorded_ground_truth(hall_scenario):
    witness, by_hand = Witness(), TrajectoryHash()
    result = Simulation(short(hall_scenario)).run([witness])
    for record in witness.records:
        by_hand.update(record.sim_time_ns, np.array([astuple(reading.ground_truth) for reading in record.readings]))
    assert by_hand.hexdigest() == result.trajectory_hash


def test_distances_are_the_lengths_of_the_true_paths(hall_scenario):
    witness = Witness()
    result = Simulation(short(hall_scenario)).run([witness])
    path = np.array([[r.readings[1].ground_truth.x_m, r.readings[1].ground_truth.y_m] for r in witness.records])
    assert result.robots[1].distance_m == pytest.approx(np.hypot(*np.diff(path, axis=0).T).sum())


def test_small_mission_is_done(hall_scenario):
    result = Simulation(hall_scenario()).run()
    assert (result.end, result.areas_explored) == ("areas_explored", 2)
    assert max(robot.longest_stay_s for robot in result.robots) < 20.0


@pytest.mark.slow
@pytest.mark.parametrize("name", scenario.scenario_names())
def test_every_shipped_scenario_runs_ten_steps(name):
    loop = Simulation(scenario.load(name))
    records = [loop.step() for _ in range(10)]
    assert records[-1].sim_time_ns == 10 * round(loop.scenario.run.step_s * 1e9)
    assert records[-1].mission.state == "running"
