from __future__ import annotations

import dataclasses

import pytest

from robotteamsim.analysis.report.samples import read_campaign
from robotteamsim.campaign import make_design
from robotteamsim.campaign.factors import Factor
from study.dissertation.missions import compared, panels


def test_dissertations_missions_are_those_of_the_levels_that_it_has(garage):
    campaign = read_campaign(garage(10.0, 15.0, trials=1), "here")
    ((cell, theirs),) = compared(campaign)
    assert cell.name == "10 dB"
    assert len(theirs) == 30
    assert int((~theirs.finished).sum()) == 2
    assert [[name for name, _ in panel.named()] for panel in panels(campaign)] == [
        ["10 dB, ours", "10 dB, dissertation"],
        ["15 dB"],
    ]


def test_garage_at_its_own_noise_is_compared_too(garage):
    ((cell, _),) = compared(read_campaign(garage(trials=1), "here"))
    assert cell.name == "garage_sar"


@pytest.mark.parametrize(
    ("name", "key", "value"), [("tutorial_arena", "voice.noise_db", 10.0), ("garage_sar", "control.alpha", 0.3)]
)
def test_other_scenarios_and_other_keys_have_no_reference(stored_campaign, name, key, value):
    design = make_design(name, trials=1, factors=[Factor(key, (value,), "--sweep")])
    assert compared(read_campaign(stored_campaign(design, lambda trial: {}), "here")) == ()


def test_plan_that_a_cell_names_by_file_has_no_reference(garage):
    stored = garage(10.0, trials=1)
    settings = {**stored.settings, "keys": ["plan"], "cells": [["elsewhere/plan.yaml"]]}
    assert compared(read_campaign(dataclasses.replace(stored, settings=settings), "here")) == ()
