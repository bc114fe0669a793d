"""Grippers: a robot holds an object as if they were welded together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from robotteamsim.scenario.mujoco import Gripper
from robotteamsim.world.mujoco.bodies import robot_name

_WELD_S = 0.1
"""Time in which a gripper brings an object to its place."""


@dataclass(frozen=True)
class Grip:
    """The hold of a robot on an object.

    object_name, body_name: its name, and that of its body in the model.
    pose: of the object in the frame of the robot, as position [m] and quaternion, shape (7,).
    """

    object_name: str
    body_name: str
    pose: np.ndarray


def grip_of(data: mujoco.MjData, robot: int, body_name: str, object_name: str, gripper: Gripper) -> Grip:
    """Return the grip that lifts an object straight up. Args: robot: index of the robot's body."""
    load, pose = data.body(body_name), np.empty(7)
    place, turn = np.empty(3), np.empty(4)
    mujoco.mju_negPose(place, turn, data.xpos[robot], data.xquat[robot])
    raised = load.xpos + np.array((0.0, 0.0, gripper.lift_m))
    mujoco.mju_mulPose(pose[:3], pose[3:], place, turn, raised, load.xquat)
    return Grip(object_name, body_name, pose)


def add_grips(spec: mujoco.MjSpec, grips: Mapping[int, Grip]) -> None:
    """Add grips to a spec with all its robots and objects. Args: grips: by the ids of robots."""
    for robot_id, grip in grips.items():
        robot = robot_name(robot_id)
        weld = spec.add_equality(
            name=f"{robot}/gripper",
            type=mujoco.mjtEq.mjEQ_WELD,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=robot,
            name2=grip.body_name,
        )
        weld.data[:3], weld.data[3:10], weld.data[10] = 0.0, grip.pose, 1.0
        weld.solref[0] = _WELD_S
        spec.add_exclude(name=weld.name, bodyname1=robot, bodyname2=grip.body_name)
