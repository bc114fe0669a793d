"""Social exclusion and inclusion [dissertation, 5.2.2 and eq. 12]."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated

import msgspec

Count = Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)]
"""A number of iterations or robots, in the range that messages allow."""


@dataclass(frozen=True, slots=True)
class ExclusionRules:
    """SC_max, N_min and N_max of one swarm."""

    search_counter_max: int = 15
    min_robots: int = 0
    max_robots: int = 15


class SwarmState(msgspec.Struct, frozen=True):
    """The memory of one swarm.

    search_counter: SC, iterations without improvement.  num_killed: N_kill, robots excluded and not included again.
    """

    search_counter: Count = 0
    num_killed: Count = 0


class Verdict(msgspec.Struct, frozen=True):
    """The effect of an iteration on a swarm: its new state, and the excluded and included robots in id order."""

    state: SwarmState
    leaves: tuple[int, ...] = ()
    joins: tuple[int, ...] = ()


def punished_search_counter(search_counter_max: int, num_killed: int) -> int:
    """Return SC after an exclusion, eq. (12), in whole iterations: SC_max * (1 - 1 / (N_kill + 1))."""
    return search_counter_max * num_killed // (num_killed + 1)


def judge(
    state: SwarmState,
    improved: bool,
    members: Mapping[int, float],
    excluded: Mapping[int, float],
    rules: ExclusionRules,
    uniform: Callable[[], float],
) -> Verdict:
    """Return the effect of an iteration on a swarm, with or without an improvement of the global best.

    Improved: SC decreases by 1; at 0 and with room for one more, the best excluded robot is included with probability
    1 / (N_kill + 1). Not improved: SC increases by 1; at SC_max the worst member is excluded, or the whole swarm is
    dissolved if it has N_min robots or fewer. Robots that received the same updates and draw from the same stream come
    to the same result.

    Args: members, excluded: value of the local best (larger is better) by robot id; ties are broken by id.
          uniform: draws a number in [0, 1); called only if a robot may be included.
    """
    if not members:
        return Verdict(state)
    if improved:
        return _rewarded(state, members, excluded, rules, uniform)
    return punish(state, members, rules)


def punish(state: SwarmState, members: Mapping[int, float], rules: ExclusionRules) -> Verdict:
    """Return the effect of an iteration without success on a swarm, of robots (RDPSO) or particles (DPSO).

    SC increases by 1; at SC_max the worst member leaves and SC is set by (12), or all leave if they are N_min or fewer.
    """
    search_counter = state.search_counter + 1
    if search_counter < rules.search_counter_max:
        return Verdict(SwarmState(search_counter, state.num_killed))
    if len(members) <= rules.min_robots:
        return Verdict(SwarmState(0, state.num_killed + len(members)), leaves=tuple(sorted(members)))
    worst = min(members, key=lambda robot_id: (members[robot_id], -robot_id))
    num_killed = state.num_killed + 1
    search_counter = punished_search_counter(rules.search_counter_max, num_killed)
    return Verdict(SwarmState(search_counter, num_killed), leaves=(worst,))


def natural_selection(
    state: SwarmState,
    improved: bool,
    members: Mapping[int, float],
    excluded: Mapping[int, float],
    rules: ExclusionRules,
) -> Verdict:
    """Return what an iteration does to a swarm of a DPSO whose particles are robots [5.1.2].

    Improved: SC and N_kill restart at 0, and the best excluded robot is included if there is room. Not improved: as
    `punish`.
    """
    if not members:
        return Verdict(state)
    if not improved:
        return punish(state, members, rules)
    joins = (_best(excluded),) if excluded and len(members) < rules.max_robots else ()
    return Verdict(SwarmState(), joins=joins)


def _rewarded(
    state: SwarmState,
    members: Mapping[int, float],
    excluded: Mapping[int, float],
    rules: ExclusionRules,
    uniform: Callable[[], float],
) -> Verdict:
    search_counter, num_killed = max(0, state.search_counter - 1), state.num_killed
    has_room = bool(excluded) and len(members) < rules.max_robots
    if search_counter > 0 or not has_room or uniform() * (num_killed + 1) >= 1.0:
        return Verdict(SwarmState(search_counter, num_killed))
    return Verdict(SwarmState(0, max(0, num_killed - 1)), joins=(_best(excluded),))


def _best(values: Mapping[int, float]) -> int:
    """Return the robot with the largest value, among equals that with the lowest id."""
    return max(values, key=lambda robot_id: (values[robot_id], -robot_id))


def spawn_chance(fraction: float, num_swarms: int) -> float:
    """Return the probability of eq. (13) that a swarm of a DPSO has a child: f / N_s, N_s being the number of swarms.

    Only a swarm with N_kill = 0 may, and only while there are fewer swarms than allowed.

    Args: fraction: f, uniform in [0, 1].
    """
    return fraction / num_swarms
