"""Starts rviz with a view that just fits the building of the run."""

import os
import sys
from pathlib import Path
from typing import Any

import rospkg
import yaml

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.ros.scene.view import unit
from robotteamsim.ros.transport.node import parameter
from robotteamsim.ros.transport.settings import PARAMETERS
from robotteamsim.scenario import Bounds, load


def main() -> None:
    """Replace this process by rviz, with the same arguments; the view is written to the folder of logs."""
    packages = rospkg.RosPack()
    config = Path(packages.get_path("robotteamsim"), "rviz", "robotteamsim.rviz")
    try:
        bounds = load(parameter(f"{PARAMETERS}/scenario", ""), parameter(f"{PARAMETERS}/set", "").split()).plan.bounds
        settings, folder = fitted(config, bounds), Path(rospkg.get_log_dir())
        folder.mkdir(parents=True, exist_ok=True)
        config = folder / f"robotteamsim-{os.getpid()}.rviz"
        config.write_text(yaml.safe_dump(settings), encoding="utf-8")
    except (RobotTeamSimError, OSError) as error:  # The world reports mistakes; rviz shows what it can.
        sys.stderr.write(f"rviz_view: the view is not fitted to the building: {error}\n")
    sys.stdout.write("rviz_view: rviz starts; without a graphics card, its window takes some 20 s to appear\n")
    sys.stdout.flush()
    os.execvp("rviz", ["rviz", "-d", str(config), *sys.argv[1:]])


def fitted(config: Path, bounds: Bounds) -> dict[str, Any]:
    """Return rviz's settings with views at distances at which the building just fits."""
    settings: dict[str, Any] = yaml.safe_load(config.read_text(encoding="utf-8"))
    scale = unit(bounds)
    views = settings["Visualization Manager"]["Views"]
    for view in (views["Current"], *views["Saved"]):
        for key, factor in (("Distance", scale), ("Scale", 1.0 / scale)):
            if key in view:
                view[key] *= factor
    views["Current"]["Focal Point"]["Y"] *= scale
    return settings
