"""Recordings as compact JSON: columns of whole numbers, of which only the differences are written."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim import palette
from robotteamsim.view.frame import Frame, VictimShape
from robotteamsim.view.layer_map import LayerMap
from robotteamsim.view.recorder import Recording

NO_LINK = 10_000
"""Replaces the signal [dBm] of a pair without a link; larger than any signal."""

_LOWEST = {"radio": -120.0}
"""Values below are not shown [dBm]; of other layers, those below 0 are not."""

_CHANGING: dict[str, Callable[[Frame], Any]] = {
    "swarms": lambda frame: frame.swarms,
    "fiedler": lambda frame: round(frame.fiedler_value, 3),
    "doors": lambda frame: [round(opening, 3) for opening in frame.doors],
    "objects": lambda frame: [[round(value, 2) for value in pose] for pose in frame.objects],
    "victims": lambda frame: [_rounded(victim) for victim in frame.victims],
    "explored": lambda frame: frame.explored,
    "target": lambda frame: frame.target,
    "state": lambda frame: frame.state,
    "noise_db": lambda frame: frame.noise_db,
    "endangered": lambda frame: frame.endangered,
    "present": lambda frame: [pose is not None for pose in frame.poses],
}


def packed(recordings: Sequence[Recording]) -> str:
    """Return recordings as text for a page: JSON, deflated, in base64."""
    document = msgspec.json.encode([_document(recording) for recording in recordings])
    return base64.b64encode(zlib.compress(document, 9)).decode()


def header(recording: Recording) -> dict[str, Any]:
    """Return what a viewer needs before the first frame."""
    return {"title": recording.title, "scene": recording.scene, "palette": colours()}


def colours() -> dict[str, Any]:
    """Return the colours of the viewer by meaning, from the palette of all pictures."""
    return {
        "victims": palette.VICTIM_STATES,
        "areas": {"open": palette.OPEN_AREA, "target": palette.TARGET_AREA, "explored": palette.EXPLORED_AREA},
        "links": {
            "strong": palette.STRONG_LINK,
            "weak": palette.WEAK_LINK,
            "endangered": palette.ENDANGERED_LINK,
        },
        "excluded": palette.EXCLUDED_ROBOT,
        "voice": palette.VOICE,
        "laser": palette.COLLISION,
        "edge": palette.WALL_EDGE,
        "bay": palette.BAY,
        "fire": {"burning": palette.FLAME, "tip": palette.YELLOW, "burnt": palette.CHAR, "hot": palette.HOT},
        "smoke": palette.SMOKE,
        "people": {
            "skin": palette.SKIN,
            "coat": palette.TURNOUT_COAT,
            "stripe": palette.REFLECTIVE,
            "helmet": palette.HELMET,
            "tent": palette.WHITE,
        },
        "nose": palette.ROBOT_BODY,
        "curves": {
            "areas": palette.EXPLORED_AREA,
            "saved": palette.WAITING,
            "links": palette.HOPS,
            "fiedler": palette.FIEDLER,
        },
        "event": palette.RELAYED,
    }


def _document(recording: Recording) -> dict[str, Any]:
    frames = recording.frames
    return {
        **header(recording),
        "events": recording.events,
        "time_ms": _deltas([frame.time_s * 1e3 for frame in frames]),
        "robots": [_track(frames, robot) for robot in range(len(recording.scene.robots))],
        "links": _links(frames),
        "changes": {key: _changes(map(value, frames)) for key, value in _CHANGING.items()},
        "scans": [
            [index, [_deltas(np.divide(scan, 0.05)) for scan in frame.scans_m]]
            for index, frame in enumerate(frames)
            if frame.scans_m
        ],
        "voice": [map_document("voice", layer) for layer in recording.voice],
        "radio": [map_document("radio", layer) for layer in recording.radio],
        "films": {"fire": _film(recording.hazards.fire), "smoke": _film(recording.hazards.smoke)},
    }


def _track(frames: Sequence[Frame], robot: int) -> dict[str, list[int]]:
    """Return the poses of a robot: x, y [cm] and yaw [0.01 rad], without jumps of yaw; an absent robot stays put."""
    poses, last = [], (0.0, 0.0, 0.0)
    for frame in frames:
        last = frame.poses[robot] or last
        poses.append(last)
    x_m, y_m, yaw_rad = np.array(poses, dtype=np.float64).reshape(-1, 3).T
    return {"x": _deltas(x_m * 100.0), "y": _deltas(y_m * 100.0), "yaw": _deltas(np.unwrap(yaw_rad) * 100.0)}


def _links(frames: Sequence[Frame]) -> list[Any]:
    """Return [first, second, indices, signals] of each pair that was ever linked: each change of its signal [dBm]."""
    changes: dict[tuple[int, int], list[tuple[int, int]]] = {}
    before: dict[tuple[int, int], int] = {}
    for index, frame in enumerate(frames):
        now = {link[:2]: link[2] for link in frame.links}
        for pair in before.keys() - now.keys():
            changes[pair].append((index, NO_LINK))
        for pair, signal in now.items():
            if signal != before.get(pair):
                changes.setdefault(pair, []).append((index, signal))
        before = now
    return [[*pair, *map(_deltas, zip(*changes[pair], strict=True))] for pair in sorted(changes)]


def _changes(values: Iterable[Any]) -> list[Any]:
    """Return [index, value] of the first value and of each that differs from the one before."""
    found: list[Any] = []
    for index, value in enumerate(values):
        if not found or value != found[-1][1]:
            found.append([index, value])
    return found


def map_document(name: str, layer: LayerMap) -> dict[str, Any]:
    """Return a map of the layer of a name."""
    rows, columns = layer.values.shape
    lowest = _LOWEST.get(name, 0.0)
    values = np.nan_to_num(layer.values, nan=lowest, posinf=lowest, neginf=lowest)
    return {
        "time_s": layer.time_s,
        "origin_m": layer.origin_m,
        "cell_m": layer.cell_m,
        "rows": rows,
        "columns": columns,
        "values": _deltas(np.maximum(values, lowest).ravel()),
    }


def _film(layers: Sequence[LayerMap]) -> dict[str, Any] | None:
    """Return maps of whole numbers as cells that change, and by how much; before the first map, all are 0."""
    if not layers:
        return None
    rows, columns = layers[0].values.shape
    before, cells, changes = np.zeros(rows * columns, dtype=np.int64), [], []
    for layer in layers:
        now = layer.values.ravel().astype(np.int64)
        changed = np.flatnonzero(now != before)
        cells.append(_deltas(changed))
        changes.append((now - before)[changed].tolist())
        before = now
    return {
        "origin_m": layers[0].origin_m,
        "cell_m": layers[0].cell_m,
        "rows": rows,
        "columns": columns,
        "time_ms": _deltas([layer.time_s * 1e3 for layer in layers]),
        "cells": cells,
        "changes": changes,
    }


def _rounded(victim: VictimShape) -> VictimShape:
    """Return a victim whose place is rounded to the centimetre."""
    x_m, y_m = victim.position_m
    return msgspec.structs.replace(victim, position_m=(round(x_m, 2), round(y_m, 2)))


def _deltas(values: Sequence[float] | np.ndarray) -> list[int]:
    """Return the first value and the differences of the following ones, rounded to whole numbers."""
    numbers = np.rint(np.asarray(values, dtype=np.float64)).astype(np.int64)
    differences: list[int] = np.diff(numbers, prepend=0).tolist()
    return differences
