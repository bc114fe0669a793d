"""Texts of the scene: above all solids, seen where they belong, off walls; the legend names what can be seen."""

from pathlib import Path

import numpy as np
import pytest
import shapely
import yaml

from robotteamsim.ros.scene import view
from robotteamsim.ros.scene.legend import entries, legend_markers
from robotteamsim.ros.scene.lettering import Lettering, Name, Written
from robotteamsim.scenario import Bounds, load

ROOT = Path(__file__).resolve().parents[3]
WHITE = (1.0, 1.0, 1.0, 1.0)


def test_text_is_above_the_highest_solid_on_the_line_of_sight_to_its_place():
    lettering = Lettering(unit=1.0, eye_m=(30.0, -6.0, 50.0), highest_m=2.0)
    marker = lettering.label("names", 0, Written("ann", (10.0, 20.0), 1.0), WHITE)
    at = np.array([marker.pose.position.x, marker.pose.position.y, marker.pose.position.z])
    assert at[2] - 0.5 > 2.0
    sight = np.array([30.0, -6.0, 50.0]) - at
    floor = at - sight * at[2] / sight[2]
    assert floor == pytest.approx([10.0, 20.0, 0.0])


def test_text_beside_a_wall_is_on_the_other_side():
    wall = shapely.box(-5.0, -1.5, 5.0, -1.0)
    lettering = Lettering(1.0, (0.0, -26.0, 51.0), 1.1, walls=wall)
    (written,) = lettering.place([Name("victim 1", (0.0, 0.0), 0.5, 1.0)])
    assert not written.box.intersects(wall)
    assert not written.box.intersects(shapely.Point(0.0, 0.0).buffer(0.4))


def test_text_at_the_edge_of_a_building_stays_within_it():
    inside = shapely.box(0.0, 0.0, 20.0, 20.0)
    lettering = Lettering(1.0, (10.0, -26.0, 51.0), 1.1, inside=inside)
    corners = [(0.5, 0.5), (19.5, 0.5), (19.5, 19.5), (0.5, 19.5)]
    written = lettering.place([Name("victim", corner, 0.5, 1.0) for corner in corners])
    assert all(inside.contains(text.box) for text in written)


def test_texts_are_equally_large_on_the_screen_in_every_building():
    assert view.unit(Bounds(max=(60.0, 40.0))) == 1.0
    assert view.unit(Bounds(max=(6.0, 4.0))) == pytest.approx(0.1)


def test_solid_covers_its_footprint_and_the_floor_behind_it():
    seen = view.covered((0.0, -20.0, 10.0), shapely.box(-1.0, 0.0, 1.0, 1.0), 2.0)
    assert seen.bounds == pytest.approx((-1.25, 0.0, 1.25, 6.25))  # seen from above its foot, the top is 5/4 as large
    assert seen.contains(shapely.box(-0.9, 0.1, 0.9, 6.0))


def test_default_view_is_that_of_the_file_of_rviz():
    config = yaml.safe_load((ROOT / "rviz" / "robotteamsim.rviz").read_text(encoding="utf-8"))
    current = config["Visualization Manager"]["Views"]["Current"]
    assert (current["Distance"], current["Pitch"]) == (view.DISTANCE_M, view.PITCH_RAD)
    assert current["Focal Point"]["Y"] == view.FOCUS_NORTH_M


@pytest.mark.parametrize(
    ("name", "missing"),
    [("garage_sar", {"base"}), ("office_manet", {"target area", "explored"}), ("tutorial_arena", {"base", "relayed"})],
)
def test_legend_names_what_a_scenario_has_below_the_building(name, missing):
    scenario = load(name)
    words = {entry.words for entry in entries(scenario)}
    assert {"victim waiting", "victim heard", "victim saved"} <= words
    assert not words & missing
    markers = legend_markers(scenario)
    assert {marker.text for marker in markers if marker.text} == words
    low = scenario.plan.bounds.min[1]
    assert all(marker.pose.position.y < low for marker in markers if marker.text)
    assert len({(marker.ns, marker.id) for marker in markers}) == len(markers)
