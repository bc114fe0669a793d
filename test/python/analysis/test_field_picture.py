from __future__ import annotations

import numpy as np

from robotteamsim.analysis.field_picture import FieldStyle, Spot, draw_field
from robotteamsim.propagation import FieldMap

STYLE = FieldStyle(
    "level", "dB", "magma", low=10.0, high=60.0, silent_below=10.0, silence="quiet", contours=((30.0, "30"),)
)


def hill() -> FieldMap:
    x, y = np.meshgrid(np.arange(0.25, 20, 0.5), np.arange(0.25, 10, 0.5))
    return FieldMap((0.0, 0.0), 0.5, 60.0 - 8.0 * np.hypot(x - 10.0, y - 5.0))


def test_picture_shows_the_plan_with_bar_title_and_sources(hall_scenario):
    figure = draw_field(hill(), hall_scenario().plan, STYLE, "a hill", [Spot("top", (10.0, 5.0))])
    axes, bar = figure.axes
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.0, 20.0), (0.0, 10.0))
    assert axes.get_title(loc="left") == "a hill"
    assert axes.get_title(loc="right") == "white: quiet"
    assert bar.get_ylabel() == "level [dB]"
    assert "top" in [text.get_text() for text in axes.texts]


def test_cells_below_silence_are_left_white(hall_scenario):
    figure = draw_field(hill(), hall_scenario().plan, STYLE, "a hill", [])
    values = figure.axes[0].images[0].get_array()
    assert values.mask[0, 0]
    assert not values.mask[10, 20]


def test_flat_map_has_no_contours(hall_scenario):
    flat = FieldMap((0.0, 0.0), 0.5, np.full((20, 40), 20.0))
    figure = draw_field(flat, hall_scenario().plan, STYLE, "flat", [])
    assert len(figure.axes[0].texts) == 0


def test_picture_of_a_wide_plan_is_wide(hall_scenario):
    width, height = draw_field(hill(), hall_scenario().plan, STYLE, "a hill", []).get_size_inches()
    assert width > 1.5 * height
