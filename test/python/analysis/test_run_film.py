"""Frames of films show the run as it was at their time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robotteamsim import palette
from robotteamsim.analysis.runs.film import RunFilm, link_segments
from robotteamsim.analysis.runs.robot_view import RobotView
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.errors import CameraError
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load

pytestmark = pytest.mark.slow

FIRST = tuple(round(255 * part) for part in palette.rgb(palette.robot_colour(0)))
SECOND_NS = 10**9


@pytest.fixture(scope="module")
def run(busy):
    return read_run([busy.bag])


@pytest.fixture(scope="module")
def film(run):
    return RunFilm(run, run_totals(run), None, width_px=640)


def marks(frame: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Return where a frame's left part, the plan, has a colour: bool, shape (height, width)."""
    plan = frame[:, : int(0.68 * frame.shape[1])].astype(int)
    return np.all(np.abs(plan - colour) < 8, axis=-1)


def test_frames_have_the_asked_width_and_count(film):
    frames = list(film.frames(7))
    assert [frame.shape for frame in frames] == [(360, 640, 3)] * 7
    assert frames[0].dtype == np.uint8


def test_film_begins_with_the_run_and_holds_its_end(film, run):
    frames = list(film.frames(25))
    np.testing.assert_array_equal(frames[0], film.frame(run.start_ns))
    np.testing.assert_array_equal(frames[-2], film.frame(run.end_ns))
    np.testing.assert_array_equal(frames[-1], frames[-2])
    assert np.any(frames[0] != frames[-1])


def test_frame_does_not_depend_on_those_before(film, run):
    middle_ns = (run.start_ns + run.end_ns) // 2
    before = film.frame(middle_ns)
    film.frame(run.end_ns)
    np.testing.assert_array_equal(film.frame(middle_ns), before)


def test_robot_moves_on_the_plan_as_it_did(film, run):
    """The dot of robot 0 is found by its colour, and its shift in pixels compared with the shift in metres."""
    axes = film.figure.axes[0]
    track = run.robots[0].track
    for stamp_ns in (run.start_ns, run.end_ns):
        frame = film.frame(stamp_ns)
        x, y = axes.transData.transform(track.poses[track.index_at(stamp_ns), :2])
        rows, columns = np.nonzero(marks(frame, FIRST))
        assert np.hypot(rows - (frame.shape[0] - y), columns - x).min() < 8.0


def test_links_are_those_of_the_time_with_the_endangered_in_another_colour(run):
    network = run.network
    for index in (0, 120, len(network.stamps_ns) - 1):
        segments, colours = link_segments(network, list(run.robots), int(network.stamps_ns[index]))
        assert len(segments) == np.triu(network.adjacency[index], 1).sum()
        endangered = np.triu(network.endangered[index], 1).sum()
        assert len([colour for colour in colours if colour == palette.ENDANGERED_LINK]) == endangered


def test_bag_with_odometry_alone_is_filmed_too(write_bag, odometry, tmp_path):
    samples = [
        ("/odom", "nav_msgs/Odometry", 10**9 * (i + 1), odometry(10**9 * (i + 1), 0.3 * i, 0.0)) for i in range(30)
    ]
    run = read_run([write_bag(tmp_path / "real.bag", samples)])
    first, *_, last = RunFilm(run, run_totals(run), None, width_px=640).frames(5)
    columns = [np.nonzero(marks(frame, FIRST))[1].mean() for frame in (first, last)]
    assert columns[1] > columns[0] + 50


def lines_of(film, index):
    """Return what is drawn in the colour of a robot: its trail, tail, nose and dot."""
    return [line for line in film.figure.axes[0].lines if line.get_color() == palette.robot_colour(index)]


def test_absent_robot_is_not_drawn(comes_again):
    run = read_run([comes_again.bag])
    film = RunFilm(run, run_totals(run), None, width_px=640)
    drawn = []
    for at_s in (4, 6, 9, 11):
        film.frame(run.start_ns + at_s * SECOND_NS)
        dots = [line for index in range(4) for line in lines_of(film, index) if line.get_marker() == "o"]
        drawn.append([dot.get_visible() for dot in dots])
        names = {text.get_text(): text.get_visible() for text in film.figure.axes[0].texts}
        assert [names[str(robot.robot_id)] for robot in run.robots] == drawn[-1]
    assert drawn == [[True, True, True, False], [True, False, True, False], [True, True, True, False], [True] * 4]


def test_tail_of_a_robot_that_was_put_elsewhere_is_broken(comes_again):
    run = read_run([comes_again.bag])
    film = RunFilm(run, run_totals(run), None, width_px=640)
    film.frame(run.end_ns)
    broken = [any(np.isnan(line.get_xdata()).sum() == 1 for line in lines_of(film, index)) for index in (0, 1)]
    assert broken == [False, True]


def test_legend_of_a_film_names_all_that_is_drawn(run, film):
    (legend,) = film.figure.legends
    names = {text.get_text() for text in legend.get_texts()}
    assert {robot.name for robot in run.robots} <= names
    assert {"victim waiting", "area, filled when explored", "link", "endangered link"} <= names


class Flashes:
    """The picture of a camera, which is red in the first half of a run and blue in the second."""

    title = "camera of robot 0"

    def __init__(self, run):
        self._middle_ns = (run.start_ns + run.end_ns) // 2

    def image(self, stamp_ns):
        return np.full((36, 64, 3), (255, 0, 0) if stamp_ns < self._middle_ns else (0, 0, 255), np.uint8)


def test_picture_of_a_camera_is_that_of_the_time(run):
    film = RunFilm(run, run_totals(run), None, 640, Flashes(run))
    for stamp_ns, colour, other in ((run.start_ns, (255, 0, 0), (0, 0, 255)), (run.end_ns, (0, 0, 255), (255, 0, 0))):
        frame = film.frame(stamp_ns)
        assert (frame == colour).all(axis=-1).sum() > 5000
        assert not (frame == other).all(axis=-1).any()


def test_view_of_a_robot_follows_its_recorded_poses(run):
    scenario = load("garage_sar")
    view = RobotView(run, scenario, 0)
    first, last = view.image(run.start_ns), view.image(run.end_ns)
    assert first.shape == (360, 640, 3)
    assert (first != last).any()
    np.testing.assert_array_equal(view.image(run.start_ns), first)


def test_view_of_an_unknown_robot_is_one_line(run):
    with pytest.raises(CameraError, match=r"^--camera 7: no robot on the map in the bag and in garage_sar; known"):
        RobotView(run, load("garage_sar"), 7)


def test_view_of_a_robot_that_is_not_on_the_map_is_one_line(run):
    robots = [replace(robot, track=replace(robot.track, frame="odom")) for robot in run.robots]
    with pytest.raises(CameraError, match=r"^--camera 0: no robot on the map .*; known: none$"):
        RobotView(replace(run, robots=tuple(robots)), load("garage_sar"), 0)
