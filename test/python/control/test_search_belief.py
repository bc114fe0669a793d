"""The belief over places of victims: losses of voices, paths between cells, and the source of a voice."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest

from robotteamsim import _core
from robotteamsim.control.search.cells import cell_grid, cell_paths, places, unheard, voice_losses
from robotteamsim.control.search.hunt import Hunt
from robotteamsim.control.search.knowledge import ListeningLog, NoiseEstimate, entries_in
from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.scenario import load
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Door, Wall
from robotteamsim.scenario.sections import Voice
from robotteamsim.sensing.readings import VoiceReading

RADIUS_M = 0.2
STEP_DB = 78.0 / 250.0


@pytest.fixture
def rooms(hall_scenario):
    """The hall of 20 x 10 cells, cut in two at x = 10 by a wall with a door at y = 2."""
    hall = hall_scenario().plan
    walls = (
        Wall(name="low", start=(10.0, 0.0), end=(10.0, 1.5)),
        Wall(name="high", start=(10.0, 2.5), end=(10.0, 10.0)),
    )
    doors = (Door(name="a", start=(10.0, 1.5), end=(10.0, 2.5)),)
    return hall_scenario(plan=hall.model_copy(update={"walls": (*hall.walls, *walls), "doors": doors}))


def _cell(column: int, row: int) -> int:
    return 20 * row + column


def _belief(scenario):
    grid = cell_grid(scenario)
    losses = voice_losses(Building(scenario.plan), scenario.voice, grid, ())
    belief = _core.control.VictimBelief(losses, np.full(grid.size, 1.0 / grid.size, dtype=np.float32))
    belief.set_unheard(unheard(scenario.voice, 30.0))
    return belief


def test_loss_over_a_distance_is_that_of_a_middling_voice_as_near_as_a_robot_perceives(hall_scenario):
    scenario = hall_scenario()
    losses = voice_losses(Building(scenario.plan), scenario.voice, cell_grid(scenario), ()).losses_from(_cell(2, 5))
    # 8 m away, of which the robot perceives 1.5 m less half a cell of 0.25 m.
    expected_db = 55.0 * math.log10(8.0 - 1.375)
    assert losses[_cell(10, 5)] == math.ceil(expected_db / STEP_DB)
    assert losses[_cell(2, 5)] == 0


def test_wall_costs_two_decibels_and_a_closed_door_as_much(rooms):
    grid = cell_grid(rooms)
    opened, closed = (voice_losses(Building(rooms.plan), rooms.voice, grid, doors) for doors in ((), (("a", True),)))
    free_steps, walls_steps = math.ceil(55.0 * math.log10(2.625) / STEP_DB), 2.0 / STEP_DB
    through_wall = opened.losses_from(_cell(8, 5))[_cell(12, 5)]
    assert through_wall == pytest.approx(free_steps + walls_steps, abs=1.0)
    assert opened.losses_from(_cell(8, 2))[_cell(12, 2)] == free_steps
    assert closed.losses_from(_cell(8, 2))[_cell(12, 2)] == pytest.approx(free_steps + walls_steps, abs=1.0)


@pytest.mark.parametrize("wall_model", get_args(Voice.model_fields["wall_model"].annotation))
def test_wall_costs_as_much_as_in_the_voice_map_with_each_wall_model(rooms, wall_model):
    strong = {"wall_loss_db": 7.0, "attenuation_per_cm": 3.0 * rooms.voice.attenuation_per_cm}
    voice = rooms.voice.model_copy(update={"wall_model": wall_model, **strong})
    scenario = rooms.model_copy(update={"voice": voice})
    field, source = VoiceField(scenario.plan, voice), VoiceSource((8.5, 5.5), -78.0, 5.5)
    # Both places are 4 m away.
    wall_db = field.level_db(source, (8.5, 9.5)) - field.level_db(source, (12.5, 5.5))
    losses = voice_losses(Building(scenario.plan), scenario.voice, cell_grid(scenario), ()).losses_from(_cell(8, 5))
    assert losses[_cell(12, 5)] - losses[_cell(8, 9)] == pytest.approx(wall_db / STEP_DB, abs=1.0)
    assert wall_db > 5.0


def test_losses_are_symmetric(rooms):
    losses = voice_losses(Building(rooms.plan), rooms.voice, cell_grid(rooms), ())
    matrix = np.array([losses.losses_from(cell) for cell in range(200)])
    assert (matrix == matrix.T).all()


def test_probability_of_missing_a_voice_is_the_share_of_victims_below_the_noise():
    missed = unheard(Voice(exponent=(5.0, 5.0)), 30.0)
    # Uniform from 72 to 78 dB: all are heard after a loss of 42 dB, half after 45 dB, none after 48 dB.
    assert missed[int(41.9 / STEP_DB)] == 0.0
    assert missed[int(45.0 / STEP_DB)] == pytest.approx(0.5, abs=0.07)
    assert missed[int(48.2 / STEP_DB)] == 1.0
    assert (np.diff(missed) >= 0.0).all()


def test_listening_does_not_depend_on_order_or_repetition(rooms):
    once, again = _belief(rooms), _belief(rooms)
    heard = [(_cell(3, 3), 0), (_cell(12, 7), 20), (_cell(16, 2), 0)]
    for cell, above in heard:
        once.listen(cell, above)
    for cell, above in [*reversed(heard), *heard]:
        again.listen(cell, above)
    assert (once.mass() == again.mass()).all()
    assert 0.0 < once.remaining() < 1.0


def test_silence_excludes_only_victims_nearby(hall_scenario):
    belief = _belief(hall_scenario())
    belief.listen(_cell(3, 5), 0)
    mass = belief.mass() * 200
    assert mass[_cell(4, 5)] == 0.0
    assert mass[_cell(18, 5)] == pytest.approx(1.0)


def test_information_gain_equals_the_sum_over_cells(rooms):
    belief, grid = _belief(rooms), cell_grid(rooms)
    belief.listen(_cell(3, 5), 0)
    paths = cell_paths(Building(rooms.plan), RADIUS_M, grid, (), None)
    claim, start, candidates = _cell(16, 7), _cell(3, 5), [_cell(5, 5), _cell(12, 3), _cell(17, 8)]
    losses = voice_losses(Building(rooms.plan), rooms.voice, grid, ())
    missed = unheard(rooms.voice, 30.0)
    left = np.minimum(belief.mass(), missed[losses.losses_from(claim)] / 200)
    gains = [np.maximum(left - missed[losses.losses_from(cell)] / 200, 0.0).sum() for cell in candidates]
    rates = [gain / (paths.length_m(start, cell) / 0.5 + 2.0) for gain, cell in zip(gains, candidates, strict=True)]
    found = belief.best(paths, start, candidates, [claim], 0.5, 2.0)
    best = int(np.argmax(rates))
    assert found == (candidates[best], pytest.approx(gains[best]), pytest.approx(rates[best]))


def test_path_leads_through_the_door_and_ends_where_the_door_is_closed(rooms):
    grid = cell_grid(rooms)
    opened, closed = (cell_paths(Building(rooms.plan), RADIUS_M, grid, doors, None) for doors in ((), (("a", True),)))
    by_door_m = math.dist((8.5, 5.5), (10.0, 2.0)) + math.dist((10.0, 2.0), (11.5, 5.5))
    assert opened.length_m(_cell(8, 5), _cell(11, 5)) == pytest.approx(by_door_m, rel=0.12)
    assert closed.length_m(_cell(8, 5), _cell(11, 5)) == math.inf
    assert opened.ahead((8.5, 5.5), _cell(11, 5), 20.0)[1] < 4.0


def test_no_path_enters_the_disc_that_is_kept_out(hall_scenario):
    scenario = hall_scenario()
    paths = cell_paths(Building(scenario.plan), RADIUS_M, cell_grid(scenario), (), ((10.0, 5.0), 2.5))
    assert paths.place_of(_cell(10, 5)) is None
    around_m = paths.length_m(_cell(4, 5), _cell(15, 5))
    assert 11.5 < around_m < 15.0


def test_room_behind_a_wall_without_a_door_is_searched_by_nobody(hall_scenario):
    hall = hall_scenario().plan
    wall = Wall(name="wall", start=(10.0, 0.0), end=(10.0, 10.0))
    plan = hall.model_copy(update={"walls": (*hall.walls, wall)})
    scenario = hall_scenario(plan=plan)
    found = places(Building(plan), RADIUS_M, cell_grid(scenario), _cell(3, 5), 1.0, 2)
    assert found.prior.sum() == pytest.approx(1.0)
    assert found.prior[_cell(15, 5)] == 0.0
    assert all(cell % 20 < 10 for cell in found.candidates)


@pytest.mark.parametrize("at", [(15.2, 7.4), (4.6, 8.3), (12.7, 2.1)])
def test_source_of_a_voice_follows_from_levels_along_a_path(rooms, at):
    grid = cell_grid(rooms)
    fix = _core.control.VoiceFix(voice_losses(Building(rooms.plan), rooms.voice, grid, ()), (75.0, 1.73), (5.5, 0.29))
    field = VoiceField(rooms.plan, rooms.voice)
    for place in [(8.0, 3.0), (8.5, 3.6), (9.0, 4.5), (8.6, 5.6), (8.0, 6.6), (7.4, 7.2)]:
        fix.add(place, field.level_db(VoiceSource(at, -76.5, 5.8), place))
    cell, misfit = fix.most_probable(np.ones(grid.size, dtype=np.float32))
    assert math.dist(grid.centre_of(cell), at) < 1.6
    assert misfit < 1.5


def test_voice_that_another_one_drowned_out_is_approached_afterwards(hall_scenario):
    scenario = hall_scenario(control={"algorithm": "search"})
    grid, field = cell_grid(scenario), VoiceField(scenario.plan, scenario.voice)
    losses = voice_losses(Building(scenario.plan), scenario.voice, grid, ())
    prior = np.full(grid.size, 1.0 / grid.size, dtype=np.float32)
    hunt, first, second = Hunt(scenario, grid), (5.5, 2.5), (16.5, 7.5)

    def follow(places, source=None):
        for place in places:
            level_db = 0.0 if source is None else field.level_db(VoiceSource(source, -76.5, 5.8), place)
            found = hunt.follow(VoiceReading(0.0, source is not None, place, level_db), 1, place, losses, prior, prior)
        return None if found is None else found.source_m

    assert math.dist(follow([(8.0, 3.0), (8.5, 3.6), (8.5, 4.4), (8.0, 5.0)], first), first) < 1.6
    assert math.dist(follow([(9.0, 5.0)]), first) < 1.6
    follow([(12.0, 6.0), (12.5, 6.6), (13.0, 7.5), (13.6, 8.0), (14.0, 8.5), (14.5, 8.0), (14.8, 7.0)], second)
    hunt.note_found(second, within_m=6.0)
    assert math.dist(follow([(16.0, 7.0)]), first) < 1.6
    hunt.note_found(first, within_m=6.0)
    assert follow([(6.0, 3.0)]) is None


def test_voices_to_come_back_to_are_at_most_as_many_as_cells(hall_scenario):
    scenario = hall_scenario(control={"algorithm": "search"})
    grid = cell_grid(scenario)
    losses = voice_losses(Building(scenario.plan), scenario.voice, grid, ())
    prior = np.full(grid.size, 1.0 / grid.size, dtype=np.float32)
    hunt = Hunt(scenario, grid)
    # Heard next to the victim, each time a little elsewhere, with silence between.
    for i in range(grid.size + 50):
        place = (5.5 + 1e-3 * i, 5.5)
        assert hunt.follow(VoiceReading(70.0, True, place, 70.0), 1, place, losses, prior, prior).follow_m == place
        assert hunt.follow(VoiceReading(0.0, False, place, 0.0), 1, place, losses, prior, prior) is not None
    assert 1 <= len(hunt._left) <= grid.size


def test_invalid_arguments_are_rejected(rooms):
    belief = _belief(rooms)
    with pytest.raises(ValueError, match="no cell 200"):
        belief.listen(200, 0)
    with pytest.raises(ValueError, match="above must be >= 0"):
        belief.listen(0, -1)
    with pytest.raises(ValueError, match="prior must have 200 cells, got 3"):
        _core.control.VictimBelief(
            voice_losses(Building(rooms.plan), rooms.voice, cell_grid(rooms), ()), np.ones(3, dtype=np.float32)
        )


def test_cells_of_a_large_plan_are_doubled_until_they_are_few(hall_scenario):
    assert cell_grid(hall_scenario(control={"algorithm": "search", "most_cells": 100})).cell_m == 2.0


def _heard(level_db: float) -> VoiceReading:
    return VoiceReading(0.0, True, (1.0, 2.0), level_db)


def test_noise_is_the_level_at_which_a_voice_appears():
    noise = NoiseEstimate(10.0)
    silent = VoiceReading(0.0, False, (0.0, 0.0), 0.0)
    noise.note(silent, 1)
    assert (noise.noise_db, noise.is_measured) == (10.0, False)
    for level_db in (31.2, 35.0, 40.0):
        noise.note(_heard(level_db), 1)
    assert (noise.noise_db, noise.is_measured) == (31.2, True)
    noise.note(_heard(30.5), 1)
    assert noise.noise_db == 30.5


def test_voice_that_ends_with_an_epoch_says_nothing_about_the_noise():
    noise = NoiseEstimate(20.0)
    noise.note(_heard(70.0), 1)
    noise.note(VoiceReading(0.0, False, (0.0, 0.0), 0.0), 2)
    assert (noise.noise_db, noise.is_measured) == (20.0, False)


def test_robot_that_receives_every_third_message_learns_all_in_time():
    sender, receiver = ListeningLog(), ListeningLog()
    for second in range(150):
        if second < 60:
            sender.add(second, second % 7, own=True)
        text = sender.to_text(12, 12)
        assert len(text) <= 6 * 24
        if second % 3 == 0:
            for cell, above in entries_in(text, 200):
                receiver.add(cell, above, own=False)
    assert len(receiver) == 60


@pytest.mark.parametrize("text", ["0", "zz", "00c8ff", "00010", "é"])
def test_text_that_does_not_fit_the_grid_has_no_entries(text):
    assert entries_in(text, 200) is None


def test_robot_next_to_the_place_of_a_cell_drives_on_to_the_next_one():
    # The straight line to the place, 6 mm away, touches a cell that is too near to a pillar.
    garage = load("garage_sar")
    paths = cell_paths(Building(garage.plan), garage.robots.reach_m, cell_grid(garage), (), None)
    position, goal = (29.4945, 10.4983), (51.5, 1.5)
    target = paths.ahead(position, paths.cell_of(goal), 8.0)
    assert paths.start_of(position) == paths.cell_of((29.55, 10.55))
    assert math.dist(position, target) > 0.5
