"""What robots believe, in recordings, pages and live missions, next to what is true."""

from __future__ import annotations

import numpy as np
import pytest
from shown_page import seek, shown, taken

from robotteamsim.recording import BagWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from robotteamsim.simulation import Simulation
from robotteamsim.view.found import FOUND_FREE, FOUND_WALL, WRONG_WALL, FoundLayers
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.live import LiveMission, SetLayers, Step
from robotteamsim.view.recorder import FrameRecorder

SETTINGS = ["robots.count=2", "mission.time_limit_s=8"]


@pytest.fixture(scope="module")
def scenario():
    return load("garage_unknown", SETTINGS)


@pytest.fixture(scope="module")
def recorded(scenario, tmp_path_factory):
    """Return the recording of a mission, and that of its bag."""
    path = tmp_path_factory.mktemp("bag") / "run.bag"
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation.setup)
    simulation.run([recorder, BagWriter(path)])
    return recorder.recording, recording_of(read_run([path]), scenario)


def found_in(scenario, cells, origin_cells=(0, 0)):
    """Return the layer of a map that begins at a cell (column, row)."""
    column, row = origin_cells
    grid = OccupancyGrid((0.1 * column, 0.1 * row), 0.1, np.asarray(cells, dtype=np.int8))
    return FoundLayers(scenario.plan).layer(5.0, grid)


def test_found_walls_are_right_within_a_cell_of_a_wall_and_else_wrong(scenario):
    true = building_of(scenario.plan).grid(0.1).cells
    # From left to right across the side of the block in the middle of the garage.
    row = 200
    edge = int(np.flatnonzero(true[row, 200:300] == OCCUPIED)[0]) + 200
    for column, expected in ((edge, FOUND_WALL), (edge - 1, FOUND_WALL), (edge - 2, WRONG_WALL)):
        layer = found_in(scenario, [[OCCUPIED, FREE, UNKNOWN]], (column, row))
        assert layer.values[row, column : column + 3].tolist() == [expected, FOUND_FREE, 0]
        assert np.count_nonzero(layer.values) == 2


def test_doors_are_walls_open_or_closed():
    scenario = load("tutorial_arena")
    plan = scenario.plan.model_copy(update={"doors": load("garage_sar").plan.doors})
    closed = building_of(plan).grid(0.1, tuple((door.name, True) for door in plan.doors)).cells
    layer = FoundLayers(plan).layer(0.0, OccupancyGrid(plan.bounds.min, 0.1, closed))
    assert np.count_nonzero(layer.values == WRONG_WALL) == 0
    assert np.count_nonzero(layer.values == FOUND_WALL) == np.count_nonzero(closed == OCCUPIED)


@pytest.mark.parametrize(("origin", "cell_m"), [((-1, 0), 0.1), ((0, 399), 0.1), ((598, 0), 0.1), ((0, 0), 0.05)])
def test_maps_beyond_the_floor_or_with_other_cells_are_not_shown(scenario, origin, cell_m):
    cells = np.zeros((2, 3), dtype=np.int8)
    grid = OccupancyGrid((0.1 * origin[0], 0.1 * origin[1]), cell_m, cells)
    assert FoundLayers(scenario.plan).layer(0.0, grid) is None


def test_recording_has_the_believed_poses_and_maps_of_each_robot(recorded):
    live, _ = recorded
    assert live.scene.has_beliefs
    for frame in live.frames:
        for pose, belief in zip(frame.poses, frame.beliefs, strict=True):
            assert belief.state == "tracking"
            assert belief.poses[0] == pytest.approx(pose, abs=0.1)
    assert any(frame.beliefs[0].poses[0] != frame.poses[0] for frame in live.frames)
    maps = live.found["found_1"].packed()
    assert len(maps["times_s"]) == 2
    assert (maps["rows"], maps["columns"], maps["cell_m"]) == (400, 600, 0.1)


def test_recording_of_a_bag_shows_the_same_beliefs(recorded):
    live, replayed = recorded
    assert replayed.scene.has_beliefs
    assert len(replayed.frames) == len(live.frames)
    for ours, theirs in zip(replayed.frames, live.frames, strict=True):
        for one, other in zip(ours.beliefs, theirs.beliefs, strict=True):
            assert one.state == other.state
            assert one.poses[0] == pytest.approx(other.poses[0])
    for name, film in live.found.items():
        found, expected = replayed.found[name].packed(), film.packed()
        assert found["changes"] == expected["changes"]
        assert found["cells"] == expected["cells"]


def test_recording_with_true_poses_has_no_beliefs():
    simulation = Simulation(load("garage_sar", ["mission.time_limit_s=1"]))
    recorder = FrameRecorder(simulation.setup)
    simulation.run([recorder])
    assert not recorder.recording.scene.has_beliefs
    assert not recorder.recording.found
    assert {frame.beliefs for frame in recorder.recording.frames} == {()}


def test_viewer_gets_the_maps_unless_they_hide_them(scenario):
    mission = LiveMission(lambda _: scenario, speed=1000.0, playing=False)
    first = taken(mission, viewer := mission.subscribe())
    names = set(first.layers)
    for _ in range(30):
        mission.execute(Step())
        names |= set(taken(mission, viewer).layers)
    assert {"found_0", "found_1"} <= names
    mission.execute(SetLayers(viewer.number, ["fire"]))
    names = set()
    for _ in range(60):
        mission.execute(Step())
        names |= set(taken(mission, viewer).layers)
    assert not names


@pytest.mark.slow
def test_page_counts_ghosts_and_wrong_walls(browser, recorded, scenario, tmp_path):
    live, _ = recorded
    cells = np.full((400, 600), UNKNOWN, dtype=np.int8)
    cells[100, 100:140] = OCCUPIED
    live.found["found_0"].add(FoundLayers(scenario.plan).layer(7.0, OccupancyGrid((0.0, 0.0), 0.1, cells)))
    with shown(browser, tmp_path, [live]) as page:
        before, after = seek(page, 6.5), seek(page, 7.5)
        assert before["ghosts"] == after["ghosts"] == "2"
        assert (before["wrong"], after["wrong"]) == ("0", "40")
        assert int(before["found"]) > 100
