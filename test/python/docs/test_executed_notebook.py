"""The notebook of the docs runs from its first to its last cell, and shows what its stored copy shows."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[3] / "docs"


def _outputs(path: Path) -> list[tuple[str, list[str]]]:
    """Return each code cell and the kinds of its outputs."""
    cells: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [
        ("".join(cell["source"]), [kind for output in cell["outputs"] for kind in output.get("data", {"text": ""})])
        for cell in cells
        if cell["cell_type"] == "code"
    ]


@pytest.mark.slow
def test_notebook_runs_and_each_cell_shows_what_is_stored(tmp_path: Path) -> None:
    words = [
        sys.executable,
        str(DOCS / "execute_notebook.py"),
        str(DOCS / "notebook.ipynb"),
        str(tmp_path / "new.ipynb"),
    ]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    assert _outputs(tmp_path / "new.ipynb") == _outputs(DOCS / "notebook.ipynb")


def test_notebook_shows_tables_with_pictures_a_player_and_statistics() -> None:
    stored = (DOCS / "notebook.ipynb").read_text(encoding="utf-8")
    assert stored.count("<svg ") == 2
    assert stored.count("<iframe srcdoc=") == 1
    assert "difference of means" in stored
