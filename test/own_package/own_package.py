"""The packages of docs/own_sensor.md and docs/own_parts.md, installed as pip does it, for all tests of them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
SENSORS = 'robots.sensors=[{"kind":"neighbours","name":"others","noise_m":0,"range_max_m":100}]'
TYPE = "geometry_msgs/PoseArray"


def blocks(kind: str, page: str) -> list[str]:
    """Return the blocks of a language on a page."""
    return re.findall(rf"```{kind}\n(.*?)```", (DOCS / f"{page}.md").read_text(encoding="utf-8"), re.DOTALL)


def block(kind: str, page: str = "own_sensor") -> str:
    """Return the only block of a language on a page."""
    (found,) = blocks(kind, page)
    return found


def entries(page: str) -> dict[str, dict[str, str]]:
    """Return the entry points of a page by group."""
    found: dict[str, dict[str, str]] = tomllib.loads(block("toml", page))["project"]["entry-points"]
    return found


def install_package(
    folder: Path, modules: Mapping[str, str], groups: Mapping[str, Mapping[str, str]]
) -> dict[str, str]:
    """Install modules, by name, and entry points, by group; return an environment in which they are."""
    for name, text in modules.items():
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    info = folder / "own-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: own\nVersion: 1.0\n", encoding="utf-8")
    lines = [line for group, points in groups.items() for line in (f"[{group}]", *map(" = ".join, points.items()))]
    (info / "entry_points.txt").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), os.environ.get("PYTHONPATH", "")))}


def install(folder: Path, module: str = "", entry: str = "") -> dict[str, str]:
    """Install the sensor and its entry point, by default those of the page; return an environment in which it is."""
    (group,) = entries("own_sensor")
    name, _, place = entry.partition(" = ")
    points = {name: place} if entry else entries("own_sensor")[group]
    return install_package(folder, {"neighbours": module or block("python")}, {group: points})


def python(folder: Path, environment: Mapping[str, str], *words: str) -> subprocess.CompletedProcess[str]:
    """Run Python in a folder."""
    kept = {"cwd": folder, "env": environment, "capture_output": True, "text": True}
    return subprocess.run((sys.executable, *words), timeout=600, check=False, **kept)
