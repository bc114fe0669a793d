from __future__ import annotations

import dataclasses

import pytest

from robotteamsim.analysis.report.samples import pooled, read_campaign
from robotteamsim.campaign import make_design
from robotteamsim.campaign.factors import Factor
from robotteamsim.errors import CampaignError
from robotteamsim.scenario import load_floor_plan


def test_missions_that_are_cut_short_count_with_the_limit(garage):
    stored = garage(10.0, trials=3)
    first = dataclasses.replace(stored.outcomes[0], end="all_excluded", time_s=50.0)
    campaign = read_campaign(dataclasses.replace(stored, outcomes=(first, *stored.outcomes[1:])), "here")
    assert campaign.cells[0].missions.restricted_s.tolist() == [600.0, 438.0, 447.0]


@pytest.mark.parametrize("end", ["victims_safe", "search_over"])
def test_missions_without_areas_count_with_their_time_when_they_are_over(garage, end):
    stored = garage(10.0, trials=2)
    first = dataclasses.replace(stored.outcomes[0], end=end, time_s=307.0)
    campaign = read_campaign(dataclasses.replace(stored, outcomes=(first, *stored.outcomes[1:])), "here")
    assert campaign.cells[0].missions.restricted_s.tolist() == [307.0, 438.0]


def test_cells_are_named_by_their_settings(garage, arena):
    assert [cell.name for cell in read_campaign(garage(10.0, 15.0, trials=1), "here").cells] == ["10 dB", "15 dB"]
    assert [cell.name for cell in read_campaign(garage(trials=1), "here").cells] == ["garage_sar"]
    cells = read_campaign(arena(Factor("control.alpha", (0.3, 0.5), "--sweep")), "here").cells
    assert [cell.name for cell in cells] == ["alpha = 0.3", "alpha = 0.5"]
    assert [cell.scenario.control.alpha for cell in cells] == [0.3, 0.5]


def test_failed_trials_and_cells_without_missions_are_omitted_and_counted(garage):
    stored = garage(10.0, 20.0, trials=2)
    failed = [dataclasses.replace(outcome, error="KeyError: 7") for outcome in stored.outcomes if outcome.cell == 1]
    campaign = read_campaign(dataclasses.replace(stored, outcomes=(stored.outcomes[0], *failed)), "here")
    assert [cell.name for cell in campaign.cells] == ["10 dB"]
    assert (campaign.empty, campaign.failed, campaign.done, campaign.total) == (("20 dB",), 2, 3, 4)


def test_campaign_without_a_mission_is_rejected(garage):
    empty = dataclasses.replace(garage(10.0, trials=1), outcomes=())
    with pytest.raises(CampaignError, match=r"^here: no mission of this campaign has ended yet; nothing to report$"):
        read_campaign(empty, "here")


def test_unreadable_scenario_is_rejected(garage):
    stored = garage(10.0, trials=1)
    broken = {**stored.settings, "scenario": {**stored.settings["scenario"], "robots": "none"}}
    with pytest.raises(CampaignError, match=r"^here: robots: .*; this version cannot read the scenario$"):
        read_campaign(dataclasses.replace(stored, settings=broken), "here")


def test_cells_whose_algorithms_have_different_keys_have_their_scenarios_and_limits(stored_campaign):
    groups = (
        (Factor("control.algorithm", ("random_walk",), "cells"),),
        (Factor("control.algorithm", ("rdpso",), "cells"), Factor("control.alpha", (0.3,), "cells")),
    )
    limits = Factor("mission.time_limit_s", (30.0, 90.0), "--sweep")
    design = make_design("garage_sar", trials=1, factors=[limits], groups=groups)
    cells = read_campaign(stored_campaign(design, lambda trial: {"time_s": 20.0, "end": "time_limit"}), "here").cells
    assert [cell.scenario.control.algorithm for cell in cells] == ["random_walk"] * 2 + ["rdpso"] * 2
    assert [cell.scenario.control.alpha for cell in cells[2:]] == [0.3, 0.3]
    assert [cell.missions.restricted_s.tolist() for cell in cells] == [[30.0], [90.0], [30.0], [90.0]]


def test_plan_that_a_cell_names_by_file_omits_only_its_maps(garage):
    stored = garage(10.0, trials=1)
    keys = ["plan", "mission.time_limit_s"]
    settings = {**stored.settings, "keys": keys, "cells": [["elsewhere/plan.yaml", 300.0]]}
    campaign = read_campaign(dataclasses.replace(stored, settings=settings), "here")
    (cell,) = campaign.cells
    assert cell.scenario is None
    assert cell.missions.limit_s == 300.0
    assert campaign.unreadable == (f"{cell.name} (plan: there is no file 'elsewhere/plan.yaml')",)


def test_cells_of_shipped_plans_have_their_plans(garage):
    stored = garage(10.0, trials=1)
    settings = {**stored.settings, "keys": ["plan"], "cells": [["office"]]}
    (cell,) = read_campaign(dataclasses.replace(stored, settings=settings), "here").cells
    assert cell.scenario.plan == load_floor_plan("office")


def test_campaigns_of_one_design_and_different_seeds_are_pooled(garage):
    first = garage(10.0, 20.0, trials=2)
    second = dataclasses.replace(first, settings=first.settings | {"seed": 7})
    campaign = pooled([first, second], ["first", "second"])
    assert campaign.seeds == (1, 7)
    assert (campaign.planned, campaign.done, campaign.total) == (4, 8, 8)
    assert campaign.cells[0].missions.time_s.tolist() == [426.0, 438.0, 426.0, 438.0]
    assert campaign.cells[0].missions.numbers.tolist() == [1, 2, 3, 4]


def test_campaigns_that_differ_are_not_pooled(garage, arena):
    first = garage(10.0, trials=2)

    def refusal(second):
        with pytest.raises(CampaignError) as raised:
            pooled([first, second], ["one", "two"])
        return str(raised.value)

    assert refusal(first) == "two: has the seed 1 of one; expected campaigns of different seeds"
    more = dataclasses.replace(first, settings=first.settings | {"seed": 2, "trials": 3})
    assert refusal(more) == "two: has trials = 3, not 2 as in one; expected campaigns of one design"
    other = dataclasses.replace(arena(trials=2), settings=arena(trials=2).settings | {"seed": 2})
    assert refusal(other).startswith("two: has ")
    newer = dataclasses.replace(first, settings=first.settings | {"seed": 2}, versions={"robotteamsim": "9"})
    assert refusal(newer) == "two: was run by other versions than one; expected the same"
