from __future__ import annotations

import re

from robotteamsim.campaign import Trial, make_design
from robotteamsim.campaign.factors import parse_sweep
from robotteamsim.campaign.reference import MissionValues, dissertation_missions
from robotteamsim.campaign.summary import summarise
from robotteamsim.campaign.tables import (
    dissertation_tables,
    exclusion_note,
    is_the_dissertations,
    missions_by_noise,
    summary_table,
)


def rows(text, title):
    """Return the cells of a table by the first of each line."""
    table = text.split(title)[1].split("\n\n")[0]
    return {line.split()[0]: line.split()[1:] for line in table.splitlines()[4:] if line}


def test_tables_8_and_9_of_the_dissertation_come_out_as_printed():
    theirs = dissertation_missions()
    text = dissertation_tables(theirs)
    table_8, table_9 = rows(text, "Table 8"), rows(text, "Table 9")
    assert table_8["Mean"][1::2] == ["4", "459.6", "3.3", "382", "2.1", "343.5"]
    assert table_8["Median"][1::2] == ["4", "445.5", "3.5", "374.5", "2", "339.5"]
    assert table_8["Mode"][1::2] == ["4", "447", "4", "348", "2", "327"]
    assert table_9["Mean"][1::2] == ["4.93", "0", "5", "0", "5", "0"]
    assert table_9["Median"][1::2] == table_9["Mode"][1::2] == ["5", "0"] * 3
    for table in (table_8, table_9):
        assert all(cells[0::2] == cells[1::2] for cells in table.values())


def test_each_mission_stands_beside_the_dissertations():
    ours = {10.0: [MissionValues(3, 401.6, 5, 2), None]}
    text = dissertation_tables(ours)
    assert rows(text, "Table 6")["1"] == ["3", "4", "402", "426"]
    assert rows(text, "Table 6")["2"] == ["-", "4", "-", "438"]
    assert rows(text, "Table 6")["30"] == ["-", "4", "-", "483"]
    assert rows(text, "Table 7")["1"] == ["5", "5", "2", "0"]


def test_level_that_the_dissertation_lacks_stands_alone():
    text = dissertation_tables({15.0: [MissionValues(3, 401.6, 5, 0), MissionValues(4, 398.0, 5, 0)]})
    assert rows(text, "Table 6") == {"1": ["3", "-", "402", "-"], "2": ["4", "-", "398", "-"]}
    assert rows(text, "Table 8")["Mean"] == ["3.5", "-", "400", "-"]


def test_missions_beyond_30_are_left_to_the_csv():
    text = dissertation_tables({10.0: [MissionValues(4, 400.0, 5, 0)] * 100})
    assert "and 70 more of ours in trials.csv" in text
    assert "31 " not in text.split("Table 7")[0]


def test_columns_stand_under_their_heads():
    lines = dissertation_tables({10.0: [MissionValues(4, 400.0, 5, 0)], 20.0: []}).splitlines()
    head, first = lines[3], lines[4]
    assert [m.end() for m in re.finditer(r"\S+", head)] == [m.end() for m in re.finditer(r"\S+", first)][1:]


def test_outcomes_become_missions_by_noise(outcome_of, failed_outcome_of):
    design = make_design("garage_sar", trials=2, factors=[parse_sweep("voice.noise_db=10,30")])
    trials = {(trial.cell, trial.number): trial for trial in design.all_trials()}
    outcomes = [outcome_of(trials[1, 2], victims_saved=2), failed_outcome_of(trials[0, 1])]
    assert missions_by_noise(design, outcomes) == {10.0: [None, None], 30.0: [None, MissionValues(2, 100.0, 4, 0)]}


def test_only_the_garage_under_noise_is_the_dissertations(short_design):
    def of(*sweeps):
        return make_design("garage_sar", trials=1, factors=[parse_sweep(text) for text in sweeps])

    assert is_the_dissertations(of("voice.noise_db=10"))
    assert not is_the_dissertations(of("voice.noise_db=10", "control.alpha=0.3"))
    assert not is_the_dissertations(of())
    assert not is_the_dissertations(short_design("voice.noise_db=10"))


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
    missions = {10.0 * i: [MissionValues(4, 400.0, 5, 0)] for i in range(1, 5)}
    for wide, narrow in (
        (summary_table(design, summarise(design, outcomes)), summary_table(design, summarise(design, outcomes), 80)),
        (dissertation_tables(missions), dissertation_tables(missions, 80)),
    ):
        assert max(map(len, wide.splitlines())) > 80
        assert max(map(len, narrow.splitlines())) <= 80
        assert set(narrow.split()) == set(wide.split())


def test_summary_of_a_scenario_with_a_base_tells_what_it_heard_of(outcome_of):
    design = make_design("office_manet", trials=2)
    first, second = design.all_trials()
    outcomes = [outcome_of(first, discoveries_delivered=3, mean_delivery_delay_s=0.5, max_delivery_delay_s=1.0)]
    outcomes += [outcome_of(second, discoveries_delivered=0)]
    table = summary_table(design, summarise(design, outcomes))
    assert re.search(r"delivered +mean delay \[s\] +max delay \[s\]$", table.splitlines()[2])
    assert re.search(r"1\.50 ± 2\.12 \[-17\.56, 20\.56\] +0\.50 +1\.00$", table.splitlines()[3])


def test_missions_that_end_by_exclusion_are_told(outcome_of):
    def ended(end, time_s):
        return outcome_of(Trial(0, 1, 1), end=end, time_s=time_s)

    others = [ended("areas_explored", 300.0), ended("time_limit", 600.0)]
    assert exclusion_note(others) == ""
    counts = "because all robots were excluded; that is the time here, while a report uses the time limit"
    first, second = ended("all_excluded", 140.0), ended("all_excluded", 129.0)
    assert exclusion_note([*others, first]) == f"1 mission of ours ended at 140 s {counts}"
    assert exclusion_note([first, *others, second]) == f"2 missions of ours ended at 129 to 140 s {counts}"
