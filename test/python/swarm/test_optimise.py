import os
import subprocess
import sys

import numpy as np
import pytest
from objectives import ackley, griewank, rastrigin, rosenbrock, schaffer, sphere

from robotteamsim import rng
from robotteamsim.swarm import (
    CommunicationTerm,
    DpsoOptions,
    ObstacleTerm,
    PsoOptions,
    RdpsoOptions,
    RpsoOptions,
    SwarmSizes,
    communication_attractor,
    maximise,
    minimise,
    robot_proximity_by_distance,
)

METHODS = ("pso", "dpso", "rpso", "rdpso")
BOUNDS = [(-6.0, 4.0), (-5.0, 7.0), (-4.0, 6.0)]


def run(fun=sphere, **options):
    return minimise(fun, BOUNDS, **{"vectorized": True, "max_evaluations": 3000, "seed": 5} | options)


@pytest.mark.parametrize("method", METHODS)
def test_result_is_what_the_objective_says_within_bounds_and_evaluations(method):
    asked = []

    def counted(x):
        asked.append(len(x))
        return sphere(x)

    result = run(counted, method=method)
    low, high = np.transpose(BOUNDS)
    assert ((low <= result.x) & (result.x <= high)).all()
    assert result.fun == sphere(result.x[None])[0]
    assert result.nfev == sum(asked) <= 3000
    assert result.nit == len(asked) - 1
    assert result.success
    assert result.message == f"{result.nfev} of 3000 evaluations are used up"
    assert result.history.shape == result.history_nfev.shape == (result.nit + 1,)
    assert (np.diff(result.history) <= 0.0).all()
    assert result.history[-1] == result.fun
    assert result.history_nfev.tolist() == np.cumsum(asked).tolist()


@pytest.mark.parametrize("method", METHODS)
def test_same_seed_gives_the_same_bits_and_another_seed_others(method):
    first, again, other = (run(rastrigin, method=method, seed=seed).history.tobytes() for seed in (1, 1, 2))
    assert first == again != other


def test_result_does_not_depend_on_what_the_processor_offers():
    code = (
        "import hashlib; from robotteamsim.swarm import RdpsoOptions, minimise;"
        "f = lambda x: sum(((x[:, k] - k) * (x[:, k] - k) for k in range(3)), 0.0 * x[:, 0]);"
        "d = hashlib.sha256();"
        "o = {'rdpso': RdpsoOptions(adaptation='fuzzy')};"
        "[d.update(minimise(f, [(-6.0, 4.0)] * 3, method=m, vectorized=True, max_evaluations=3000, options=o.get(m))"
        ".history.tobytes()) for m in ('pso', 'dpso', 'rdpso')];"
        "print(d.hexdigest())"
    )
    extensions = np.show_config(mode="dicts")["SIMD Extensions"]
    hashes = set()
    for disabled in ("", " ".join(extensions["found"])):
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"NPY_DISABLE_CPU_FEATURES": disabled},
            capture_output=True,
            text=True,
            check=True,
        )
        hashes.add(done.stdout)
    assert len(hashes) == 1


@pytest.mark.parametrize("method", METHODS)
def test_maximum_of_the_negative_is_the_minimum(method):
    least = run(rosenbrock, method=method)
    greatest = maximise(lambda x: -rosenbrock(x), BOUNDS, method=method, vectorized=True, max_evaluations=3000, seed=5)
    assert greatest.fun == -least.fun
    assert greatest.x.tolist() == least.x.tolist()
    assert greatest.history.tolist() == (-least.history).tolist()


@pytest.mark.parametrize("method", METHODS)
def test_path_depends_on_the_order_of_values_alone(method):
    plain = run(sphere, method=method)
    stretched = run(lambda x: 4.0 * sphere(x), method=method)
    assert stretched.x.tolist() == plain.x.tolist()
    assert stretched.history.tolist() == (4.0 * plain.history).tolist()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("fun", [sphere, rastrigin])
def test_objective_and_bounds_moved_together_move_the_result(method, fun):
    # Multiples of 1/8 keep most sums exact; what is left is rounding, so the runs are short.
    shift = np.array([16.0, -32.0, 8.0])
    here = run(fun, method=method, max_evaluations=600)
    there = minimise(
        lambda x: fun(x - shift),
        np.array(BOUNDS) + shift[:, None],
        method=method,
        vectorized=True,
        max_evaluations=600,
        seed=5,
    )
    assert there.x - shift == pytest.approx(here.x, abs=1e-9)
    assert there.history == pytest.approx(here.history, rel=1e-6)


def test_one_point_at_a_time_gives_the_same_bits_as_many():
    assert run().history.tobytes() == run(lambda x: float(np.sum(x * x)), vectorized=False).history.tobytes()


def test_rpso_without_obstacles_and_rdpso_of_one_swarm_without_exclusion_are_pso():
    pso = run(method="pso").history.tolist()
    assert run(method="rpso").history.tolist() == pso
    sizes = SwarmSizes(1, 1, 1, 30, 30, 30, search_counter_max=10_000)
    c = PsoOptions().c1
    rdpso = RdpsoOptions(sizes=sizes, memory="inertia", c1=c, c2=c)
    assert run(method="rdpso", options=rdpso).history.tolist() == pso


def test_grunwald_letnikov_memory_of_order_one_is_pso_of_eq_11():
    fractional = PsoOptions(memory="grunwald_letnikov", alpha=1.0, memory_terms=7)
    assert (
        run(method="pso", options=fractional).x.tolist()
        == run(method="pso", options=PsoOptions(inertia=1.0)).x.tolist()
    )


@pytest.mark.parametrize("fun", [sphere, rosenbrock, rastrigin, griewank, ackley, schaffer])
@pytest.mark.parametrize("method", METHODS)
def test_minimum_of_standard_functions_in_two_dimensions_is_found(method, fun):
    found = minimise(fun, [(-6.0, 5.0)] * 2, method=method, vectorized=True, max_evaluations=20_000, seed=3)
    assert found.fun < 0.02


@pytest.mark.parametrize("kind", ["none", "crisp", "fuzzy"])
@pytest.mark.parametrize("memory", ["published", "grunwald_letnikov"])
def test_rdpso_finds_the_minimum_with_every_adaptation_and_memory(kind, memory):
    alpha = 0.45 if memory == "published" else 0.6
    result = run(options=RdpsoOptions(adaptation=kind, memory=memory, alpha=alpha), max_evaluations=10_000)
    assert result.fun < 1e-3


def test_number_of_robots_stays_and_swarms_stay_within_their_sizes():
    sizes = SwarmSizes(2, 3, 4, 0, 6, 8, search_counter_max=3)
    seen = set()

    def watch(state):
        assert state.positions.shape == (18, 3)
        ids, counts = np.unique(state.swarm_ids[state.swarm_ids >= 0], return_counts=True)
        assert len(ids) <= 4
        assert counts.max(initial=0) <= 8
        seen.add((len(ids), int(np.sum(state.swarm_ids < 0))))

    run(rastrigin, options=RdpsoOptions(sizes=sizes), callback=watch)
    assert {number for number, _ in seen} >= {2, 3}
    assert len({excluded for _, excluded in seen}) > 3


def test_dpso_has_swarms_come_and_go_within_their_sizes():
    numbers = []

    def watch(state):
        ids, counts = np.unique(state.swarm_ids, return_counts=True)
        assert counts.min() >= 3
        assert counts.max() <= 9
        numbers.append(len(ids))

    sizes = SwarmSizes(2, 3, 5, 3, 6, 9, search_counter_max=3)
    run(rastrigin, method="dpso", options=DpsoOptions(sizes=sizes), callback=watch)
    assert min(numbers) >= 2
    assert max(numbers) <= 5
    assert len(set(numbers)) > 1


def test_obstacle_term_keeps_robots_off_a_wall_where_the_minimum_is():
    def wall_at_zero(x):
        near = np.clip(1.0 - np.abs(x[:, 0]), 0.0, 1.0)
        away = np.where(x[:, 0] < 0.0, -1.0, 1.0)
        return ObstacleTerm(np.column_stack((away, x[:, 1:])), near)

    def mean_clearance(options):
        places = []
        run(method="rpso", options=options, callback=lambda state: places.append(np.abs(state.positions[:, 0])))
        return np.mean(places[-20:])

    assert mean_clearance(RpsoOptions(c3=2.0, obstacles=wall_at_zero)) > 20.0 * mean_clearance(RpsoOptions())


def links_of_two(positions):
    """Return the network of robots that reach 2, and keep 1.6, from each other."""
    apart = np.linalg.norm(positions[:, None] - positions[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    nearest = np.argmin(apart, axis=1)
    places = [tuple(p[:2]) for p in positions.tolist()]
    pulls = [communication_attractor(p, places[n], 1.6) for p, n in zip(places, nearest, strict=True)]
    proximity = np.array([robot_proximity_by_distance(d, 2.0) for d in apart.min(axis=1)])
    return CommunicationTerm(np.array(pulls), proximity, 1.0)


def test_communication_term_keeps_robots_in_reach_of_their_neighbours():
    def lost_links(network):
        sizes = SwarmSizes(1, 1, 1, 8, 8, 8, search_counter_max=10_000)
        options = RdpsoOptions(sizes=sizes, c1=0.3, c2=0.02, c4=1.0, max_step=0.02, communication=network)
        lost = []

        def watch(state):
            lost.append(np.mean(links_of_two(state.positions).proximity == 0.0))

        minimise(rastrigin, [(-6.0, 6.0)] * 2, vectorized=True, options=options, max_evaluations=800, callback=watch)
        return float(np.mean(lost))

    assert lost_links(links_of_two) < 0.5 * lost_links(None)


def test_callback_sees_the_run_and_ends_it():
    seen = []

    def stop_at_third(state):
        seen.append((state.nit, state.nfev, state.fun))
        return state.nit == 3

    result = run(method="pso", callback=stop_at_third)
    assert [nfev for _, nfev, _ in seen] == [30, 60, 90, 120]
    assert (result.nit, result.nfev, result.fun) == seen[-1]
    assert not result.success
    assert result.message == "the callback ended the run"

    def interrupt(_):
        raise StopIteration

    assert run(callback=interrupt).nit == 0


@pytest.mark.parametrize("method", METHODS)
def test_nan_ends_the_run_with_what_was_found_until_then(method):
    calls = []

    def breaks(x):
        calls.append(len(x))
        return np.where((np.arange(len(x)) == 7) & (len(calls) == 4), np.nan, sphere(x))

    result = run(breaks, method=method)
    assert not result.success
    assert result.message.startswith("the objective returned nan for particle 7 at [")
    assert result.nit == 2
    assert result.fun == sphere(result.x[None])[0]
    assert result.nfev == sum(calls)


def test_objective_that_raises_is_reported_with_its_particle():
    def raises(x):
        raise KeyError("victim")

    with pytest.raises(ValueError, match=r"the objective raised KeyError for particle 0 at \[.*\]: 'victim'"):
        run(raises, vectorized=False)


def test_infinite_penalty_is_a_value_like_any_other():
    result = run(lambda x: np.where(x[:, 0] < 1.0, np.inf, sphere(x)), max_evaluations=10_000)
    assert result.fun == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ([(0.0, 1.0), (2.0, 2.0)], r"bounds of dimension 1 must be finite with low < high, got \(2.0, 2.0\)"),
        ([(1.0, 0.0)], r"bounds of dimension 0 .* got \(1.0, 0.0\)"),
        ([(0.0, np.inf)], r"bounds of dimension 0 .* got \(0.0, inf\)"),
        ([(np.nan, 1.0)], r"bounds of dimension 0 .* got \(nan, 1.0\)"),
        ([], r"bounds must have shape \(dimensions, 2\)"),
        ([0.0, 1.0], r"bounds must have shape \(dimensions, 2\), got \(2,\)"),
        ([("a", "b")], r"a \(low, high\) of numbers"),
    ],
)
def test_wrong_bounds_are_refused(bounds, message):
    with pytest.raises(ValueError, match=message):
        minimise(sphere, bounds)


def test_wrong_calls_are_refused():
    with pytest.raises(ValueError, match="method must be one of pso, dpso, rpso, rdpso, got 'ant'"):
        run(method="ant")
    with pytest.raises(ValueError, match="method 'pso' takes PsoOptions, got RpsoOptions"):
        run(method="pso", options=RpsoOptions())
    with pytest.raises(ValueError, match="max_evaluations must be at least the 30 particles, got 29"):
        run(max_evaluations=29)
    with pytest.raises(ValueError, match="seed must be >= 0, got -1"):
        run(seed=-1)
    with pytest.raises(ValueError, match="seed must be a whole number, got None"):
        run(seed=None)
    with pytest.raises(ValueError, match=r"max_evaluations must be a whole number, got 100\.5"):
        run(max_evaluations=100.5)


def test_generator_given_is_drawn_from():
    generator = rng.stream(5, "swarm optimiser")
    assert run(seed=generator).history.tolist() == run(seed=5).history.tolist()
    assert run(seed=generator).history.tolist() != run(seed=5).history.tolist()
