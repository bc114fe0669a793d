"""The models of a world as walls, blocks and doors."""

from __future__ import annotations

import numpy as np
from pydantic import ValidationError

from robotteamsim.gazebo.door_import import door_settings, read_door
from robotteamsim.gazebo.frames import Frames
from robotteamsim.gazebo.included import ModelLibrary, describe, is_without_walls
from robotteamsim.gazebo.names import BLOCKS, DOOR, FLOOR, PILLARS, WALLS, UniqueNames
from robotteamsim.gazebo.outlines import Outline, ShapeError, outline_of
from robotteamsim.gazebo.xml_tree import Node
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.floor_plan import Block, Door, Wall
from robotteamsim.scenario.plan import Corners, wall_corners
from robotteamsim.scenario.problems import problems
from robotteamsim.scenario.rectangles import Rectangle, in_micrometres, rectangle_of
from robotteamsim.scenario.yaml_text import shown
from robotteamsim.wording import printable

MAX_THICKNESS_M = 0.8
"""Thicker ones are blocks."""

LEAST_SLENDERNESS = 2.0
"""Walls are at least so many times as long as thick; others are blocks."""

STANDING_M = 0.5
"""What begins above this height does not stand on the floor: a beam, or the lintel of a door."""

FLAT_M = 0.02
"""What ends below this height is a part of the floor."""

MAX_PARTS = 200_000
"""Models, links and collisions; included models can multiply."""

_MAX_HEIGHT_M = 20.0
_MAX_LEVELS = 50


class WallReader:
    """Collects the walls and blocks of a world, and its doors if `export_world` has written them.

    notes:  what could not become a wall, one line each. moving: the names of models that are not static.
    """

    def __init__(self, library: ModelLibrary, strict: bool) -> None:
        """Args: strict: whether to raise instead of noting what cannot become a wall."""
        self.walls: list[Wall] = []
        self.blocks: list[Block] = []
        self.doors: list[Door] = []
        self.notes: list[str] = []
        self.moving: list[str] = []
        self._library, self._strict = library, strict
        self._floor: Corners = ()
        self._names = UniqueNames()
        self._num_parts = 0

    @property
    def solids(self) -> tuple[Wall | Block, ...]:
        """All walls and blocks."""
        return (*self.walls, *self.blocks)

    @property
    def bounds_m(self) -> tuple[list[float], list[float]]:
        """The lowest and the highest corner of the plan: of the exported floor, or else of the solids."""
        points = list(self._floor)
        for wall in self.walls:
            points += (wall.start, wall.end) if self._floor else wall_corners(wall)
        points += [corner for block in self.blocks for corner in block.polygon]
        points += [point for door in self.doors for point in (door.start, door.end)]
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        return np.round(low, 6).tolist(), np.round(high, 6).tolist()

    def read(self, scene: Node) -> None:
        """Add the models of a world. Raises: ScenarioError: one line with file, line and what was expected."""
        for ignored in scene.all("state", "population"):
            self._cannot(ignored, "is ignored: the models have the poses that they have without it")
        models, doors = self._models_in(scene, 1), door_settings(scene)
        frames = Frames(scene, models)
        for model in models:
            if model.name in doors:
                name = self._unused(model.name.removeprefix(DOOR))
                self.doors.append(read_door(name, model, frames.place(model), doors[model.name]))
            else:
                self._add_model(model, frames.place(model), model, 1)

    def _models_in(self, scope: Node, level: int) -> list[Node]:
        """Return the models of a world or model, with those that it includes."""
        models = []
        for child in scope.all("model", "include"):
            found = child if child.tag == "model" else self._library.included(child, level)
            if found is not None:
                models.append(found)
            elif not is_without_walls(child):
                text = (
                    f"there is no model {describe(child)}; expected a folder with it in --models or GAZEBO_MODEL_PATH"
                )
                self._cannot(child, text)
        return models

    def _add_model(self, model: Node, matrix: np.ndarray, outer: Node, level: int) -> None:
        """Add a model and those in it. Args: matrix: of its frame in the world. outer: the model around all."""
        self._count(model)
        if level > _MAX_LEVELS:
            raise model.error(f"more than {_MAX_LEVELS} models are within each other")
        static = model.child("static")
        # A model in a static one is static, too.
        if model is outer and (static is None or not static.flag()):
            self.moving.append(printable(model.name))
            return
        inner = self._models_in(model, level)
        frames, links = Frames(model, inner), list(model.all("link"))
        for link in links:
            self._count(link)
            base = model.name if len(links) == 1 else link.name
            collisions = list(link.all("collision"))
            link_matrix = frames.place(link)
            for i, collision in enumerate(collisions):
                name = base if len(collisions) == 1 else f"{base}_{i + 1}"
                place = matrix @ frames.place(collision, link_matrix)
                self._add_shape(collision, place, outer.name, name)
        for nested in inner:
            self._add_model(nested, matrix @ frames.place(nested), outer, level + 1)

    def _add_shape(self, collision: Node, matrix: np.ndarray, model: str, name: str) -> None:
        self._count(collision)
        geometry = collision.required("geometry")
        if model == FLOOR and self._read_floor(geometry, matrix):
            return
        try:
            outline = outline_of(geometry, matrix)
            if outline is None or outline.top_m < FLAT_M:
                return
            if outline.bottom_m > STANDING_M:
                height = f"{outline.bottom_m:g} m above the floor"
                self.notes.append(f"{collision.place}: {shown(name)}: omitted: it begins {height}")
                return
            self._add_solid(outline, model, self._unused(name))
        except ShapeError as error:
            self._cannot(collision, f"in {shown(name)}: {error}")

    def _read_floor(self, geometry: Node, matrix: np.ndarray) -> bool:
        """Read the size of the floor that `export_world` writes; return whether it is one."""
        plane = geometry.child("plane")
        size = plane.child("size") if plane is not None else None
        if size is None:
            return False
        length_m, width_m = size.lengths(2)
        x, y = matrix[:2, 3].tolist()
        self._floor = ((x - 0.5 * length_m, y - 0.5 * width_m), (x + 0.5 * length_m, y + 0.5 * width_m))
        return True

    def _add_solid(self, outline: Outline, model: str, name: str) -> None:
        """Add a wall or a block. Raises: ShapeError: it is neither."""
        height = {"height_m": min(outline.top_m, _MAX_HEIGHT_M)}
        middle = self._middle_of_wall(rectangle_of(outline.corners), model)
        try:
            if middle is not None:
                start, end = middle.ends_m
                keys = {"from": start, "to": end, "thickness_m": round(middle.width_m, 6), **height}
                self.walls.append(Wall.model_validate({"name": name, **keys}))
            else:
                kind = {"kind": "pillar"} if model == PILLARS else {}
                keys = {"polygon": tuple(map(in_micrometres, outline.corners)), **kind, **height}
                self.blocks.append(Block.model_validate({"name": name, **keys}))
        except ValidationError as error:
            kind_of = Block if middle is None else Wall
            raise ShapeError(f"it cannot become a wall: {problems(error, kind_of)[0]}") from None

    @staticmethod
    def _middle_of_wall(found: Rectangle | None, model: str) -> Rectangle | None:
        """Return a rectangle with its first side along the wall; None: it is not a wall."""
        if found is None or model in (BLOCKS, PILLARS):
            return None
        if model == WALLS:
            return found  # whose x axis is along the wall, however short
        along = found if found.length_m >= found.width_m else found.turned()
        slender = along.length_m >= LEAST_SLENDERNESS * along.width_m
        return along if slender and along.width_m <= MAX_THICKNESS_M else None

    def _unused(self, wanted: str) -> str:
        return self._names.unused(printable(wanted)[: MAX_NAME_CHARACTERS - 7] or "unnamed")

    def _cannot(self, node: Node, text: str) -> None:
        """Note what cannot become a wall, or raise it."""
        error = node.error(text)
        if self._strict:
            raise error
        self.notes.append(str(error))

    def _count(self, node: Node) -> None:
        self._num_parts += 1
        if self._num_parts > MAX_PARTS:
            raise node.error(f"the world has more than {MAX_PARTS} models, links and collisions")
