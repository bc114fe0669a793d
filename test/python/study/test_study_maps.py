from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.analysis.report.samples import read_campaign
from study.dissertation.maps import heard_shares, nearest_other_m, widest_moment_m


def test_nearest_other_robot_of_three_equals_the_hand_calculation():
    paths_m = np.array([[[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]]])
    assert nearest_other_m(paths_m).tolist() == [[5.0, 1.0, 1.0]]


def test_widest_moment_is_that_of_the_robot_farthest_from_all(garage):
    campaign = read_campaign(garage(10.0, trials=1), "here")
    positions_m = widest_moment_m(campaign)
    assert np.linalg.norm(positions_m[0] - positions_m[1]) == pytest.approx(2.0)


def test_voices_reach_less_far_with_noise_and_at_their_lowest_range(garage):
    campaign = read_campaign(garage(10.0, 20.0, 30.0, trials=1), "here")
    lowest = heard_shares(campaign.scenario, [10.0, 20.0, 30.0], "lowest")
    highest = heard_shares(campaign.scenario, [10.0, 20.0, 30.0], "highest")
    assert lowest[0] > lowest[1] > lowest[2] > 0.0
    assert all(low < high for low, high in zip(lowest, highest, strict=True))
