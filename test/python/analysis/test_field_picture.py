"""Pictures of radio and voice maps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.contour import QuadContourSet

from robotteamsim.analysis.fields.picture import FieldStyle, Level, Panel, Spot, draw_fields
from robotteamsim.propagation import FieldMap

STYLE = FieldStyle("level", "dB", "YlOrRd", low=10.0, high=60.0, silence="quiet", levels=(Level(30.0, "half"),))


def _hill(resolution_m: float = 0.5) -> FieldMap:
    half = resolution_m / 2
    x, y = np.meshgrid(np.arange(half, 20, resolution_m), np.arange(half, 10, resolution_m))
    return FieldMap((0.0, 0.0), resolution_m, 60.0 - 8.0 * np.hypot(x - 10.0, y - 5.0))


@pytest.fixture
def hill(hall_scenario) -> Panel:
    top = Spot("top", (10.0, 5.0), "victim")
    return Panel("a hill", _hill(), hall_scenario().plan, (top,), silent_below=10.0)


def _contours(axes) -> list[QuadContourSet]:
    return [drawn for drawn in axes.collections if isinstance(drawn, QuadContourSet)]


def test_picture_shows_the_plan_with_bar_title_and_sources(hill):
    axes, bar = draw_fields([hill], STYLE, "hall").axes
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.0, 20.0), (0.0, 10.0))
    assert axes.get_title(loc="left") == "hall, a hill"
    assert "top" in [text.get_text() for text in axes.texts]
    assert (bar.get_title(), bar.get_xlabel()) == ("dB", "blank:\nquiet")


def test_bar_marks_levels_with_their_meaning_between_the_ends_of_the_scale(hill):
    _, bar = draw_fields([hill], STYLE, "hall").axes
    assert {label.get_text() for label in bar.get_yticklabels()} == {"10", "20", "30 half", "40", "50", "60"}


def test_cells_below_silence_are_left_blank(hill):
    values = draw_fields([hill], STYLE, "hall").axes[0].images[0].get_array()
    assert values.mask[0, 0]
    assert not values.mask[10, 20]


def test_contour_of_a_level_lies_where_the_map_has_it(hall_scenario):
    panel = Panel("", _hill(0.1), hall_scenario().plan)
    (contours,) = _contours(draw_fields([panel], STYLE, "").axes[0])
    (ring,) = contours.allsegs[0]
    np.testing.assert_allclose(np.hypot(*(ring - (10.0, 5.0)).T), 30.0 / 8.0, atol=0.01)


def test_speck_sliver_and_short_ring_of_a_map_get_no_contour(hall_scenario):
    values = np.zeros((100, 200))
    values[50, 20] = values[20, :150] = 60.0
    values[60:70, 60:70] = values[80:83, 80:83] = 60.0
    panel = Panel("", FieldMap((0.0, 0.0), 0.1, values), hall_scenario().plan)
    (contours,) = _contours(draw_fields([panel], STYLE, "").axes[0])
    points = np.concatenate(contours.allsegs[0])
    np.testing.assert_allclose((points.min(axis=0), points.max(axis=0)), ((6.0, 6.0), (7.0, 7.0)), atol=0.1)


def test_labels_of_contours_keep_clear_of_walls_borders_and_sources(hall_scenario):
    values = np.zeros((100, 200))
    values[4:30, 4:30] = values[45:95, 100:150] = 60.0
    values[:, 197:] = 60.0  # along the wall
    spot = Spot("source", (10.0, 7.0), "robot")  # on the second contour
    panel = Panel("", FieldMap((0.0, 0.0), 0.1, values), hall_scenario().plan, (spot,))
    (contours,) = _contours(draw_fields([panel], STYLE, "").axes[0])
    places = [label.get_position() for label in contours.labelTexts]
    assert len(places) == 2
    assert all(0.4 < x < 19.6 and 0.4 < y < 9.6 and np.hypot(x - 10.0, y - 7.0) > 0.5 for x, y in places)


def test_contours_end_at_walls(hall_scenario):
    level = FieldStyle("level", "dB", "YlOrRd", 0.0, 60.0, levels=(Level(20.0),))  # 5 m from the top: at the walls
    (contours,) = _contours(draw_fields([Panel("", _hill(0.1), hall_scenario().plan)], level, "").axes[0])
    points = np.concatenate(contours.allsegs[0])
    assert points[:, 1].min() > 0.2
    assert points[:, 1].max() < 9.8


def test_level_below_the_silence_of_a_map_is_not_drawn(hall_scenario):
    plan, field = hall_scenario().plan, _hill()
    quiet = draw_fields([Panel("", field, plan, silent_below=40.0)], STYLE, "")
    assert _contours(quiet.axes[0]) == []


def test_flat_map_has_no_contours(hall_scenario):
    flat = FieldMap((0.0, 0.0), 0.5, np.full((20, 40), 20.0))
    assert _contours(draw_fields([Panel("flat", flat, hall_scenario().plan)], STYLE, "").axes[0]) == []


def test_map_without_any_voice_is_drawn_blank(hall_scenario):
    silent = FieldMap((0.0, 0.0), 0.5, np.zeros((20, 40)))
    figure = draw_fields([Panel("", silent, hall_scenario().plan, silent_below=10.0)], STYLE, "")
    assert figure.axes[0].images[0].get_array().mask.all()


def test_several_maps_share_one_bar_and_one_scale(hill):
    figure = draw_fields([hill, hill, hill], STYLE, "three hills")
    *maps, bar = figure.axes
    assert len(maps) == 3
    assert {image.get_clim() for axes in maps for image in axes.images} == {(10.0, 60.0)}
    assert [axes.get_title(loc="left") for axes in maps] == ["a hill"] * 3
    assert figure.get_suptitle() == "three hills"
    assert bar.get_title() == "dB"


@pytest.mark.slow
def test_long_titles_of_maps_stay_over_their_maps(hill):
    long = replace(hill, title="radio.wall_loss_db=[0,0,0,0], radio.pillars=false, radio.door_loss_db=0: " * 2)
    figure = draw_fields([long, hill], STYLE, "two hills")
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    left, right, _ = (axes.get_tightbbox(renderer) for axes in figure.axes)
    assert left.x1 <= right.x0
    assert left.y1 <= figure.bbox.y1
    assert " ".join(figure.axes[0].get_title(loc="left").split()) == long.title.strip()


@pytest.mark.parametrize("count", [1, 2, 3, 5, 9])
def test_picture_fits_a_slide(hill, count):
    width, height = draw_fields([hill] * count, STYLE, "").get_size_inches()
    assert max(width / 14.0, height / 7.6) <= 1.0
    assert min(width / 14.0, height / 7.6) > 0.3


def test_level_is_written_with_a_true_minus():
    assert str(Level(-80.0)) == "\N{MINUS SIGN}80"
    assert str(Level(47.4)) == "47.4"
    assert Panel("", _hill(), None).silent_below == -math.inf


def test_parts_common_to_all_titles_are_in_the_title_of_the_figure(hill):
    panels = [replace(hill, title=f"{noise} dB of noise, highest range") for noise in (10, 20)]
    figure = draw_fields(panels, STYLE, "hall")
    assert [axes.get_title(loc="left") for axes in figure.axes[:2]] == ["10 dB of noise", "20 dB of noise"]
    assert figure.get_suptitle() == "hall, highest range"
