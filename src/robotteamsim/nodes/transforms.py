"""The newest transforms from /tf and /tf_static."""

from __future__ import annotations

import math
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from robotteamsim.nodes.inputs import Input
from robotteamsim.nodes.node import Node
from robotteamsim.recording.topics.robots import TF
from robotteamsim.recording.topics.world import LEVEL_FRAMES

MAX_LINKS = 100
"""So many transforms at most lead from one frame to another; more mean a cycle."""
NORM_ERROR = 0.01
"""Largest error of the squared norm of a quaternion."""


class _Link(NamedTuple):
    """The newest transform to a frame from its parent; stamp 0 is any time."""

    parent: str
    stamp_ns: int
    position_m: tuple[float, float, float]
    rotation: tuple[float, float, float, float]

    def matrix(self) -> np.ndarray:
        """Return parent_T_child, shape (4, 4)."""
        parent_T_child = np.eye(4)  # noqa: N806
        parent_T_child[:3, :3] = Rotation.from_quat(self.rotation).as_matrix()
        parent_T_child[:3, 3] = self.position_m
        return parent_T_child


class Transforms:
    """The newest transform to each frame. It counts until the next one comes, with any stamp."""

    def __init__(self, node: Node) -> None:
        """Subscribe."""
        self._moving: dict[str, _Link] = {}
        self._static: dict[str, _Link] = {}
        moving = Input(node, TF.name, TF.type_name, partial(_read, is_static=False))
        moving.listen(lambda _, __, links: self._moving.update(links))
        static = Input(node, LEVEL_FRAMES.name, TF.type_name, partial(_read, is_static=True), latched=True)
        static.listen(lambda _, __, links: self._static.update(links))

    def newest(self, target: str, source: str) -> tuple[tuple[int, float, float, float] | None, str]:
        """Return the place of a frame in one above it, as `tf_pose.Newest`, with the oldest stamp of its transforms."""
        target_T_source, frame = np.eye(4), source  # noqa: N806
        stamps_ns: list[int] = []
        for _ in range(MAX_LINKS):
            if frame == target:
                x_m, y_m = target_T_source[:2, 3].tolist()
                yaw_rad = math.atan2(target_T_source[1, 0], target_T_source[0, 0])
                return (min(filter(None, stamps_ns), default=0), x_m, y_m, yaw_rad), ""
            link = self._moving.get(frame) or self._static.get(frame)
            if link is None:
                return None, f"no transform leads to {frame}"
            target_T_source = link.matrix() @ target_T_source  # noqa: N806
            stamps_ns.append(link.stamp_ns)
            frame = link.parent
        return None, f"the transforms to {source} are a cycle"

    def clear(self) -> None:
        """Forget all transforms but static ones."""
        self._moving.clear()


def _read(message: Any, *, is_static: bool) -> dict[str, _Link]:
    """Return the transforms of a tf2_msgs/TFMessage, by frame. Raises: ValueError."""
    return dict(_read_link(transform, is_static) for transform in message.transforms)


def _read_link(message: Any, is_static: bool) -> tuple[str, _Link]:
    # Some programs of ROS 1 still write a slash.
    parent, child = (name.removeprefix("/") for name in (message.header.frame_id, message.child_frame_id))
    place, turn = message.transform.translation, message.transform.rotation
    position_m, rotation = (place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w)
    if not all(map(math.isfinite, position_m)) or not abs(sum(part * part for part in rotation) - 1.0) < NORM_ERROR:
        raise ValueError(f"{parent} -> {child}: expected finite numbers and a quaternion of norm 1")
    if not parent or not child or parent == child:
        raise ValueError(f"{parent!r} -> {child!r}: expected the names of two frames")
    return child, _Link(parent, 0 if is_static else message.header.stamp, position_m, rotation)
