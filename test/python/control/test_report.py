"""What robots tell each other, as text."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from robotteamsim import _core
from robotteamsim.control.rdpso.update import Best, RdpsoUpdate, parse_update, updates_in
from robotteamsim.interface import OUTSIDE
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.swarm import SwarmState


def random_report(rng: np.random.Generator) -> RdpsoUpdate:
    def place() -> tuple[float, float]:
        x, y = (rng.normal(size=2) * 10.0 ** rng.integers(-8, 9)).tolist()
        return x, y

    def best() -> Best | None:
        return Best(float(rng.normal()), place()) if rng.random() < 0.7 else None

    return RdpsoUpdate(
        robot_id=int(rng.integers(100)),
        iteration=int(rng.integers(1000)),
        epoch=int(rng.integers(9)),
        position=place(),
        loudest=place() if rng.random() < 0.5 else None,
        local_best=best(),
        known_best=best(),
        swarm_id=int(rng.integers(OUTSIDE, 4)),
        swarm=SwarmState(int(rng.integers(15)), int(rng.integers(5))),
        doors=(('a "b"', True, 3), ("ß", False, 0)) if rng.random() < 0.3 else (),
    )


@pytest.mark.parametrize("seed", range(100))
def test_report_is_written_as_the_json_library_writes_it_and_keeps_every_bit(seed):
    report = random_report(np.random.default_rng(seed))
    text = report.to_json()
    assert json.dumps(json.loads(text)) == text
    assert parse_update(text) is report, "a robot of this process wrote it"
    assert parse_update(text + " ") == report


def test_text_of_the_library_is_that_of_json():
    rng = np.random.default_rng(0)
    bits = rng.integers(0, 2**64, size=20_000, dtype=np.uint64).view(np.float64)
    rounded = [
        round(x, int(n)) for x, n in zip(rng.normal(0.0, 1e3, 2000).tolist(), rng.integers(0, 17, 2000), strict=True)
    ]
    powers = [s * m * 10.0**e for e in range(-30, 31) for m in (1.0, 1.5, 9.999999999999999) for s in (-1.0, 1.0)]
    edges = [0.0, -0.0, 5e-324, 1.7976931348623157e308, 2.0**53, 2.0**54 + 2.0, 123456789012345680.0]
    whole = [0, -1, 2**31, -(2**63), 2**63, 10**40, True, False]
    texts = ["", "plain", 'a "b"', "back\\slash", "tab\t", "ß", "\ud800", "\x7f"]
    for value in [*bits.tolist(), *rounded, *powers, *edges, *whole, *texts, math.inf, -math.inf, math.nan, None]:
        assert _core.json_text(value) == json.dumps(value)
    nested = {"a": [1, (2.5, None)], "b": {}, 'c "d"': [], "best": Best(1.0, (2.0, 3.0)), "np": np.float64(0.1)}
    assert _core.json_text(nested) == json.dumps(nested)


@pytest.mark.parametrize("value", [{1, 2}, {1: 2}, b"bytes", [np.int64(1)]])
def test_text_of_the_library_refuses_what_is_no_json(value):
    with pytest.raises(TypeError):
        _core.json_text(value)


def test_messages_that_carry_something_else_are_no_reports():
    report = random_report(np.random.default_rng(0))
    inbox = [Message(1, EVERYBODY, text) for text in ("", "[]", '{"robot": 1}', report.to_json())]
    assert list(updates_in(inbox)) == [report]
