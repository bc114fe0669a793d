"""Tables 6 to 9 as text."""

from __future__ import annotations

import dataclasses
import re

import pytest

from robotteamsim.errors import CampaignError
from study.dissertation.reference import MissionValues, dissertation_missions
from study.dissertation.tables import dissertation_tables, missions_by_noise


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


def test_each_mission_is_next_to_the_dissertations():
    ours = {10.0: [MissionValues(3, 401.6, 5, 2), None]}
    text = dissertation_tables(ours)
    assert rows(text, "Table 6")["1"] == ["3", "4", "402", "426"]
    assert rows(text, "Table 6")["2"] == ["-", "4", "-", "438"]
    assert rows(text, "Table 6")["30"] == ["-", "4", "-", "483"]
    assert rows(text, "Table 7")["1"] == ["5", "5", "2", "0"]


def test_level_that_the_dissertation_lacks_is_shown_alone():
    text = dissertation_tables({15.0: [MissionValues(3, 401.6, 5, 0), MissionValues(4, 398.0, 5, 0)]})
    assert rows(text, "Table 6") == {"1": ["3", "-", "402", "-"], "2": ["4", "-", "398", "-"]}
    assert rows(text, "Table 8")["Mean"] == ["3.5", "-", "400", "-"]


def test_missions_beyond_30_are_left_to_the_csv():
    text = dissertation_tables({10.0: [MissionValues(4, 400.0, 5, 0)] * 100})
    assert "and 70 more of ours in trials.csv" in text
    assert "31 " not in text.split("Table 7")[0]


def test_columns_are_aligned_with_their_headings():
    lines = dissertation_tables({10.0: [MissionValues(4, 400.0, 5, 0)], 20.0: []}).splitlines()
    head, first = lines[3], lines[4]
    assert [m.end() for m in re.finditer(r"\S+", head)] == [m.end() for m in re.finditer(r"\S+", first)][1:]


def test_tables_fit_a_terminal_of_80_columns_and_lose_nothing():
    missions = {10.0 * i: [MissionValues(4, 400.0, 5, 0)] for i in range(1, 5)}
    wide, narrow = dissertation_tables(missions), dissertation_tables(missions, 80)
    assert max(map(len, wide.splitlines())) > 80
    assert max(map(len, narrow.splitlines())) <= 80
    assert set(narrow.split()) == set(wide.split())


def test_missions_of_a_store_are_sorted_by_noise_without_failed_ones(garage):
    stored = garage(10.0, 30.0, trials=2)
    failed = dataclasses.replace(stored.outcomes[0], error="KeyError: 7")
    missions = missions_by_noise(dataclasses.replace(stored, outcomes=(failed, *stored.outcomes[2:])), "here")
    assert missions == {10.0: [None, None], 30.0: list(dissertation_missions()[30.0][:2])}


def test_only_campaigns_of_the_garage_under_noise_have_these_tables(garage):
    stored = garage(trials=1)
    refusal = r"^here: expected a campaign of garage_sar in which only voice.noise_db varies$"
    with pytest.raises(CampaignError, match=refusal):
        missions_by_noise(stored, "here")
    named = dataclasses.replace(stored, settings=stored.settings | {"keys": ["voice.noise_db", "control.alpha"]})
    with pytest.raises(CampaignError, match=refusal):
        missions_by_noise(named, "here")
