"""Missions of a team that explores a building that it does not know."""

from __future__ import annotations

import itertools
import math

import pytest

from robotteamsim.control.exploration.frontier import parse_frontier_update
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.sections import Area, Laser, Mission, Network, PlacedRobot, Victim, Voice
from robotteamsim.simulation import Simulation

ROUND = Laser(beams=361, angle_min_rad=-math.pi, angle_max_rad=math.pi, range_max_m=6.0)
STARTS = ((3.0, 4.0, 0.0), (3.0, 6.0, 0.0))
ANN = Victim(name="ann", position=(17.0, 8.5))
EAST, WEST = Area(name="east", center=(16.0, 5.0)), Area(name="west", center=(5.0, 5.0))
CORRIDOR = Wall(name="low", start=(0.0, 4.0), end=(20.0, 4.0)), Wall(name="high", start=(0.0, 6.0), end=(20.0, 6.0))
EXPLORED = "everything within reach is explored"


class Run:
    """A mission, with what robots sent. updates: of each robot, in the order of time; goals: theirs."""

    def __init__(self, scenario):
        self.simulation = Simulation(scenario)
        self.updates = [[] for _ in scenario.robots]
        self.events, self.records = [], []
        self.simulation.mission.start()
        while self.simulation.mission.status.state != "ended":
            record = self.simulation.step()
            self.records.append(record)
            self.events += record.events
            for message in itertools.chain(*(decision.outbox for decision in record.decisions)):
                update = parse_frontier_update(message.payload)
                if update is not None:
                    self.updates[update.robot_id].append(update)
        assert set(self.simulation.controllers.faults) == {""}

    @property
    def goals(self):
        return [[update.goal for update in updates] for updates in self.updates]

    @property
    def status(self):
        return self.simulation.mission.status

    @property
    def ending(self):
        return self.events[-1].detail

    def closest_m(self, robot_id, place):
        return min(math.dist(record.state.positions_m[robot_id], place) for record in self.records)


@pytest.fixture
def run(hall_scenario):
    """Return a function that runs a mission in the hall, whose plan the robots do not know."""

    def run(walls=(), control=None, starts=STARTS, plan=None, noise_db=40.0, network=None, **fields):
        hall = plan or hall_scenario().plan
        mission = {"victims": (), "areas": (), "time_limit_s": 400.0} | fields
        return Run(
            hall_scenario(
                plan=hall.model_copy(update={"walls": (*hall.walls, *walls)}),
                robots=tuple(PlacedRobot(start_pose=start, laser=ROUND) for start in starts),
                mission=Mission(**mission),
                control={"algorithm": "frontier", "map": "unknown", **(control or {})},
                voice=Voice(noise_db=noise_db),
                network=network or Network(),
            )
        )

    return run


def _box(x_m, y_m, half_m):
    corners = [(x_m + a * half_m, y_m + b * half_m) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    return [
        Wall(name=f"{half_m:.2f}_{i}", start=start, end=end)
        for i, (start, end) in enumerate(itertools.pairwise(corners))
    ]


def _wall(x_m, from_m, to_m):
    return Wall(name=f"wall_{x_m:g}_{from_m:g}", start=(x_m, from_m), end=(x_m, to_m))


@pytest.mark.parametrize("choice", ["gain_over_path", "nearest", "cost_utility", "rrt"])
def test_team_sees_the_room_behind_a_wall_and_says_that_all_is_explored(run, choice):
    mission = run(walls=[_wall(12.0, 0.0, 8.0)], control={"choice": choice})
    assert mission.status.end == "search_over"
    assert mission.ending.endswith(f"{EXPLORED}; 0/0 areas, 0/0 victims")
    # Its corner is only seen from behind the wall.
    assert min(mission.closest_m(robot_id, (13.0, 5.0)) for robot_id in range(2)) < 6.0


def test_robots_of_a_team_choose_different_ends_of_a_corridor_and_uncoordinated_ones_the_same(run):
    starts = (8.0, 4.6, 0.0), (8.0, 5.4, 0.0)  # more is to be seen to the right

    def apart_m(coordinated):
        goals = run(walls=CORRIDOR, starts=starts, control={"coordinated": coordinated}).goals
        return [math.dist(*pair) for pair in zip(*goals, strict=True) if None not in pair][4:8]

    assert min(apart_m(coordinated=True)) > 6.0
    assert max(apart_m(coordinated=False)) < 3.0


def test_robot_that_is_shut_in_is_done(run):
    mission = run(walls=_box(3.0, 4.0, 1.0), starts=STARTS[:1])
    assert mission.status.end == "search_over"
    assert mission.status.time_s < 30.0


def test_robot_without_room_to_move_is_done(run):
    walls = [wall for ring in range(4) for wall in _box(3.0, 4.0, 0.35 + 0.4 * ring)]
    mission = run(walls=walls, starts=STARTS[:1], areas=(EAST,))
    assert mission.status.end == "search_over"
    assert f"{EXPLORED}; east cannot be reached" in mission.ending


def test_plain_without_walls_is_explored_up_to_its_bounds(run):
    plain = FloorPlan(name="plain", bounds=Bounds(min=(0.0, 0.0), max=(20.0, 10.0)))
    mission = run(plan=plain)
    assert mission.status.end == "search_over"
    assert EXPLORED in mission.ending


def test_victim_who_is_heard_on_the_way_is_saved(run):
    mission = run(victims=(ANN,), noise_db=10.0)
    assert mission.status.victims == ("saved",)


def test_area_behind_walls_is_given_up_and_the_others_are_explored(run):
    mission = run(walls=_box(16.0, 5.0, 2.5), areas=(EAST, WEST))
    assert mission.status.areas_explored == 1
    assert f"{EXPLORED}; east cannot be reached" in mission.ending


@pytest.mark.parametrize("order", ["given", "nearest"])
@pytest.mark.parametrize("starts", [STARTS, STARTS[:1]])
def test_floor_behind_the_last_area_does_not_keep_robots_from_it(run, starts, order):
    door = Area(name="door", center=(12.0, 5.0))  # all paths to the corners of the room on the right lead through it
    mission = run(walls=[_wall(12.0, 0.0, 4.3), _wall(12.0, 5.7, 10.0)], areas=(door,), starts=starts, area_order=order)
    assert mission.status.end == "areas_explored"
    assert mission.status.time_s < 60.0
    # It was only kept out of for a while.
    assert not any(decision.done for record in mission.records for decision in record.decisions)


@pytest.mark.parametrize("order", ["given", "nearest"])
def test_areas_are_explored_and_the_last_one_after_everything(run, order):
    south = Area(name="south", center=(10.0, 2.0))
    mission = run(areas=(WEST, south, EAST), area_order=order)
    assert mission.status.end == "areas_explored"


def test_room_that_is_seen_through_a_gap_too_narrow_for_a_robot_does_not_hold_it_up(run):
    narrow = [_wall(12.0, 0.0, 4.8), _wall(12.0, 5.2, 10.0)]
    mission = run(walls=narrow)
    assert EXPLORED in mission.ending
    assert mission.status.time_s < 120.0


def test_equal_seeds_give_equal_bits(run):
    first, second = (run(walls=[_wall(12.0, 0.0, 8.0)], control={"choice": "rrt"}) for _ in range(2))
    assert len(first.records) == len(second.records)
    assert all(
        (a.state.true_pose == b.state.true_pose).all() for a, b in zip(first.records, second.records, strict=True)
    )


def test_robots_that_follow_a_voice_together_leave_it_to_one_of_them(run):
    victims = (Victim(name="one", position=(12.0, 5.0)),)
    mission = run(starts=((4.0, 4.0, 0.0), (4.0, 6.0, 0.0)), victims=victims, noise_db=10.0)
    assert mission.status.victims_saved == 1
    following = [tuple(update.voice is True for update in both) for both in zip(*mission.updates, strict=True)]
    # Robots perceive a voice around themselves: they notice that it is the same one as they come together.
    assert 1 <= sum(all(both) for both in following) < 0.4 * sum(any(both) for both in following)


def test_robots_out_of_reach_meet_again_at_the_start(run):
    short = Network(link="distance", max_distance_m=5.0)
    plan = FloorPlan(name="long", bounds=Bounds(max=(60.0, 10.0)))
    walls = tuple(Wall(name=f"y_{y:g}", start=(0.0, y), end=(60.0, y)) for y in (4.0, 6.0))
    starts = (29.0, 5.0, math.pi), (31.0, 5.0, 0.0)

    def first_silence_s(rendezvous_s):
        control = {"rendezvous_s": rendezvous_s}
        mission = run(walls=walls, plan=plan, starts=starts, network=short, control=control)
        apart = [not record.network.adjacency[0, 1] for record in mission.records]
        return 0.1 * next(len(list(group)) for is_apart, group in itertools.groupby(apart) if is_apart)

    assert first_silence_s(20.0) < 0.75 * first_silence_s(None)
