"""The library's Hypot gives the bits of math.hypot and math.dist."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from robotteamsim import _core, rng

pytestmark = pytest.mark.slow

COUNT = 1_000_000


def random_pairs(name):
    generator = rng.stream(1, "hypot", name)
    if name == "metres":
        return generator.uniform(-60.0, 60.0, COUNT), generator.uniform(-60.0, 60.0, COUNT)
    if name == "float32":
        x, y = generator.normal(0.0, 5.0, (2, COUNT)).astype(np.float32)
        return x.astype(np.float64), y.astype(np.float64)
    exponents = generator.integers(-60, 60, (2, COUNT))
    x, y = generator.normal(size=(2, COUNT)) * 2.0**exponents
    return x, y


def is_tie(x, y, length):
    """Whether the exact length is the middle between a double and a neighbour of it."""
    squared = Fraction(x) ** 2 + Fraction(y) ** 2
    neighbours = math.nextafter(length, 0.0), math.nextafter(length, math.inf)
    return squared in [((Fraction(length) + Fraction(other)) / 2) ** 2 for other in neighbours]


@pytest.mark.parametrize("name", ["metres", "float32", "all sizes"])
def test_hypot_equals_that_of_python_for_a_million_random_pairs(name):
    x, y = random_pairs(name)
    ours = _core.base.hypot(x, y)
    np.testing.assert_array_equal(ours, list(map(math.hypot, x.tolist(), y.tolist())))
    few = slice(0, 10_000)
    ends, starts = (
        zip(x[few].tolist(), y[few].tolist(), strict=True),
        zip(y[few].tolist(), x[few].tolist(), strict=True),
    )
    np.testing.assert_array_equal(_core.base.hypot((x - y)[few], (y - x)[few]), list(map(math.dist, ends, starts)))


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (0.0, -0.0),
        (3.0, -4.0),
        (1e308, 1e308),
        (1.7e308, 1.7e308),
        (-1e-200, 1e-200),
        (5e-324, 0.0),
        (math.inf, math.nan),
        (math.nan, -math.inf),
        (math.nan, 1.0),
        (1.0, math.nan),
        (0.0, math.nan),
        (math.inf, 0.0),
    ],
)
def test_hypot_equals_that_of_python_at_the_ends_of_the_range(x, y):
    np.testing.assert_equal(_core.base.hypot(np.array([x]), np.array([y])), [math.hypot(x, y)])


def test_hypot_differs_from_that_of_python_only_in_ties():
    x, y = 0.05 * rng.stream(1, "hypot", "grid").integers(-500, 500, (2, COUNT))
    ours = _core.base.hypot(x, y)
    differ = ours != np.array(list(map(math.hypot, x.tolist(), y.tolist())))
    places = set(zip(x[differ].tolist(), y[differ].tolist(), ours[differ].tolist(), strict=True))
    assert all(is_tie(*place) for place in places)
