"""The package of docs/own_sensor.md, installed as pip does it, for the tests of all versions of ROS and without ROS."""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "own_sensor.md").read_text(encoding="utf-8")
SENSORS = 'robots.sensors=[{"kind":"neighbours","name":"others","noise_m":0,"range_max_m":100}]'
TYPE = "geometry_msgs/PoseArray"


def block(kind: str) -> str:
    """Return the only block of a language on the page."""
    (found,) = re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)
    return str(found)


def install(folder: Path, module: str = "", entry: str = "") -> dict[str, str]:
    """Install the module and its entry point, by default those of the page; return an environment in which it is."""
    ((name, place),) = tomllib.loads(block("toml"))["project"]["entry-points"]["robotteamsim.sensors"].items()
    (folder / "neighbours.py").write_text(module or block("python"), encoding="utf-8")
    info = folder / "neighbours-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: neighbours\nVersion: 1.0\n", encoding="utf-8")
    entry_points = f"[robotteamsim.sensors]\n{entry or f'{name} = {place}'}\n"
    (info / "entry_points.txt").write_text(entry_points, encoding="utf-8")
    return {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), os.environ.get("PYTHONPATH", "")))}
