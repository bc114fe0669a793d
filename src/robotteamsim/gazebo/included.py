"""Models that a world includes from folders, as Gazebo finds them."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from robotteamsim.errors import ScenarioError
from robotteamsim.gazebo.xml_tree import Node, read_tree
from robotteamsim.scenario.yaml_text import is_file, shown

MAX_INCLUDES = 10_000
MAX_LEVELS = 10
"""Models that include models; no real one needs as many."""

WITHOUT_WALLS = ("sun", "ground_plane")
"""Gazebo's own models, which are in most worlds; not an error if they are missing."""

_SCHEME = re.compile(r"[a-z]+://")


class ModelLibrary:
    """Finds and reads included models, each file once."""

    def __init__(self, folders: Sequence[Path]) -> None:
        """Args: folders: searched in this order for model://NAME."""
        self._folders = folders
        self._read: dict[Path, Node] = {}
        self._count = 0

    def included(self, include: Node, level: int) -> Node | None:
        """Return the model of an <include>, with what the <include> replaces: name, pose, static.

        Args:   level: of models that include models, from 1.
        Returns: None: no folder has the model.
        Raises: ScenarioError: the model is wrong, or includes itself.
        """
        self._count += 1
        if self._count > MAX_INCLUDES:
            raise include.error(f"more than {MAX_INCLUDES} models are included")
        if level > MAX_LEVELS:
            raise include.error(f"more than {MAX_LEVELS} models include each other")
        path = self._find(include.required("uri").text)
        if path is None:
            return None
        model = self._model_in(path)
        replaced = list(include.all("name", "pose", "static", "placement_frame"))
        attributes = dict(model.attributes)
        for child in replaced:
            if child.tag in ("name", "placement_frame"):
                attributes[child.tag] = child.text
        tags = {child.tag for child in replaced}
        kept = [child for child in model.children if child.tag not in tags]
        return Node("model", include.place, attributes, [*replaced, *kept])

    def _find(self, uri: str) -> Path | None:
        scheme = _SCHEME.match(uri)
        if scheme is None or scheme[0] not in ("model://", "file://"):
            return None
        parts = PurePosixPath(uri[scheme.end() :])
        if scheme[0] == "file://":
            return _file_of(Path(os.fspath(parts)))
        if parts.is_absolute() or ".." in parts.parts or not parts.parts:
            return None
        return next((path for folder in self._folders if (path := _file_of(folder / parts)) is not None), None)

    def _model_in(self, path: Path) -> Node:
        if path not in self._read:
            self._read[path] = read_tree(path, os.fspath(path))
        root = self._read[path]
        model = root.child("model")
        if root.tag != "sdf" or model is None:
            raise ScenarioError(f"{path}: has no <model> in an <sdf>")
        return model


def _file_of(place: Path) -> Path | None:
    """Return the file of a model: the newest in the model.config of a folder, or its model.sdf, or the file itself."""
    if is_file(place):
        return place
    config = place / "model.config"
    name = "model.sdf"
    if is_file(config):
        files = list(read_tree(config, os.fspath(config)).all("sdf"))
        if files:
            name = max(files, key=_version).text
    path = place / name
    return path if is_file(path) else None


def _version(file: Node) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"\d{1,9}", file.attributes.get("version", "")))


def describe(include: Node) -> str:
    """Return what messages call an included model."""
    uri = include.child("uri")
    return shown(uri.text if uri else "")


def is_without_walls(include: Node) -> bool:
    """Whether this is one of Gazebo's own models without walls."""
    uri = include.child("uri")
    return uri is not None and uri.text.removeprefix("model://").strip("/") in WITHOUT_WALLS
