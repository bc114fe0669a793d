"""The greedy climber, PSO and RPSO on robots: what each of them leaves out."""

from __future__ import annotations

import math

import pytest

from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.rdpso.team import Best
from robotteamsim.control.rdpso.terms import LocalBestFinder, RuledOut
from robotteamsim.geometry import Pose
from robotteamsim.interface import Task
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.simulation import Simulation

VICTIM = (9.0, 8.0)


def of(algorithm: str, **keys: float) -> dict[str, object]:
    return {"algorithm": algorithm, **keys}


def final_poses(team, hall_scenario, control: dict[str, object]) -> list[Pose]:
    """Return where the robots are after 20 s."""
    hall = team(hall_scenario(control=control))
    hall.run(20.0)
    return hall.world.poses()


def voice_of_victim(position: tuple[float, float]) -> VoiceReading:
    """Return what a robot hears of a victim: the louder the nearer, the loudest 1.5 m ahead."""
    away_m = math.dist(position, VICTIM)
    if away_m > 6.0:
        return VoiceReading(0.0, False, position, 0.0)
    share = min(1.0, 1.5 / max(away_m, 1e-9))
    loudest = tuple(a + share * (b - a) for a, b in zip(position, VICTIM, strict=True))
    return VoiceReading(10.0 - away_m, True, loudest, 10.0 - math.dist(loudest, VICTIM))


def test_local_best_is_the_voice_unless_it_is_ruled_out(hall_scenario):
    scenario = hall_scenario()
    ruled_out, carried = RuledOut(scenario), known_map(Building(scenario.plan), 0.2)
    finder = LocalBestFinder(scenario)
    voice, here = VoiceReading(5.0, True, (4.0, 4.0), 7.0), (3.0, 4.0)
    assert finder.find(carried, ruled_out.covers, voice, (16.0, 5.0), here) == Best(7.0, (4.0, 4.0))
    ruled_out.add((4.1, 4.0), (4.0, 4.0))
    best = finder.find(carried, ruled_out.covers, voice, (16.0, 5.0), here)
    # 13.04 m as the crow flies, less the radius of 1.5 m; paths on a grid are a little longer.
    assert best.value == pytest.approx(-11.54, abs=0.4)
    assert 1.3 < math.dist(best.position, here) <= 1.5
    assert finder.find(carried, ruled_out.covers, voice, None, here) is None


def test_greedy_robot_climbs_to_the_voice_and_says_nothing(team, hall_scenario):
    hall = team(hall_scenario(control=of("greedy")))
    hall.hear = voice_of_victim
    nearest_m = math.inf
    for _ in range(400):
        assert not any(decision.outbox or decision.excluded for decision in hall.step())
        nearest_m = min(nearest_m, *(math.dist((pose.x_m, pose.y_m), VICTIM) for pose in hall.world.poses()))
    assert nearest_m < 1.0


def test_greedy_robot_without_a_voice_goes_to_the_area_and_without_both_wanders(team, hall_scenario):
    hall = team(hall_scenario(control=of("greedy")))
    hall.run(40.0)
    assert min(math.dist((pose.x_m, pose.y_m), (16.0, 5.0)) for pose in hall.world.poses()) < 2.0
    hall.task = Task(running=True, epoch=2)
    goals = {decision.goal_m for _ in range(300) for decision in hall.step()}
    assert len(goals) > 3


def test_pso_has_an_inertia_and_two_coefficients(team, hall_scenario):
    poses = final_poses(team, hall_scenario, of("pso", inertia=0.7))
    for change in ({"inertia": 0.2}, {"c1": 0.5}, {"c2": 0.5}):
        assert poses != final_poses(team, hall_scenario, of("pso", **({"inertia": 0.7} | change)))


def test_rpso_is_pso_with_the_obstacle_term(team, hall_scenario):
    poses = final_poses(team, hall_scenario, of("pso", inertia=0.5))
    assert poses == final_poses(team, hall_scenario, of("rpso", c3=0.0, inertia=0.5))
    assert poses != final_poses(team, hall_scenario, of("rpso", c3=0.3, inertia=0.5))


@pytest.mark.parametrize(("algorithm", "num_excluded"), [("pso", 0), ("rpso", 0), ("dpso", 2)])
def test_only_dpso_excludes(team, hall_scenario, algorithm, num_excluded):
    mission = Mission(areas=(Area(name="here", center=(3.5, 5.0)),))
    hall = team(hall_scenario(mission=mission, control=of(algorithm)))
    hall.run(40.0)
    assert sum(decision.excluded for decision in hall.decisions) == num_excluded


def test_dpso_moves_by_pso_until_it_excludes(team, hall_scenario):
    poses = final_poses(team, hall_scenario, of("dpso", inertia=0.5))
    assert poses == final_poses(team, hall_scenario, of("pso", inertia=0.5))


def test_dpso_of_three_robots_is_not_pso_because_its_swarm_has_a_child(team, hall_scenario):
    robots = tuple(PlacedRobot(start_pose=(3.0, 4.0 + i, 0.0)) for i in range(3))

    def poses_and_swarms(algorithm: str) -> tuple[list[Pose], list[int]]:
        hall = team(hall_scenario(robots=robots, control=of(algorithm)))
        hall.run(20.0)
        return hall.world.poses(), sorted(decision.swarm for decision in hall.decisions)

    (pso, alone), (dpso, swarms) = poses_and_swarms("pso"), poses_and_swarms("dpso")
    assert alone == [0, 0, 0]
    # The only swarm gives two of its robots to the child; neither of the two could then give another one.
    assert swarms == [0, 1, 1]
    assert dpso != pso


def test_mission_of_a_dpso_ends_when_natural_selection_has_deleted_all_swarms(hall_scenario):
    nothing = Mission(time_limit_s=60.0)
    ended = Simulation(hall_scenario(mission=nothing, control=of("dpso"))).run()
    # Nothing improves: SC is 15 in iteration 15, then 15 (1 - 1/2) = 7, so it is 15 again in iteration 23. Iterations
    # begin at 0 s and last 1 s; robots judge in the step after they have sent their updates.
    assert (ended.end, ended.time_s) == ("all_excluded", pytest.approx(22.0, abs=0.25))
    assert [robot.excluded_s > 7.5 for robot in ended.robots] == [False, True]
    assert Simulation(hall_scenario(mission=nothing, control=of("pso"))).run().end == "time_limit"


def test_rdpso_of_one_memory_term_is_rpso_of_that_inertia(team, hall_scenario):
    # alpha is the weight of the newest velocity; two robots side by side keep their link, so c4 is silent.
    def poses(control: dict[str, object]) -> list:
        hall = team(hall_scenario(control=control))
        hall.run(10.0)
        return hall.world.poses()

    assert poses(of("rdpso", alpha=0.6, memory_terms=1)) == poses(of("rpso", inertia=0.6))


@pytest.mark.parametrize(
    ("algorithm", "differs"),
    [("greedy", False), ("pso", True), ("rpso", True), ("rdpso", True), ("random_walk", True)],
)
def test_path_of_a_team_is_a_function_of_the_seed(team, hall_scenario, algorithm, differs):
    def poses(seed: int) -> list:
        hall = team(hall_scenario(seed=seed, control=of(algorithm)))
        hall.run(15.0)
        return hall.world.poses()

    assert poses(5) == poses(5)
    # Greedy robots draw nothing at random.
    assert (poses(5) != poses(6)) == differs
