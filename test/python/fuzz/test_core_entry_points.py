"""Odd numbers at every entry point of the C++ core: an error or finite results, never a crash or an endless loop."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from robotteamsim import _core

_FUZZ = Path(__file__).parents[2] / "fuzz"
sys.path.insert(0, str(_FUZZ))

from call_trees import Call  # noqa: E402
from core_calls import calls  # noqa: E402

# Objects that other calls return; their attributes are read there.
_RESULTS = {"simulation.RobotTotals", "world.DoorState"}


def _entry_points() -> set[str]:
    """The functions, classes, methods and properties of all submodules."""
    names: set[str] = set()
    for part, module in vars(_core).items():
        if not isinstance(module, ModuleType):
            continue
        for name, value in vars(module).items():
            if name.startswith("_") or isinstance(value, int) or f"{part}.{name}" in _RESULTS:
                continue
            names.add(f"{part}.{name}")
            if isinstance(value, type):
                names.update(f"{part}.{name}.{method}" for method in vars(value) if not method.startswith("_"))
    return names


def _called(node: object) -> set[str]:
    match node:
        case Call():
            parts = (node.args, node.named, node.then)
            return {node.name, *(f"{node.name}.{method[0]}" for method in node.then)}.union(*map(_called, parts))
        case tuple() | list():
            return set().union(*map(_called, node))
    return set()


def test_each_entry_point_has_a_valid_call_to_change():
    assert _entry_points() - _called(calls()) == set()


@pytest.mark.slow
def test_odd_numbers_give_an_error_or_finite_results_within_five_seconds_each():
    done = subprocess.run(
        (sys.executable, _FUZZ / "core_fuzz.py"), capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    assert "nothing found" in done.stdout


@pytest.mark.parametrize("x", [math.inf, -math.inf, math.nan, 1e300])
def test_planning_grid_rejects_a_place_outside(x):
    grid = _core.plan.PlanningGrid(np.zeros((200, 300), np.bool_), (0.0, 0.0), 0.1, 0.2)
    with pytest.raises(ValueError, match=r"center must be (finite|within 1e9), got \("):
        grid.nearest_free((x, 5.0), 3.0)
