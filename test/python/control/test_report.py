"""What robots tell each other, as text."""

from __future__ import annotations

import json

import numpy as np
import pytest

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


def test_messages_that_carry_something_else_are_no_reports():
    report = random_report(np.random.default_rng(0))
    inbox = [Message(1, EVERYBODY, text) for text in ("", "[]", '{"robot": 1}', report.to_json())]
    assert list(updates_in(inbox)) == [report]
