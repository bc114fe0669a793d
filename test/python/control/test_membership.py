"""Several swarms: who leaves, joins, dissolves and founds, decided by each robot from what it heard."""

from __future__ import annotations

import copy
import itertools

import numpy as np
import pytest

from robotteamsim.control.rdpso.membership import DpsoMembership, Membership
from robotteamsim.control.rdpso.team import Best, CommonView, RdpsoUpdate, parse_update
from robotteamsim.interface import OUTSIDE
from robotteamsim.mission.monitors import TeamMonitor
from robotteamsim.scenario.controllers.swarms import RdpsoControl, SocialExclusion, Swarms
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot
from robotteamsim.swarm import SwarmState

NUM = 6


def control(min_robots: int = 0, max_robots: int = 5, sc_max: int = 3, **swarms: int) -> RdpsoControl:
    exclusion = SocialExclusion(search_counter_max=sc_max, min_robots=min_robots, max_robots=max_robots)
    return RdpsoControl(
        exclusion=exclusion, swarms=Swarms(**({"min": 0, "initial": 2, "max": 3, "new_robots": 2} | swarms))
    )


@pytest.fixture
def members(hall_scenario):
    """Make the memberships of six robots."""

    def make(settings: RdpsoControl, seed: int = 1, rules: type[Membership] = Membership) -> list[Membership]:
        robots = tuple(PlacedRobot(start_pose=(3.0 + i, 5.0, 0.0)) for i in range(NUM))
        scenario = hall_scenario(seed=seed, robots=robots, control=settings)
        return [rules(i, scenario) for i in range(NUM)]

    return make


def iterate(
    team: list[Membership],
    iteration: int,
    improved: set[int],
    heard: tuple[int, ...] = tuple(range(NUM)),
    nearer: tuple[int, ...] = (),
):
    """Let all of `heard` hear each other in one iteration; the lower the id, the better the robot.

    Args: nearer: those who came nearer to the global best.
    """
    updates = {
        i: RdpsoUpdate(
            robot_id=i,
            iteration=iteration,
            epoch=1,
            position=(0.0, 0.0),
            loudest=None,
            local_best=Best(-float(i), (0.0, 0.0)),
            known_best=None,
            swarm_id=team[i].swarm_id,
            swarm=team[i].state,
            nearer=i in nearer,
        )
        for i in heard
    }
    in_use = {member.swarm_id for member in team}
    shared = CommonView(tuple(updates.values()))
    for i in heard:
        alone = copy.copy(team[i])
        alone.judge(iteration, CommonView(tuple(updates.values())), improved, in_use)
        team[i].judge(iteration, shared, improved, in_use)
        assert (team[i].swarm_id, team[i].state) == (alone.swarm_id, alone.state)


def ids(team: list[Membership]) -> list[int]:
    return [member.swarm_id for member in team]


def test_robots_are_dealt_to_swarms_in_runs_of_equal_length(members):
    assert ids(members(control())) == [0, 0, 0, 1, 1, 1]
    assert ids(members(control(initial=1))) == [0] * NUM


def test_verdict_of_a_team_with_other_rules_is_its_own(members):
    teams = [members(control(sc_max=1)), members(control(sc_max=3))]
    view = CommonView((RdpsoUpdate(2, 0, 1, (0.0, 0.0), None, Best(-2.0, (0.0, 0.0)), None, 0, SwarmState()),))
    for team in teams:
        team[2].judge(0, view, (), {0})
    assert [team[2].swarm_id for team in teams] == [OUTSIDE, 0]


def test_swarm_without_success_excludes_its_worst_and_the_other_stays(members):
    team = members(control())
    for iteration in range(3):
        iterate(team, iteration, improved={1})
    assert ids(team) == [0, 0, OUTSIDE, 1, 1, 1]
    # SC = 3 (1 - 1/2), in whole iterations; the other swarm's is untouched.
    assert team[0].state == SwarmState(1, 1)
    assert team[3].state == SwarmState(0, 0)


def test_iteration_in_which_a_member_comes_nearer_does_not_count(members):
    team = members(control())
    for iteration in range(20):
        iterate(team, iteration, improved=set(), nearer=(4,))
        assert team[3].state == SwarmState()
    # The excluded robots of the other swarm come nearer to nothing.
    assert ids(team) == [OUTSIDE] * 3 + [1, 1, 1]
    for iteration in range(20, 23):
        iterate(team, iteration, improved=set(), nearer=(0,))
    assert ids(team) == [OUTSIDE] * 3 + [1, 1, OUTSIDE]


def test_best_excluded_robot_is_called_into_the_swarm_that_improves_whichever_it_left(members):
    team = members(control())
    for iteration in range(3):
        iterate(team, iteration, improved={1})
    iterate(team, 3, improved={1})
    # N_kill = 0 of swarm 1: the chance of the call is 1.
    assert ids(team) == [0, 0, 1, 1, 1, 1]


def test_swarm_of_the_fewest_robots_is_dissolved_but_not_the_last_ones(members):
    team = members(control(min_robots=3, min=1, max=2))
    for iteration in range(3):
        iterate(team, iteration, improved={1})
    assert ids(team) == [OUTSIDE] * 3 + [1, 1, 1]
    team = members(control(min_robots=3, min=2, max=2))
    for iteration in range(3):
        iterate(team, iteration, improved={1})
    assert ids(team) == [0, 0, 0, 1, 1, 1]
    assert team[0].state == SwarmState(0, 0)


def test_last_robot_of_the_last_swarm_stays_unless_as_printed(members):
    printed = control(min_robots=0, min=0)
    for settings, left in ((RdpsoControl(exclusion=SocialExclusion(search_counter_max=3)), 1), (printed, 0)):
        team = members(settings)
        for iteration in range(40):
            iterate(team, iteration, improved=set())
        assert sum(swarm_id != OUTSIDE for swarm_id in ids(team)) == left


def test_excluded_robots_found_a_swarm_of_their_best_by_chance(members):
    founded = 0
    for seed in range(200):
        team = members(control(min_robots=3, max_robots=3, min=1, max=2), seed)
        for iteration in range(3):
            iterate(team, iteration, improved={1})
        iterate(team, 3, improved={1, OUTSIDE})
        assert ids(team) in ([OUTSIDE] * 3 + [1, 1, 1], [0, 0, OUTSIDE, 1, 1, 1])
        founded += team[0].swarm_id == 0
        assert team[0].state == SwarmState() or team[0].swarm_id == OUTSIDE
    # Two ask, swarm 1 (three of at most three robots) and the three excluded: a chance of f N/N_max each, with the
    # mean 1/2; one dice for both askings gives 1 - 1/2 * 1/2.
    assert founded == pytest.approx(150, abs=25)


def test_no_swarm_is_founded_beyond_the_most_or_by_too_few(members):
    for limits in ({"min": 1, "max": 2, "new_robots": 3}, {"min": 0, "initial": 1, "max": 1, "new_robots": 2}):
        for seed in range(30):
            team = members(control(min_robots=0, max_robots=3, **limits), seed)
            for iteration in range(8):
                iterate(team, iteration, improved={OUTSIDE} if iteration < 7 else {0, OUTSIDE})
            assert len(set(ids(team)) - {OUTSIDE}) <= limits["max"]


def test_robots_with_the_same_messages_agree_and_others_decide_alone(members):
    team = members(control(), seed=3)
    for iteration, improved in enumerate(itertools.islice(itertools.cycle(({0}, {1}, {OUTSIDE}, set())), 60)):
        before = ids(team)
        iterate(team, iteration, improved)
        for swarm_id in set(ids(team)) - {OUTSIDE}:
            stayed = [member.state for member in team if member.swarm_id == swarm_id]
            assert len(set(stayed)) == 1, (iteration, before)
    split = members(control())
    for iteration in range(3):
        iterate(split, iteration, {1}, heard=(0, 1, 3, 4))
    # Nobody told robot 2 that swarm 0 had no success; robot 1 is the worst of those that were heard.
    assert ids(split) == [0, OUTSIDE, 0, 1, 1, 1]


def test_child_of_a_dpso_has_robots_of_its_parent_and_its_mate_with_the_chance_of_eq_13(members):
    founded = 0
    for seed in range(200):
        team = members(control(max=3), seed, DpsoMembership)
        iterate(team, 0, improved={0, 1})
        child = [i for i, swarm_id in enumerate(ids(team)) if swarm_id == 2]
        assert not child or (len(child) == 2 and child[0] < 3 <= child[1])
        founded += bool(child)
    # Each of the two swarms asks with the chance f / 2, f with the mean 1/2: 1 - 3/4 * 3/4.
    assert founded == pytest.approx(0.4375 * 200, abs=25)


def test_dpso_spawns_nothing_after_a_deletion_and_no_more_swarms_than_allowed(members):
    for seed in range(20):
        team = members(control(sc_max=1, max=3), seed, DpsoMembership)
        iterate(team, 0, improved=set())
        assert ids(team) == [0, 0, OUTSIDE, 1, 1, OUTSIDE]
        team = members(control(max=2), seed, DpsoMembership)
        iterate(team, 0, improved={0})
        assert ids(team) == [0, 0, 0, 1, 1, 1]


def test_nobody_moves_without_exclusion(members):
    team = members(RdpsoControl(exclusion=SocialExclusion(enabled=False), swarms=Swarms(initial=3, max=3)))
    for iteration in range(50):
        iterate(team, iteration, set())
    assert ids(team) == [0, 0, 1, 1, 2, 2]


def test_swarm_changes_on_robots_are_reported(team, hall_scenario):
    robots = tuple(PlacedRobot(start_pose=(2.0 + 0.8 * (i % 3), 4.0 + 0.8 * (i // 3), 0.0)) for i in range(NUM))
    mission = Mission(areas=(Area(name="here", center=(3.0, 4.5)),))
    settings = control(sc_max=4, max=4)
    hall = team(hall_scenario(robots=robots, mission=mission, control=settings))
    monitor, kinds = TeamMonitor(), set()
    for step in range(1500):
        if step % 70 == 69:
            hall.new_epoch(area_center_m=(16.0, 5.0) if step % 140 < 70 else (3.0, 4.5))
        decisions = hall.step()
        kinds |= {change.kind for change in monitor.changes(decisions, np.ones(len(decisions), dtype=bool))}
    assert kinds >= {"robot_excluded", "robot_included", "swarm_dissolved"}


def known_bests(hall) -> list[Best]:
    """Return the best of each robot's last update within 15 steps."""
    updates = [parse_update(m.payload) for _ in range(15) for decision in hall.step() for m in decision.outbox]
    return [update.known_best for update in updates[-2:]]


def test_global_best_of_a_swarm_is_not_that_of_another(team, hall_scenario):
    # Two swarms of one robot, one near the area and one far: without a voice nobody draws the other.
    settings = RdpsoControl(swarms=Swarms(initial=2, max=2))
    hall = team(hall_scenario(control=settings))
    first, second = known_bests(hall)
    assert first.position != second.position
    first, second = known_bests(team(hall_scenario()))
    assert first == second
