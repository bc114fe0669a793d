"""Robots that are not told where they start: how they find their place in the map of their team, and when not."""

import math

import numpy as np
import pytest

from robotteamsim.control.runtime.located import Located
from robotteamsim.control.runtime.registry import make_belief
from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Estimate, Localisation, Message, Observation, Task
from robotteamsim.interface.survey_news import survey_news_in
from robotteamsim.maps.found_map import CELL_M, FoundMap, without_walls
from robotteamsim.maps.merging import Match, WallField, centers_m, moving_places
from robotteamsim.maps.own_map import OwnMap
from robotteamsim.maps.recent_scans import moved
from robotteamsim.maps.survey import Survey
from robotteamsim.maps.teammates import Teammates
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

UNKNOWN_STARTS = "control.mapping.starts=unknown"


def error_of(record, robot_id):
    """Return how wrong a robot's believed pose is [m, rad]."""
    apart = record.readings[robot_id].true_pose.inverse() @ record.decisions[robot_id].localisation.pose
    return math.hypot(apart.x_m, apart.y_m), abs(apart.yaw_rad)


def mission(seconds, *settings):
    """Return the records of a mission of two robots in the garage."""
    simulation = Simulation(load("garage_unknown", ["robots.count=2", "run.seed=3", UNKNOWN_STARTS, *settings]))
    simulation.mission.start()
    return [simulation.step() for _ in range(round(10 * seconds))]


@pytest.fixture(scope="module")
def records():
    return mission(20)


def states_of(records, robot_id):
    return [record.decisions[robot_id].localisation.state for record in records]


def test_robot_is_lost_until_walls_and_a_teammate_agree(records):
    states = states_of(records, 1)
    assert states[0] == "lost"
    assert states[-1] == "tracking"
    first = records[states.index("tracking")]
    assert error_of(first, 1)[0] < 0.1
    assert error_of(first, 1)[1] < math.radians(1.0)
    assert set(states_of(records, 0)) == {"tracking"}


def test_robot_that_is_lost_speaks_of_no_place(records):
    for record in records:
        decision = record.decisions[1]
        if decision.localisation.state == "tracking":
            break
        said = [survey_news_in(message.payload) for message in decision.outbox]
        assert all(news is not None and news.position is None and news.cells is None for news in said)
        assert decision.found is None
        assert decision.localisation.estimates[0].covariance[0] > 100.0
    assert any(record.decisions[1].found is not None for record in records)


def test_same_seed_gives_the_same_place(records):
    again = mission(20)
    assert [record.decisions[1].localisation for record in again] == [
        record.decisions[1].localisation for record in records
    ]


def test_walls_without_the_sight_of_a_teammate_are_not_enough(monkeypatch):
    note = Teammates.note
    elsewhere = lambda self, i, at, time_ns: note(self, i, (at[0] + 6.0, at[1]), time_ns)  # noqa: E731
    monkeypatch.setattr(Teammates, "note", elsewhere)
    assert set(states_of(mission(20), 1)) <= {"lost", "ambiguous"}


def test_teammates_who_do_not_see_the_robot_are_not_enough(monkeypatch):
    monkeypatch.setattr(Survey, "_what_moves", lambda self: ())
    assert set(states_of(mission(20), 1)) <= {"lost", "ambiguous"}


def test_teammates_report_what_moves_only_while_somebody_is_lost(records):
    found_s = records[states_of(records, 1).index("tracking")].sim_time_s
    reports = [
        (record.sim_time_s, survey_news_in(message.payload).moving)
        for record in records
        for message in record.decisions[0].outbox
        if '"survey"' in message.payload
    ]
    assert any(moving for time_s, moving in reports if time_s < found_s)
    assert not any(moving for time_s, moving in reports if time_s > found_s + 2.0)


def test_what_moves_is_where_several_neighbouring_beams_end():
    ends_m = np.array([(float(i), 0.0) for i in range(20)])
    moving = np.isin(np.arange(20), [1, 2, 4, 8, 9, 14, 15, 16, 17])
    assert moving_places(ends_m, moving) == ((15.5, 0.0), (2.33, 0.0))


GOOD = Match(Pose(0.0, 0.0, 0.0), cells=200, agreement=0.95, seen=20, missed=1, spread_m=3.0, confirmed=5)


@pytest.mark.parametrize(
    "change", [{"cells": 99}, {"agreement": 0.89}, {"seen": 7}, {"missed": 3}, {"spread_m": 1.9}, {"confirmed": 2}]
)
def test_place_is_certain_only_if_everything_confirms_it(change):
    assert GOOD.is_certain
    assert not GOOD._replace(**change).is_certain


def test_robot_that_comes_back_does_not_know_where_it_is():
    setup = resolve(load("garage_unknown", ["robots.count=2"]))
    first, again = (make_belief(1, setup, arrival).survey for arrival in (1, 2))
    assert first.is_placed
    assert not again.is_placed


def test_map_lies_best_where_it_was_taken_from():
    setup = resolve(load("office_unknown"))
    grid = setup.building.grid(CELL_M)
    walls_m = centers_m(grid.cells, grid.origin_m)
    near_m = walls_m[np.hypot(*(walls_m - (20.0, 12.0)).T) < 12.0]
    true = Pose(20.0, 12.0, 0.5)
    found = WallField(grid.cells, grid.origin_m).aligned(Pose(20.2, 11.9, 0.53), moved(true.inverse(), near_m))
    apart = true.inverse() @ found
    assert math.hypot(apart.x_m, apart.y_m) < 0.01
    assert abs(apart.yaw_rad) < 0.001


def own_map(pose, *, may_move):
    """Return the map of a robot in the garage, whose laser sees a wall 2 m ahead, and how to look again."""
    setup = resolve(load("garage_unknown"))
    laser, found = setup.robots[0].laser, FoundMap(without_walls(setup.plan))
    own = OwnMap(laser, setup.scenario.control.mapping, pose, found, may_move=may_move)
    angles_rad = laser.angles_rad
    ahead = np.abs(angles_rad) < 0.5
    ranges_m = np.where(ahead, 2.0 / np.cos(angles_rad), laser.range_max_m).astype(np.float32)
    own.step(Pose(0.0, 0.0, 0.0), (0.0,) * 6, ranges_m, np.zeros(len(ranges_m), dtype=bool))
    own.take_changes()
    return own, found.origin_m


def test_map_that_has_moved_is_that_of_the_other_place():
    own, _ = own_map(Pose(30.05, 20.05, 0.0), may_move=True)
    own.move(Pose(10.05, 30.05, 0.5 * math.pi) @ Pose(30.05, 20.05, 0.0).inverse())
    part, changed = own.take_changes()
    there, _ = own_map(Pose(10.05, 30.05, 0.5 * math.pi), may_move=False)
    both = (own.cells != UNKNOWN) & (there.cells != UNKNOWN)
    assert both.sum() > 0.97 * (there.cells != UNKNOWN).sum()
    assert (own.cells[both] == there.cells[both]).mean() > 0.99
    assert changed.any()
    assert changed.shape == own.cells[part].shape


def test_unmoved_map_is_the_same_with_and_without_a_margin():
    first, _ = own_map(Pose(30.0, 20.0, 0.3), may_move=False)
    second, _ = own_map(Pose(30.0, 20.0, 0.3), may_move=True)
    np.testing.assert_array_equal(first.cells, second.cells)
    assert {FREE, OCCUPIED} <= set(np.unique(first.cells))


class _Survey:
    """In place of a survey: finds the place of its robot when a test says so."""

    looks, is_placed, found, particles = True, False, FoundMap(without_walls(load("garage_unknown").plan)), ()
    at = Pose(1.0, 2.0, 0.3)

    def pose(self, observation, teammates=()):
        return self.at

    def look(self):
        pass

    def news(self, position, time_ns):
        return ()

    @property
    def localisation(self):
        return Localisation("tracking" if self.is_placed else "lost", (Estimate(self.at),))


class _Controller:
    def __init__(self, setup):
        self.setup, self.seen = setup, []

    def step(self, observation, inbox, task):
        self.seen.append((list(inbox), task))
        return Decision(Twist(0.5), (Message(1, -1, "I am here"),), done="nothing is left")


def test_controller_begins_again_with_areas_once_its_robot_knows_its_place():
    setup = resolve(load("garage_unknown", [UNKNOWN_STARTS]))
    survey, made = _Survey(), []

    def make(told):
        made.append(_Controller(told))
        return made[-1]

    located = Located(make, 1, setup, survey, survey)
    reading = PoseReading.from_pose(Pose(5.0, 5.0, 0.0))
    robot = RobotReading(reading, Twist(), OdometryReading(reading, Twist()), np.zeros(0, np.float32), in_contact=False)
    observation = Observation(1, 10**8, robot, VoiceReading(0.0, False, (0.0, 0.0), 0.0))
    task, inbox = Task(running=True, area_center_m=(18.0, 7.0)), (Message(0, -1, "go there"),)
    before = located.step(observation, inbox, task)
    assert before.done == ""
    survey.is_placed = True
    for _ in range(2):
        after = located.step(observation, inbox, task)
    assert [len(each.setup.scenario.mission.areas) for each in made] == [0, 5]
    assert [each.setup.robots[1].start_pose for each in made] == [(30.0, 20.0, 0.0), (1.0, 2.0, 0.3)]
    assert made[1].setup.robots[2].start_pose == (30.0, 20.0, 0.0)
    assert made[1].setup.robots[0].start_pose == setup.robots[0].start_pose
    assert before.outbox == ()
    assert [message.payload for message in after.outbox] == ["I am here"]
    assert made[0].seen == [([], Task(running=True))]
    assert made[1].seen[-1] == (list(inbox), task)


@pytest.mark.parametrize(
    ("scenario", "settings", "text"),
    [
        ("garage_sar", [], "control.mapping.starts: 'unknown' needs control.map 'unknown'"),
        (
            "garage_unknown",
            ["control.localisation=odometry"],
            "control.mapping.starts: 'unknown' is not possible with localisation odometry; expected 'laser'",
        ),
    ],
)
def test_starts_are_known_without_a_map_of_ones_own(scenario, settings, text):
    with pytest.raises(ScenarioError) as error:
        load(scenario, [UNKNOWN_STARTS, *settings])
    assert text in str(error.value)


def test_robot_that_comes_back_elsewhere_finds_out_where():
    events = "schedule=[{at_s: 15, remove: 1}, {at_s: 20, spawn: 1, pose: [10, 8, 1.5]}]"
    simulation = Simulation(load("garage_unknown", ["run.seed=1", events]))
    simulation.mission.start()
    records = [simulation.step() for _ in range(600)]
    assert records[205].decisions[1].localisation.state == "lost"
    assert records[-1].decisions[1].localisation.state == "tracking"
    assert error_of(records[-1], 1)[0] < 0.2
