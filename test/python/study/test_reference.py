"""The dissertation's raw data against what it says of them."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from robotteamsim.analysis.report.rank_tests import mann_whitney
from study.dissertation.reference import dissertation_missions


def test_there_are_30_missions_at_each_of_three_levels():
    assert {noise_db: len(missions) for noise_db, missions in dissertation_missions().items()} == {
        10: 30,
        20: 30,
        30: 30,
    }


def test_victims_are_saved_as_often_as_counted_in_table_6():
    counts = {n: Counter(m.victims_saved for m in missions) for n, missions in dissertation_missions().items()}
    assert counts == {10: {4: 30}, 20: {2: 6, 3: 9, 4: 15}, 30: {2: 28, 3: 1, 4: 1}}


def test_the_two_missions_without_all_areas_are_those_of_600_s():
    missions = [(n, i + 1, m) for n, level in dissertation_missions().items() for i, m in enumerate(level)]
    assert [(n, i) for n, i, m in missions if m.time_s == 600] == [(10, 9), (10, 15)]
    assert [(n, i) for n, i, m in missions if m.areas_explored == 4] == [(10, 9), (10, 15)]
    assert sum(m.endangered_links for _, _, m in missions) == 0


def test_missions_with_all_victims_take_longer_at_10_than_at_20_db():
    missions = dissertation_missions()
    all_saved = [np.array([m.time_s for m in missions[db] if m.victims_saved == 4]) for db in (10.0, 20.0)]
    assert mann_whitney(*all_saved) == pytest.approx(0.006, abs=0.0005)
