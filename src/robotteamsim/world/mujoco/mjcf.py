"""A scenario in MJCF, the format of MuJoCo's own programs."""

from __future__ import annotations

from robotteamsim.geometry import Pose
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.world.mujoco.building import leaf_name
from robotteamsim.world.mujoco.leaves import Leaves
from robotteamsim.world.mujoco.model import make_spec
from robotteamsim.world.mujoco.shapes import about_z
from robotteamsim.world.placement import check_places, placed_robots


def mjcf(scenario: Scenario) -> str:
    """Return the model of a scenario at its start, as the world of MuJoCo compiles it, in MJCF.

    Raises: PlacementError: a robot or object has no room.
    """
    check_places(scenario)
    robots = {
        robot_id: (robot, Pose(*robot.start_pose))
        for robot_id, robot in enumerate(placed_robots(scenario))
        if robot.present
    }
    objects = [(obj, Pose(*obj.pose)) for obj in scenario.objects]
    spec, leaves = make_spec(scenario.plan, robots, objects, scenario.run), Leaves(scenario.plan)
    for index, door in enumerate(scenario.plan.doors):
        leaf, pose = spec.body(leaf_name(door)), leaves.pose(index)
        if pose is None:
            spec.delete(leaf)
        else:
            leaf.pos, leaf.quat = [pose.x_m, pose.y_m, 0.0], about_z(pose.yaw_rad)
    spec.compile()
    text: str = spec.to_xml()
    return text
