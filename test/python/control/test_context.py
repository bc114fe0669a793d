"""What one robot measures of its swarm, and how its coefficients follow."""

from __future__ import annotations

import math

import networkx
import numpy as np
import pytest

from robotteamsim.control.rdpso.context import ContextMeter
from robotteamsim.control.rdpso.terms import LinkKeeper, Surroundings
from robotteamsim.geometry import Pose
from robotteamsim.interface import SwarmContext
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.sections import Laser, Mission, Network
from robotteamsim.setup import resolve

CRISP = RdpsoControl(adaptation="crisp")
PLACES = {0: (0.0, 0.0), 1: (6.0, 8.0), 2: (12.0, 0.0)}
"""Robot 1 is 10 m from both others, which are 12 m apart."""


@pytest.fixture
def meter(hall_scenario):
    """Make the meter of a robot whose links reach 11 m."""

    def make(control: RdpsoControl = CRISP) -> ContextMeter:
        scenario = hall_scenario(control=control, network=Network(link="distance", max_distance_m=11.0))
        return ContextMeter(control, control.adaptation, LinkKeeper(0, resolve(scenario)))

    return make


def moved(places: dict[int, tuple[float, float]], x_m: float) -> dict[int, tuple[float, float]]:
    return {robot_id: (x + x_m, y) for robot_id, (x, y) in places.items()}


def metrics(context: SwarmContext) -> tuple[float, ...]:
    return context.activity, context.socialisation, context.avoidance, context.proximity, context.connectivity


def coefficients(context: SwarmContext) -> tuple[float, ...]:
    return context.alpha, context.c1, context.c2, context.c3, context.c4


def test_metrics_equal_the_hand_calculation(meter):
    robot = meter()
    robot.measure(7, 1, moved(PLACES, -0.29), True, (0.0, 0.0), math.inf)
    context = robot.measure(8, 1, PLACES, True, (0.0, 0.0), 0.25)
    # Half of the largest step of 0.58 m; 10 of 12 m from the best; 0.25 of 1 m; 10 of 11 m; a path of three has
    # lambda_2 = 1.
    assert metrics(context) == pytest.approx((0.5, 1 / 6, 0.75, 1 / 11, 1 / 3))
    # Close and far: alpha is nominal, c3 and c4 are large, c2 is 0.3 of the remaining 0.4.
    assert (context.alpha, context.c1, context.c2, context.c3, context.c4) == pytest.approx(
        (0.45, 0.28, 0.12, 0.8, 0.8)
    )


def test_swarm_whose_robots_move_apart_is_not_active_and_one_that_was_not_seen_before_neither(meter):
    robot = meter()
    assert robot.measure(0, 0, {0: (0.0, 0.0), 1: (1.0, 0.0)}, True, (0.0, 0.0), math.inf).activity == 0.0
    assert robot.measure(1, 0, {0: (-0.5, 0.0), 1: (1.5, 0.0)}, True, (0.0, 0.0), math.inf).activity == 0.0
    assert robot.measure(3, 0, {0: (0.5, 0.0), 1: (2.5, 0.0)}, True, (0.0, 0.0), math.inf).activity == 0.0
    # Robot 2 was not heard before; the others move at more than full speed.
    known = {0: (1.3, 0.0), 1: (3.3, 0.0), 2: (5.0, 0.0)}
    assert robot.measure(4, 0, known, True, (0.0, 0.0), math.inf).activity == 1.0


def test_swarm_with_a_member_unheard_is_not_connected_and_a_robot_alone_is(meter):
    assert meter().measure(0, 1, PLACES, False, (0.0, 0.0), math.inf).connectivity == 0.0
    alone = meter().measure(0, 0, {0: (3.0, 4.0)}, True, (9.0, 9.0), math.inf)
    assert metrics(alone) == (0.0, 0.0, 0.0, 1.0, 1.0)
    lost = meter().measure(0, 0, {0: (3.0, 4.0)}, False, (9.0, 9.0), math.inf)
    assert (lost.proximity, lost.connectivity) == (0.0, 0.0)


@pytest.mark.parametrize("adaptation", ["crisp", "fuzzy"])
def test_context_does_not_depend_on_the_direction_of_the_axes(meter, adaptation):
    def measured(angle_rad: float) -> SwarmContext:
        robot, cos, sin = meter(RdpsoControl(adaptation=adaptation)), math.cos(angle_rad), math.sin(angle_rad)
        for iteration, step_m in enumerate((0.0, 0.2)):
            turned = {i: (cos * x - sin * y, sin * x + cos * y) for i, (x, y) in moved(PLACES, step_m).items()}
            context = robot.measure(iteration, 2, turned, True, (5.0 * cos, 5.0 * sin), 0.4)
        return context

    expected = measured(0.0)
    for angle_rad in (0.3, 1.9, 4.0):
        turned = measured(angle_rad)
        for name in SwarmContext.__struct_fields__:
            assert getattr(turned, name) == pytest.approx(getattr(expected, name), abs=1e-9), name


def test_connectivity_by_signal_is_the_fiedler_value_of_networkx(hall_scenario):
    scenario = hall_scenario(control=CRISP, network=Network(lost_below_dbm=-70.0, endangered_below_dbm=-60.0))
    links, field = LinkKeeper(0, resolve(scenario)), RadioField(scenario.plan, scenario.radio)
    generator = np.random.default_rng(3)
    found = set()
    for _ in range(20):
        places_m = generator.uniform((1.0, 1.0), (19.0, 9.0), (6, 2))
        adjacency = field.rssi_matrix_dbm(places_m) >= -70.0
        np.fill_diagonal(adjacency, False)
        graph = networkx.from_numpy_array(adjacency)
        expected = networkx.algebraic_connectivity(graph, method="lanczos", tol=1e-10) if graph.edges else 0.0
        assert links.connectivity([tuple(place) for place in places_m.tolist()]) == pytest.approx(
            expected / 6, abs=1e-6
        )
        found.add(round(expected, 3))
    assert len(found) > 5


def test_clearance_is_the_distance_to_the_nearest_hit_from_the_centre_of_the_robot():
    laser = Laser(beams=3, angle_min_rad=-math.pi / 2, angle_max_rad=math.pi / 2, range_max_m=5.0, forward_m=0.1)
    surroundings = Surroundings(laser, 1.0)
    assert surroundings.clearance_m(np.full(3, 5.0, dtype=np.float32)) == math.inf
    ranges_m = np.array([0.75, 0.6, 5.0], dtype=np.float32)
    assert surroundings.clearance_m(ranges_m) == pytest.approx(0.7)
    assert surroundings.clearance_m(np.array([0.24, 0.6, 5.0], dtype=np.float32)) == pytest.approx(0.26)
    # O_n is above 0 exactly where there is an obstacle to keep away from.
    assert surroundings.clearest_place(Pose(0.0, 0.0, 0.0), ranges_m) is not None


@pytest.mark.parametrize("adaptation", ["crisp", "fuzzy"])
def test_robots_adapt_their_own_coefficients_which_sum_to_two(team, hall_scenario, adaptation):
    hall = team(hall_scenario(control=RdpsoControl(adaptation=adaptation)))
    hall.run(12.0)
    for decision in hall.decisions:
        context = decision.context
        assert context.c1 + context.c2 + context.c3 + context.c4 == pytest.approx(2.0)
        assert all(0.0 <= value <= 1.0 for value in metrics(context))
    assert hall.decisions[0].context != hall.decisions[1].context
    fixed = team(hall_scenario())
    fixed.run(12.0)
    assert fixed.world.poses() != hall.world.poses()


def test_robots_without_adaptation_and_wandering_robots_have_no_context(team, hall_scenario):
    fixed = team(hall_scenario())
    fixed.run(5.0)
    assert [decision.context for decision in fixed.decisions] == [None, None]
    wandering = team(hall_scenario(control=CRISP, mission=Mission(areas=hall_scenario().mission.areas)))
    wandering.run(3.0)
    assert wandering.decisions[0].context is not None
    wandering.new_epoch(area_center_m=None)
    wandering.run(3.0)
    assert wandering.decisions[0].context is None
