import math

import pytest

from robotteamsim.swarm import DpsoOptions, PsoOptions, RdpsoOptions, RpsoOptions, SwarmSizes, memory_coefficients
from robotteamsim.swarm.adaptation import EXACT_LEVELS, PUBLISHED_LEVELS, Levels
from robotteamsim.swarm.options import inertia_coefficients
from robotteamsim.swarm.stability import mean_radius, variance_radius


@pytest.mark.parametrize("kind", [PsoOptions, DpsoOptions, RpsoOptions, RdpsoOptions])
@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"c1": -0.1}, r"c1 must lie in \[0, 4\], got -0.1"),
        ({"c2": 4.1}, r"c2 must lie in \[0, 4\], got 4.1"),
        ({"c1": math.nan}, r"c1 must lie in \[0, 4\], got nan"),
        ({"inertia": 1.1}, r"inertia must lie in \[0, 1\], got 1.1"),
        ({"alpha": 1.5}, r"alpha must lie in \[0, 1\], got 1.5"),
        ({"alpha": -0.1}, r"alpha must lie in \[0, 1\], got -0.1"),
        ({"memory": "published", "memory_terms": 5}, "the published memory has 4 terms, got 5"),
        ({"memory_terms": 0}, "at least 1 term, got 0"),
        ({"memory_terms": 2.5}, "memory_terms must be a whole number, got 2.5"),
        ({"c1": "0.5"}, "c1 must be a number, got '0.5'"),
        ({"alpha": "half"}, "alpha must be a number, got 'half'"),
        ({"memory": "caputo"}, "memory must be inertia, published or grunwald_letnikov, got 'caputo'"),
        ({"max_step": 0.0}, r"max_step must lie in \(0, 1\].*got 0.0"),
    ],
)
def test_coefficients_outside_their_range_are_refused(kind, wrong, message):
    with pytest.raises(ValueError, match=message):
        kind(**wrong)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"c3": 5.0}, r"c3 must lie in \[0, 4\], got 5.0"),
        ({"c4": -1.0}, r"c4 must lie in \[0, 4\], got -1.0"),
        ({"endangered_proximity": 0.0}, r"endangered_proximity must lie in \(0, 1\], got 0.0"),
        ({"adaptation": "neural"}, "adaptation must be none, crisp or fuzzy, got 'neural'"),
        ({"adaptation": "fuzzy", "memory": "inertia"}, "'fuzzy' sets alpha: it needs a fractional memory"),
        (
            {"adaptation": "crisp", "c1": 1.5},
            r"c1 \+ c2 \+ c3 \+ c4 must be 2 with adaptation 'crisp', eq. \(26\), got 3.99618",
        ),
    ],
)
def test_wrong_terms_of_robots_are_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        RdpsoOptions(**wrong)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"min_swarms": 7}, "swarms need 0 <= min <= initial <= max.*got min 7, initial 6, max 8"),
        ({"max_particles": 4}, "particles need .*got min 0, initial 5, max 4"),
        ({"initial_particles": 0}, "particles need .*got min 0, initial 0, max 15"),
        ({"min_swarms": -1}, "swarms need .*got min -1"),
        ({"initial_particles": 5.5}, "initial_particles must be a whole number, got 5.5"),
        ({"search_counter_max": 1.5}, "search_counter_max must be a whole number, got 1.5"),
        ({"search_counter_max": 0}, "search_counter_max must be at least 1, got 0"),
    ],
)
def test_sizes_out_of_order_are_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        SwarmSizes(**wrong)


def test_weights_on_the_constraint_are_taken_with_an_adaptation_and_any_without():
    assert RdpsoOptions(adaptation="fuzzy", c1=0.5, c2=0.7, c3=0.3, c4=0.5).c2 == 0.7
    assert RdpsoOptions(adaptation="fuzzy").c1 == RdpsoOptions().c1
    assert RdpsoOptions(c1=1.5).c1 == 1.5


def test_pso_without_particles_and_dpso_that_may_lose_all_swarms_are_refused():
    with pytest.raises(ValueError, match="num_particles must be at least 1, got 0"):
        PsoOptions(num_particles=0)
    with pytest.raises(ValueError, match=r"num_particles must be a whole number, got 2\.5"):
        PsoOptions(num_particles=2.5)
    with pytest.raises(ValueError, match="min_swarms of a DPSO must be at least 1"):
        DpsoOptions(sizes=SwarmSizes(min_swarms=0))


def test_inertia_is_one_term_and_a_fractional_memory_as_many_as_asked_for():
    assert inertia_coefficients(PsoOptions(inertia=0.5)) == (0.5,)
    fractional = PsoOptions(memory="grunwald_letnikov", alpha=0.5, memory_terms=9)
    assert inertia_coefficients(fractional) == memory_coefficients("grunwald_letnikov", 0.5, 9)


def test_levels_suit_the_memory_unless_given():
    assert RdpsoOptions(memory="published").levels_used() == PUBLISHED_LEVELS
    assert RdpsoOptions().levels_used() == EXACT_LEVELS
    assert RdpsoOptions(levels=Levels(alpha_small=0.1)).levels_used().alpha_small == 0.1


@pytest.mark.parametrize(
    "options", [PsoOptions(), DpsoOptions(), RpsoOptions(), RdpsoOptions(), RdpsoOptions(memory="published")]
)
def test_defaults_let_a_swarm_come_to_rest(options):
    memory = inertia_coefficients(options)
    assert mean_radius(memory, options.c1, options.c2) < 1.0
    assert variance_radius(memory, options.c1, options.c2) < 1.0
