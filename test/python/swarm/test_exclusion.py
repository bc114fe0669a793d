import pytest

from robotteamsim.swarm import (
    ExclusionRules,
    SwarmState,
    Verdict,
    judge,
    natural_selection,
    punished_search_counter,
    spawn_chance,
)

RULES = ExclusionRules(search_counter_max=15, min_robots=0, max_robots=15)
MEMBERS = {0: -3.0, 1: -5.0, 2: -4.0}


def never() -> float:
    raise AssertionError("no random number is needed here")


@pytest.mark.parametrize(("num_killed", "search_counter"), [(0, 0), (1, 7), (2, 10), (3, 11), (14, 14)])
def test_search_counter_after_an_exclusion_nears_its_maximum(num_killed, search_counter):
    # 15 * (1 - 1/(n+1)) = 0, 7.5, 10, 11.25, 14
    assert punished_search_counter(15, num_killed) == search_counter


OUTSIDE = {3: -9.0, 4: -2.0, 5: -2.0}
PAIRED = ExclusionRules(15, min_robots=3, max_robots=15)
FULL = ExclusionRules(15, min_robots=0, max_robots=3)


@pytest.mark.parametrize(
    ("before", "improved", "members", "excluded", "rules", "verdict"),
    [
        # No improvement raises the counter; at its maximum the worst robot leaves, of equals that with the highest id.
        (SwarmState(3, 1), False, MEMBERS, {}, RULES, Verdict(SwarmState(4, 1))),
        (SwarmState(14, 0), False, MEMBERS, {}, RULES, Verdict(SwarmState(7, 1), leaves=(1,))),
        (SwarmState(14, 0), False, dict.fromkeys(range(3), 1.0), {}, RULES, Verdict(SwarmState(7, 1), leaves=(2,))),
        # A swarm of the minimum is dissolved.
        (SwarmState(14, 0), False, MEMBERS, {}, PAIRED, Verdict(SwarmState(0, 3), leaves=(0, 1, 2))),
        # Improvement lowers the counter to zero at least; nobody is included before, nor into a full swarm.
        (SwarmState(3, 0), True, MEMBERS, {}, RULES, Verdict(SwarmState(2, 0))),
        (SwarmState(0, 0), True, MEMBERS, {}, RULES, Verdict(SwarmState(0, 0))),
        (SwarmState(2, 1), True, MEMBERS, OUTSIDE, RULES, Verdict(SwarmState(1, 1))),
        (SwarmState(0, 1), True, MEMBERS, OUTSIDE, FULL, Verdict(SwarmState(0, 1))),
        # Without robots, nothing happens.
        (SwarmState(3, 3), False, {}, MEMBERS, RULES, Verdict(SwarmState(3, 3))),
    ],
)
def test_verdict_follows_the_rules_of_punishment_and_reward(before, improved, members, excluded, rules, verdict):
    assert judge(before, improved, members, excluded, rules, never) == verdict


def test_best_excluded_robot_is_included_when_the_draw_is_low():
    # One of two robots was excluded: the chance is 1/2.
    assert judge(SwarmState(1, 1), True, MEMBERS, OUTSIDE, RULES, lambda: 0.49) == Verdict(SwarmState(0, 0), joins=(4,))
    assert judge(SwarmState(1, 1), True, MEMBERS, OUTSIDE, RULES, lambda: 0.5) == Verdict(SwarmState(0, 1))


def test_swarm_without_success_loses_its_last_robot_after_fifteen_eight_and_five_iterations():
    members, state, gone_after = dict(MEMBERS), SwarmState(), []
    for iteration in range(1, 40):
        verdict = judge(state, False, members, {}, RULES, never)
        state = verdict.state
        for robot_id in verdict.leaves:
            del members[robot_id]
            gone_after.append(iteration)
    assert gone_after == [15, 23, 28]
    assert members == {}


def test_success_of_a_dpso_clears_both_counters_and_calls_in_the_best_where_there_is_room():
    assert natural_selection(SwarmState(9, 2), True, MEMBERS, OUTSIDE, RULES) == Verdict(SwarmState(), joins=(4,))
    assert natural_selection(SwarmState(9, 2), True, MEMBERS, {}, RULES) == Verdict(SwarmState())
    assert natural_selection(SwarmState(9, 2), True, MEMBERS, OUTSIDE, FULL) == Verdict(SwarmState())


def test_failure_of_a_dpso_is_punished_as_that_of_an_rdpso():
    for state in (SwarmState(3, 1), SwarmState(14, 0)):
        expected = judge(state, False, MEMBERS, {}, RULES, never)
        assert natural_selection(state, False, MEMBERS, {}, RULES) == expected


def test_chance_of_a_child_swarm_falls_with_the_number_of_swarms():
    assert [spawn_chance(0.6, n) for n in (1, 2, 6)] == pytest.approx([0.6, 0.3, 0.1])
