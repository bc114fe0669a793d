"""A few hundred inputs of each target of `make fuzz`, always the same ones."""

from __future__ import annotations

import random
import runpy
from pathlib import Path

import pytest

FUZZ = runpy.run_path(str(Path(__file__).parents[2] / "fuzz" / "input_fuzz.py"))


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("yaml", 500),
        ("scenario", 100),
        ("bag", 20),
        ("message", 500),
        pytest.param("mission", 4, marks=pytest.mark.slow),
    ],
)
def test_odd_input_is_read_or_rejected_in_one_line(tmp_path, name, count):
    target, generator = FUZZ["TARGETS"][name](tmp_path), random.Random(7)
    for _ in range(count):
        target.check(target.make(generator))
