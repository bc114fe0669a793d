"""The step loop, written once: one trial in one process."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from robotteamsim.control import Guard, make_controller
from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.mission import Mission
from robotteamsim.network.messages import Message
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import RobotReading, TeamReadings, ground_truth_rows
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation.environment import Environment
from robotteamsim.simulation.record import Observer, Result, StepRecord
from robotteamsim.simulation.tally import Tally
from robotteamsim.world import World
from robotteamsim.world.placement import check_places, placed_robots


class Simulation:
    """One trial of a scenario. Everything that it does follows from the scenario, its seed included.

    The stages hand each other only what ROS messages of the same stamp, or of the step before, can carry: in step k
    the world moves by the twists of step k-1, the network delivers what was sent in step k-1, controllers know the
    mission's task as of step k-1. Nodes that wait for the same stamps therefore compute the same bits.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Build all stages. Raises: PlacementError: a robot, object, area or victim has no room where it is."""
        check_places(scenario)
        robots, seed = placed_robots(scenario), scenario.run.seed
        self.scenario = scenario
        objects, schedule = scenario.objects, scenario.schedule
        self.world = World(scenario.plan, robots, scenario.run, objects=objects, schedule=schedule)
        self.sensors = RobotSensors(self.world, robots, seed)
        self.environment = Environment(scenario)
        self._arrivals = self.world.arrivals
        self.controllers = [self._controller(robot_id, 1) for robot_id in range(len(robots))]
        self.mission = Mission(scenario)
        self._base = scenario.mission.base
        self._decisions: tuple[Decision, ...] = tuple(Decision() for _ in robots)
        self._task = Task()
        self._saved: tuple[str, ...] = ()
        self._voice_map_changes = -1

    def step(self) -> StepRecord:
        """Advance by one step and return all that happened in it."""
        world, environment, mission = self.world, self.environment, self.mission
        # The world moves.
        twists, outboxes, *_ = zip(*self._decisions)  # noqa: B905
        world.step(twists)
        sim_time_ns, doors, present = world.sim_time_ns, world.door_states(), world.present
        environment.follow_doors(doors)
        mission.follow_doors(doors)
        # The robots sense; the network delivers.
        readings = self.sensors.read()
        positions_m, of_robots = readings.positions_m, readings.one_by_one()
        voices, network, inboxes = environment.step(positions_m, outboxes, self._saved, present)
        # Each controller decides.
        are_same = present is None and world.arrivals is self._arrivals
        controllers = self.controllers if are_same else self._present_controllers(present)
        task = self._task
        for robot_id, controller in enumerate(controllers):
            observation = Observation(robot_id, sim_time_ns, of_robots[robot_id], voices[robot_id])
            controller.observe(observation, inboxes[robot_id], task)
        decided = []
        for controller in controllers:
            decided.append(controller.decide())
        self._decisions = decisions = tuple(decided)
        # The mission judges.
        base_inbox = () if self._base is None else inboxes[self._base]
        events = mission.step(sim_time_ns, positions_m, voices, network, decisions, base_inbox, present)
        self._task, self._saved = mission.task, mission.saved_victims
        return StepRecord(
            world.step_index,
            sim_time_ns,
            readings,
            voices,
            network,
            inboxes,
            decisions,
            mission.status,
            events,
            mission.victims,
            mission.noise_db,
            None if environment.voice.changes == self._voice_map_changes else self._fresh_voice_map(),
            doors,
            present,
            world.arrivals,
        )

    def run(self, observers: Sequence[Observer] = ()) -> Result:
        """Run until the mission has ended, with observers looking on; a mission that waits is started.

        Whatever breaks the run off (an observer's RecordingError, an interrupt) is raised after every observer that
        began was told to abandon.
        """
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
        """Have a door opened or closed, see `World.set_door`. Raises: ValueError: no such door.

        The world alone knows whether it is: voice and radio follow at once, the mission with the next step.
        """
        self.world.set_door(name, closed)
        self.environment.follow_doors(self.world.door_states())

    def set_noise_db(self, noise_db: float) -> None:
        """Set the background noise [dB]."""
        self.environment.set_noise_db(noise_db)
        self.mission.set_noise_db(noise_db)

    def remove_robot(self, robot_id: int) -> None:
        """Take a robot off the floor, see `World.remove_robot`. What it sent last is lost.

        Raises: ValueError: no such robot, or it is not there.
        """
        self.world.remove_robot(robot_id)

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """Put a robot that is not there somewhere, see `World.spawn_robot`; it begins anew, its controller included.

        Raises: PlacementError: it cannot stand there.
                ValueError: no such robot, it is there already, or the pose is not finite.
        """
        self.world.spawn_robot(robot_id, pose)
        # What its controller decided before it left is no command for it now.
        still = [d if i != robot_id else d._replace(twist=Twist()) for i, d in enumerate(self._decisions)]
        self._decisions = tuple(still)

    def set_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Add a victim, or move the one of that name [m, map]."""
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

    def _present_controllers(self, present: np.ndarray | None) -> Sequence[Guard | _Nobody]:
        """Return the controllers in id order, those of robots that have come anew; nobody asks who is not there."""
        if self._arrivals is not self.world.arrivals:
            arrivals = self.world.arrivals
            for robot_id, (before, now) in enumerate(zip(self._arrivals, arrivals, strict=True)):
                if before != now:
                    self.controllers[robot_id] = self._controller(robot_id, now)
            self._arrivals = arrivals
        if present is None:
            return self.controllers
        who = zip(self.controllers, present.tolist(), strict=True)
        return [controller if is_there else _NOBODY for controller, is_there in who]

    def _fresh_voice_map(self) -> FieldMap:
        self._voice_map_changes = self.environment.voice.changes
        return self.environment.voice_map()


class _Nobody:
    """The controller of a robot that is not there."""

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Take no notice."""

    def decide(self) -> Decision:
        """Return no command and no message."""
        return Decision()


_NOBODY = _Nobody()


def true_positions_m(readings: Sequence[RobotReading]) -> np.ndarray:
    """Return the robots' true positions in `map`, float64 of shape (n, 2) [m]."""
    if isinstance(readings, TeamReadings):
        return readings.positions_m
    return np.ascontiguousarray(ground_truth_rows(readings)[:, :2])
