"""Pictures of recorded runs show what the bags hold, and nothing else."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import msgspec
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.text import Text

from robotteamsim import palette
from robotteamsim.analysis.runs.curves import curves, draw_progress
from robotteamsim.analysis.runs.picture import draw_runs, outcome
from robotteamsim.analysis.runs.plan_panel import colour_of, extent_m, victim_style
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.palette import robot_colour
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.replay.recorded_run import RecordedNetwork, Timeline
from robotteamsim.recording.topics import base
from robotteamsim.scenario import Bounds, load
from robotteamsim.scenario.plan import OccupancyGrid


@pytest.fixture(scope="module")
def run(busy):
    return read_run([busy.bag])


@pytest.fixture(scope="module")
def real(write_bag, odometry, tmp_path_factory):
    """One robot that turns a circle, and a map of which little is known."""
    path = tmp_path_factory.mktemp("real") / "real.bag"
    cells = np.full((400, 400), -1, dtype=np.int8)
    cells[180:220, 190:260] = 0
    cells[180, 190:260] = 100
    grid = base.occupancy_grid(0, OccupancyGrid((-10.0, -10.0), 0.05, cells))
    samples = [("/map", "nav_msgs/OccupancyGrid", 1, grid)]
    for step in range(200):
        angle, time_ns = step / 30.0, 10**9 + step * 10**8
        pose = odometry(time_ns, 0.5 * math.cos(angle), 0.5 * math.sin(angle), frame="map")
        samples.append(("/odom", "nav_msgs/Odometry", time_ns, pose))
    return read_run([write_bag(path, samples)])


@pytest.fixture(scope="module")
def figure(run):
    return draw_runs([run], [run_totals(run)])


def names(figure: Figure) -> list[str]:
    """Return the labels of the axes, top to bottom."""
    return [axes.get_ylabel() for axes in figure.axes]


def legend(figure: Figure) -> set[str]:
    return {text.get_text() for text in figure.legends[0].get_texts()}


@pytest.mark.slow
def test_path_breaks_where_a_robot_left_and_came_elsewhere(comes_again):
    run = read_run([comes_again.bag])
    lines = [line for line in draw_runs([run], [run_totals(run)]).axes[0].lines if line.get_color() == robot_colour(1)]
    path, *_ = lines
    (gap,) = np.flatnonzero(np.isnan(path.get_xdata()))
    steps_m = np.hypot(np.diff(path.get_xdata()), np.diff(path.get_ydata()))
    assert np.nanmax(steps_m) < 0.2
    ends = next(line for line in lines if line.get_marker() == "o")
    assert ends.get_xdata().tolist() == [path.get_xdata()[gap - 1], path.get_xdata()[-1]]


def test_one_run_has_its_plan_and_all_curves(figure, busy):
    assert names(figure) == [
        "y [m]",
        "mission",
        "links",
        "longest path\n[hops]",
        "Fiedler value",
        "speed,\nmean of 10 s [m/s]",
        "driven [m]",
    ]
    assert figure.axes[0].get_aspect() == 1.0
    assert len([patch for patch in figure.axes[0].patches if isinstance(patch, Circle)]) == 5
    assert f"robot_0: {busy.result.robots[0].distance_m:.0f} m" in " ".join(legend(figure))
    assert {"victim waiting", "collision"} <= legend(figure)


def test_path_is_drawn_where_the_robot_was(figure, run):
    paths = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 100]
    assert [line.get_color() for line in paths] == [robot_colour(index) for index in range(5)]
    for robot, line in zip(run.robots, paths, strict=True):
        np.testing.assert_array_equal(line.get_xydata(), robot.track.poses[:, :2])


@pytest.mark.slow
def test_bag_without_mission_and_network_has_neither_curve(real):
    figure = draw_runs([real], [run_totals(real)])
    assert names(figure) == ["y [m]", "speed,\nmean of 10 s [m/s]", "driven [m]"]
    title = figure.legends[0].get_title().get_text()
    assert "network: no /network/state" in title
    assert "collision" not in legend(figure)


@pytest.mark.slow
def test_bag_with_the_network_alone_has_its_curves_and_says_that_there_is_no_plan(busy, write_bag, tmp_path):
    with BagReader([busy.bag]) as bag:
        kind = bag.topics["/network/state"]
        states = [(topic, kind, stamp_ns, state) for topic, stamp_ns, state in bag.messages({"/network/state"})]
    only = read_run([write_bag(tmp_path / "net.bag", states)])
    figure = draw_runs([only], [run_totals(only)])
    assert [axes.get_ylabel() for axes in figure.axes[1:]] == ["links", "longest path\n[hops]", "Fiedler value"]
    assert [text.get_text() for text in figure.axes[0].texts] == ["no paths and no floor plan in this bag"]
    assert run_totals(only).title == "net: 5 robots"


def test_only_the_known_part_of_a_map_is_shown(real):
    x0, x1, y0, y1 = extent_m(real, None)
    assert (x0, x1) == pytest.approx((-0.605, 3.105), abs=0.3)
    assert (y1 - y0) < 5.0


@pytest.mark.slow
def test_plan_of_a_scenario_replaces_the_map(figure, run):
    plan = load("garage_sar").plan
    with_plan = draw_runs([run], [run_totals(run)], plan).axes[0]
    assert len(with_plan.images) == 0
    assert len(figure.axes[0].images) == 1
    assert len(with_plan.patches) > len(plan.walls)


def test_compared_runs_share_the_scales_and_name_missing_curves(run, real):
    figure = draw_runs([run, real], [run_totals(run), run_totals(real)])
    rows = np.reshape(figure.axes, (6, 2))
    assert rows[5, 0].get_xlim() == rows[5, 1].get_xlim()
    assert rows[5, 0].get_ylim() == rows[5, 1].get_ylim()
    assert [text.get_text() for text in rows[1, 1].texts] == ["not in this bag"]


def test_outcome_is_one_line(run, real, busy):
    assert run_totals(run).title == "busy: garage_sar, 5 robots, 5 dB noise"
    assert outcome(run_totals(run)) == "0/5 areas, 0/4 victims in 25.0 s: time limit reached"
    assert run_totals(real).title == "real: 1 robot"
    assert outcome(run_totals(real)) == ""


def test_mission_without_robots_and_areas_shows_neither(run):
    """As a study of egress: its network has no robots, and its mission no areas."""
    none, shape = np.zeros((2, 0, 0)), (2, 0, 0)
    network = RecordedNetwork(np.array([0, 10**9]), none.astype(bool), none.astype(bool), np.zeros(shape), np.zeros(2))
    stamp_ns, last = run.statuses[-1]
    people = replace(
        run, robots=(), network=network, statuses=Timeline([(stamp_ns, msgspec.structs.replace(last, explored=()))])
    )
    assert curves(people) == [draw_progress]
    assert outcome(run_totals(people)) == "0/4 victims in 25.0 s: time limit reached"


@pytest.mark.slow
def test_picture_has_colour_where_paths_are(figure, tmp_path):
    figure.savefig(tmp_path / "run.png")
    image = cv2.imread(str(tmp_path / "run.png"))
    assert image.shape[1] > 1500
    first = [round(255 * part) for part in reversed(palette.rgb(robot_colour(0)))]
    assert np.all(np.abs(image.astype(int) - first) < 12, axis=-1).sum() > 200


def test_states_of_victims_differ_in_shape_and_not_only_in_colour():
    styles = [victim_style(state) for state in palette.VICTIMS]
    assert len({style["marker"] for style in styles}) == len({style["color"] for style in styles}) == 3


def test_robot_has_the_colour_of_its_number_as_in_rviz(run):
    assert [colour_of(9, robot) for robot in run.robots] == [robot_colour(index) for index in range(5)]
    assert colour_of(9, replace(run.robots[0], robot_id=None)) == robot_colour(9)


@pytest.mark.slow
@pytest.mark.parametrize("width_m", [60.0, 84.0, 88.0, 92.0, 110.0])
def test_title_outcome_and_legend_do_not_overlap_for_any_shape_of_the_floor(run, width_m):
    plan = load("garage_sar").plan.model_copy(update={"bounds": Bounds(max=(width_m, 64.0))})
    figure = draw_runs([run], [run_totals(run)], plan)
    figure.draw_without_rendering()
    floor = figure.axes[0]
    texts = {text.get_text(): text.get_window_extent() for text in figure.findobj(Text)}
    title, outcome_box = texts[figure.get_suptitle()], texts[floor.get_title("left")]
    legend_box, label = figure.legends[0].get_window_extent(), floor.xaxis.label.get_window_extent()
    assert title.y0 >= outcome_box.y1
    assert label.y0 >= legend_box.y1
