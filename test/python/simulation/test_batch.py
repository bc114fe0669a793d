"""Teams that move and measure together, against each of them alone."""

from __future__ import annotations

import numpy as np
import pytest
from robotteamsim._core.simulation import Batch
from robotteamsim._core.state import CONTACT, LINKS_CHANGED, PLACE_REACHED, VOICE_CHANGED, State

from robotteamsim.geometry import Pose
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

SCENARIOS = (
    "garage_sar",
    "garage_sar_published",
    "isr_floor_0_sar",
    "tutorial_arena",
    "office_manet",
    "warehouse_push",
)
STEPS = 100
ARRAYS = (
    *("true_pose", "positions_m", "true_twist", "contact", "odometry_pose", "odometry_twist"),
    *("odometry_pose_covariance", "odometry_twist_variances", "ranges_m"),
    *("voice_level_db", "voice_heard", "local_best_m", "local_best_level_db"),
)
MATRICES = ("rssi_dbm", "link", "adjacency", "endangered", "hop_count")


def simulation_of(name: str) -> Simulation:
    """Return a simulation whose odometry has the random numbers of all steps."""
    simulation = Simulation(resolve(load(name)))
    while simulation.sensors.core.noise_left < STEPS:
        simulation.sensors.draw()
    return simulation


def batch_of(simulations: list[Simulation], threads: int = 1) -> Batch:
    robots = max(simulation.world.num_robots for simulation in simulations)
    batch = Batch(len(simulations), robots, max(one.sensors.core.beams for one in simulations), threads)
    for mission, one in enumerate(simulations):
        links, ear = one.network.network.links, one.hearing.sensor.core()
        batch.put(mission, one.world.core, one.sensors.core, links, ear, one.mission.places)
    return batch


def commands(missions: int, robots: int, step: int) -> np.ndarray:
    generators = [np.random.default_rng([mission, step // 10]) for mission in range(missions)]
    return np.stack([each.uniform((-0.3, 0.0, -1.0), (0.7, 0.0, 1.0), (robots, 3)) for each in generators])


def alone(simulation: Simulation, twists: np.ndarray) -> State:
    """Return the state after a step that the parts of a simulation make one after the other."""
    simulation.world.step(twists)
    state = simulation.sensors.read()
    simulation.hearing.step(state, {}, ())
    simulation.network.step(state, [()] * len(state))
    return state


@pytest.mark.slow
@pytest.mark.parametrize("threads", [1, 3])
def test_batch_of_six_scenarios_has_the_bits_of_each_alone(threads):
    batch = batch_of([simulation_of(name) for name in SCENARIOS], threads)
    singles, everybody, seen = [simulation_of(name) for name in SCENARIOS], list(range(len(SCENARIOS))), 0
    robots = max(single.world.num_robots for single in singles)
    for step in range(STEPS):
        twists = commands(len(singles), robots, step)
        batch.move(twists, everybody)
        together = batch.sense(everybody)
        for mission, single in enumerate(singles):
            count, beams = single.world.num_robots, single.sensors.core.beams
            own, expected = together.of(mission), alone(single, twists[mission, :count])
            for name in ARRAYS:
                ours = getattr(own, name)[:count]
                np.testing.assert_array_equal(ours[:, :beams] if name == "ranges_m" else ours, getattr(expected, name))
            for name in MATRICES:
                np.testing.assert_array_equal(getattr(own, name)[:count, :count], getattr(expected, name))
            assert own.fiedler_value == expected.fiedler_value
            assert np.isnan(own.positions_m[count:]).all()
            assert not own.adjacency[count:].any()
            assert bool(together.happened[mission] & CONTACT) == expected.contact.any()
        seen |= int(np.bitwise_or.reduce(together.happened))
    assert seen & (LINKS_CHANGED | VOICE_CHANGED | CONTACT) == LINKS_CHANGED | VOICE_CHANGED | CONTACT


def test_place_is_reached_and_links_are_new_only_when_they_are():
    simulation = simulation_of("garage_sar")
    batch = batch_of([simulation])
    happened = [int(batch.sense([0]).happened[0]) for _ in range(3)]
    assert [bool(bits & LINKS_CHANGED) for bits in happened] == [True, False, False]
    assert not any(bits & PLACE_REACHED for bits in happened)
    area = simulation.scenario.mission.areas[0]
    simulation.world.core.set_pose(0, type(simulation.world.poses()[0])(*area.center, 0.0))
    assert batch.sense([0]).happened[0] & PLACE_REACHED


def test_states_of_several_missions_have_an_axis_for_them():
    simulations = [simulation_of("garage_sar") for _ in range(2)]
    state, placed = batch_of(simulations).sense([0, 1]), Pose(2.0, 3.0, 0.0)
    assert state.true_pose.shape == (2, 3, 4)
    assert state.ranges_m.shape == (2, 3, simulations[0].sensors.core.beams)
    alone, before_m = state.of(1), state.positions_m.copy()
    alone.place(1, placed)
    assert alone.positions_m[1].tolist() == [2.0, 3.0]
    np.testing.assert_array_equal(state.positions_m, before_m)
    with pytest.raises(IndexError, match="no such mission"):
        state.of(2)
    for read in (lambda: state[0], lambda: state.place(0, placed)):
        with pytest.raises(ValueError, match="one mission"):
            read()


def test_memory_of_a_state_is_used_again_only_after_nobody_holds_it():
    batch = batch_of([simulation_of("garage_sar")])
    held = batch.sense([0])
    place = held.true_pose.ctypes.data
    assert batch.sense([0]).true_pose.ctypes.data != place
    row = held.ranges_m[0, 1]
    del held
    assert batch.sense([0]).true_pose.ctypes.data != place
    del row
    assert batch.sense([0]).true_pose.ctypes.data == place


def test_missions_that_are_not_named_stay_as_they_are():
    simulations = [simulation_of("garage_sar") for _ in range(2)]
    batch, before = batch_of(simulations), simulations[0].world.positions_m()
    batch.move(np.full((2, 3, 3), 0.5), [1])
    assert np.array_equal(simulations[0].world.positions_m(), before)
    assert not np.array_equal(simulations[1].world.positions_m(), before)


def test_error_in_a_mission_names_it_and_leaves_the_others():
    simulations = [simulation_of("garage_sar") for _ in range(3)]
    batch, before = batch_of(simulations), simulations[0].world.positions_m()
    twists = np.full((3, 3, 3), 0.5)
    twists[1, 2, 0] = np.nan
    with pytest.raises(ValueError, match=r"^mission 1: .*finite"):
        batch.move(twists, [0, 1, 2])
    moved = [not np.array_equal(simulation.world.positions_m(), before) for simulation in simulations]
    assert moved == [True, False, True]


def test_mission_that_is_named_twice_and_parts_of_another_mission_are_refused():
    simulations = [simulation_of("garage_sar") for _ in range(2)]
    batch = batch_of(simulations)
    for do in (lambda: batch.move(np.zeros((2, 3, 3)), [0, 1, 0]), lambda: batch.sense([0, 0])):
        with pytest.raises(ValueError, match="mission 0: is named twice"):
            do()
    with pytest.raises(ValueError, match="mission -1: there is none"):
        batch.sense([-1])
    one, other = simulations
    parts = one.sensors.core, one.network.network.links, one.hearing.sensor.core(), one.mission.places
    with pytest.raises(ValueError, match="another mission has a part"):
        batch.put(0, other.world.core, *parts)


def test_teams_and_commands_that_do_not_fit_are_refused():
    simulation = simulation_of("garage_sar")
    batch = batch_of([simulation])
    with pytest.raises(ValueError, match="a row of three numbers per robot and mission"):
        batch.move(np.zeros((1, 2, 3)), [0])
    with pytest.raises(ValueError, match="mission 1: there is none"):
        batch.move(np.zeros((1, 3, 3)), [1])
    with pytest.raises(ValueError, match="there must be a mission"):
        Batch(0, 3, 181, 1)
    small = Batch(1, 2, 181, 1)
    links, ear = simulation.network.network.links, simulation.hearing.sensor.core()
    with pytest.raises(ValueError, match="more robots or beams"):
        small.put(0, simulation.world.core, simulation.sensors.core, links, ear, simulation.mission.places)
    for _ in range(128):
        batch.sense([0])
    with pytest.raises(ValueError, match="mission 0: no random numbers are left"):
        batch.sense([0])
