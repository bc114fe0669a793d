from __future__ import annotations

import re

import pytest

from robotteamsim.campaign import Trial, make_design
from robotteamsim.campaign.summary import Spread, copies_note, exclusion_note, spread, summarise, summary_table


def test_interval_is_students():
    # By hand: mean 3, variance 2.5, t(0.975, 4) = 2.7764451, half width 2.7764451 * sqrt(2.5 / 5).
    found = spread([1.0, 2.0, 3.0, 4.0, 5.0])
    assert (found.mean, found.sd) == (3.0, pytest.approx(2.5**0.5))
    assert (found.low, found.high) == (pytest.approx(3.0 - 1.9632432), pytest.approx(3.0 + 1.9632432))


def test_single_value_has_no_spread():
    assert spread([7.0]) == Spread(7.0, None, None, None)
    with pytest.raises(ValueError, match="values must not be empty"):
        spread([])


def test_failed_trials_count_but_have_no_figures(short_design, outcome_of, failed_outcome_of):
    design = short_design("voice.noise_db=10,20")
    trials = list(design.all_trials())
    outcomes = [outcome_of(trials[0], time_s=1.0), failed_outcome_of(trials[2]), failed_outcome_of(trials[1])]
    first, second = summarise(design, outcomes)
    assert (first.name, first.settings) == ("10 dB", {"voice.noise_db": 10.0})
    assert (first.trials, first.failed, first.statistics["time_s"].mean) == (1, 1, 1.0)
    assert (second.trials, second.failed, second.statistics) == (0, 1, {})


def test_summary_has_a_line_per_cell(short_design, outcome_of, failed_outcome_of):
    design = short_design("control.algorithm=rdpso,random_walk", trials=3)
    trials = list(design.all_trials())
    outcomes = [outcome_of(trials[0], time_s=90.0), outcome_of(trials[2], time_s=110.0, end="time_limit")]
    outcomes += [failed_outcome_of(trials[1]), outcome_of(trials[3])]
    lines = summary_table(design, summarise(design, outcomes)).splitlines()
    assert lines[2].split()[:2] == ["control.algorithm", "trials"]
    assert lines[3].startswith(
        "rdpso              2             1.00 ± 0.00 [1.00, 1.00]  100.00 ± 14.14 [-27.06, 227.06]"
    )
    assert lines[4].startswith("random_walk        1 + 1 failed  1.00                      100.00 ")
    assert lines[-1] == "1 mission ended at the time limit, which counts as the duration"


def test_tables_fit_a_terminal_of_80_columns_and_lose_nothing(short_design, outcome_of):
    design = short_design("control.algorithm=rdpso,random_walk", trials=2)
    outcomes = [outcome_of(trial, time_s=90.0 + trial.number, distance_m=1234.5) for trial in design.all_trials()]
    wide = summary_table(design, summarise(design, outcomes))
    narrow = summary_table(design, summarise(design, outcomes), 80)
    assert max(map(len, wide.splitlines())) > 80
    assert max(map(len, narrow.splitlines())) <= 80
    assert set(narrow.split()) == set(wide.split())


def test_summary_of_a_scenario_with_a_base_lists_deliveries(outcome_of):
    design = make_design("office_manet", trials=2)
    first, second = design.all_trials()
    outcomes = [outcome_of(first, discoveries_delivered=3, mean_delivery_delay_s=0.5, max_delivery_delay_s=1.0)]
    outcomes += [outcome_of(second, discoveries_delivered=0)]
    table = summary_table(design, summarise(design, outcomes))
    assert re.search(r"delivered +mean delay \[s\] +max delay \[s\]$", table.splitlines()[2])
    assert re.search(r"1\.50 ± 2\.12 \[-17\.56, 20\.56\] +0\.50 +1\.00$", table.splitlines()[3])


def test_report_counts_missions_that_end_by_exclusion(outcome_of):
    def ended(end, time_s):
        return outcome_of(Trial(0, 1, 1), end=end, time_s=time_s)

    others = [ended("areas_explored", 300.0), ended("time_limit", 600.0)]
    assert exclusion_note(others) == ""
    counts = "because all robots were excluded; that is the time here, while a report uses the time limit"
    first, second = ended("all_excluded", 140.0), ended("all_excluded", 129.0)
    assert exclusion_note([*others, first]) == f"1 mission ended at 140 s {counts}"
    assert exclusion_note([first, *others, second]) == f"2 missions ended at 129 to 140 s {counts}"


def test_missions_with_the_same_trajectories_are_reported_with_their_cell(short_design, outcome_of, failed_outcome_of):
    design = short_design("voice.noise_db=10,20", trials=4)
    trials = [trial for trial in design.all_trials() if trial.number < 4]
    outcomes = [outcome_of(trial, **({"trajectory_hash": "same"} if trial.cell else {})) for trial in trials]
    outcomes += [failed_outcome_of(trial) for trial in design.all_trials() if trial.number == 4]
    other, copied = summarise(design, outcomes)
    assert ((other.trials, other.different), (copied.trials, copied.different)) == ((3, 3), (3, 1))
    assert copies_note([("10 dB", 3, 3), ("none", 0, 0)]) == ""
    assert copies_note([("10 dB", 3, 3), ("20 dB", 3, 1)]).endswith("too narrow. 20 dB: 3 missions, 1 different.")
    assert "north: 2 missions, 1 different; north: 2" in copies_note([("north", 2, 1), ("north", 2, 1)])
    assert copies_note([(f"{i}", 2, 1) for i in range(9)]).endswith("7: 2 missions, 1 different; and 1 more setting.")
