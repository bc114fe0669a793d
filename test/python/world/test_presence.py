"""Robots that leave and come while the world runs."""

import numpy as np

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Laser as LaserModel
from robotteamsim.sensing.beams import Beams
from robotteamsim.setup import resolve
from robotteamsim.simulation.stages import ScheduleStage
from robotteamsim.testing.contract.two_rooms import two_rooms
from robotteamsim.world import World

PLAN = two_rooms(motion="slide", time_s=1.0)
FORWARD = Twist(0.7)
STARTS = ((2.0, 2.0, 0.0), (3.0, 2.0, 0.0))


def world_of(*poses: tuple[float, float, float], absent: tuple[int, ...] = (), **keys: object) -> World:
    robots = [PlacedRobot(start_pose=pose, present=i not in absent) for i, pose in enumerate(poses)]
    return World(PLAN, robots, Run(), **keys)


def present(world: World) -> list[bool]:
    return world.present.tolist()


def bits(world: World) -> bytes:
    return world.core.poses().tobytes()


def test_no_beam_meets_a_robot_that_is_not_there_and_it_sees_nothing_itself():
    world = world_of(*STARTS)
    laser = LaserModel(beams=3, angle_min_rad=-1.5, angle_max_rad=1.5, range_max_m=3.0)
    beams, no_noise = Beams(world, laser.beam_model()), np.empty((0, 0))
    assert beams.scan([0], no_noise)[0, 1] < 1.0
    world.remove_robot(1)
    assert beams.scan([0, 1], no_noise)[:, 1].tolist() == [3.0, 3.0]
    world.spawn_robot(1, Pose(4.0, 2.0, 0.0))
    assert 1.5 < beams.scan([0], no_noise)[0, 1] < 2.0


def test_leaf_of_a_door_waits_for_no_robot_that_is_gone():
    world = world_of((6.0, 3.0, 0.0), (2.0, 2.0, 0.0))
    world.set_door("gate", True)
    for _ in range(20):
        world.step([Twist(), Twist()])
    assert not world.door_states().closed()["gate"]
    world.remove_robot(0)
    for _ in range(20):
        world.step([Twist(), Twist()])
    assert world.door_states().closed()["gate"]


def test_robot_that_left_has_no_effect_on_the_others():
    alone, left = world_of(STARTS[0], (9.0, 4.0, 0.0), absent=(1,)), world_of(STARTS[0], (9.0, 4.0, 0.0))
    left.remove_robot(1)
    for _ in range(30):
        for world in (alone, left):
            world.step([FORWARD, FORWARD])
        assert bits(alone) == bits(left)


def test_scheduled_robot_waits_until_its_place_is_free():
    world = world_of(*STARTS, absent=(1,))
    schedule = ScheduleStage([ScheduledEvent(at_s=0.0, spawn=1, pose=(2.3, 2.0, 0.0))])
    schedule.step(world.sim_time_ns, world)
    world.step([Twist(-0.7), Twist()])
    assert present(world) == [True, False]
    for _ in range(10):
        schedule.step(world.sim_time_ns, world)
        world.step([Twist(-0.7), Twist()])
    assert world.present.all()


def test_schedule_that_others_forestalled_changes_nothing():
    world = world_of(*STARTS)
    schedule = ScheduleStage([ScheduledEvent(at_s=0.1, remove=0), ScheduledEvent(at_s=0.2, spawn=0)])

    def step() -> None:
        schedule.step(world.sim_time_ns, world)
        world.step([Twist(), Twist()])

    world.remove_robot(0)
    step()
    world.spawn_robot(0)
    step()
    assert not present(world)[0]
    step()
    assert (present(world), world.arrivals) == ([True, True], (3, 1))


def test_reserve_of_a_team_is_its_last_robots_at_their_places():
    robots = resolve(load("garage_sar", ["robots.count=5", "robots.reserve=2"])).robots
    assert [robot.present for robot in robots] == [True, True, True, False, False]
    everybody = resolve(load("garage_sar", ["robots.count=5"])).robots
    assert [robot.start_pose for robot in robots] == [robot.start_pose for robot in everybody]
