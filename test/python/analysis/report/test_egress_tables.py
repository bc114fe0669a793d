"""Egress of a campaign's missions: tables."""

from __future__ import annotations

import numpy as np

from robotteamsim.analysis.report.egress import egress_table, exit_table
from robotteamsim.analysis.report.samples import Panel, Sample, Series
from robotteamsim.mission.egress import Egress, ExitEgress, PersonEgress


def mission(*out_s: float | None, untenable_s: float | None = None) -> Egress:
    people = (
        PersonEgress(f"p{index}", True, heat=0.2, untenable_s=untenable_s, out_s=time_s, exit="west" if time_s else "")
        for index, time_s in enumerate(out_s)
    )
    return Egress(10.0, tuple(people), (ExitEgress("west", untenable_s=50.0), ExitEgress("east")))


def panel(*missions: Egress) -> Panel:
    nothing = np.zeros(len(missions), dtype=int)
    times_s = np.full(len(missions), 100.0)
    numbers = np.arange(len(missions))
    sample = Sample(times_s, nothing > 0, nothing, nothing, nothing, times_s, numbers, 2, 0, 100.0, egress=missions)
    return Panel("one", (Series("", sample, "#000000"),))


def test_table_has_the_times_of_the_missions_that_have_them():
    shown = [panel(mission(20.0, 60.0), mission(30.0, 40.0), mission(20.0, None, untenable_s=35.0))]
    table = egress_table(shown)
    row = dict(zip(table.head, table.texts[0], strict=True))
    assert row["people out"].startswith("1.7 [")
    assert row["RSET [s]"].startswith("40.0 [")  # 50 and 30 s after ignition
    assert row["ASET [s]"] == "25.0 [25.0, 25.0]"
    assert row["all out"].startswith("66.7 %")
    assert row["largest FED"] == "0.20 [0.20, 0.20]"
    exits = {row[1]: row[2:] for row in exit_table(shown).texts}
    assert exits["west"][0] == "3"
    assert exits["west"][2:] == ("3", "40.0 [40.0, 40.0]")
    assert exits["east"] == ("3", "0.0 [0.0, 0.0]", "0", "-")
    assert exit_table(shown).csv().splitlines()[1] == "one,east,3,0.0,0.0,0.0,0,,,"


def test_missions_without_ways_out_have_no_rows():
    shown = [panel(Egress(10.0, (PersonEgress("ann"),)))]
    assert egress_table(shown).rows == ()
    assert exit_table(shown).rows == ()
