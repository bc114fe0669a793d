"""The step loop, written once: one trial in one process."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from robotteamsim import _core
from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.geometry import Pose, Twist, are_finite
from robotteamsim.interface import Decision, Task
from robotteamsim.mission import Mission
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission as MissionSection
from robotteamsim.scenario.sections import Victim, Voice
from robotteamsim.sensing.robots import RobotSensors, Sensors
from robotteamsim.setup import Setup, check_headless, resolve
from robotteamsim.simulation.controllers import Controllers, TeamControllers
from robotteamsim.simulation.passages import PassageStage
from robotteamsim.simulation.record import Observer, Result, StepRecord
from robotteamsim.simulation.stages import (
    FireStage,
    HearingStage,
    NetworkStage,
    NoHazards,
    PeopleStage,
    ScheduleStage,
)
from robotteamsim.simulation.timings import OBSERVERS, StageTime, StageTimes
from robotteamsim.simulation.trial import Trial
from robotteamsim.wording import printable
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.placement import check_mission
from robotteamsim.world.world import make_world


class Simulation:
    """One trial of a scenario. It depends on nothing but the scenario, which includes the seed.

    The stages pass each other only what ROS messages of the same stamp, or of the step before, can carry: in step k
    the world moves by the twists of step k-1, the network delivers what was sent in step k-1, controllers know the
    mission's task as of step k-1. Nodes that wait for the same stamps therefore compute the same bits.
    """

    def __init__(
        self,
        of: Scenario | Setup,
        *,
        controllers: Controllers | None = None,
    ) -> None:
        """Build all stages.

        Args:   of: a scenario, or an already resolved one.
                controllers: in place of the scenario's, such as programs outside this process.
        Raises: PlacementError, ScenarioError: no room for a robot, object, area or victim.
        """
        if not isinstance(of, (Scenario, Setup)):
            raise ScenarioError(f"Simulation: {of!r:.60} is not a Scenario; robotteamsim.load returns one")
        setup = of if isinstance(of, Setup) else resolve(of)
        scenario, robots = setup.scenario, setup.robots
        self.setup, self.scenario = setup, scenario
        self.schedule = ScheduleStage(scenario.schedule)
        self.world = make_world(scenario, robots)
        self.hazards = NoHazards() if scenario.fire is None else FireStage(setup, self.world)
        """Fire and smoke."""
        self.passages = PassageStage(setup, self.world, self.hazards) if scenario.plan.passages else None
        """The robots that go from level to level; None if no way leads to another."""
        self.people = PeopleStage(setup, self.world)
        """The victims who move."""
        self.sensors: Sensors = RobotSensors(self.world, robots, scenario.run.seed, self.hazards.source)
        """Of the robots; may be replaced before the first step, such as where readings come from outside."""
        self.hearing = HearingStage(setup)
        """The voices of victims."""
        self.network = NetworkStage(setup, self.world)
        self.controllers: Controllers = controllers or TeamControllers(setup)
        self.mission = Mission(setup, self.hearing.sensor.speaker)
        self._doors = DoorStates.at_start(scenario.plan)
        # What a step knows of the step before: decisions, the mission's task, and the names of silent victims.
        self._decisions: Sequence[Decision] = tuple(Decision() for _ in robots)
        self._task = Task()
        self._silent: tuple[str, ...] = ()
        self._times: StageTimes | None = None

    def step(self) -> StepRecord:
        """Advance by one step and return its record, which observers receive."""
        return self.decide(self.sense())

    def sense(self) -> StepRecord:
        """Advance up to what the controllers perceive in this step; then comes `decide`, which completes the record."""
        world, hazards, mission = self.world, self.hazards, self.mission
        self.schedule.step(world.sim_time_ns, self)
        twists = hazards.slowed([decision.twist for decision in self._decisions])
        if self.passages is None:
            world.step(twists)
        else:
            world.step(self.passages.held(twists))
            self.passages.step(self._decisions, self._task)
        hazards.step()
        moved = self.people.step(mission.status.victims, self._task.assistance, hazards.field)
        self._follow_doors()
        state = self.sensors.read()
        self.hearing.step(state, moved, self._silent)
        network, inboxes = self.network.step(state, [decision.outbox for decision in self._decisions])
        return self._sensed(state, network, inboxes, moved)

    def _sensed(
        self,
        state: _core.state.State,
        network: NetworkState,
        inboxes: Sequence[Sequence[Message]],
        moved: Mapping[str, Point],
    ) -> StepRecord:
        """Return the record of a step before anybody decides."""
        world, hazards = self.world, self.hazards
        return StepRecord(
            step_index=world.step_index,
            sim_time_ns=world.sim_time_ns,
            state=state,
            network=network,
            inboxes=inboxes,
            task=self._task,
            voice_map=self.hearing.new_map,
            smoke=hazards.field,
            smoke_is_new=hazards.is_updated,
            failed=hazards.failed,
            ignited=hazards.ignited,
            burnt_doors=hazards.burnt_doors,
            moved=moved,
            people=self.people.states,
            people_version=self.people.version,
            decisions=self._decisions,
            events=(),
            **self._as_it_is(),
        )

    def _as_it_is(self) -> dict[str, Any]:
        """Return the parts of a record that others can change between two steps."""
        world, mission = self.world, self.mission
        return {
            "doors": world.door_states(),
            "team_version": world.team_version,
            "present": world.present,
            "arrivals": world.arrivals,
            "mishaps": world.mishaps,
            "loads": world.loads,
            "objects": world.object_states(),
            "mission": mission.status,
            "victims": mission.victims,
            "noise_db": mission.noise_db,
            "egress": mission.egress,
        }

    def decide(self, record: StepRecord) -> StepRecord:
        """Complete a step: let the controllers decide and the mission judge, and return its record."""
        if not isinstance(record, StepRecord):
            raise ValueError(f"decide: {record!r:.60}; expected what sense returns")
        return self.judge(record, self.controllers.step(record))

    def judge(self, record: StepRecord, decisions: Sequence[Decision]) -> StepRecord:
        """Complete a step in which the team decides this, and return its record."""
        mission = self.mission
        self._decisions = record.decisions = decisions
        record.events = mission.step(record, decisions)
        self._task, self._silent = mission.status.task, mission.silent_victims
        record.mission, record.victims = mission.status, mission.victims
        record.noise_db, record.egress = mission.noise_db, mission.egress
        return record

    def pass_quietly(self, record: StepRecord, decisions: Sequence[Decision]) -> StepRecord:
        """As `judge`, for a step before `mission.quiet_until_ns` in which nothing has happened."""
        self._decisions = record.decisions = decisions
        self.mission.pass_quietly(record.sim_time_ns)
        record.mission = self.mission.status
        return record

    def look(self, record: StepRecord) -> StepRecord:
        """Return the record of the last step with what was changed since then, while no further step is made.

        A robot that came has measured nothing yet, but its pose.
        """
        world, state = self.world, record.state
        if world.team_version != record.team_version:
            state = _core.state.State(*record.state.ranges_m.shape)
            for robot_id, pose in enumerate(world.poses()):
                has_stayed = record.is_there(robot_id) and world.arrivals[robot_id] == record.arrivals[robot_id]
                if world.present[robot_id] and has_stayed:
                    state.put_reading(robot_id, record.readings[robot_id])
                elif world.present[robot_id]:
                    state.place(robot_id, pose)
        return msgspec.structs.replace(record, state=state, **self._as_it_is())

    def silence(self) -> bool:
        """Silence the victims who call no more, before robots that are moved elsewhere hear; whether that is new."""
        self.hearing.silence(self._silent)
        return self.hearing.new_map is not None

    def follow(self, steps: int, state: _core.state.State, outboxes: Sequence[Sequence[Message]]) -> StepRecord:
        """As `sense`, after steps that a batch has made, in a mission in which nothing else moves or changes.

        Args: steps: how many.  state: of the last one, with its links.  outboxes: whose messages arrive in it.
        """
        self.world.count_steps(steps)
        return self._sensed(state, *self.network.network.deliver(state, outboxes), {})

    def run(self, observers: Sequence[Observer] = ()) -> Result:
        """Run until the mission has ended, and report each step to the observers; a mission that waits is started.

        Whatever interrupts the run (an observer's RecordingError, a signal) is raised after every observer that began
        has abandoned the trial.

        Raises: ScenarioError: the robots' poses come from tf. ValueError: the mission has ended, or an observer pauses
                it, or something else is among the observers.
        """
        others = observers if isinstance(observers, Sequence) else [observers]
        for other in others:
            if not all(callable(getattr(other, method, None)) for method in ("begin", "step", "end", "abandon")):
                raise ValueError(f"run: {other!r:.60} is not an Observer; expected a list of them")
        check_headless(self.scenario)
        if self.mission.status.state == "ended":
            raise ValueError("run: the mission has ended; make another Simulation")
        trial = Trial(self.setup, observers)
        try:
            self.mission.start()
            add = trial.add if self._times is None else self._times.of(OBSERVERS, trial.add)
            while trial.result is None:
                add(self.step())
                if self.mission.status.state == "paused":
                    raise ValueError("run: an observer has paused the mission; expected calls of step instead of run")
            return trial.result
        finally:
            trial.abandon()

    def time_stages(self) -> None:
        """Measure from now on where the time of each step goes, see `timings`; a step then takes some us longer."""
        if self._times is None:
            times = StageTimes()
            times.measure(self)
            self._times = times

    def timings(self) -> tuple[StageTime, ...]:
        """Return how long each stage took so far, in the order of a step.

        Raises: ValueError: `time_stages` was not called.
        """
        if self._times is None:
            raise ValueError("timings: nothing was measured; call time_stages() before the steps")
        return self._times.table()

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door, see `World.set_door`. Raises: ValueError: no such door.

        Voice and radio follow the state of the world's door at once, the mission in the next step.
        """
        self.world.set_door(name, closed)
        self._follow_doors()

    def _follow_doors(self) -> None:
        """Let voices and radio through the doors that are open now."""
        doors = self.world.door_states()
        if doors.version == self._doors.version:
            return
        for name, closed in doors.closed_since(self._doors).items():
            self.hearing.sensor.set_door(name, closed)
            self.network.radio.set_door(name, closed)
        self._doors = doors

    def set_noise_db(self, noise_db: float) -> None:
        """Set the background noise [dB]. Raises: ValueError: it is out of the scenario's range."""
        checked(Voice, {"noise_db": noise_db}, ValueError)
        self.hearing.sensor.set_noise_db(noise_db)
        self.mission.set_noise_db(noise_db)

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot, see `World.remove_robot`. Its last messages are lost.

        Raises: ValueError: no such robot, or it is absent.
        """
        self.world.remove_robot(robot_id)
        self._decisions = [Decision() if i == robot_id else decision for i, decision in enumerate(self._decisions)]

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """Spawn an absent robot, see `World.spawn_robot`; it starts with a new controller.

        Raises: PlacementError: there is no room.
                ValueError: no such robot, it is present already, or the pose is not finite.
        """
        self.world.spawn_robot(robot_id, pose)
        # The last command of its former controller must not move it.
        self.command({robot_id: Twist()})

    def command(self, twists: Mapping[int, Twist]) -> None:
        """Let robots, by id, move in the next step by other commands than their controllers', as if driven by hand.

        Raises: ValueError: no such robot, it is absent, or a command is not finite.
        """
        present = self.world.present
        if not isinstance(twists, Mapping):
            raise ValueError(f"command: {twists!r:.60}; expected a Twist by robot")
        for robot_id, twist in twists.items():
            if robot_id not in range(len(present)):
                raise ValueError(f"command: there is no robot {robot_id!r}, only 0 to {len(present) - 1}")
            if not present[robot_id]:
                raise ValueError(f"command: robot {robot_id} is absent; record.is_there({robot_id}) says so")
            if not isinstance(twist, Twist) or not are_finite(*msgspec.structs.astuple(twist)):
                raise ValueError(f"command: robot {robot_id}: {twist!r}; expected a Twist of finite numbers")
        self._decisions = [
            msgspec.structs.replace(decision, twist=twists[robot_id]) if robot_id in twists else decision
            for robot_id, decision in enumerate(self._decisions)
        ]

    def take_passage(self, robot_id: int, level: str) -> None:
        """Let a robot at a stop of stairs, a ramp or a lift go to a level, see `PassageStage`.

        Raises: ValueError: no such robot or level, the robot is absent, or the plan has no passages.
        """
        if self.passages is None:
            raise ValueError("take_passage: the plan has no passages")
        self.passages.take(robot_id, level)

    def lift_object(self, robot_id: int, name: str) -> None:
        """Let a robot's gripper hold an object, see `AnyWorld.lift_object`. Raises: ValueError."""
        self.world.lift_object(robot_id, name)

    def drop_object(self, robot_id: int) -> None:
        """Open a robot's gripper. Raises: ValueError: no such robot, or it holds nothing."""
        self.world.drop_object(robot_id)

    def set_light(self, name: str, lit: bool) -> None:
        """Switch a light on or off. Raises: ValueError: no such light."""
        self.world.set_light(name, lit)

    def ignite(self, position_m: tuple[float, float]) -> None:
        """Set fire to a place in `map` [m]. Raises: ValueError: nothing burns there, or the scenario has no fire."""
        self.hazards.ignite(position_m)

    def set_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Add a victim, or move the one of that name [m, map]; they call from there and no longer walk.

        Raises: ValueError: a victim cannot have this name or be at this place.
        """
        _check_victim(self.scenario, name, position_m)
        self.people.place(name, position_m)
        self.hearing.sensor.set_victim(name, position_m)
        self.mission.set_victim(name, position_m)


def _check_victim(scenario: Scenario, name: str, position_m: tuple[float, float]) -> None:
    if not name.strip():
        raise ValueError("set_victim: name: is empty")
    try:
        victim = checked(Victim, {"name": name, "position": position_m}, ValueError)
        check_mission(scenario.plan, MissionSection(victims=(victim,)))
    except (ValueError, PlacementError) as error:
        # This victim is the only one of the mission above.
        problem = str(error).removeprefix("mission.victims.0.")
        raise ValueError(f"set_victim: {printable(name)}: {problem}") from None
