"""Base class of the simpler controllers: it localises the robot, knows the map and drives to a point."""

from collections.abc import Mapping, Sequence

from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.driving.localisation import Localiser, body_of
from robotteamsim.control.driving.navigation import Navigator
from robotteamsim.control.driving.wander import Wander
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.geometry import Pose
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector


class PathController:
    """Base class of a controller that chooses goals; it drives there, or wanders if there is no goal."""

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        body = body_of(robot_id, scenario)
        self.robot_id = robot_id
        self.scenario = scenario
        self.map = known_map(scenario.plan, body.reach_m)
        self._reach_m = body.reach_m
        self._hot = HotPlaces(scenario.plan)
        self.speed_mps = scenario.control.max_step_speed_mps
        self._localiser = Localiser(robot_id, scenario)
        control = scenario.control
        self._navigator = Navigator(body, robot_id, control.navigation, control.navigator)
        self._wander = Wander(
            scenario.control.wander, robot_stream(scenario, "wander", robot_id, arrival), self.speed_mps
        )
        self._observation: Observation | None = None
        self.inbox: Sequence[Message] = ()
        self.task = Task()

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Process the observation, the messages that arrived, and the mission's task."""
        self._observation, self.inbox, self.task = observation, inbox, task
        self._hot.look(observation.robot)
        if self._hot.update(observation.sim_time_ns):
            self.map = known_map(self.scenario.plan, self._reach_m, (), self._hot.blocked)

    @property
    def observation(self) -> Observation:
        """The observation of this step."""
        assert self._observation is not None, "observe comes before decide"
        return self._observation

    @property
    def is_running(self) -> bool:
        """Whether the mission is running and there has been an observation."""
        return self._observation is not None and self.task.running

    @property
    def time_s(self) -> float:
        """Simulated time of this step [s]."""
        return self.observation.sim_time_ns * 1e-9

    def pose(self) -> Pose:
        """Return the pose that the robot uses as its own, in `map`."""
        return self._localiser.map_T_base_link(self.observation.robot)

    def stand(self, pose: Pose, outbox: tuple[Message, ...] = ()) -> Decision:
        """Return the decision to stand still or, in a hot place, to leave it."""
        shelter = self._hot.shelter(self.map.grid, (pose.x_m, pose.y_m))
        return Decision(outbox=outbox) if shelter is None else self.drive(pose, shelter, outbox)

    def drive(
        self,
        pose: Pose,
        goal: Vector | None,
        outbox: tuple[Message, ...] = (),
        *,
        local_best: float = 0.0,
        teammates: Mapping[int, Vector] | None = None,
    ) -> Decision:
        """Return the decision to drive to a goal in `map` [m] at full speed, or to wander if it is None."""
        if goal is None:
            goal = self._wander.goal(self.map, (pose.x_m, pose.y_m), self.time_s)
        else:
            self._wander.stop()
        goal = self._hot.way_out(self.map.grid, (pose.x_m, pose.y_m)) or goal
        observation = self.observation
        twist = self._navigator.drive(
            self.map.grid,
            pose,
            observation.robot.ranges_m,
            goal,
            self.speed_mps,
            observation.sim_time_ns,
            lambda: teammates or {},
        )
        return Decision(twist, outbox, goal_m=goal, local_best=local_best)
