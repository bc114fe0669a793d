"""The swarm of a robot: social exclusion and inclusion, dissolution and new swarms [5.2.2].

There is no leader. Each robot applies the same rules to every swarm in the updates that it received in this iteration,
and applies the result to itself. Robots that received the same updates come to the same result. If the team is split,
each part continues on its own, and each robot's own statement of its swarm counts.
"""

from collections.abc import Callable, Collection, Mapping
from functools import partial

import numpy as np

from robotteamsim import rng
from robotteamsim.control.rdpso.team import CommonView
from robotteamsim.interface import OUTSIDE
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import ExclusionRules, SwarmState, Verdict, judge, natural_selection, spawn_chance

Values = dict[int, float]
"""Values of local bests by robot id."""


class Membership:
    """One robot's swarm, and its copy of that swarm's memory."""

    def __init__(self, robot_id: int, scenario: Scenario) -> None:
        control = scenario.control.as_kind(RdpsoControl)
        exclusion, swarms = control.exclusion, control.swarms
        self._robot_id = robot_id
        self._seed = scenario.run.seed
        self._enabled = exclusion.enabled
        limits = exclusion.search_counter_max, exclusion.min_robots, exclusion.max_robots
        self._rules = ExclusionRules(*limits)
        self._swarms = swarms
        self._settings = type(self).__name__, self._seed, *limits, swarms.min, swarms.max, swarms.new_robots
        """All inputs of a verdict besides the updates."""
        self.swarm_id = robot_id * swarms.initial // scenario.num_robots
        """OUTSIDE if it is excluded."""
        self.state = SwarmState()
        self._last_swarm_id = self.swarm_id

    @property
    def excluded(self) -> bool:
        """Whether the robot is socially excluded."""
        return self.swarm_id == OUTSIDE

    def judge(self, iteration: int, view: CommonView, improved: Collection[int], in_use: Collection[int]) -> None:
        """Apply the rules to all swarms in the updates, in the order of their numbers.

        Args: view: of the updates of this iteration, including the robot's own.
              improved: swarms that improved their best; contains OUTSIDE if the excluded robots did.
              in_use: numbers of all known swarms, heard in this iteration or before.
        """
        if not self._enabled:
            return
        # Robots that share a view come to the same verdict, so the first one computes it for all.
        key = self._settings, tuple(improved), frozenset(in_use)
        verdict = view.verdicts.get(key)
        if verdict is None:
            verdict = view.verdicts[key] = self._verdict(iteration, view, improved, in_use)
        moves, states = verdict
        self._move(moves.get(self._robot_id, self.swarm_id), states)

    def _verdict(
        self, iteration: int, view: CommonView, improved: Collection[int], in_use: Collection[int]
    ) -> tuple[dict[int, int], dict[int, SwarmState]]:
        """Return the new swarm of each robot that changes, and the swarms' memories."""
        swarms: dict[int, Values] = dict(view.values)
        outside = swarms.pop(OUTSIDE, {})
        moves: dict[int, int] = {}
        # Swarms that were not heard in this iteration may still exist.
        taken = {*swarms, *in_use} - {OUTSIDE}
        asking: dict[int, int] = {}
        num_swarms = len(taken)
        states: dict[int, SwarmState] = {}
        for swarm_id, members in sorted(swarms.items()):
            dice = partial(self._dice, iteration, swarm_id)
            free = {i: value for i, value in outside.items() if i not in moves}
            has_improved = swarm_id in improved
            # A swarm on its way to the global best is neither rewarded nor punished.
            verdict = Verdict(view.states[swarm_id])
            if has_improved or swarm_id not in view.nearing:
                verdict = self._judged(verdict.state, has_improved, members, free, dice)
            if len(verdict.leaves) == len(members):
                verdict, num_swarms = self._dissolved_or_not(verdict, num_swarms)
            moves |= dict.fromkeys(verdict.leaves, OUTSIDE) | dict.fromkeys(verdict.joins, swarm_id)
            states[swarm_id] = verdict.state
            if len(verdict.leaves) < len(members) and self._asks(verdict.state, has_improved):
                asking[swarm_id] = len(members)
        if OUTSIDE in improved:
            asking[OUTSIDE] = len(outside)
        if asking:
            self._found(iteration, asking, view.values, moves, num_swarms, taken)
        return moves, states

    def _dissolved_or_not(self, verdict: Verdict, num_swarms: int) -> tuple[Verdict, int]:
        """Dissolve a swarm that all members leave, or restart it if too few swarms would be left."""
        if num_swarms > self._swarms.min:
            return verdict, num_swarms - 1
        return Verdict(SwarmState(0, verdict.state.num_killed - len(verdict.leaves))), num_swarms

    def _found(
        self,
        iteration: int,
        asking: Mapping[int, int],
        values: Mapping[int, Values],
        moves: dict[int, int],
        num_swarms: int,
        taken: set[int],
    ) -> None:
        """Found swarms of the best excluded robots: one per swarm that requests it, with probability f N_s / N_max.

        f is uniform in [0, 1]. The excluded robots also request one if their best improved.

        Args: asking: number of members of each swarm that requests one.
              values: of the local bests, by swarm and robot.
              moves: the new swarm of each robot that changes; new members are added here.
              taken: numbers of swarms that are in use.
        """
        dice, outside = None, values.get(OUTSIDE, {})
        for num_asking in asking.values():
            free = [robot_id for robot_id in outside if robot_id not in moves]
            if num_swarms >= self._swarms.max or len(free) < self._swarms.new_robots:
                return
            dice = dice or rng.stream(self._seed, "new_swarm", iteration)
            fraction, drawn = dice.random(2).tolist()
            if drawn < fraction * min(1.0, num_asking / self._rules.max_robots):
                swarm_id = min(set(range(len(taken) + 1)) - taken)
                best_first = sorted(free, key=lambda robot_id: (-outside[robot_id], robot_id))
                moves |= dict.fromkeys(best_first[: self._swarms.new_robots], swarm_id)
                taken = taken | {swarm_id}
                num_swarms += 1

    def _judged(
        self, state: SwarmState, improved: bool, members: Values, free: Values, dice: Callable[[], float]
    ) -> Verdict:
        """Return what an iteration does to a swarm."""
        return judge(state, improved, members, free, self._rules, dice)

    def _asks(self, state: SwarmState, improved: bool) -> bool:
        """Whether a swarm in this state after an iteration requests a new one."""
        return improved and state.search_counter == 0

    def _move(self, swarm_id: int, states: Mapping[int, SwarmState]) -> None:
        """Join a swarm and adopt its memory; an excluded robot keeps that of the swarm that it left."""
        if swarm_id not in (OUTSIDE, self.swarm_id):
            self.state = SwarmState()  # of a new swarm
        self.swarm_id = swarm_id
        if swarm_id != OUTSIDE:
            self._last_swarm_id = swarm_id
        self.state = states.get(self._last_swarm_id, self.state)

    def _dice(self, iteration: int, swarm_id: int) -> float:
        """Return the random number that all robots draw identically for a swarm in an iteration."""
        name = (iteration, swarm_id) if swarm_id else (iteration,)
        return float(rng.stream(self._seed, "swarm", *name).random())


class DpsoMembership(Membership):
    """One robot's swarm by the natural selection of DPSO [5.1.2, eq. 12 and 13].

    Particles are created and deleted, but robots cannot be. A deleted particle is a robot that is excluded, a new
    particle an excluded robot that is included, and a child swarm takes its robots from its parent and its mate (ours).
    """

    def _judged(
        self, state: SwarmState, improved: bool, members: Values, free: Values, dice: Callable[[], float]
    ) -> Verdict:
        return natural_selection(state, improved, members, free, self._rules)

    def _asks(self, state: SwarmState, improved: bool) -> bool:
        return state.num_killed == 0

    def _found(
        self,
        iteration: int,
        asking: Mapping[int, int],
        values: Mapping[int, Values],
        moves: dict[int, int],
        num_swarms: int,
        taken: set[int],
    ) -> None:
        """Found child swarms with the probability (13): half of the robots from the parent, half from a mate."""
        dice = rng.stream(self._seed, "child_swarm", iteration)
        for parent in sorted(set(asking) - {OUTSIDE}):
            fraction, drawn = dice.random(2).tolist()
            if num_swarms >= self._swarms.max or not drawn < spawn_chance(fraction, num_swarms):
                continue
            chosen = self._family(parent, values, moves, dice)
            if chosen:
                swarm_id = min(set(range(len(taken) + 1)) - taken)
                moves |= dict.fromkeys(chosen, swarm_id)
                taken = taken | {swarm_id}
                num_swarms += 1

    def _family(
        self, parent: int, values: Mapping[int, Values], moves: Mapping[int, int], dice: np.random.Generator
    ) -> list[int]:
        """Return the robots of a child swarm, drawn at random; none if a family would be left without robots."""
        stay = {
            swarm_id: [robot_id for robot_id in members if robot_id not in moves]
            for swarm_id, members in sorted(values.items())
            if swarm_id != OUTSIDE
        }
        mates = [swarm_id for swarm_id in stay if swarm_id != parent]
        mate = mates[int(dice.integers(len(mates)))] if mates else parent
        from_mate = self._swarms.new_robots // 2 if mates else 0
        wanted = {mate: from_mate, parent: self._swarms.new_robots - from_mate}
        if any(len(stay[swarm_id]) <= number for swarm_id, number in wanted.items() if number > 0):
            return []
        return [
            int(i) for swarm_id, number in wanted.items() for i in dice.choice(stay[swarm_id], number, replace=False)
        ]
