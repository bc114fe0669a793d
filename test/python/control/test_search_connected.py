"""A searching team that stays connected: its predicted links, who goes first, and missions without a split."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.search.cells import NO_CELL, cell_grid, cell_paths
from robotteamsim.control.search.connected import ConnectedTeam, predicted_links
from robotteamsim.control.search.goals import Approach
from robotteamsim.control.search.team import SearchUpdate, Teammates, update_of
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Observation
from robotteamsim.network import EVERYBODY, Message
from robotteamsim.recording.network_log import NetworkLog
from robotteamsim.scenario import load
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Area, Mission, Network, PlacedRobot, Victim, Voice
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

NEAR = Network(link="distance", max_distance_m=6.0)
CONNECTED = {"algorithm": "search", "network": "connected"}
EAST, WEST = Area(name="east", center=(16.0, 5.0)), Area(name="west", center=(5.0, 5.0))
ANN, BOB = Victim(name="ann", position=(9.0, 4.0)), Victim(name="bob", position=(17.0, 8.5))
ALICE_AND_BASE = (PlacedRobot(start_pose=(9.0, 5.0, 0.0)), PlacedRobot(start_pose=(10.0, 5.0, 0.0)))


@pytest.fixture
def hall(hall_scenario):
    """The hall with links up to 6 m, its cells, and the paths between them."""
    scenario = hall_scenario(control=CONNECTED, network=NEAR)
    grid = cell_grid(scenario)
    return resolve(scenario), grid, cell_paths(Building(scenario.plan), 0.2, grid, (), None)


@pytest.fixture
def team_of(hall):
    """Make the team of a robot with an id, and its links."""
    setup, grid, paths = hall

    def make(robot_id: int) -> tuple[Teammates, ConnectedTeam]:
        team = Teammates(robot_id, given_up_s=30.0)
        connected = ConnectedTeam(robot_id, setup, grid, team)
        connected.use((), paths)
        return team, connected

    return make


@pytest.fixture
def run(hall_scenario):
    """Run a mission in the hall; return its status and what it did to the network."""

    def run(control=CONNECTED, walls=(), schedule=(), robots=None, **fields):
        hall = hall_scenario().plan
        scenario = hall_scenario(
            plan=hall.model_copy(update={"walls": (*hall.walls, *walls)}),
            mission=Mission(**({"victims": (ANN, BOB), "areas": (EAST, WEST), "time_limit_s": 300.0} | fields)),
            control=control,
            voice=Voice(noise_db=60.0),
            network=NEAR,
            schedule=schedule,
            **({"robots": robots} if robots else {}),
        )
        simulation, log = Simulation(scenario), NetworkLog()
        simulation.run([log])
        assert set(simulation.controllers.faults) == {""}
        return simulation.mission.status, log.totals

    return run


def _update(robot_id: int, at: int, work: str = "search", goal: int = NO_CELL, wanted: int = NO_CELL) -> SearchUpdate:
    return SearchUpdate(robot_id, (0.0, 0.0), at, work, goal, None, None, 0.0, (), "", wanted=wanted)


def test_link_is_sure_if_it_is_likely_from_all_cells_around_both_ends(hall):
    setup, grid, _ = hall
    scenario = setup.scenario
    key = ((), scenario.radio.model_dump_json(), NEAR, 3.0)
    sure, likely = predicted_links(Building(scenario.plan), 0.2, grid, *key)
    start = grid.cell_of((5.5, 5.5))
    for away_m, expected in ((4.0, (True, True)), (5.0, (False, True)), (7.0, (False, False))):
        cell = grid.cell_of((5.5 + away_m, 5.5))
        assert (bool(sure[start, cell]), bool(likely[start, cell])) == expected
    assert np.array_equal(sure, sure.T)
    assert not np.any(sure & ~likely)


@pytest.mark.parametrize(
    ("margin_db", "loss", "linked"), [(0.0, "none", True), (8.0, "none", False), (0.0, "signal", False)]
)
def test_link_by_signal_needs_the_margin_and_loses_few_messages(hall_scenario, margin_db, loss, linked):
    # A 40 cm wall costs 3.9 dB; 10 m in free space 70.6 dB: -74.5 dBm, at which 45 % of the messages are lost.
    scenario = hall_scenario(network=Network(lost_below_dbm=-80.0, endangered_below_dbm=-70.0, loss=loss))
    wall = Wall(name="middle", start=(10.0, 0.0), end=(10.0, 10.0), thickness_m=0.4)
    plan = scenario.plan.model_copy(update={"walls": (*scenario.plan.walls, wall)})
    grid = cell_grid(hall_scenario(control=CONNECTED))
    key = ((), scenario.radio.model_dump_json(), scenario.network, margin_db)
    _, likely = predicted_links(Building(plan), 0.2, grid, *key)
    assert bool(likely[grid.cell_of((5.5, 5.5)), grid.cell_of((15.5, 5.5))]) is linked


def test_robot_may_choose_only_what_is_linked_to_the_goal_of_one_that_goes_first(hall, team_of):
    _, grid, _ = hall
    at, goal = grid.cell_of((3.5, 5.5)), grid.cell_of((15.5, 5.5))
    team, connected = team_of(1)
    assert connected.linked("search") is None  # Nobody is there.
    team.hear(_update(2, at, "search", goal), 0.0)
    assert connected.linked("search") is None  # A higher id comes later,
    team.hear(_update(2, at, "voice", goal), 0.0)
    linked = connected.linked("search")  # but a voice goes first.
    assert linked[grid.cell_of((12.5, 5.5))]
    assert not linked[grid.cell_of((8.5, 5.5))]
    team.hear(_update(3, at, "wait"), 0.0)
    assert connected.linked("search")[grid.cell_of((8.5, 5.5))]  # The robot without work can be a relay.


def test_robot_stops_where_it_would_lose_another_and_comes_if_another_would_lose_it(hall, team_of):
    _, grid, paths = hall
    near, far = grid.cell_of((3.5, 5.5)), grid.cell_of((16.5, 5.5))
    position, target = paths.place_of(grid.cell_of((7.5, 5.5))), paths.place_of(far)
    at = grid.cell_of(position)

    def steer(robot_id: int, update: SearchUpdate):
        team, connected = team_of(robot_id)
        team.hear(update, 0.0)
        return connected.steer(position, at, "search", far, target, paths, 0.0), connected.wanted

    ahead, wanted = steer(0, _update(1, near))
    assert ahead is None  # 4 m is the longest sure link.
    assert paths.place_of(wanted)[0] > position[0]  # But it says where it wants to be.
    ahead, _ = steer(1, _update(0, near, wanted=near - 2))
    assert ahead[0] < position[0]


def test_robot_whose_links_are_only_likely_breaks_none_of_them(hall, team_of):
    # 5 m from the one that goes first and 6 m from the other: a step to the first would lose the other.
    _, grid, paths = hall
    position = paths.place_of(grid.cell_of((7.5, 5.5)))
    at = grid.cell_of(position)
    team, connected = team_of(1)
    team.hear(_update(0, grid.cell_of((2.5, 5.5))), 0.0)
    team.hear(_update(2, grid.cell_of((13.5, 5.5))), 0.0)
    assert connected.steer(position, at, "wait", NO_CELL, None, paths, 0.0) is None
    assert paths.place_of(connected.wanted)[0] < position[0]  # It says where it wants to be.


def test_robot_that_loses_another_goes_back_to_where_it_last_heard_it(hall, team_of):
    _, grid, paths = hall
    home, later = grid.cell_of((5.5, 5.5)), grid.cell_of((8.5, 5.5))
    team, connected = team_of(0)
    team.hear(_update(1, grid.cell_of((3.5, 5.5))), 0.0)
    for time_s, cell in ((0.0, home), (2.0, later), (3.0, later)):
        connected.steer(paths.place_of(cell), cell, "wait", NO_CELL, None, paths, time_s)
    ahead = connected.steer(paths.place_of(later), later, "wait", NO_CELL, None, paths, 4.0)
    assert ahead == paths.place_of(home)
    # There it waits for the other one, whose id is higher.
    assert connected.steer(ahead, home, "wait", NO_CELL, None, paths, 5.0) is None


def test_team_comes_to_a_robot_that_has_been_held_for_long(hall, team_of):
    # Robot 1 can go no farther west without losing robot 0, which goes first, and it is 4 m away.
    _, grid, paths = hall
    west, east = grid.cell_of((6.5, 5.5)), grid.cell_of((10.5, 5.5))
    team, held = team_of(1)
    team.hear(_update(0, east), 0.0)
    since_s = []
    for time_s in range(30):
        team.hear(_update(0, east), time_s)
        target = paths.place_of(west - 4)
        assert held.steer(paths.place_of(west), west, "search", west - 4, target, paths, time_s) is None or time_s > 5
        since_s += [time_s] if held.is_long_held else []
        held._patience.note(-100.0)  # it does not drive on over likely links
    # progress_timeout_s = 20: held from 0 s on, for the 20th time at 19 s.
    assert since_s == list(range(19, 30))
    steps = []
    for is_held in (msgspec.UNSET, True):
        team, first = team_of(0)
        team.hear(msgspec.structs.replace(_update(1, west, wanted=west - 1), held=is_held), 0.0)
        target = paths.place_of(east + 4)
        steps.append(first.steer(paths.place_of(east), east, "search", east + 4, target, paths, 0.0))
    assert steps[0] is None
    assert steps[1][0] < paths.place_of(east)[0]


def test_of_two_robots_that_are_held_for_long_the_one_that_goes_first_is_helped(hall, team_of):
    # They are 4 m apart, the longest sure link, and each wants to go away from the other.
    _, grid, paths = hall
    west, east = grid.cell_of((6.5, 5.5)), grid.cell_of((10.5, 5.5))
    steps = []
    for own, at, other in ((0, east, west), (1, west, east)):
        team, connected = team_of(own)
        away = 1 if at == east else -1
        team.hear(msgspec.structs.replace(_update(1 - own, other, wanted=other - away), held=True), 0.0)
        connected._long_patience.note(100.0)
        assert len(connected._placings("search")) == 1 + own  # The team as it is, and with who goes first moved, once.
        steps.append(connected.steer(paths.place_of(at), at, "search", at + 4 * away, paths.place_of(at), paths, 0.0))
    assert steps[0] is None
    assert steps[1][0] > paths.place_of(west)[0]


def test_time_in_which_a_robot_waits_for_others_is_not_a_lack_of_progress(hall, team_of):
    setup, grid, paths = hall
    at, far = grid.cell_of((6.5, 5.5)), grid.cell_of((13.5, 5.5))
    team, first = team_of(0)
    for apart, waits in ((grid.cell_of((8.5, 5.5)), False), (far, True)):
        team.hear(_update(1, apart), 0.0)
        first.steer(paths.place_of(at), at, "voice", at - 3, paths.place_of(at - 3), paths, 0.0)
        assert first.waits is waits
    approach = Approach(setup.scenario.control, speed_mps=0.5)
    going = []
    for time_s in range(50):
        going.append(approach.goes_on((3.5, 5.5), 3.0, time_s, was_on=time_s > 0))
        if time_s < 15:
            approach.pause(1.0)
    # Given up 20 s after the last pause, at 15 s.
    assert going.index(False) == 36


def test_team_whose_radio_reaches_6_m_does_all_and_never_splits(run):
    status, network = run(control={"algorithm": "search"})
    assert network.split_s > 5.0
    status, network = run()
    assert status.end == "areas_explored"
    assert status.victims == ("saved", "saved")
    assert (network.split_s, network.breaks, network.messages_lost) == (0.0, 0, 0)


def test_team_goes_around_a_wall_together(run):
    # With the wall, the two ways around it are 10 m apart.
    walls = [Wall(name="middle", start=(6.0, 5.0), end=(14.0, 5.0))]
    status, network = run(walls=walls, victims=(ANN, Victim(name="bob", position=(12.0, 7.0))))
    assert (status.end, status.victims) == ("areas_explored", ("saved", "saved"))
    assert network.split_s == 0.0


def test_team_gives_up_a_robot_that_is_gone(run):
    status, _ = run(schedule=(ScheduledEvent(at_s=8.0, remove=0),))
    assert (status.end, status.victims) == ("areas_explored", ("saved", "saved"))


def test_searcher_keeps_its_link_to_the_base_and_does_what_it_can_reach(run):
    # The base is at (10, 5): a robot alone reaches 4 m, so the area at 18 m is out of its reach.
    areas = (Area(name="near", center=(13.0, 5.0)), Area(name="far", center=(18.0, 5.0), radius_m=1.0))
    status, network = run(robots=ALICE_AND_BASE, base=1, victims=(ANN,), areas=areas, time_limit_s=60.0)
    assert (status.victims, status.explored) == (("saved",), (True, False))
    assert network.split_s == 0.0
    assert (network.base_areas, network.base_victims) == (1, 1)


def test_free_team_sends_the_same_bytes_as_before():
    update = msgspec.structs.replace(_update(1, 3), wanted=msgspec.UNSET)
    assert "wanted" not in update.to_json()
    assert '"wanted":5' in msgspec.structs.replace(update, wanted=5).to_json()


def test_too_many_cells_for_predicted_links_are_an_error():
    with pytest.raises(ScenarioError, match=r"control.most_cells: 20000 is above 10000"):
        load("garage_sar", ["control.algorithm=search", "control.network=connected", "control.most_cells=20000"])


@pytest.mark.slow
def test_garage_without_a_split_takes_at_most_twice_the_time(network_of_garage):
    free, connected = (network_of_garage(mode) for mode in ("free", "connected"))
    assert free[1].split_s > 1.0
    assert connected[1].split_s == 0.0
    assert connected[0].victims_saved == free[0].victims_saved == 4
    assert connected[0].areas_explored == 5
    assert connected[0].time_s < 2.0 * free[0].time_s


@pytest.fixture
def network_of_garage():
    """Run the garage at 30 dB with a free or a connected team."""

    def run(mode: str):
        settings = ["control.algorithm=search", f"control.network={mode}", "voice.noise_db=30", "run.seed=2"]
        simulation, log = Simulation(load("garage_sar", settings)), NetworkLog()
        simulation.run([log])
        return simulation.mission.status, log.totals

    return run


def test_message_with_a_wanted_cell_outside_the_grid_is_ignored():
    scenario = load("garage_sar", ["control.algorithm=search", "control.network=connected"])
    simulation, second = Simulation(scenario), make_controller(1, resolve(scenario))
    for _ in range(20):
        record = simulation.step()
        updates = [update_of(message) for message in record.decisions[0].outbox]
        wrong = [msgspec.structs.replace(update, wanted=60_000, work="voice") for update in updates if update]
        observation = Observation(1, record.sim_time_ns, record.readings[1], record.voices[1])
        second.step(observation, [Message(0, EVERYBODY, each.to_json()) for each in wrong], record.mission.task)
