"""A few hundred inputs of each target of `make fuzz`, always the same ones."""

from __future__ import annotations

import random
import runpy
import sys
from pathlib import Path

import pytest

_FOLDER = Path(__file__).parents[2] / "fuzz"
sys.path.insert(0, str(_FOLDER))
FUZZ = runpy.run_path(str(_FOLDER / "input_fuzz.py"))


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
