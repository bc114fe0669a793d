"""Campaigns with made-up missions, as a store gives them back."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest

from robotteamsim.campaign import Design, Outcome, StoredCampaign, Trial, make_design
from robotteamsim.campaign.factors import Factor
from robotteamsim.campaign.paths import encode_paths
from robotteamsim.campaign.reference import MissionValues, dissertation_missions

LIMIT_S = 600.0


def mission(trial: Trial, figures: MissionValues, num_areas: int = 5, num_victims: int = 4) -> Outcome:
    """Return the outcome of a mission with such figures; its two robots drive 30 m eastwards, 2 m apart."""
    x_m = 4.0 + np.linspace(0.0, 30.0, 60)
    paths_m = np.stack([np.stack([x_m, np.full(60, y_m)], axis=1) for y_m in (7.0, 9.0)], axis=1)
    return Outcome(
        cell=trial.cell,
        number=trial.number,
        seed=trial.seed,
        end="areas_explored" if figures.time_s < LIMIT_S else "time_limit",
        time_s=figures.time_s,
        areas_explored=figures.areas_explored,
        num_areas=num_areas,
        victims_saved=figures.victims_saved,
        num_victims=num_victims,
        endangered_links=figures.endangered_links,
        distance_m=60.0,
        contact_s=0.0,
        steps=600,
        trajectory_hash="ab" * 32,
        details="{}",
        paths=encode_paths(paths_m),
    )


def stored(design: Design, outcomes: list[Outcome]) -> StoredCampaign:
    """Return what a store of these outcomes gives back."""
    ordered = sorted(outcomes, key=lambda outcome: (outcome.cell, outcome.number))
    versions = {"robotteamsim": "0.1.0", "numpy": "2"}
    return StoredCampaign(json.loads(json.dumps(design.settings())), versions, tuple(ordered))


@pytest.fixture(scope="session")
def garage_design() -> Callable[..., Design]:
    """Make a design of the garage under several noises [dB]."""

    def make(*noises_db: float, trials: int) -> Design:
        factors = [Factor("voice.noise_db", noises_db, "--noise")] if noises_db else []
        return make_design("garage_sar", trials=trials, factors=factors)

    return make


@pytest.fixture(scope="session")
def garage(garage_design) -> Callable[..., StoredCampaign]:
    """Make a campaign of the dissertation's own missions, again and again; `change` makes other ones of them."""

    def make(
        *noises_db: float,
        trials: int,
        change: Callable[[float, MissionValues], MissionValues] = lambda noise_db, figures: figures,
    ) -> StoredCampaign:
        design, missions = garage_design(*noises_db, trials=trials), dissertation_missions()
        outcomes = []
        for trial in design.all_trials():
            noise_db = design.cells[trial.cell].scenario.voice.noise_db
            known = missions.get(noise_db, missions[10.0])
            outcomes.append(mission(trial, change(noise_db, known[(trial.number - 1) % len(known)])))
        return stored(design, outcomes)

    return make


@pytest.fixture(scope="session")
def arena() -> Callable[..., StoredCampaign]:
    """Make a campaign of the tutorial arena, of missions that end after 20 s + 5 s a cell + 1 s a trial."""

    def make(*factors: Factor, trials: int = 4) -> StoredCampaign:
        design = make_design("tutorial_arena", trials=trials, factors=factors)
        areas = len(design.scenario.mission.areas)
        return stored(
            design,
            [
                mission(
                    trial, MissionValues(trial.cell % 2, 20.0 + 5.0 * trial.cell + trial.number, areas, 0), areas, 1
                )
                for trial in design.all_trials()
            ],
        )

    return make
