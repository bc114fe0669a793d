"""The survey of one robot: what it maps, tells its team and takes over."""

import itertools
import math

import msgspec
import numpy as np
import pytest

from robotteamsim.interface.survey_news import survey_news, survey_news_in
from robotteamsim.maps.found_map import FoundMap, without_walls
from robotteamsim.maps.survey import Survey
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Block
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation


def driven(steps, *settings):
    """Return the setup of a mission in the garage, and what its robots observed in each step."""
    simulation = Simulation(load("garage_unknown", settings))
    observed = [[] for _ in simulation.controllers.guards]
    for robot_id, guard in enumerate(simulation.controllers.guards):
        inner = guard.controller
        ours = inner.step

        def step(observation, inbox, task, seen=observed[robot_id], ours=ours):
            seen.append(observation)
            return ours(observation, inbox, task)

        inner.step = step
    simulation.mission.start()
    for _ in range(steps):
        simulation.step()
    return simulation.setup, observed


@pytest.fixture(scope="module")
def drive():
    return driven(60, "robots.count=2", "run.seed=3")


def surveyed(setup, observations, robot_id, discs=()):
    """Return the survey of a robot after it has observed all of it."""
    survey = Survey(robot_id, setup, FoundMap(without_walls(setup.plan)), None)
    for observation in observations:
        survey.pose(observation, discs)
    survey.look()
    return survey


def sent(survey, time_s=0.0):
    """Return the news of a robot as its team gets them."""
    return [survey_news_in(survey_news(one)) for one in survey.news((1.0, 2.0), round(1e9 * time_s))]


class Seen:
    """In place of a mapper: a row of cells that a test sets."""

    def __init__(self):
        self.cells = np.full((1, 3), UNKNOWN, dtype=np.int8)

    def take_changes(self, factor):
        return (0.0, 0.0), self.cells.copy()


class Team:
    """Surveys of robots whose mappers are tests, and a network that loses messages."""

    def __init__(self, setup, count):
        self.surveys = [Survey(i, setup, FoundMap(without_walls(setup.plan)), None) for i in range(count)]
        for survey in self.surveys:
            survey._own._mapper = Seen()
        self.time_s = 0.0

    def sees(self, robot_id, *cells):
        """Let a robot map these cells."""
        self.surveys[robot_id]._own._mapper.cells[:] = cells

    def share(self, *lost):
        """Let all robots send, some time later; lost: pairs of a sender and a receiver."""
        self.time_s += 10.0
        for survey in self.surveys:
            survey.look()
        news = [sent(survey, self.time_s) for survey in self.surveys]
        for sender, receiver in itertools.permutations(range(len(self.surveys)), 2):
            for each in () if (sender, receiver) in lost else news[sender]:
                self.surveys[receiver].hear(sender, each, round(1e9 * self.time_s))
        for survey in self.surveys:
            survey.look()

    @property
    def known(self):
        return [survey.found.cells[0, :3].tolist() for survey in self.surveys]


@pytest.fixture
def team():
    setup = resolve(load("garage_unknown", ["robots.count=3"]))
    return lambda count: Team(setup, count)


def test_who_lost_messages_asks_until_it_gets_all(team):
    two = team(2)
    two.sees(0, FREE, FREE, UNKNOWN)
    two.share((0, 1))
    two.sees(0, FREE, FREE, OCCUPIED)
    two.share((1, 0))  # notices the gap, and asks in vain
    two.share((1, 0))
    assert two.known[1] == [UNKNOWN, UNKNOWN, OCCUPIED]
    two.share()
    two.share()
    assert two.known[1] == [FREE, FREE, OCCUPIED]
    assert not any(news.wanted or news.cells for news in sent(two.surveys[1], 1000.0))


def test_cells_that_are_unknown_again_are_so_for_the_team(team):
    three = team(3)
    three.sees(0, OCCUPIED, FREE, FREE)
    three.share()
    three.sees(0, UNKNOWN, FREE, FREE)
    three.share()
    assert three.known == [[UNKNOWN, FREE, FREE]] * 3


def test_correction_reaches_the_team_also_if_it_is_what_another_robot_has_said_before(team):
    three = team(3)
    three.sees(1, FREE, UNKNOWN, UNKNOWN)
    three.share()
    three.sees(0, OCCUPIED, UNKNOWN, UNKNOWN)
    three.share()
    assert three.known[2][0] == OCCUPIED
    three.sees(0, FREE, UNKNOWN, UNKNOWN)
    three.share()
    assert [cells[0] for cells in three.known] == [FREE, FREE, FREE]


def test_robot_that_comes_back_with_new_numbers_is_asked_for_all(team):
    two, again = team(2), team(1)
    for cells in ((FREE, UNKNOWN, UNKNOWN), (FREE, FREE, UNKNOWN)):
        two.sees(0, *cells)
        two.share()
    two.surveys[0] = again.surveys[0]
    two.sees(0, OCCUPIED, UNKNOWN, UNKNOWN)
    two.share((0, 1))
    for _ in range(3):  # it notices, asks, and gets the answer
        two.share()
    assert two.known[1][0] == OCCUPIED


def test_messages_fit_into_those_of_the_network(drive):
    _, (first, _) = drive
    scenario = load("garage_unknown", ["robots.count=2", "run.seed=3", "network.max_message_bytes=600"])
    messages = [survey_news(news) for news in surveyed(resolve(scenario), first, 0).news((1.0, 2.0), 0)]
    assert len(messages) > 1
    assert max(len(message.encode()) for message in messages) <= 600


def test_nothing_new_is_one_message_without_cells(drive):
    setup, (first, _) = drive
    survey = surveyed(setup, first, 0)
    sent(survey)
    survey.look()
    (news,) = sent(survey, 60.0)
    assert news.cells is None
    assert news.position == (1.0, 2.0)


def test_cells_are_sent_at_most_every_share_s(drive):
    setup, (first, _) = drive
    survey = surveyed(setup, first[:20], 0)
    assert sent(survey)[0].cells is not None
    for observation in first[20:]:
        survey.pose(observation)
    survey.look()
    share_s = setup.scenario.control.mapping.share_s
    assert [news.cells for news in sent(survey, share_s - 0.1)] == [None]
    assert sent(survey, share_s)[0].cells is not None


def test_what_a_teammate_has_told_is_not_told_again(drive):
    setup, (first, _) = drive
    survey, twin = surveyed(setup, first, 0), surveyed(setup, first, 0)
    for news in sent(survey):
        twin.hear(1, news, 0)
    twin.look()
    assert [news.cells for news in sent(twin)] == [None]


def test_map_that_is_looked_at_often_is_that_which_is_looked_at_once():
    setup, (observations,) = driven(600, "robots.count=1", "run.seed=1")
    often = surveyed(setup, observations[:1], 0)
    for step, observation in enumerate(observations[1:]):
        often.pose(observation)
        if step % 10 == 0:
            often.look()
    often.look()
    np.testing.assert_array_equal(often.found.cells, surveyed(setup, observations, 0).found.cells, strict=True)


def test_teammates_are_no_walls(drive):
    setup, (first, _) = drive
    without = surveyed(setup, first, 0)
    wall_m = _walls_m(without)[0]
    masked = surveyed(setup, first, 0, [((float(wall_m[0]), float(wall_m[1])), 1.0)])
    assert np.hypot(*(_walls_m(without) - wall_m).T).min() < 0.1
    # Beams are left out before they are matched: the odometry of one step may be wrong.
    assert np.hypot(*(_walls_m(masked) - wall_m).T).min() > 0.7


def _walls_m(survey):
    rows, columns = np.nonzero(survey.found.cells == OCCUPIED)
    return (np.column_stack((columns, rows)) + 0.5) * 0.1 + survey.found.origin_m


def test_beams_without_a_return_map_the_same_as_infinity(drive):
    setup, (first, _) = drive
    longest_m = setup.robots[0].laser.range_max_m
    as_inf = [
        msgspec.structs.replace(
            seen,
            robot=msgspec.structs.replace(
                seen.robot,
                ranges_m=np.where(seen.robot.ranges_m >= longest_m, math.inf, seen.robot.ranges_m).astype(np.float32),
            ),
        )
        for seen in first
    ]
    assert any(np.isinf(seen.robot.ranges_m).any() for seen in as_inf)
    np.testing.assert_array_equal(
        surveyed(setup, as_inf, 0).found.cells, surveyed(setup, first, 0).found.cells, strict=True
    )


def test_its_own_map_counts_where_both_know_something(drive):
    setup, (first, second) = drive
    ours, theirs = surveyed(setup, first, 0), surveyed(setup, second, 1)
    own = ours.found.cells.copy()
    for news in sent(theirs):
        ours.hear(1, news, 0)
    ours.look()
    np.testing.assert_array_equal(ours.found.cells[own != UNKNOWN], own[own != UNKNOWN])
    assert np.sum(ours.found.cells == FREE) >= np.sum(own == FREE)


def test_walls_that_no_laser_sees_change_no_decision():
    """Where robots have not been, the building may be any."""
    plain = load("garage_unknown", ["run.seed=3"])
    far = Block(name="far", kind="block", polygon=((50.0, 26.0), (54.0, 26.0), (54.0, 26.2), (50.0, 26.2)))
    plan = plain.plan.model_copy(update={"blocks": (*plain.plan.blocks, far)})
    other = plain.model_copy(update={"plan": plan})
    decided = []
    for scenario in (plain, other):
        simulation = Simulation(scenario)
        simulation.mission.start()
        decided.append([])
        for _ in range(80):
            record = simulation.step()
            decided[-1].append([(one.twist, one.goal_m, one.outbox) for one in record.decisions])
    assert decided[0] == decided[1]


def test_beam_that_ends_beside_a_teammate_is_a_wall_only_where_one_is_known(drive):
    setup, observed = drive
    everywhere = [((20.0, 20.0), 100.0)]
    assert not (surveyed(setup, observed[0], 0, everywhere).found.cells == OCCUPIED).any()
    told = FoundMap(without_walls(setup.plan))
    told.show([((slice(None), slice(None)), setup.building.grid(0.1).cells)])
    survey = Survey(0, setup, told, None)
    for observation in observed[0]:
        survey.pose(observation, everywhere)
    survey.look()
    walls = survey._own.cells == OCCUPIED
    assert walls.sum() > 100
    assert (told.cells[walls] == OCCUPIED).all()


def test_robot_that_comes_along_a_wall_is_not_lost():
    # Beams that graze the wall of the core, at (24, 13), had freed its cells before robot 2 came there.
    simulation = Simulation(load("garage_unknown", ["run.seed=34099"]))
    simulation.mission.start()
    records = [simulation.step() for _ in range(1060)]
    assert {record.decisions[2].localisation.state for record in records} == {"tracking"}
