from __future__ import annotations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from robotteamsim.analysis.report.figures import PAPERS
from robotteamsim.analysis.report.maps import draw_heat, heat
from robotteamsim.analysis.report.samples import read_campaign
from robotteamsim.campaign import make_design
from robotteamsim.campaign.factors import Factor
from robotteamsim.scenario import load
from robotteamsim.setup import resolve


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


def test_random_victims_are_those_of_the_mission_whose_path_is_drawn(stored_campaign):
    number = Factor("mission.random_victims", (3,), "--set")
    design = make_design("garage_sar", trials=3, overrides=[number])
    stored = stored_campaign(design, lambda trial: {"time_s": 100.0 + trial.number})
    median = stored.outcomes[1]
    figure = draw_heat(read_campaign(stored, "here").cells)
    drawn = [line.get_xydata().tolist()[0] for line in figure.axes[0].lines if line.get_marker() == "X"]
    seeded = resolve(load("garage_sar", ["mission.random_victims=3", f"run.seed={median.seed}"])).scenario
    assert drawn == [list(victim.position) for victim in seeded.mission.victims]
    assert len(drawn) == 4 + 3


@pytest.mark.parametrize("width", PAPERS)
def test_all_of_a_figure_of_a_paper_is_within_its_width(garage, width):
    cells = [read_campaign(garage(noise_db, trials=1), "here").cells[0] for noise_db in (10.0, 30.0)]
    figure = draw_heat(cells, sheet=PAPERS[width])
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    assert max(axes.get_tightbbox(canvas.get_renderer()).x1 for axes in figure.axes) <= figure.bbox.width
