"""The third dimension: heights, slip, lean, robots that tip over or leave the world."""

import math

import mujoco
import numpy as np
import pytest

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.drives import CarDrive, Drive, OmniDrive
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.mujoco import Mujoco, Wheels
from robotteamsim.scenario.sections import Laser, Odometry, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation import Simulation
from robotteamsim.world.mujoco.model import make_spec
from robotteamsim.world.mujoco.world import MujocoWorld

EMPTY = FloorPlan(name="field", bounds=Bounds(max=(20.0, 10.0)))
HASTY = Drive(max_speed_mps=3.0, max_acceleration_mps2=50.0)
BEAM = Laser(beams=1, angle_min_rad=0.0, angle_max_rad=0.1, forward_m=0.0, range_max_m=9.0)


def world_of(*robots: PlacedRobot, plan: FloorPlan = EMPTY, run: Run = Run()) -> MujocoWorld:  # noqa: B008
    return MujocoWorld(plan, robots, run)


def drive(world, *twists, steps):
    for _ in range(steps):
        world.step(twists)


def test_tyres_with_little_friction_slip():
    reached_m = []
    for friction in (0.9, 0.05):
        robot = PlacedRobot(start_pose=(2.0, 5.0, 0.0), drive=HASTY, wheels=Wheels(friction=friction))
        world = world_of(robot)
        drive(world, Twist(3.0), steps=5)
        reached_m.append(world.poses()[0].x_m - 2.0)
    # Two thirds of the weight or so is on the driven wheels: at most 0.05 g, for half a second.
    assert reached_m[1] < 0.5 * 0.05 * 9.81 * 0.5**2
    assert reached_m[0] > 3.0 * reached_m[1]


@pytest.mark.parametrize("turn_radps", [0.1, 2.0])
def test_odometry_charges_a_turn_on_the_spot_once_although_the_wheels_slip(turn_radps):
    only_turns = Odometry(alpha1=0.04, alpha2=0.0, alpha3=0.0, alpha4=0.0)
    robots = [PlacedRobot(start_pose=(4.0 * i + 2.0, 5.0, float(i)), odometry=only_turns) for i in range(3)]
    world = world_of(*robots)
    sensors = RobotSensors(world, robots, 1)
    charged_rad2 = 0.0
    for _ in range(50):
        before = [pose.yaw_rad for pose in world.poses()]
        world.step([Twist(0.0, 0.0, turn_radps)] * 3)
        turned = [after.yaw_rad - yaw for after, yaw in zip(world.poses(), before, strict=True)]
        charged_rad2 += 0.04 * np.array([math.remainder(turn, math.tau) ** 2 for turn in turned])
        readings = sensors.read()
    assert [reading.odometry.pose_covariance[5] for reading in readings] == pytest.approx(charged_rad2, rel=0.02)


def test_robot_that_brakes_leans_forward():
    world = world_of(PlacedRobot(start_pose=(2.0, 5.0, 0.0), height_m=0.6, drive=HASTY))
    drive(world, Twist(1.5), steps=10)
    rest = world.engine.lean_rad()[0]
    world.step([Twist()])
    assert world.engine.lean_rad()[0] > rest + 1e-4
    assert world.mishaps == {}


def test_tall_robot_that_brakes_hard_tips_over_and_the_world_goes_on():
    tall = PlacedRobot(start_pose=(2.0, 5.0, 0.0), radius_m=0.1, height_m=2.0, drive=HASTY)
    world = world_of(tall, PlacedRobot(start_pose=(2.0, 8.0, 0.0)))
    drive(world, Twist(3.0), Twist(0.5), steps=30)
    assert world.mishaps == {0: "tipped_over"}
    assert world.present.all()
    assert world.poses()[1].x_m == pytest.approx(3.45, abs=0.05)
    world.set_pose(0, Pose(5.0, 5.0, 0.0))
    drive(world, Twist(), Twist(), steps=1)
    assert world.mishaps == {}


def test_robot_that_leaves_the_bounds_is_removed_and_may_come_back():
    world = world_of(PlacedRobot(start_pose=(1.0, 5.0, math.pi)), PlacedRobot(start_pose=(5.0, 5.0, 0.0)))
    drive(world, Twist(0.7), Twist(), steps=30)
    assert world.mishaps == {0: "left_world"}
    assert world.present.tolist() == [False, True]
    world.spawn_robot(0)
    drive(world, Twist(), Twist(), steps=1)
    assert (world.mishaps, world.present.all()) == ({}, True)


def test_mission_reports_mishaps_and_continues():
    scenario = load(
        "garage_sar",
        [
            "run.world=mujoco",
            "mission.time_limit_s=6",
            "robots.height_m=2",
            "robots.radius_m=0.1",
            "robots.drive={max_speed_mps: 3, max_acceleration_mps2: 50, max_turn_radps: 6}",
            "control.max_step_speed_mps=3",
        ],
    )
    simulation = Simulation(scenario)
    simulation.mission.start()
    events = []
    while simulation.mission.status.state != "ended":
        events += simulation.step().events
    tipped = [event for event in events if event.kind == "robot_tipped_over"]
    assert tipped
    assert tipped[0].detail == f"robot {tipped[0].robot_id} tips over"
    assert simulation.mission.status.end == "time_limit"


def test_beam_passes_over_a_wall_that_is_lower_than_the_laser():
    plan = EMPTY.model_copy(
        update={
            "walls": (
                Wall(name="kerb", start=(5.0, 0.0), end=(5.0, 10.0), height_m=0.2),
                Wall(name="wall", start=(8.0, 0.0), end=(8.0, 10.0)),
            )
        }
    )
    robots = [
        PlacedRobot(start_pose=(2.0, y, 0.0), laser=BEAM.model_copy(update={"height_m": z}))
        for y, z in ((2.0, 0.15), (4.0, 0.25))
    ]
    world = world_of(*robots, plan=plan)
    ranges_m = [reading.ranges_m[0] for reading in RobotSensors(world, robots, 1).read()]
    assert ranges_m == pytest.approx([2.9, 5.9], abs=0.01)
    drive(world, Twist(0.5), Twist(0.5), steps=80)  # but robots drive against it
    assert [pose.x_m for pose in world.poses()] == pytest.approx([4.7, 4.7], abs=0.01)


def test_beam_of_a_robot_on_its_side_meets_the_floor():
    both = BEAM.model_copy(update={"beams": 2, "angle_max_rad": math.pi})
    tall = PlacedRobot(start_pose=(2.0, 5.0, 0.0), radius_m=0.1, height_m=2.0, drive=HASTY, laser=both)
    world = world_of(tall)
    drive(world, Twist(3.0), steps=30)
    drive(world, Twist(), steps=20)
    assert world.mishaps == {0: "tipped_over"}
    assert sorted(RobotSensors(world, [tall], 1).read()[0].ranges_m < 1.0) == [False, True]


@pytest.mark.parametrize(
    "form",
    [{}, {"drive": OmniDrive(kind="omni")}, {"drive": CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.6)}],
    ids=["differential", "omni", "car"],
)
def test_robots_have_the_mass_of_the_scenario_and_rest_on_the_floor(form):
    robot = PlacedRobot(start_pose=(5.0, 5.0, 0.0), mass_kg=7.0, **form)
    world = world_of(robot)
    body = world.engine.body_id(0)
    assert world.engine.model.body_subtreemass[body] == pytest.approx(7.0)
    drive(world, Twist(), steps=20)
    assert world.engine.data.xpos[body][2] == pytest.approx(0.0, abs=1e-3)


def test_longest_timestep_divides_a_substep():
    run = Run(mujoco=Mujoco(timestep_s=0.003))
    world = world_of(PlacedRobot(start_pose=(5.0, 5.0, 0.0)), run=run)
    assert world.engine.model.opt.timestep == pytest.approx(0.02 / 7.0)


def test_spec_is_valid_mjcf():
    scenario = load("warehouse_push")
    robots = {i: (robot, Pose(*robot.start_pose)) for i, robot in enumerate(scenario.robots)}
    spec = make_spec(scenario.plan, robots, [(obj, Pose(*obj.pose)) for obj in scenario.objects], scenario.run)
    compiled = spec.compile()
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    assert (again.nq, again.nv, again.ngeom, again.nu) == (compiled.nq, compiled.nv, compiled.ngeom, compiled.nu)
