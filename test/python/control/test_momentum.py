"""What a robot remembers of its own path: how it goes on, and whether it comes nearer to the global best."""

from __future__ import annotations

import pytest

from robotteamsim.control.rdpso.terms import Approach, Momentum


def test_displacements_of_the_last_iterations_count_by_their_weights():
    momentum = Momentum((0.5, 0.25))
    momentum.note((1.0, 1.0))
    assert momentum.term() == (0.0, 0.0), "one place is no velocity"
    momentum.note((3.0, 0.0))
    assert momentum.term() == (1.0, -0.5)
    momentum.note((3.0, 0.0))  # blocked
    assert momentum.term() == (0.5, -0.25)
    momentum.note((7.0, 8.0))
    assert momentum.term() == (2.0, 4.0), "older than the weights"


def test_memory_of_commands_is_that_of_the_chosen_velocities_wherever_the_robot_is():
    momentum = Momentum((0.5, 0.25), "commands")
    for _ in range(3):
        momentum.note((1.0, 1.0))  # blocked
        momentum.note_command((2.0, -4.0))
    assert momentum.term() == (1.5, -3.0)
    momentum.forget()
    assert momentum.term() == (0.0, 0.0)


def test_robot_that_forgets_begins_at_rest():
    momentum = Momentum((0.5,))
    momentum.note((1.0, 1.0))
    momentum.note((2.0, 2.0))
    momentum.forget()
    assert momentum.term() == (0.0, 0.0)
    momentum.note((5.0, 5.0))
    assert momentum.term() == (0.0, 0.0)


@pytest.mark.parametrize(
    ("lengths_m", "nearer"),
    [
        ((5.0, 4.0, 4.0, 4.5, 4.2, 3.9), [False, True, False, False, False, True]),  # than ever before
        ((1.0, 0.95, 0.92, 0.89, 0.81, 0.78), [False, False, False, True, False, True]),  # by a cell of 0.1 m
    ],
)
def test_robot_is_nearer_to_the_best_when_it_is_nearer_than_ever_by_a_cell(lengths_m, nearer):
    approach, seen = Approach(), []
    for length_m in lengths_m:
        approach.note((9.0, 1.0), length_m)
        seen.append(approach.nearer)
    assert seen == nearer


def test_approach_to_another_best_or_to_one_that_was_discarded_begins_again():
    approach = Approach()
    for place, length_m in (((9.0, 1.0), 5.0), ((2.0, 1.0), 3.0)):
        approach.note(place, length_m)
        assert not approach.nearer
    approach.forget()
    approach.note((2.0, 1.0), 1.0)
    assert not approach.nearer
    approach.note((2.0, 1.0), 0.5)
    assert approach.nearer
