"""The vectors of agents against the formulas of their parts, one number after the other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.learning import Observe, Percepts
from robotteamsim.learning.errors import LearningError
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load
from robotteamsim.setup import resolve

SAID, MISSIONS, AGENTS = 2, 4, 3


@pytest.fixture
def observe() -> Observe:
    return Observe(resolve(load("office_manet", ["robots.count=3"])), range(AGENTS), SAID)


@pytest.fixture
def percepts(observe: Observe) -> Percepts:
    rng, size = np.random.default_rng(5), observe.setup.plan.bounds.max
    shape, yaws = (MISSIONS, AGENTS), rng.uniform(-math.pi, math.pi, (MISSIONS, AGENTS))
    places_m = rng.uniform((0.0, 0.0), size, (3, *shape, 2))
    poses = np.concatenate((places_m[0], np.sin(yaws / 2)[..., None], np.cos(yaws / 2)[..., None]), -1)
    heard = np.concatenate(
        (
            rng.integers(0, 2, (*shape, 2, 1)),
            rng.uniform((0.0, 0.0), size, (*shape, 2, 2)),
            rng.uniform(0.0, 12.0, (*shape, 2, 1)),
            rng.uniform(-1.0, 1.0, (*shape, 2, SAID)),
        ),
        -1,
    )
    voices = np.concatenate((rng.integers(0, 2, (*shape, 1)), rng.uniform(0.0, 120.0, (*shape, 1)), places_m[1]), -1)
    area = np.concatenate((rng.integers(0, 2, (MISSIONS, 1, 1)), places_m[2][:, :1]), -1)
    ranges_m = rng.uniform(0.0, 7.0, (*shape, observe.beams)).astype(np.float32)
    return Percepts(ranges_m, poses, rng.normal(size=(*shape, 3)), voices, area, heard, np.zeros((*shape, 0)))


def _expected(observe: Observe, percepts: Percepts, mission: int, agent: int) -> list[float]:
    setup, field = observe.setup, RadioField(observe.setup.plan, observe.setup.scenario.radio)
    robot, (width_m, height_m) = setup.robots[agent], setup.plan.bounds.max
    x, y, qz, qw = percepts.poses[mission, agent]
    yaw, diagonal_m = 2.0 * math.atan2(qz, qw), math.hypot(width_m, height_m)

    def seen(known: float, place: np.ndarray, unit_m: float) -> tuple[float, float]:
        bearing, away_m = math.atan2(place[1] - y, place[0] - x) - yaw, math.dist(place, (x, y))
        return known * away_m * math.cos(bearing) / unit_m, known * away_m * math.sin(bearing) / unit_m

    ahead_mps, _, turn_radps = percepts.twists[mission, agent]
    is_heard, level_db, *loudest = percepts.voices[mission, agent]
    is_area, *center = percepts.area[mission, 0]
    voice = setup.scenario.voice
    numbers = [*(percepts.ranges_m[mission, agent] / robot.laser.range_max_m)]
    numbers += [2.0 * x / width_m - 1.0, 2.0 * y / height_m - 1.0, math.cos(yaw), math.sin(yaw)]
    numbers += [ahead_mps / robot.drive.max_speed_mps, turn_radps / robot.drive.max_turn_radps]
    numbers += [is_heard, level_db / 100.0]
    numbers += seen(is_heard, loudest, voice.local_best_radius_m + voice.map_resolution_m)
    numbers += [is_area, *seen(is_area, center, diagonal_m)]
    for known, other_x, other_y, age_s, *said in percepts.heard[mission, agent]:
        rssi_dbm = setup.scenario.radio.tx_power_dbm - field.path_loss_db((x, y), (other_x, other_y))
        numbers += [known, *seen(known, (other_x, other_y), diagonal_m)]
        numbers += [known * max((rssi_dbm + 100.0) / 80.0, 0.0), known * age_s / 10.0, *said]
    return [min(max(number, -1.0), 1.0) for number in numbers]


def test_each_number_is_that_of_its_formula(observe, percepts):
    vectors = observe.vectors(percepts)
    assert vectors.shape == (MISSIONS, AGENTS, *observe.space.shape)
    assert vectors.dtype == np.float32
    for mission, agent in np.ndindex(MISSIONS, AGENTS):
        expected = _expected(observe, percepts, mission, agent)
        np.testing.assert_allclose(vectors[mission, agent], expected, rtol=0.0, atol=1e-6)


def test_vectors_of_one_mission_have_no_axis_in_front(observe, percepts):
    alone = observe.vectors(Percepts(*(part[1] for part in percepts)))
    np.testing.assert_array_equal(alone, observe.vectors(percepts)[1])


def test_numbers_that_are_remembered_come_last_and_are_limited(observe, percepts):
    remembered = np.full((MISSIONS, AGENTS, 2), (0.5, -3.0))
    vectors = observe.vectors(percepts._replace(remembered=remembered))
    np.testing.assert_array_equal(vectors[..., -2:], np.broadcast_to(np.float32([0.5, -1.0]), remembered.shape))


@pytest.mark.parametrize("part", ["ranges_m", "twists", "voices", "area", "heard"])
def test_parts_of_other_agents_are_refused(observe, percepts, part):
    with pytest.raises(LearningError, match="do not have the shapes of the same agents"):
        observe.vectors(percepts._replace(**{part: getattr(percepts, part)[:-1]}))


def test_what_is_no_number_is_refused(observe, percepts):
    twists = percepts.twists.copy()
    twists[0, 1, 2] = np.nan
    with pytest.raises(LearningError, match=rf"^percepts: agent 1: number {observe.beams + 5} of its vector is NaN$"):
        observe.vectors(percepts._replace(twists=twists))
    with pytest.raises(LearningError, match=r"^percepts: "):
        observe.vectors(percepts._replace(twists="fast"))
