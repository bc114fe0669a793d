"""Robots that choose their next areas, and share it over the network."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.runtime.area_planner import AreaPlanner
from robotteamsim.control.search.cells import cell_grid
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.interface.area_news import AreaNews, area_news, area_news_in
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario import load
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

EAST, WEST, MIDDLE = (
    Area(name="east", center=(16.0, 5.0)),
    Area(name="west", center=(5.0, 5.0)),
    Area(name="middle", center=(10.0, 5.0)),
)
UNEXPLORED = (-1, -1, -1)


class Listener:
    """A controller that keeps the tasks and inboxes that it gets, and sends what it is given."""

    def __init__(self) -> None:
        self.tasks: list[Task] = []
        self.inboxes: list[list[str]] = []
        self.outbox: tuple[Message, ...] = ()

    def step(self, observation, inbox, task) -> Decision:
        self.tasks.append(task)
        self.inboxes.append([message.payload for message in inbox])
        return Decision(outbox=self.outbox)


class Planned:
    """A planner of one robot of three, with what it hands to its controller."""

    def __init__(self, hall_scenario, order: str, robot_id: int = 0, algorithm: str = "greedy", best_area=None) -> None:
        robots = tuple(PlacedRobot(start_pose=(3.0, 3.0 + 2.0 * i, 0.0)) for i in range(3))
        mission = Mission(areas=(EAST, WEST, MIDDLE), area_order=order)
        scenario = hall_scenario(robots=robots, mission=mission, control={"algorithm": algorithm})
        self.controller, self.robot_id = Listener(), robot_id
        self.planner = AreaPlanner(self.controller, robot_id, resolve(scenario), best_area)
        self.explored_by = UNEXPLORED

    def step(self, time_s: float, place=(3.0, 5.0), heard=(), epoch: int = 0) -> Decision:
        reading = RobotReading(
            ground_truth=PoseReading.from_pose(Pose(*place, 0.0)),
            twist=Twist(),
            odometry=OdometryReading(PoseReading.from_pose(Pose(0.0, 0.0, 0.0)), Twist()),
            ranges_m=np.full(181, 5.0, dtype=np.float32),
            in_contact=False,
        )
        observation = Observation(self.robot_id, round(time_s * 1e9), reading, VoiceReading(0.0, False, place, 0.0))
        inbox = [Message(sender, EVERYBODY, area_news(news)) for sender, news in heard]
        task = Task(running=True, epoch=epoch, area_center_m=EAST.center, explored_by=self.explored_by)
        return self.planner.step(observation, inbox, task)

    @property
    def task(self) -> Task:
        return self.controller.tasks[-1]


def news_of(decision: Decision) -> AreaNews | None:
    found = [area_news_in(message.payload) for message in decision.outbox]
    return found[-1] if found else None


@pytest.fixture
def planned(hall_scenario):
    return lambda *args, **more: Planned(hall_scenario, *args, **more)


def test_nearest_area_comes_next_and_not_the_first_one_of_the_list(planned):
    robot = planned("nearest")
    assert robot.step(0.1).area == 1
    assert (robot.task.area_center_m, robot.task.area_radius_m, robot.task.areas_left) == (WEST.center, 2.0, (1, 0, 2))
    robot.explored_by = (-1, 0, -1)
    # From (9, 5) it is 1 m to the middle and 7 m to the east.
    assert (robot.step(0.2, (9.0, 5.0)).area, robot.task.area_center_m) == (2, MIDDLE.center)
    robot.explored_by = (-1, 0, 0)
    assert (robot.step(0.3, (9.0, 5.0)).area, robot.task.areas_left) == (0, (0,))
    robot.explored_by = (0, 0, 0)
    assert (robot.step(0.4).area, robot.task.area_center_m, robot.task.areas_left) == (-1, None, ())


def test_choice_stays_while_the_robot_drives_past_another_area(planned):
    robot = planned("nearest")
    assert [robot.step(0.1).area, robot.step(0.2, (16.0, 5.0)).area] == [1, 1]


def test_nearest_leaves_a_teammate_the_same_area(planned):
    robot = planned("nearest", robot_id=2)
    robot.step(0.1)
    assert robot.step(0.2, heard=[(0, AreaNews((), 1))]).area == 1
    assert robot.task.rivals == (0,)


def test_sebs_avoids_the_area_of_a_teammate(planned):
    robot = planned("sebs", robot_id=2)
    assert robot.step(0.1).area == 1  # no gain yet: all are equal, so the shortest path decides
    assert robot.step(0.2, heard=[(0, AreaNews((), 1))]).area == 2  # 0.1 / 2 in the west, 0.1 in the middle
    assert robot.step(0.3, heard=[(1, AreaNews((), 2))]).area == 0
    assert robot.step(0.4, heard=[(1, AreaNews((), 0))]).area in (1, 2)


@pytest.mark.parametrize(
    ("time_s", "place", "area"),
    [
        # 3 m from the west, the gain is 15 / 3 = 5, and half of P is 0.1 exp(2.303 * 0.05) / 2 = 0.056. 8 m from the
        # east it is 1.9, and P is 0.104.
        (15.0, (8.0, 5.0), 0),
        # 0.5 m count as 1 m: the gain, 150, is above G2, and half of P is 0.5. From the east P is 0.139.
        (150.0, (5.5, 5.0), 1),
    ],
)
def test_sebs_goes_where_a_teammate_goes_only_if_the_gain_is_much_larger(planned, time_s, place, area):
    robot = planned("sebs")
    assert robot.step(0.0, (10.0, 5.0), heard=[(1, AreaNews((), 1))]).area == 2
    robot.explored_by = (-1, -1, 0)
    assert robot.step(time_s, place).area == area


def test_robot_with_the_lower_id_keeps_its_area(planned):
    robot = planned("sebs", robot_id=0)
    robot.step(0.1)
    assert robot.step(0.2, heard=[(1, AreaNews((), 1)), (2, AreaNews((), 1))]).area == 1


def test_areas_of_teammates_are_known_from_their_messages_alone(planned):
    robot = planned("nearest")
    robot.explored_by = (-1, 2, -1)  # robot 2 explored the west, which it has not announced
    assert robot.step(0.1).area == 1
    assert robot.step(0.2, heard=[(1, AreaNews((1,), None))]).area == 2  # robot 1 repeats what robot 2 has announced
    assert robot.controller.inboxes == [[], []]


def test_robot_in_its_area_sees_that_somebody_has_explored_it(planned):
    robot = planned("nearest")
    robot.explored_by = (-1, 2, -1)
    assert robot.step(0.1, (5.0, 2.9)).area == 1
    assert robot.step(0.2, (5.0, 3.1)).area == 2


def test_news_are_sent_at_once_and_every_iteration(planned):
    robot = planned("nearest")
    sent = [news_of(robot.step(0.1 * step)) for step in range(1, 22)]
    assert [step for step, news in enumerate(sent, 1) if news] == [1, 11, 21]
    assert sent[0] == AreaNews((), 1)
    robot.explored_by = (-1, 0, -1)
    assert news_of(robot.step(2.2)) == AreaNews((1,), 2)
    assert json.loads(area_news(AreaNews((1,), 2))) == {"area_news": {"explored": [1], "next": 2}}


@pytest.mark.parametrize("payload", ["", '{"area_news"', '{"area_news": 1}', '{"area_news": {"explored": [-1]}}'])
def test_other_messages_have_no_news(payload):
    assert area_news_in(payload) is None


def test_news_of_areas_that_do_not_exist_are_ignored(planned):
    robot = planned("nearest")
    robot.step(0.1)
    assert robot.step(0.2, heard=[(1, AreaNews((1, 3), None)), (2, AreaNews((1,), 3))]).area == 1


def test_epoch_is_that_of_the_area(planned):
    one, other = planned("nearest"), planned("nearest", robot_id=1)
    one.step(0.1)
    other.step(0.1, place=(16.0, 3.0))
    assert one.task.epoch != other.task.epoch
    other.explored_by = (1, -1, -1)
    other.step(0.2)
    assert one.task.epoch == other.task.epoch  # both go to the west
    one.step(0.3, epoch=1)
    assert one.task.epoch not in (other.task.epoch, one.controller.tasks[0].epoch)


def test_area_without_a_path_comes_after_the_others(planned):
    robot = planned("nearest")
    robot.controller.outbox = (Message(0, EVERYBODY, json.dumps({"closed_area": WEST.center})),)
    assert [robot.step(0.1).area, robot.step(0.2).area] == [1, 2]
    robot.explored_by = (-1, -1, 0)
    robot.controller.outbox = ()
    assert robot.step(0.3).area == 1  # it tries again what was closed before


def test_search_asks_the_controller_and_keeps_the_last_area_for_the_end(planned):
    asked = []

    def best_area(areas, position):
        asked.append((list(areas), position))
        return areas[-1]

    robot = planned("search", robot_id=1, algorithm="search", best_area=best_area)
    assert robot.step(0.1, heard=[(0, AreaNews((), 1))]).area == 0  # without the middle, and the area of robot 0
    assert asked == [([0], (3.0, 5.0))]
    assert robot.task.areas_left == (0, 1, 2)
    robot.explored_by = (1, -1, -1)
    assert robot.step(0.2).area == 1  # rather than none
    robot.explored_by = (1, 1, -1)
    assert robot.step(0.3).area == 2


def test_search_prefers_the_area_around_which_nothing_was_heard_yet():
    scenario = load("garage_sar", ["control.algorithm=search", "mission.area_order=search"])
    controller = make_controller(0, resolve(scenario)).controller
    center_m = scenario.mission.areas[0].center
    start_m = center_m[0] + 1.0, center_m[1]
    assert controller.best_area([3, 0], start_m) == 0  # both are unheard, and one is next to it
    grid = cell_grid(scenario)
    for cell in range(grid.size):
        if math.dist(grid.centre_of(cell), center_m) < 15.0:
            controller.knowledge.listen(cell, VoiceReading(0.0, False, start_m, 0.0))
    assert controller.best_area([3, 0], start_m) == 3


def test_who_stands_still_or_follows_a_route_does_not_choose(hall_scenario):
    mission = Mission(areas=(EAST, WEST), area_order="nearest", base=0)
    setup = resolve(hall_scenario(mission=mission, control={"algorithm": "cover"}))
    assert not isinstance(make_controller(0, setup), AreaPlanner)
    patrol = make_controller(1, setup)
    assert isinstance(patrol, AreaPlanner)


@pytest.mark.parametrize(("order", "first"), [("given", "east"), ("nearest", "west"), ("sebs", "west")])
def test_team_explores_all_areas_in_every_order(hall_scenario, order, first):
    mission = Mission(areas=(EAST, WEST), area_order=order, time_limit_s=120.0)
    simulation = Simulation(hall_scenario(mission=mission, control={"algorithm": "greedy"}))
    events = []
    while simulation.mission.status.state != "ended":
        events += simulation.step().events
    explored = [event.subject for event in events if event.kind == "area_explored"]
    assert (explored[0], sorted(explored)) == (first, ["east", "west"])
    assert simulation.mission.status.end == "areas_explored"


def test_patrol_that_does_not_know_areas_explores_them_in_the_order_in_which_it_passes_them(hall_scenario):
    areas = (EAST, WEST, Area(name="south", center=(10.0, 2.0)))
    found = {}
    for order in ("given", "sebs"):
        mission = Mission(areas=areas, area_order=order, time_limit_s=40.0)
        simulation = Simulation(hall_scenario(mission=mission, control={"algorithm": "sebs"}))
        found[order] = simulation.run().areas_explored
    assert found["given"] < found["sebs"]
