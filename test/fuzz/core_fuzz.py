"""Every function and method of `robotteamsim._core` with odd numbers: an error or finite results, within a time limit.

Usage: python test/fuzz/core_fuzz.py [--seconds 60] [--seed 0] [--core FILE]. Without --seconds, each number of each
call is replaced by each odd value once; else up to three numbers at a time, at random. With --core, that build of the
C++ is used, such as the one under the sanitizers. A call that takes longer than 5 s ends the process with a traceback,
also while it holds the interpreter lock.
"""

from __future__ import annotations

import argparse
import faulthandler
import math
import os
import random
import signal
import struct
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from peak_memory import peak_memory_mb

ODD = (
    *(math.nan, math.inf, -math.inf, 1e308, -1e308, 1e18, -1e18, 1e9, 5e-324, -5e-324, 1e-310, 0.0, -1.0),
    *(None, 0, -1, 2**31 - 1, -(2**31), 2**63 - 1),
)
TIME_LIMIT_S = 5.0
MEMORY_LIMIT_MB = 1024
# An infinite length means that there is no path, an infinite range no return (REP-117). hypot equals math.hypot, and
# the pose of a removed robot is NaN. Without a wall, distances to one are infinite. A state has the numbers that it is
# given.
MAY_BE_INFINITE = {
    *("base.hypot", "distance_map", "value_at", "values_near", "least_reachable", "cast", "read", "remove_robot"),
    *("lengths_from", "length_m", "distances_m", "trace"),
    "state.State",
}
INFINITE_IF_GIVEN = {"sensing.report", "sensing.dim"}
"""Calls that report what they are given where a laser has no return, also an infinite range (REP-117)."""
AS_GIVEN = {"State"}
"""Inputs of other calls that have the numbers that they are given; what those calls return must be finite."""
# What is wrong is named: the type, the value, or the index.
EXPECTED = (ValueError, TypeError, IndexError)


def is_finite(value: Any) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, np.ndarray):
        return value.dtype.kind != "f" or bool(np.isfinite(value).all())
    if isinstance(value, dict):
        return is_finite(list(value.values()))
    if isinstance(value, (tuple, list)):
        return all(is_finite(item) for item in value)
    if type(value).__name__ == "Call":
        return is_finite([*vars(value).values()])
    if not type(value).__module__.startswith("robotteamsim._core") or type(value).__name__ in AS_GIVEN:
        return True
    public = [name for name in dir(value) if not name.startswith("_")]
    return all(is_finite(part) for name in public if not callable(part := getattr(value, name)))


def check(call: Any, expected: tuple[type[Exception], ...] = EXPECTED) -> None:
    """Make a call within the time limit; anything but an expected error or finite results raises an exception."""
    from call_trees import evaluate

    filled: list[Any] = []
    signal.setitimer(signal.ITIMER_REAL, TIME_LIMIT_S)
    try:
        evaluate(call, filled)
    except expected:
        return
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    if call.name in INFINITE_IF_GIVEN and not is_finite(call):
        return
    if MAY_BE_INFINITE.isdisjoint({call.name, *(method[0] for method in call.then)}):
        assert is_finite(filled), f"{call} returned {filled}"


def each_once(calls: tuple[Any, ...]) -> Iterator[Any]:
    from call_trees import leaves, replaced

    for call in calls:
        for path in leaves(call):
            yield from (replaced(call, path, odd) for odd in ODD)


def at_random(calls: tuple[Any, ...], seconds: float, seed: int) -> Iterator[Any]:
    from call_trees import leaves, replaced

    generator, end_s = random.Random(seed), time.monotonic() + seconds
    paths = {index: list(leaves(call)) for index, call in enumerate(calls)}
    while time.monotonic() < end_s:
        index = generator.randrange(len(calls))
        call = calls[index]
        for path in generator.sample(paths[index], min(len(paths[index]), generator.randint(1, 3))):
            bits = struct.unpack("d", generator.randbytes(8))[0]
            call = replaced(call, path, generator.choice((*ODD, bits, generator.gauss(0.0, 10.0))))
        yield call


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--core", type=Path, default=os.environ.get("ROBOTTEAMSIM_CORE"))
    options = parser.parse_args()
    if options.core:
        from sanitized_core import use_core

        if "robotteamsim" not in sys.modules:
            use_core(Path(options.core))
    from core_calls import calls

    faulthandler.register(signal.SIGALRM, chain=True)  # a traceback, and then the signal ends the process
    valid = calls()
    for call in valid:
        check(call, expected=())
    count = 0
    some = each_once(valid) if options.seconds is None else at_random(valid, options.seconds, options.seed)
    for count, call in enumerate(some, 1):  # noqa: B007
        check(call)
    memory_mb = peak_memory_mb()
    assert options.core or memory_mb < MEMORY_LIMIT_MB, f"{memory_mb} MB"
    print(f"core_fuzz: {count} inputs, seed {options.seed}, {memory_mb} MB: nothing found")


if __name__ == "__main__":
    main()
