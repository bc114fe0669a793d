"""The step loop, written once: one trial in one process."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from operator import attrgetter

import msgspec
import numpy as np

from robotteamsim.control import Guard, make_controller
from robotteamsim.control.driving.localisation import check_headless
from robotteamsim.geometry import Pose, Twist
from robotteamsim.hazards import HazardField
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.mission import Mission
from robotteamsim.mission.status import Event
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import RobotReading, VoiceReading, reading_rows
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation.environment import Environment
from robotteamsim.simulation.hazard_stage import HazardStage
from robotteamsim.simulation.people_stage import PeopleStage
from robotteamsim.simulation.record import Observer, Result, StepRecord
from robotteamsim.simulation.tally import Tally
from robotteamsim.world.making import make_world
from robotteamsim.world.placement import check_places, placed_robots
from robotteamsim.world.random_victims import with_random_victims

_TWIST, _OUTBOX = attrgetter("twist"), attrgetter("outbox")


class Simulation:
    """One trial of a scenario. It depends on nothing but the scenario, which includes the seed.

    The world moves, fire and smoke spread, the robots sense, the network delivers, the controllers decide, the mission
    judges.
    The stages pass each other only what ROS messages of the same stamp, or of the step before, can carry: in step k
    the world moves by the twists of step k-1, the network delivers what was sent in step k-1, controllers know the
    mission's task as of step k-1. Nodes that wait for the same stamps therefore compute the same bits.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Build all stages. Raises: PlacementError, ScenarioError: no room for a robot, object, area or victim."""
        scenario = with_random_victims(scenario)
        check_places(scenario)
        robots, seed = placed_robots(scenario), scenario.run.seed
        self.scenario = scenario
        self.world = make_world(scenario, robots)
        self.fire = None if scenario.fire is None else HazardStage(scenario, self.world)
        """Fire and smoke; None if nothing can burn."""
        self.sensors = RobotSensors(self.world, robots, seed, None if self.fire is None else self.fire.hazards)
        self.people = PeopleStage(scenario) if scenario.moves_people else None
        """The people who move; None if victims only walk along their paths."""
        self.environment = Environment(scenario)
        self._arrivals = self.world.arrivals
        self._team_news = self.world.mishaps, self.world.loads
        self.controllers = [self._controller(robot_id, 1) for robot_id in range(len(robots))]
        self.mission = Mission(scenario)
        self._base = scenario.base
        self._decisions: tuple[Decision, ...] = tuple(Decision() for _ in robots)
        self._task = Task()
        self._saved: tuple[str, ...] = ()
        self._voice_map_changes = -1
        self._doors_version = 0
        self._hazard_field: HazardField | None = None

    def step(self) -> StepRecord:
        """Advance by one step and return its record."""
        self._move_world()
        readings = self.sensors.read()
        positions_m = readings.positions_m
        voices, network, inboxes = self._deliver(positions_m)
        self._decisions = self._decide(readings.one_by_one(), voices, inboxes)
        events = self._judge(positions_m, voices, network, inboxes)
        world, mission = self.world, self.mission
        return StepRecord(
            world.step_index,
            world.sim_time_ns,
            readings,
            voices,
            network,
            inboxes=inboxes,
            decisions=self._decisions,
            mission=mission.status,
            events=events,
            victims=mission.victims,
            noise_db=mission.noise_db,
            voice_map=self._fresh_voice_map(),
            doors=world.door_states(),
            present=world.present,
            arrivals=world.arrivals,
            mishaps=world.mishaps,
            loads=world.loads,
            hazards=self._hazard_field,
            failed=mission.failed,
            people=() if self.people is None else self.people.states,
        )

    def _move_world(self) -> None:
        """Move the world by the last decisions; voice, radio and mission follow its doors and its time."""
        twists = list(map(_TWIST, self._decisions))
        self.world.step(twists if self.fire is None else self.fire.slowed(twists))
        if self.fire is not None:
            self._hazard_field = self.fire.field if self.fire.step() else None
            self.mission.follow_hazards(self._hazard_field, self.fire.failed)
        doors = self.world.door_states()
        if doors.version != self._doors_version:
            self._doors_version = doors.version
            self.environment.follow_doors(doors)
            self.mission.follow_doors(doors)
        if self.people is not None:
            victims, assistance = self.mission.status.victims, self._task.assistance
            field = None if self.fire is None else self.fire.field
            self.people.step(self.world.sim_time_ns, self.world.positions_m(), doors, victims, assistance, field)
            self.environment.follow_people(self.people.states)
            self.mission.follow_people(self.people.states)
        self.environment.advance_to(self.world.sim_time_ns)

    def _deliver(
        self, positions_m: np.ndarray
    ) -> tuple[tuple[VoiceReading, ...], NetworkState, Sequence[Sequence[Message]]]:
        """Let each robot hear, and deliver what was sent in the last step."""
        outboxes = list(map(_OUTBOX, self._decisions))
        return self.environment.step(positions_m, outboxes, self._saved, self.world.present)

    def _decide(
        self,
        readings: Sequence[RobotReading],
        voices: Sequence[VoiceReading],
        inboxes: Sequence[Sequence[Message]],
    ) -> tuple[Decision, ...]:
        """Let each controller observe and decide."""
        sim_time_ns, task = self.world.sim_time_ns, self._task
        decisions = []
        for robot_id, controller in enumerate(self._present_controllers()):
            observation = Observation(robot_id, sim_time_ns, readings[robot_id], voices[robot_id])
            decisions.append(controller.step(observation, inboxes[robot_id], task))
        return tuple(decisions)

    def _judge(
        self,
        positions_m: np.ndarray,
        voices: Sequence[VoiceReading],
        network: NetworkState,
        inboxes: Sequence[Sequence[Message]],
    ) -> tuple[Event, ...]:
        """Let the mission judge the step, and return its events."""
        base_inbox = () if self._base is None else inboxes[self._base]
        world = self.world
        news = world.mishaps, world.loads
        if news != self._team_news:
            self._team_news = news
            self.mission.follow_team(*news)
        events = self.mission.step(
            world.sim_time_ns, positions_m, voices, network, self._decisions, base_inbox, world.present
        )
        self._task, self._saved = self.mission.task, self.mission.silent_victims
        return events

    def run(self, observers: Sequence[Observer] = ()) -> Result:
        """Run until the mission has ended, and report each step to the observers; a mission that waits is started.

        Whatever interrupts the run (an observer's RecordingError, a signal) is raised after every observer that began
        has abandoned the trial.

        Raises: ScenarioError: the robots' poses come from tf.
        """
        check_headless(self.scenario)
        begun: list[Observer] = []
        try:
            for observer in observers:
                begun.append(observer)
                observer.begin(self.scenario)
            result = self._run_to_end(observers)
            while begun:
                begun[0].end(result)
                begun.pop(0)
            return result
        except BaseException:
            for observer in begun:
                observer.abandon()
            raise

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door, see `World.set_door`. Raises: ValueError: no such door.

        Voice and radio follow the state of the world's door at once, the mission in the next step.
        """
        self.world.set_door(name, closed)
        self.environment.follow_doors(self.world.door_states())

    def set_noise_db(self, noise_db: float) -> None:
        """Set the background noise [dB]."""
        self.environment.set_noise_db(noise_db)
        self.mission.set_noise_db(noise_db)

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot, see `World.remove_robot`. Its last messages are lost.

        Raises: ValueError: no such robot, or it is absent.
        """
        self.world.remove_robot(robot_id)

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """Spawn an absent robot, see `World.spawn_robot`; it starts with a new controller.

        Raises: PlacementError: there is no room.
                ValueError: no such robot, it is present already, or the pose is not finite.
        """
        self.world.spawn_robot(robot_id, pose)
        # The last command of its former controller must not move it.
        decisions = list(self._decisions)
        decisions[robot_id] = msgspec.structs.replace(decisions[robot_id], twist=Twist())
        self._decisions = tuple(decisions)

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
        if self.fire is None:
            raise ValueError("ignite: the scenario has no section 'fire'")
        self.fire.ignite(position_m)

    def set_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Add a victim, or move the one of that name [m, map]; they call from there and no longer walk."""
        if self.people is not None:
            self.people.place(name, position_m)
        self.environment.set_victim(name, position_m)
        self.mission.set_victim(name, position_m)

    def _run_to_end(self, observers: Sequence[Observer]) -> Result:
        tally = Tally(self.scenario)
        self.mission.start()
        while True:
            record = self.step()
            tally.add(record)
            for observer in observers:
                observer.step(record)
            if record.mission.state == "ended":
                return tally.result()

    def _controller(self, robot_id: int, arrival: int) -> Guard:
        return Guard(robot_id, self.world.num_robots, partial(make_controller, robot_id, self.scenario, arrival))

    def _present_controllers(self) -> Sequence[Guard | _Absent]:
        """Return the controllers in id order, with new ones for robots that have arrived since the last step."""
        arrivals, present = self.world.arrivals, self.world.present
        if arrivals != self._arrivals:
            for robot_id, (before, now) in enumerate(zip(self._arrivals, arrivals, strict=True)):
                if before != now:
                    self.controllers[robot_id] = self._controller(robot_id, now)
            self._arrivals = arrivals
        if present is None:
            return self.controllers
        pairs = zip(self.controllers, present.tolist(), strict=True)
        return [controller if is_there else _ABSENT for controller, is_there in pairs]

    def _fresh_voice_map(self) -> FieldMap | None:
        """Return the voice map if it has changed since the last step."""
        if self.environment.voice.changes == self._voice_map_changes:
            return None
        self._voice_map_changes = self.environment.voice.changes
        return self.environment.voice_map()


class _Absent:
    """The controller of an absent robot."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return no command and no message."""
        return Decision()


_ABSENT = _Absent()


def true_positions_m(readings: Sequence[RobotReading]) -> np.ndarray:
    """Return the robots' true positions in `map`, float64 of shape (n, 2) [m]."""
    return np.ascontiguousarray(reading_rows(readings)[:, :2])
