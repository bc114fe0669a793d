"""Campaigns with made-up missions."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from robotteamsim.campaign import StoredCampaign, make_design
from robotteamsim.campaign.factors import Factor

TIMES_S = (426.0, 438.0, 447.0, 600.0)
"""Durations of the missions of the garage, by their numbers; at the limit of 600 s, one area is missing."""


@pytest.fixture(scope="session")
def garage(stored_campaign) -> Callable[..., StoredCampaign]:
    """Make a campaign of the garage under several noises [dB]; each 10 dB cost a victim and save 50 s.

    One victim is saved every 60 s.
    """

    def make(*noises_db: float, trials: int) -> StoredCampaign:
        factors = [Factor("voice.noise_db", noises_db, "--noise")] if noises_db else []
        design = make_design("garage_sar", trials=trials, factors=factors)

        def figures(trial):
            tens = design.cells[trial.cell].scenario.voice.noise_db / 10.0 - 1.0
            time_s = TIMES_S[(trial.number - 1) % len(TIMES_S)]
            ended = time_s < 600.0
            saved = 4 - int(tens) - trial.number % 2
            victims = {f"victim_{i}": {"saved_s": 60.0 * i if i <= saved else None} for i in range(1, 5)}
            return {
                "end": "areas_explored" if ended else "time_limit",
                "time_s": time_s - 50.0 * tens if ended else time_s,
                "areas_explored": 5 if ended else 4,
                "num_areas": 5,
                "victims_saved": saved,
                "num_victims": 4,
                "details": json.dumps({"victims": victims}),
            }

        return stored_campaign(design, figures)

    return make


@pytest.fixture(scope="session")
def arena(stored_campaign) -> Callable[..., StoredCampaign]:
    """Make a campaign of the tutorial arena, of missions that end after 20 s + 5 s a cell + 1 s a trial."""

    def make(*factors: Factor, trials: int = 4) -> StoredCampaign:
        design = make_design("tutorial_arena", trials=trials, factors=factors)
        areas = len(design.scenario.mission.areas)

        def figures(trial):
            time_s = 20.0 + 5.0 * trial.cell + trial.number
            found = {"areas_explored": areas, "num_areas": areas, "num_victims": 1}
            return found | {"time_s": time_s, "victims_saved": trial.cell % 2}

        return stored_campaign(design, figures)

    return make
