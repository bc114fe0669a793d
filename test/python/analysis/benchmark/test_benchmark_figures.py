from __future__ import annotations

import itertools

import numpy as np
import pytest

from robotteamsim.analysis.benchmark.figures import draw_idleness
from robotteamsim.analysis.benchmark.measures import PatrolSample


@pytest.mark.slow
@pytest.mark.parametrize("counts", [(3,), range(1, 41), (1, 2, 4, 8, 100, 1000)])
def test_labels_of_robots_do_not_overlap(counts):
    one, vertices = np.ones(1), np.ones((1, 1))
    samples = [PatrolSample(count, "pso", one, one, one, vertices, vertices, vertices, ()) for count in counts]
    figure = draw_idleness(samples)
    figure.draw_without_rendering()
    for axes in figure.axes:
        low, high = axes.get_xlim()
        labels = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
        boxes = [label.get_window_extent() for at, label in labels if low <= at <= high]
        assert boxes
        assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))
