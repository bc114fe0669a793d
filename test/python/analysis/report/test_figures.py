from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from matplotlib.text import Text

from robotteamsim.analysis.report.figures import PAPERS, draw_counts, draw_saved, draw_survival, draw_times
from robotteamsim.analysis.report.page import campaign_pictures
from robotteamsim.analysis.report.samples import panels_of, read_campaign

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("most", [3, 60, 1_136, 250_000])
def test_labels_of_bars_do_not_overlap(garage, most):
    panels = panels_of(read_campaign(garage(10.0, 20.0, 30.0, trials=2), "here"))
    figure = draw_counts(panels, lambda sample: np.linspace(0, most, len(sample)).astype(int), "times", None)
    figure.draw_without_rendering()
    for axes in figure.axes:
        labels = axes.get_xticklabels()
        assert 2 <= len(labels) <= 9
        boxes = [label.get_window_extent() for label in labels]
        if labels[0].get_rotation() == 0.0:
            assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))
        else:  # slanted labels are as far apart as their ends
            assert all(right.x1 - left.x1 > left.height / 4 for left, right in itertools.pairwise(boxes))


def test_curves_of_saved_victims_end_at_the_mean_number_of_each_setting(garage):
    stored = garage(10.0, 20.0, trials=4)
    panels = panels_of(read_campaign(stored, "here"))
    axes = draw_saved(panels).axes[0]
    curves = {line.get_label(): line.get_ydata() for line in axes.lines if line.get_label() in ("10 dB", "20 dB")}
    assert {name: (values[0], values[-1]) for name, values in curves.items()} == {
        "10 dB": (0.0, 3.5),
        "20 dB": (0.0, 2.5),
    }
    unknown = dataclasses.replace(stored, outcomes=[dataclasses.replace(o, details="{}") for o in stored.outcomes])
    assert {panel.series[0].missions.saved_s for panel in panels_of(read_campaign(unknown, "here"))} == {()}


def test_curves_of_survival_begin_at_0_if_all_missions_are_cut_short(garage):
    stored = garage(10.0, 20.0, trials=3)
    late = [dataclasses.replace(o, time_s=600.0, end="time_limit") for o in stored.outcomes]
    cut_short = panels_of(read_campaign(dataclasses.replace(stored, outcomes=tuple(late)), "here"))
    assert draw_survival(cut_short).axes[0].get_xlim() == pytest.approx((0.0, 612.0))
    # The earliest of the others ends after 376 s, 12 % of 600 s after the left end.
    assert draw_survival(panels_of(read_campaign(stored, "here"))).axes[0].get_xlim() == pytest.approx((304.0, 612.0))


def test_long_names_of_settings_are_complete_in_labels_and_legends(garage):
    names = [f"algorithm = my_controllers:Pheromone{end}" for end in ("Greedy", "Patient")]
    panels = panels_of(read_campaign(garage(10.0, 20.0, trials=4), "here"))
    named = [dataclasses.replace(panel, name=name) for panel, name in zip(panels, names, strict=True)]
    rows, legend = draw_times(named).axes[0].get_yticklabels(), draw_saved(named).legends[0].get_texts()
    for texts in (rows, legend):
        lines = [text.get_text().split("\n") for text in texts]
        assert [" ".join(parts) for parts in lines] == names
        assert all(len(line) <= 32 for parts in lines for line in parts)


@pytest.mark.parametrize(("width", "inches"), [("column", 3.5), ("page", 7.16)])
def test_figures_of_papers_have_the_width_of_a_column_or_page_and_text_of_8_points(garage, width, inches):
    campaign = read_campaign(garage(10.0, 20.0, 30.0, trials=4), "here")
    pictures = list(campaign_pictures(campaign, panels_of(campaign), PAPERS[width]))
    assert {picture.name for picture in pictures} >= {"victims", "times", "survival", "saved", "areas", "endangered"}
    for picture in pictures:
        svg = picture.files(("svg",))[f"{picture.name}.svg"].decode()
        assert f'width="{72 * inches:g}pt"' in svg
        texts = [text for text in picture.figure.findobj(Text) if text.get_text() and text.get_visible()]
        assert {text.get_fontsize() for text in texts} == {8.0}
        inside = picture.figure.get_tightbbox()
        assert -0.05 <= inside.x0 < inside.x1 <= inches + 0.05
