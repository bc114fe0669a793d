"""Figures as files: PNG for slides, PDF and SVG for papers."""

from __future__ import annotations

import io
import os
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from robotteamsim.errors import RecordingError
from robotteamsim.recording.files import atomically

_METADATA: dict[str, dict[str, Any]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}
"""Without dates, so that the same figure gives the same bytes."""

_STYLE: dict[Any, Any] = {
    "pdf.fonttype": 42,  # TrueType: many publishers reject Matplotlib's default, Type 3.
    "svg.hashsalt": "robotteamsim",
}


def figure_bytes(figure: Figure, kind: str, **options: Any) -> bytes:
    """Return a figure as a file; the same figure gives the same bytes.

    Args:   kind: png, pdf or svg.  options: of `Figure.savefig`.
    Raises: RecordingError: SOURCE_DATE_EPOCH, which Matplotlib reads, is no time.
    """
    date = os.environ.get("SOURCE_DATE_EPOCH") or "0"
    try:
        datetime.fromtimestamp(int(date), UTC)
    except (ValueError, OverflowError, OSError):
        raise RecordingError(f"SOURCE_DATE_EPOCH, environment: {date!r:.60}; expected seconds since 1970") from None
    data = io.BytesIO()
    with matplotlib.rc_context(_STYLE):
        figure.savefig(data, format=kind, metadata=_METADATA[kind], **options)
    return data.getvalue()


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure as the kind of file that the suffix names: .png, .pdf or .svg. Raises: RecordingError."""
    data = figure_bytes(figure, path.suffix.lower().removeprefix("."))
    with atomically(path) as part:
        part.write_bytes(data)
