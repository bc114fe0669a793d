from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.analysis.report.maps import heat
from robotteamsim.analysis.report.samples import read_campaign


def test_heat_adds_up_to_the_time_of_all_robots(garage):
    cell = read_campaign(garage(10.0, trials=3), "here").cells[0]
    field = heat(cell)
    assert field.values.sum() * field.resolution_m**2 == pytest.approx(2 * 60.0)
    assert field.contains(4.0, 7.0)
    assert field.value_at(10.0, 7.0) > 0.0
    assert field.value_at(10.0, 20.0) == 0.0


def test_heat_has_no_gap_on_a_straight_path(garage):
    field = heat(read_campaign(garage(10.0, trials=1), "here").cells[0])
    assert all(field.value_at(x_m, 7.0) > 0.0 for x_m in np.arange(4.5, 33.0, field.resolution_m))
