"""Random numbers of one robot's controller."""

import numpy as np

from robotteamsim import rng
from robotteamsim.scenario.scenario import Scenario


def robot_stream(scenario: Scenario, purpose: str, robot_id: int, arrival: int) -> np.random.Generator:
    """Return the generator of one robot's controller for a purpose.

    Not for numbers that all robots must draw identically.

    Args: arrival: number of the robot's arrivals, including the start; a robot draws new numbers after each.
    """
    again = (arrival,) if arrival > 1 else ()
    return rng.stream(scenario.run.seed, purpose, robot_id, *again)
