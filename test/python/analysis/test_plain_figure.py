from __future__ import annotations

import io

import numpy as np
import pytest

from robotteamsim.analysis.figure_files import figure_bytes
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.plan_picture import draw_plan
from robotteamsim.analysis.report.figures import draw_saved, draw_survival
from robotteamsim.analysis.report.samples import Panel, Sample, Series
from robotteamsim.errors import RecordingError
from robotteamsim.scenario import load_floor_plan


@pytest.mark.parametrize("name", ["$\\frac{$", "a$b_{$c", "$x$", "\\$"])
def test_name_with_dollars_is_drawn_as_text(name):
    figure = PlainFigure()
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], label=name)
    axes.set_title(name)
    axes.set_yticks([0.0], [name])
    axes.legend()
    figure.savefig(io.BytesIO(), format="png", bbox_inches="tight")
    assert axes.get_title() == name
    assert not axes.title.get_parse_math()


def test_plan_whose_names_have_dollars_is_drawn():
    plan = load_floor_plan("tutorial_arena").model_copy(update={"name": "$\\frac{$"})
    draw_plan(plan).savefig(io.BytesIO(), format="png")


def test_setting_whose_name_has_dollars_is_drawn():
    ones = np.ones(2)
    sample = Sample(ones, ones > 0, ones, ones, ones, ones, ones, 1, 0, 9.0, saved_s=((1.0,), (2.0,)))
    panel = Panel("$x_{ b $c", (Series("$x_{ b $c", sample, "#000000"),))
    for draw in (draw_saved, draw_survival):
        draw([panel]).savefig(io.BytesIO(), format="png")


@pytest.mark.parametrize("date", ["99999999999999", "x"])
def test_date_of_the_environment_that_is_none_is_one_line(monkeypatch, date):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
    with pytest.raises(RecordingError, match=rf"^SOURCE_DATE_EPOCH, environment: '{date}'; expected seconds"):
        figure_bytes(PlainFigure(), "pdf")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1600000000")
    assert figure_bytes(PlainFigure(), "pdf").startswith(b"%PDF")
