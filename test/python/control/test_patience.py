"""When a robot gives up a place."""

import numpy as np
import pytest

from robotteamsim.control.exploration.patience import Patience
from robotteamsim.scenario.controllers.frontier import FrontierControl

PLACE, OTHER = (10.0, 0.0), (0.0, 10.0)


@pytest.fixture
def patience():
    """Return the patience of a robot that drives 0.5 m/s: 10 s, and 4 times the time of the way."""
    return Patience(FrontierControl(algorithm="frontier", max_step_speed_mps=0.5, timeout_s=10.0, timeout_factor=4.0))


def is_given_up(patience, place=PLACE):
    return bool(patience.given_up(np.array([place]))[0])


def test_place_to_which_a_robot_comes_nearer_is_not_given_up(patience):
    for length_m in np.arange(60.0, 0.0, -1.0):  # a metre takes 7 s, less than 4 times 2 s
        patience.spend(PLACE, length_m, 7.0)
    assert not is_given_up(patience)


def test_place_to_which_a_robot_comes_no_nearer_is_given_up_after_the_timeout(patience):
    for _ in range(3):
        patience.spend(PLACE, 5.0, 4.0)
    assert not is_given_up(patience)  # 8 s: the first call begins
    patience.spend(PLACE, 5.0, 4.0)
    assert is_given_up(patience)
    assert is_given_up(patience, (11.5, 0.0))
    assert not is_given_up(patience, (12.5, 0.0))


def test_robot_that_changes_between_two_places_gives_both_up(patience):
    for _ in range(12):
        for place in (PLACE, PLACE, OTHER, OTHER):
            patience.spend(place, 5.0, 1.0)
    assert is_given_up(patience)
    assert is_given_up(patience, OTHER)


def test_place_that_moves_on_as_a_robot_comes_nearer_is_not_given_up(patience):
    for x_m in np.arange(0.0, 60.0, 0.4):
        patience.spend((x_m, 0.0), 1.0, 1.0)
    assert not any(is_given_up(patience, (x_m, 0.0)) for x_m in range(60))
