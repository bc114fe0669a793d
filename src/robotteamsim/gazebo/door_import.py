"""The doors of an exported world as doors of a floor plan."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from robotteamsim.gazebo.frames import matrix_of
from robotteamsim.gazebo.names import WORLD_PLUGIN
from robotteamsim.gazebo.xml_tree import Node
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.scenario.problems import checked


def door_settings(scene: Node) -> dict[str, Node]:
    """Return the settings of doors in the world plugin, by model. Raises: ScenarioError: one has no model."""
    plugins = [plugin for plugin in scene.all("plugin") if plugin.attributes.get("filename") == WORLD_PLUGIN]
    return {door.required("model").text: door for plugin in plugins for door in plugin.all("door")}


def read_door(name: str, model: Node, matrix: np.ndarray, setting: Node) -> Door:
    """Return the door of a model that `door_model` has made.

    Args:   matrix: of the model's frame, which is that of the leaf at the start. setting: in the world plugin.
    Raises: ScenarioError: one line with file, line and what was expected.
    """
    collision = model.required("link").required("collision")
    _, thickness_m, leaf_m = collision.required("geometry").required("box").required("size").lengths(3)
    middle_x, _, middle_z = matrix_of(collision.child("pose"))[:3, 3].tolist()
    length_m, closed = 2.0 * middle_x, setting.required("closed").flag()
    motion, opens_by = _motion(model.required("joint"), closed)
    x, y, yaw = float(matrix[0, 3]), float(matrix[1, 3]), math.atan2(matrix[1, 0], matrix[0, 0])
    if not closed and motion == "swing":
        yaw -= opens_by
    if not closed and motion == "slide":
        x, y = x - opens_by * math.cos(yaw), y - opens_by * math.sin(yaw)
    end = (x + length_m * math.cos(yaw), y + length_m * math.sin(yaw))
    keys: Mapping[str, Any] = {
        "name": name,
        "from": [round(value, 6) for value in (x, y)],
        "to": [round(value, 6) for value in end],
        "kind": setting.required("kind").text,
        "closed": closed,
        "thickness_m": round(thickness_m, 6),
        "height_m": round(middle_z + 0.5 * leaf_m, 6),
        "motion": motion,
        **({"time_s": setting.required("time_s").numbers(1)[0]} if motion != "instant" else {}),
        **({"angle_rad": opens_by} if motion == "swing" else {}),
    }
    return checked(Door, keys, place=f"{model.place}: {model.label}: ")


def _motion(joint: Node, closed: bool) -> tuple[str, float]:
    """Return how a leaf moves, and the position of its joint when open, if that is 0 when closed [m or rad]."""
    axis = joint.required("axis")
    limit, (_, _, up) = axis.required("limit"), axis.required("xyz").numbers(3)
    travel = sum(limit.required(key).numbers(1)[0] for key in ("lower", "upper"))
    opens_by = travel if closed else -travel
    if joint.attributes.get("type") == "revolute":
        return "swing", opens_by
    return ("instant" if up else "slide"), opens_by
