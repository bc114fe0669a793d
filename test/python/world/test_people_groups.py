"""Groups of people: places, speeds and delays that the seed draws (test 5 of ISO 20414)."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy import stats

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.victims import Victim
from robotteamsim.setup import resolve

PLAN = {
    "name": "two rooms",
    "bounds": {"max": [24, 12]},
    "walls": [{"name": "low", "from": [12, 0], "to": [12, 5]}, {"name": "high", "from": [12, 6.2], "to": [12, 12]}],
    "doors": [{"name": "door", "from": [12, 5], "to": [12, 6.2], "closed": True}],
}
NORMAL = {"kind": "normal", "mean": 1.2, "sd": 0.2, "min": 0.8, "max": 1.5}
LOGNORMAL = {"kind": "lognormal", "mean": 40.0, "sd": 20.0}
STAFF: dict[str, Any] = {"name": "staff", "count": 24, "speed_mps": NORMAL, "flees_after_s": LOGNORMAL}


def scenario(*groups: dict[str, Any], **sections: Any) -> Scenario:
    data = {
        "name": "groups",
        "plan": PLAN,
        "robots": {"count": 2, "start": [2.0, 2.0, 0.0]},
        "command_centre": 0,
        "firefighters": {"count": 1, "start": [4.0, 4.0, 0.0]},
        "control": {"algorithm": "cover"},
        "people": {"groups": list(groups)},
        "mission": {"saved_by": "firefighter", "exits": [{"name": "west", "center": [1.0, 6.0]}]},
    }
    return from_mapping({**data, **sections}, "groups.yaml")


def people(*groups: dict[str, Any], **sections: Any) -> tuple[Victim, ...]:
    return resolve(scenario(*groups, **sections)).scenario.mission.victims


def test_members_of_a_group_are_victims_with_room_around_them():
    drawn = people(STAFF)
    assert [victim.name for victim in drawn] == [f"staff_{number}" for number in range(1, 25)]
    assert all(victim.flees and not victim.calling for victim in drawn)
    team = [(*robot.start_pose[:2], robot.reach_m) for robot in resolve(scenario(STAFF)).robots]
    bodies = [*((*victim.position, 0.15) for victim in drawn), *team]
    for (x1, y1, r1), (x2, y2, r2) in itertools.combinations(bodies[:24] + team[:1], 2):
        assert math.hypot(x1 - x2, y1 - y2) >= r1 + r2
    assert all(math.dist(victim.position, (1.0, 6.0)) > 1.0 for victim in drawn)
    # Through open doors, an exit can be reached from both rooms.
    assert {victim.position[0] > 12.0 for victim in drawn} == {True, False}


@pytest.mark.parametrize(
    "region", [{"center": [18, 6], "radius_m": 2.0}, {"polygon": [[14, 2], [20, 2], [20, 9], [14, 9]]}]
)
def test_members_are_in_the_region_of_their_group(region):
    group = scenario({**STAFF, "region": region}).people.groups[0]
    for victim in people({**STAFF, "region": region}):
        assert group.region.contains(victim.position)


def test_the_seed_alone_draws_people():
    first, again = people(STAFF), people(STAFF, network={"hop_delay_s": 0.1})
    assert first == again
    assert people(STAFF, run={"seed": 2}) != first
    # Another group changes nobody of the first one.
    assert people(STAFF, {**STAFF, "name": "guests"})[:24] == first


@pytest.mark.parametrize(
    ("speed", "distribution"),
    [
        (NORMAL, stats.truncnorm(-2.0, 1.5, 1.2, 0.2)),
        ({"kind": "normal", "mean": 1.34, "sd": 0.26}, stats.truncnorm(-3.0, 3.0, 1.34, 0.26)),
        ({"kind": "uniform", "min": 0.5, "max": 1.5}, stats.uniform(0.5, 1.0)),
    ],
)
def test_speeds_have_the_distribution_of_their_group(speed, distribution):
    speeds = [victim.speed_mps for victim in people({**STAFF, "count": 400, "speed_mps": speed})]
    assert stats.kstest(speeds, distribution.cdf).pvalue > 0.01


def test_delays_have_a_lognormal_distribution_of_that_mean():
    delays_s = [victim.flees_after_s for victim in people({**STAFF, "count": 400})]
    sigma = math.sqrt(math.log(1.0 + (20.0 / 40.0) ** 2))
    expected = stats.lognorm(sigma, scale=40.0 * math.exp(-0.5 * sigma**2))
    assert expected.mean() == pytest.approx(40.0)
    assert expected.std() == pytest.approx(20.0)
    assert stats.kstest(delays_s, expected.cdf).pvalue > 0.01


def test_number_is_a_value_that_everybody_has():
    drawn = people({"name": "guest", "count": 3, "speed_mps": 1, "flees_after_s": 30})
    assert np.unique([(victim.speed_mps, victim.flees_after_s) for victim in drawn], axis=0).tolist() == [[1.0, 30.0]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"count": 0}, "people.groups.0.count: 0 is below 1"),
        ({"name": "west_guard", "speed": 1.0}, "people.groups.0.speed: unknown key"),
        ({"speed_mps": "fast"}, "people.groups.0.speed_mps: 'fast' is not a number or a distribution"),
        ({"speed_mps": {"kind": "gamma"}}, "people.groups.0.speed_mps"),
        (
            {"speed_mps": {"kind": "uniform", "min": 2.0, "max": 1.0}},
            "people.groups.0.speed_mps.max: 1 is below min, 2",
        ),
        (
            {"speed_mps": {"kind": "normal", "mean": 1.2, "sd": 0.5}},
            "people.groups.0.speed_mps: has values from -0.3 to",
        ),
        ({"speed_mps": {**NORMAL, "min": 1.3}}, "people.groups.0.speed_mps.mean: 1.2 is not between min, 1.3, and max"),
        ({"flees_after_s": -1.0}, "people.groups.0.flees_after_s: has values from -1 to -1; expected 0 to"),
        ({"count": 900, "region": {"center": [18, 6], "radius_m": 1.0}}, "900 people, but there is room for"),
    ],
)
def test_invalid_groups_name_key_and_value(change, message):
    with pytest.raises(ScenarioError, match=r"groups\.yaml: ") as raised:
        people({**STAFF, **change})
    assert message in str(raised.value)


def test_groups_need_an_exit_and_names_of_their_own():
    with pytest.raises(ScenarioError, match=r"people\.groups\.0\.flees: there is no exit"):
        scenario(STAFF, mission={"saved_by": "firefighter"})
    mission = scenario(STAFF).mission.model_dump(mode="json", by_alias=True)
    mission["victims"] = [{"name": "staff_3", "position": [3.0, 3.0]}]
    with pytest.raises(ScenarioError, match=r"people\.groups\.0\.name: 'staff_3' is the name of another victim"):
        scenario(STAFF, mission=mission)
    with pytest.raises(ScenarioError, match=r"people\.groups\.1\.name: 'staff' is already the name of another"):
        scenario(STAFF, STAFF)
