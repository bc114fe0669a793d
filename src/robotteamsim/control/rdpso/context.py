"""The context of one robot in its swarm, and the coefficients that follow from it [dissertation, 5.2.2]."""

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from robotteamsim.control.rdpso.terms import LinkKeeper
from robotteamsim.interface import SwarmContext
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.swarm import (
    EXACT_LEVELS,
    PUBLISHED_LEVELS,
    Context,
    Vector,
    adapted_coefficients,
    robot_avoidance,
    robot_socialisation,
    swarm_activity,
)


class ContextMeter:
    """Measures A_s, S_n, O_n, P_n and C_s (28 to 34) from one robot's observations and messages, once per iteration.

    The robot predicts the links between teammates from the positions that they sent.
    """

    def __init__(self, control: RdpsoControl, kind: Literal["crisp", "fuzzy"], links: LinkKeeper) -> None:
        self._kind: Literal["crisp", "fuzzy"] = kind
        self._levels = PUBLISHED_LEVELS if control.memory == "published" else EXACT_LEVELS
        self._max_step_m = control.max_step_speed_mps * control.iteration_s
        self._sensing_radius_m = control.sensing_radius_m
        self._links = links
        self._places: Mapping[int, Vector] = {}
        self._iteration = -1

    def measure(
        self,
        iteration: int,
        robot_id: int,
        places: Mapping[int, Vector],
        is_complete: bool,
        global_best: Vector,
        clearance_m: float,
    ) -> SwarmContext:
        """Return the context of an iteration and the coefficients that follow from it.

        Args: places: of the robot and the members of its swarm that it heard, in `map` [m], by robot id.
              is_complete: whether it heard all members; if not, it takes the swarm as split.
              clearance_m: distance to the nearest obstacle that the laser sees; infinite if it sees none.
        """
        position = places[robot_id]
        others = [place for i, place in places.items() if i != robot_id]
        context = Context(
            activity=self._activity(iteration, places),
            socialisation=robot_socialisation(position, global_best, places.values()),
            avoidance=robot_avoidance(clearance_m, self._sensing_radius_m),
            proximity=self._links.proximity(position, others) if others else float(is_complete),
            connectivity=self._links.connectivity(list(places.values())) if is_complete else 0.0,
        )
        self._places, self._iteration = dict(places), iteration
        found = adapted_coefficients(self._kind, context, self._levels)
        return SwarmContext(**context._asdict(), **found._asdict())

    def _activity(self, iteration: int, places: Mapping[int, Vector]) -> float:
        """Return A_s of the members whose motion since the last iteration is known; 0 if there are none."""
        if iteration != self._iteration + 1:
            return 0.0
        motions: Sequence[np.ndarray] = [
            np.subtract(place, self._places[robot_id]) for robot_id, place in places.items() if robot_id in self._places
        ]
        # Robots drive slightly faster than v[t+1], to arrive before the next iteration starts.
        return min(1.0, swarm_activity(motions, self._max_step_m)) if motions else 0.0
