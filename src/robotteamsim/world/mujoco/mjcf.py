"""A scenario in MJCF, the format of MuJoCo's own programs."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.geometry import Pose
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.mujoco.building import leaf_name
from robotteamsim.world.mujoco.leaves import Leaves
from robotteamsim.world.mujoco.model import make_spec
from robotteamsim.world.mujoco.shapes import about_z


def mjcf(scenario: Scenario, team: Sequence[PlacedRobot]) -> str:
    """Return the model of a scenario and its team at the start, as the world of MuJoCo compiles it, in MJCF."""
    robots = {robot_id: (robot, Pose(*robot.start_pose)) for robot_id, robot in enumerate(team) if robot.present}
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
