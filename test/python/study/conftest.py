"""Campaigns of the dissertation's own missions."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.campaign import StoredCampaign, make_design
from robotteamsim.campaign.factors import Factor
from study.dissertation.reference import MissionValues, dissertation_missions


@pytest.fixture(scope="session")
def garage(stored_campaign) -> Callable[..., StoredCampaign]:
    """Make a campaign of the dissertation's own missions, again and again; `change` makes other ones of them."""

    def make(
        *noises_db: float,
        trials: int,
        change: Callable[[float, MissionValues], MissionValues] = lambda noise_db, values: values,
    ) -> StoredCampaign:
        factors = [Factor("voice.noise_db", noises_db, "--noise")] if noises_db else []
        design, missions = make_design("garage_sar", trials=trials, factors=factors), dissertation_missions()

        def figures(trial):
            noise_db = design.cells[trial.cell].scenario.voice.noise_db
            known = missions.get(noise_db, missions[10.0])
            values = change(noise_db, known[(trial.number - 1) % len(known)])
            return {
                "end": "areas_explored" if values.time_s < 600.0 else "time_limit",
                "time_s": values.time_s,
                "areas_explored": values.areas_explored,
                "num_areas": 5,
                "victims_saved": values.victims_saved,
                "num_victims": 4,
                "endangered_links": values.endangered_links,
            }

        return stored_campaign(design, figures, samples=10)

    return make
