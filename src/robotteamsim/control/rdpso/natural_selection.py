"""The swarm of a robot of a DPSO: natural selection [dissertation, 5.1.2, eq. 12 and 13].

Particles are created and deleted, but robots cannot be. A deleted particle is a robot that is excluded, a new particle
an excluded robot that is included, and a child swarm takes its robots from its parent and its mate (ours).
"""

from collections.abc import Callable, Mapping

import numpy as np

from robotteamsim import rng
from robotteamsim.control.rdpso.membership import Membership, Values
from robotteamsim.interface import OUTSIDE
from robotteamsim.swarm import SwarmState, Verdict, natural_selection, spawn_chance


class DpsoMembership(Membership):
    """One robot's swarm by the rules of DPSO."""

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
