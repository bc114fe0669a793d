"""Imports the static models of a Gazebo world as a floor plan."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from robotteamsim.errors import ScenarioError
from robotteamsim.gazebo.included import ModelLibrary
from robotteamsim.gazebo.walls import WallReader
from robotteamsim.gazebo.xml_tree import Node, read_tree
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.problems import checked
from robotteamsim.wording import printable

_HOME_MODELS = Path(".gazebo", "models")
"""Where Gazebo keeps models, in the home folder."""

_LONGEST_LIST = 300
"""Of names in a note [characters]."""


@dataclass(frozen=True, slots=True)
class GazeboImport:
    """The floor plan of a world, and notes on what it lacks, one line each."""

    plan: FloorPlan
    notes: tuple[str, ...]


def import_world(
    world: str | os.PathLike[str], model_folders: Sequence[Path] = (), *, strict: bool = False
) -> GazeboImport:
    """Return the floor plan of a world in SDF: its static shapes on the floor, at height 0.

    Upright boxes and rectangles at most 0.8 m thick and at least twice as long become walls; other boxes, cylinders and
    polylines become blocks. Doors come back from worlds of `export_world`. The bounds are those of the floor that
    `export_world` writes, or else those of the solids.

    Args:   model_folders: searched for included models, before the world's folder and Gazebo's own.
            strict: whether a shape that cannot become a wall or block is an error, not a note.
    Raises: ScenarioError: one line with file, line and what was expected.
    """
    path = Path(world)
    file = os.fspath(world)
    scene = _scene(read_tree(path, file), file)
    library = ModelLibrary([*model_folders, path.parent, Path.home() / _HOME_MODELS])
    reader = WallReader(library, strict)
    reader.read(scene)
    if not reader.solids:
        reason = f"; {reader.notes[0]}" if reader.notes else ""
        raise ScenarioError(f"{file}: no static box, cylinder or polyline stands on the floor{reason}")
    low, high = reader.bounds_m
    keys = {
        "name": printable(path.stem)[:MAX_NAME_CHARACTERS],
        "bounds": {"min": low, "max": high},
        "walls": reader.walls,
        "blocks": reader.blocks,
        "doors": reader.doors,
    }
    plan = checked(FloorPlan, keys, place=f"{file}: ")
    return GazeboImport(plan, (*reader.notes, *_moving(reader.moving, file)))


def _scene(root: Node, file: str) -> Node:
    """Return the world of a file, or the file itself if it has models only. Raises: ScenarioError."""
    if root.tag != "sdf":
        raise ScenarioError(f"{root.place}: <{printable(root.tag)}> is not a world of Gazebo; expected <sdf>")
    worlds = list(root.all("world"))
    if len(worlds) > 1:
        raise worlds[1].error(f"{file} has {len(worlds)} worlds; expected one")
    if not worlds and not list(root.all("model")):
        raise root.error("has neither a <world> nor a <model>")
    return worlds[0] if worlds else root


def _moving(names: Sequence[str], file: str) -> list[str]:
    if not names:
        return []
    listed = textwrap.shorten(", ".join(names), _LONGEST_LIST, placeholder=f" ... ({len(names)} in all)")
    return [f"{file}: omitted, because they are not static: {listed}"]
