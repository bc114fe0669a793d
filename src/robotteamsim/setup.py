"""A scenario that is ready to run: its checks made, its victims drawn, its team placed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose
from robotteamsim.hazards.hazards import make_hazards
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building, MapSource, building_of
from robotteamsim.scenario.controllers import Control
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.placement import check_places, placed_robots
from robotteamsim.world.random_people import with_drawn_people
from robotteamsim.world.random_victims import with_random_victims


@dataclass(frozen=True)
class Setup:
    """A resolved scenario; simulation, controllers, recorders and shells take it.

    scenario: with the victims of `mission.random_victims` and the people of `people.groups` at their places.
    robots:   the team with start poses, in id order: robots, firefighters, command centre.
    building: the floor plan, with the grids and maps of it that several users need.
    found:    by id, what robots have found of a building that they do not know; others know `building`.
    """

    scenario: Scenario
    robots: tuple[PlacedRobot, ...]
    building: Building
    found: Mapping[int, MapSource] = field(default_factory=dict, hash=False)

    @property
    def plan(self) -> FloorPlan:
        """The floor plan."""
        return self.scenario.plan

    def map_of(self, robot_id: int) -> MapSource:
        """Return what a member of the team knows of the building."""
        return self.found.get(robot_id, self.building)

    @property
    def smallest_reach_m(self) -> float:
        """The reach of the smallest member of the team, who gets everywhere where anybody gets [m]."""
        return min(robot.reach_m for robot in self.robots)

    def start_m(self, robot_id: int) -> Point:
        """Return where a member of the team starts, in `map` [m]."""
        return self.robots[robot_id].start_pose[:2]

    def without_building(self, known: FloorPlan, found: Mapping[int, MapSource]) -> Setup:
        """Return what robots get that do not know the building.

        Args: known: what they know of the plan.  found: by id, what they find.
        """
        scenario = self.scenario.model_copy(update={"plan": known})
        return replace(self, scenario=scenario, building=Building(known), found=found)

    def knows_start(self, robot_id: int, arrival: int = 1) -> bool:
        """Whether a member of the team knows where it starts. Args: arrival: number of its arrivals."""
        starts = self.scenario.control.mapping.starts
        return arrival == 1 and (starts == "known" or robot_id in (0, self.scenario.base))

    @property
    def middle(self) -> Pose:
        """The middle of the building: where a robot takes itself to be that does not know where it starts."""
        (x0, y0), (x1, y1) = self.plan.bounds.min, self.plan.bounds.max
        return Pose(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0)

    def with_starts(self, starts: Mapping[int, Pose]) -> Setup:
        """Return the same setup with other start poses of some members of the team, by id."""
        poses = {i: (pose.x_m, pose.y_m, pose.yaw_rad) for i, pose in starts.items()}
        robots = enumerate(self.robots)
        moved = (robot.model_copy(update={"start_pose": poses.get(i, robot.start_pose)}) for i, robot in robots)
        return replace(self, robots=tuple(moved))

    def without_areas(self) -> Setup:
        """Return the same setup without areas to explore."""
        mission = self.scenario.mission.model_copy(update={"areas": (), "area_order": "given"})
        return replace(self, scenario=self.scenario.model_copy(update={"mission": mission}))

    def with_control(self, control: Control) -> Setup:
        """Return the same setup with another section `control`."""
        return replace(self, scenario=self.scenario.model_copy(update={"control": control}))


def resolve(scenario: Scenario) -> Setup:
    """Draw victims, place the team, and check that everybody and everything has room in the plan.

    Raises: PlacementError, ScenarioError: one line with file or --set, key and value.
    """
    building = building_of(scenario.plan)
    scenario = with_drawn_people(with_random_victims(scenario, building), building)
    check_places(scenario, building)
    if scenario.fire is not None:
        make_hazards(scenario, building)  # checks fuel and ignitions
    return Setup(scenario, placed_robots(scenario, building), building)


def check_headless(scenario: Scenario) -> None:
    """Raises: ScenarioError: the robots' poses come from tf, which only nodes of ROS can read."""
    if scenario.control.localisation == "tf":
        key = "control.localisation"
        text = f"{key}: 'tf' is available only in ROS; expected ground_truth, odometry or laser"
        raise ScenarioError(scenario.origin.line(text, key))
