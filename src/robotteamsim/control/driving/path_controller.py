"""Base class of the simpler controllers: it knows the map and drives to a point."""

import abc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from robotteamsim.control.driving.driver import Driver
from robotteamsim.control.driving.known_map import Disc
from robotteamsim.control.driving.wander import Wander
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.geometry import Pose
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.network.messages import Message
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


@dataclass(frozen=True, slots=True)
class Situation:
    """The input of a controller in one step, and the pose that the robot uses as its own, in `map`."""

    observation: Observation
    inbox: Sequence[Message]
    task: Task
    pose: Pose

    @property
    def position(self) -> Vector:
        """The robot's position in `map` [m]."""
        return self.pose.x_m, self.pose.y_m

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self.observation.sim_time_ns * 1e-9


class PathController(abc.ABC):
    """Base class of a controller that chooses goals; it drives there, or wanders if there is no goal.

    A subclass has `decide` and, if it needs them, `note` and `kept_out`.

    robot_id:   the robot, from 0.
    setup:      the scenario that is ready to run: the team, its start poses, the building.
    scenario:   `setup.scenario`, with all keys.
    driver:     has the known map (`driver.map`), the hot places (`driver.hot`), and drives to points.
    speed_mps:  at which it drives.
    """

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        scenario = setup.scenario
        self.robot_id = robot_id
        self.setup, self.scenario = setup, scenario
        self.driver = Driver(robot_id, setup)
        self.speed_mps = scenario.control.max_step_speed_mps
        self._wander = Wander(
            scenario.control.wander, robot_stream(scenario, "wander", robot_id, arrival), self.speed_mps
        )

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and the messages of this step; the robot stands still while the mission does not run."""
        self.driver.hot.look(observation.robot)
        self.driver.update_map(observation.sim_time_ns, kept_out=self.kept_out(task))
        now = Situation(observation, inbox, task, observation.pose)
        self.note(now)
        return self.decide(now) if task.running else Decision()

    def note(self, now: Situation) -> None:  # noqa: B027  (few controllers need it)
        """Note the input of a step, also while the mission does not run; nothing by default."""

    def kept_out(self, task: Task) -> Disc | None:
        """Return a disc that paths must not enter in this step; None by default."""
        return None

    @abc.abstractmethod
    def decide(self, now: Situation) -> Decision:
        """Return the command and the messages of a step while the mission runs."""

    def stand(self, now: Situation, outbox: tuple[Message, ...] = ()) -> Decision:
        """Return the decision to stand still or, in a hot place, to leave it."""
        shelter = self.driver.shelter(now.position)
        return Decision(outbox=outbox) if shelter is None else self.drive(now, shelter, outbox)

    def drive(
        self,
        now: Situation,
        goal: Vector | None,
        outbox: tuple[Message, ...] = (),
        *,
        local_best: float = 0.0,
        local_best_m: Vector | None = None,
        teammates: Mapping[int, Vector] | None = None,
    ) -> Decision:
        """Return the decision to drive to a goal in `map` [m] at full speed, or to wander if it is None."""
        if goal is None:
            goal = self._wander.goal(self.driver.map, now.position, now.time_s)
        else:
            self._wander.stop()
        goal = self.driver.way_out(now.position) or goal
        twist = self.driver.drive(now.observation, now.pose, goal, self.speed_mps, lambda: teammates or {})
        return Decision(twist, outbox, goal_m=goal, local_best=local_best, local_best_m=local_best_m)
