"""The report of an exploration benchmark from made-up missions."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from robotteamsim.analysis.benchmark.measures import exploration_samples
from robotteamsim.analysis.benchmark.report import make_exploration_report
from robotteamsim.campaign.protocol import ExplorationProtocol, exploration_design
from robotteamsim.errors import CampaignError

DESIGN = exploration_design(
    ExplorationProtocol(("frontier", "nearest"), ("rooms",), (2,), ("near",), ("unknown",), trials=6, duration_s=300.0)
)
T90_S = {0: (100.0, 110.0, 120.0, 130.0, 140.0, 150.0), 1: (150.0, 170.0, 190.0, None, None, None)}


@pytest.fixture
def outcomes(outcome_of):
    """Missions of the design: frontier knows 90 % after 100 to 150 s; nearest in three of six, and later."""

    def outcome(trial):
        t90_s = T90_S[trial.cell][trial.number - 1]
        found = {"known": 0.8, "t90_s": t90_s, "t99_s": None, "right": 0.9, "aligned": 0.95, "bytes_per_s": 250.0}
        return outcome_of(trial, details=json.dumps({"exploration": found}))

    return tuple(sorted(map(outcome, DESIGN.all_trials()), key=lambda outcome: (outcome.cell, outcome.number)))


def table(made, name: str) -> list[list[str]]:
    (found,) = (each for each in made.tables if each.name == name)
    return [list(row) for row in found.texts]


def test_missions_that_never_know_so_much_rank_last_in_medians(outcomes):
    made = make_exploration_report(DESIGN, outcomes, "robotteamsim benchmark exploration")
    frontier, nearest = table(made, "exploration")
    assert frontier[:7] == ["rooms, near, unknown poses, 2 robots", "frontier", "6", "125", "0", "-", "6"]
    assert nearest[1:5] == ["nearest", "6", "-", "3"]  # the middle of 190 s and never
    assert frontier[-1] == "250"


def test_difference_counts_the_limit_and_its_test_only_ranks(outcomes):
    made = make_exploration_report(DESIGN, outcomes, "robotteamsim benchmark exploration")
    of_t90, of_t99 = table(made, "differences")
    # The mean of 100 to 150, and (150 + 170 + 190 + 3 x 300) / 6.
    assert {"T_90 [s]", "125", "235"} <= set(of_t90)
    assert of_t90[-1] == "p = 0.031"  # all six pairs have the same sign: 2 / 2^6
    assert {"T_99 [s]", "300"} <= set(of_t99)


def test_samples_keep_never_as_infinity(outcomes):
    _, nearest = exploration_samples(DESIGN, outcomes)
    assert nearest.t90_s.tolist() == [150.0, 170.0, 190.0, math.inf, math.inf, math.inf]
    assert np.isinf(nearest.t99_s).all()
    assert nearest.limit_s == 300.0


def test_missions_without_measures_are_rejected(outcomes, outcome_of):
    with pytest.raises(CampaignError, match=r"^cell 0: missions without measures of the exploration$"):
        exploration_samples(DESIGN, tuple(outcome_of(trial, details="{}") for trial in DESIGN.all_trials()))
