"""Named random streams: nothing that is drawn depends on when, where, or on what else is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.rng import stream

RECORD = [0.005071911256591899, 0.5884480527074781]


def test_stream_of_a_name_and_seed_gives_the_numbers_of_record():
    # Of record, so that no process, machine or release draws others: hashes of missions depend on them.
    assert stream(7, "odometry", 1).random(2).tolist() == RECORD
    assert stream(7, "odometry", 1).random(2).tolist() == RECORD


@pytest.mark.parametrize("name", [("odometry", 2), ("laser", 1), ("odometry",), ("odometry", "1"), ("odometry1",)])
def test_stream_of_another_name_gives_other_numbers(name):
    assert stream(7, *name).random() != stream(7, "odometry", 1).random()


def test_stream_of_another_seed_gives_other_numbers():
    assert stream(8, "odometry", 1).random() != stream(7, "odometry", 1).random()


def test_stream_is_not_shifted_by_draws_of_another():
    first, other = stream(7, "odometry", 1), stream(7, "sonar", 1)
    other.random(1000)
    assert first.random(2).tolist() == RECORD


@pytest.mark.parametrize("seed", [-1, 1.0, None, "1"])
def test_seed_that_is_not_a_whole_number_from_zero_is_rejected(seed):
    with pytest.raises(ValueError, match=r"^seed must be a whole number >= 0, got"):
        stream(seed, "odometry")


def test_name_with_a_number_of_numpy_is_that_of_the_number():
    numbers = [stream(7, "arrival", number).random() for number in (2, np.uint32(2), np.int64(2))]
    assert len(set(numbers)) == 1
