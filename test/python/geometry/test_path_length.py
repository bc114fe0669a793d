"""The length of a path, bit by bit."""

from __future__ import annotations

from robotteamsim.geometry import path_length_m


def test_length_is_that_of_all_segments():
    assert path_length_m([(0.0, 0.0), (3.0, 4.0), (3.0, 6.0)]) == 7.0
    assert path_length_m([(1.0, 2.0)]) == path_length_m([]) == 0.0


def test_segments_are_added_from_the_first_to_the_last():
    expected = 0.0
    for _ in range(10):
        expected += 0.1
    points = [(0.0, 0.1 * (step % 2)) for step in range(11)]
    assert expected != 1.0
    assert path_length_m(points) == expected
