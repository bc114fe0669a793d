"""A short campaign."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.campaign import Design, make_design
from robotteamsim.campaign.factors import Factor, parse_override, parse_sweep

SHORT = parse_override("mission.time_limit_s=1")


@pytest.fixture
def short_design() -> Callable[..., Design]:
    """Make a design in the tutorial arena, of missions of one second."""

    def make(
        *sweeps: str, trials: int = 2, seed: int = 1, overrides: tuple[Factor, ...] = (), paired: bool = False
    ) -> Design:
        factors = [parse_sweep(text) for text in sweeps]
        return make_design(
            "tutorial_arena", trials=trials, seed=seed, overrides=[SHORT, *overrides], factors=factors, paired=paired
        )

    return make
