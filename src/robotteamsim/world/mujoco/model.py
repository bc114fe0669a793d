"""The MuJoCo model of a plan, its robots and its objects, as a spec that is compiled or written as MJCF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
from msgspec.structs import astuple

from robotteamsim.errors import PhysicsError
from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.world.mujoco.appearance import set_appearance
from robotteamsim.world.mujoco.bodies import add_object, add_robot
from robotteamsim.world.mujoco.building import add_building, leaf_name
from robotteamsim.world.mujoco.cameras import cameras_of
from robotteamsim.world.mujoco.leaves import Leaves
from robotteamsim.world.mujoco.lights import add_lights
from robotteamsim.world.mujoco.ramps import add_ramps, ground_m
from robotteamsim.world.mujoco.shapes import about_z


def steps_per_substep(run: Run) -> int:
    """Return the number of MuJoCo's steps in a physics substep of a run."""
    substep_s = run.step_s / run.physics_substeps
    return max(1, -int(-(substep_s / run.mujoco.timestep_s - 1e-9) // 1))


def make_spec(
    plan: FloorPlan,
    robots: Mapping[int, tuple[PlacedRobot, Pose]],
    objects: Sequence[tuple[MovableObject, Pose]],
    run: Run,
) -> mujoco.MjSpec:
    """Return the spec of a world: the floor and the building, then robots and objects, in their orders, at their poses.

    Args: robots: those that are present, by id. The leaves of doors are closed.
    """
    spec = mujoco.MjSpec()
    spec.modelname = plan.name
    _set_options(spec, run.step_s / run.physics_substeps / steps_per_substep(run))
    cameras = [camera for robot, _ in robots.values() for camera in cameras_of(robot)]
    set_appearance(spec, plan, cameras, run.mujoco.lights)
    add_lights(spec, run.mujoco.lights)
    add_building(spec, plan, run.mujoco.body_friction)
    ramps = run.mujoco.ramps
    for robot_id, (robot, pose) in robots.items():
        add_robot(spec, robot_id, robot, pose, ground_m(ramps, robot.body_at(astuple(pose))), run.mujoco.body_friction)
    for obj, pose in objects:
        add_object(spec, obj, pose, ground_m(ramps, obj.body_at(astuple(pose))))
    add_ramps(spec, ramps)
    return spec


def start_spec(scenario: Scenario, robots: Mapping[int, PlacedRobot]) -> mujoco.MjSpec:
    """Return the spec of a scenario at the start, with these robots, by id, at their start poses."""
    placed = {robot_id: (robot, Pose(*robot.start_pose)) for robot_id, robot in robots.items()}
    spec = make_spec(scenario.plan, placed, [(obj, Pose(*obj.pose)) for obj in scenario.objects], scenario.run)
    leaves = Leaves(scenario.plan)
    for index, door in enumerate(scenario.plan.doors):
        leaf, pose = spec.body(leaf_name(door)), leaves.pose(index)
        if pose is None:
            spec.delete(leaf)
        else:
            leaf.pos, leaf.quat = [pose.x_m, pose.y_m, 0.0], about_z(pose.yaw_rad)
    return spec


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Return the model of a specification.

    Raises: PhysicsError: MuJoCo refuses a body, such as one without mass, or may not start its threads.
    """
    try:
        return spec.compile()
    except RuntimeError as error:
        limits = "see `ulimit -u` and `ulimit -s`, the limits of threads and of their stacks"
        raise PhysicsError(f"MuJoCo cannot build the world: {error}; {limits}") from None
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise PhysicsError(f"MuJoCo rejects a robot or object (too small or too light?): {reason}") from None


def mjcf(scenario: Scenario, team: Sequence[PlacedRobot]) -> str:
    """Return a scenario and its team at the start in MJCF, the format of MuJoCo's own programs."""
    spec = start_spec(scenario, {robot_id: robot for robot_id, robot in enumerate(team) if robot.present})
    compiled(spec)
    text: str = spec.to_xml()
    return text


def _set_options(spec: mujoco.MjSpec, timestep_s: float) -> None:
    option = spec.option
    option.timestep = timestep_s
    # Motors of light wheels are stiff. The other integrators compute the friction of tyres as if they were not.
    option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 10.0  # tyres creep less under a steady load
    # A state that is not finite is an error of the simulation, and not a reason to start again.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
