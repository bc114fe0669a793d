"""What a trial did to the network of its team, from networks whose links are known."""

from __future__ import annotations

import pytest

from robotteamsim.recording.network_log import NetworkLog
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Mission, Network, PlacedRobot, Run
from robotteamsim.simulation import Simulation


@pytest.fixture
def network_of(hall_scenario):
    """Run 10 s with two robots, 2 m apart, that send a message each second; return the totals of their network."""

    def run(network: Network, **sections: object):
        mission = sections.pop("mission", Mission(time_limit_s=10.0))
        control = {"algorithm": "search"}
        log = NetworkLog()
        Simulation(hall_scenario(control=control, mission=mission, network=network, run=Run(), **sections)).run([log])
        return log.totals

    return run


def test_robots_without_links_are_split_all_the_time(network_of):
    totals = network_of(Network(link="distance", max_distance_m=1.0))
    assert totals.split_s == pytest.approx(10.0, abs=0.2)
    assert (totals.endangered_s, totals.breaks) == (0.0, 0)
    assert totals.messages_lost >= 18
    assert (totals.base_areas, totals.base_victims) == (None, None)


def test_weak_link_endangers_a_team_that_is_not_split(network_of):
    # In free space a robot at 2 m hears -54.4 dBm.
    totals = network_of(Network(endangered_below_dbm=-20.0))
    assert (totals.split_s, totals.breaks, totals.messages_lost) == (0.0, 0, 0)
    assert totals.endangered_s == pytest.approx(10.0, abs=0.2)


def test_link_that_ends_because_a_robot_leaves_is_not_broken(network_of):
    robots = tuple(PlacedRobot(start_pose=(3.0, y_m, 0.0)) for y_m in (3.0, 5.0, 7.0))
    totals = network_of(Network(), robots=robots, schedule=(ScheduledEvent(at_s=5.0, remove=2),))
    assert (totals.split_s, totals.breaks) == (0.0, 0)
