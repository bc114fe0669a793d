"""Missions as the page reads them: JSON of frames and films, in which only what changes is written."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim import palette
from robotteamsim.view.frame import Frame
from robotteamsim.view.layers import Film
from robotteamsim.view.recorder import Recording

NO_LINK = 10_000
"""Replaces the signal [dBm] of a pair without a link; larger than any signal."""


def packed(recordings: Sequence[Recording]) -> str:
    """Return recordings as text for a page: JSON, deflated, in base64."""
    document = msgspec.json.encode([_document(recording) for recording in recordings])
    return base64.b64encode(zlib.compress(document)).decode()


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
        "found": {"wall": palette.FOUND, "wrong": palette.WRONGLY_FOUND},
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
    layers = {name: Film(getattr(recording, name)) for name in ("voice", "radio", "fire", "smoke")} | recording.found
    return {
        **header(recording),
        "events": recording.events,
        "frames": _frames(recording.frames),
        "links": _links(recording.frames),
        "layers": {name: film.packed() for name, film in layers.items()},
    }


def _frames(frames: Sequence[Frame]) -> list[dict[str, Any]]:
    """Return frames without what is as in the frame before, without links, and rounded.

    A frame without scans or readings of sensors keeps those before it.
    """
    found: list[dict[str, Any]] = []
    known: dict[str, Any] = {}
    for frame in frames:
        now = _rounded(msgspec.to_builtins(msgspec.structs.replace(frame, links=())), 2)
        del now["links"]
        now |= _rounded({"fiedler_value": frame.fiedler_value, "doors": frame.doors}, 3)
        for name in ("scans_m", "sensors"):
            if not now[name]:
                del now[name]
        changed = {key: value for key, value in now.items() if key not in known or value != known[key]}
        found.append(changed | {"time_s": frame.time_s})
        known |= changed
    return found


def _links(frames: Sequence[Frame]) -> list[Any]:
    """Return [first, second, indices, signals] of each pair that was ever linked.

    Its signal [dBm] changes in the frames with these indices. Of indices and signals, the differences are written.
    """
    changes: dict[tuple[int, int], list[tuple[int, int]]] = {}
    before: dict[tuple[int, int], int] = {}
    for index, frame in enumerate(frames):
        now = {(first, second): signal_dbm for first, second, signal_dbm in frame.links}
        for pair in before.keys() - now.keys():
            changes[pair].append((index, NO_LINK))
        for pair, signal_dbm in now.items():
            if signal_dbm != before.get(pair):
                changes.setdefault(pair, []).append((index, signal_dbm))
        before = now
    return [[*pair, *np.diff(changes[pair], axis=0, prepend=[(0, 0)]).T.tolist()] for pair in sorted(changes)]


def _rounded(value: Any, digits: int) -> Any:
    """Return a value whose numbers are rounded."""
    if isinstance(value, float):
        return round(value, digits)
    if isinstance(value, list | tuple):
        return [_rounded(one, digits) for one in value]
    return {key: _rounded(one, digits) for key, one in value.items()} if isinstance(value, dict) else value
