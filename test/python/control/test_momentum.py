"""How a robot's own way carries on in its next step."""

from __future__ import annotations

from robotteamsim.control.rdpso.terms import Momentum


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
