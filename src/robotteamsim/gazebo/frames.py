"""Poses and frames of SDF as 4x4 matrices.

A pose is relative to the element around it, or to the frame that its attribute `relative_to` names (in SDF 1.6 and
earlier `frame`): a link, joint, model or explicit frame of the same model or world.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.gazebo.xml_tree import Node
from robotteamsim.scenario.yaml_text import shown

MAX_CHAIN = 50
"""Frames that are relative to each other, one after the other."""

_ROOTS = ("", "world", "__model__", "__root__")


def matrix_of(pose: Node | None) -> np.ndarray:
    """Return the matrix of a <pose>; None: no motion. Raises: ScenarioError: it is not six numbers."""
    matrix = np.eye(4)
    if pose is None or not pose.text:
        return matrix
    if pose.attributes.get("rotation_format") == "quat_xyzw":
        *place, qx, qy, qz, qw = pose.numbers(7)
        length = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
        if length < 1e-6:
            raise pose.error(f"{shown(pose.text)} has no rotation; expected a quaternion other than 0")
        matrix[:3, :3] = _of_quaternion(qx / length, qy / length, qz / length, qw / length)
    else:
        *place, roll, pitch, yaw = pose.numbers(6)
        unit = math.pi / 180.0 if pose.attributes.get("degrees") in ("true", "1") else 1.0
        matrix[:3, :3] = _about_z(yaw * unit) @ _about_y(pitch * unit) @ _about_x(roll * unit)
    matrix[:3, 3] = place
    return matrix


class Frames:
    """The named frames of a world or of a model."""

    def __init__(self, root: Node, models: Sequence[Node], pending: list[Node] | None = None) -> None:
        """Args: models: those in it, included ones too. pending: whose frames are being calculated."""
        named = [*root.all("link", "joint", "frame"), *models]
        self._nodes = {node.name: node for node in reversed(named) if node.name}
        self._known: dict[str, np.ndarray] = {}
        self._pending = [] if pending is None else pending

    def place(self, node: Node, default: np.ndarray | None = None) -> np.ndarray:
        """Return the frame of an element as a matrix in this world or model.

        Args:   default: the frame that its pose is relative to unless it names another.
        Raises: ScenarioError: an unknown frame, or one that is relative to itself.
        """
        pose, base = node.child("pose"), ""
        if pose is not None:
            base = pose.attributes.get("relative_to") or pose.attributes.get("frame", "")
        parent = self._named(base, node) if base else (np.eye(4) if default is None else default)
        placed: np.ndarray = parent @ matrix_of(pose)
        placement = node.attributes.get("placement_frame", "")
        if node.tag == "model" and placement:
            placed = placed @ np.linalg.inv(self._inside(node)._named(placement, node))
        return placed

    def _inside(self, model: Node) -> Frames:
        return Frames(model, list(model.all("model")), self._pending)

    def _named(self, name: str, user: Node) -> np.ndarray:
        """Return a frame by its name; user: the element that needs it."""
        if name in _ROOTS:
            return np.eye(4)
        if name in self._known:
            return self._known[name]
        outer, _, inner = name.partition("::")
        node = self._nodes.get(outer)
        if node is None or (inner and node.tag != "model"):
            raise user.error(f"there is no frame {shown(name)} that its pose could be relative to")
        if node in self._pending:
            raise user.error(f"frame {shown(name)} is relative to itself")
        if len(self._pending) >= MAX_CHAIN:
            raise user.error(f"more than {MAX_CHAIN} frames are relative to each other")
        self._pending.append(node)
        matrix = self.place(node, self._default(node))
        if inner:
            matrix = matrix @ self._inside(node)._named(inner, user)
        self._pending.pop()
        self._known[name] = matrix
        return matrix

    def _default(self, node: Node) -> np.ndarray:
        """Return what the pose of a joint or frame is relative to: its child link, or what it is attached to."""
        if node.tag == "joint":
            child = node.child("child")
            return self._named(child.text if child else "", node)
        return self._named(node.attributes.get("attached_to", "") if node.tag == "frame" else "", node)


def _about_x(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])


def _about_y(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def _about_z(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _of_quaternion(x: float, y: float, z: float, w: float) -> np.ndarray:
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
