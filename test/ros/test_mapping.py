"""`mapping.launch` in its arena: the map that a mapping program builds there is that of the floor plan."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely
from running import ROSLAUNCH, TIMEOUT_S, Program, running

from robotteamsim.ros.programs import installed
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import obstacles

SCENARIO = "mrl_arena_mapping"
NO_DRIFT = " ".join(f"robots.odometry.alpha{i}=0" for i in range(1, 5))
NEAR_M = 0.15
"""Two cells of a map, and what gmapping may be wrong by."""

SAVE = """
import numpy, rospy
from nav_msgs.msg import OccupancyGrid

rospy.init_node("save", disable_rostime=True)
grid = rospy.wait_for_message("/robot_0/map", OccupancyGrid, timeout=60.0)
rows, columns = numpy.nonzero(numpy.reshape(grid.data, (grid.info.height, grid.info.width)) > 50)
origin = grid.info.origin.position
cells = numpy.stack([columns, rows], axis=1) + 0.5
numpy.save("walls.npy", cells * grid.info.resolution + [origin.x, origin.y])
"""


@pytest.fixture
def mapper(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """slam_gmapping, or where it is not installed a package of its name with a simpler mapper."""
    if installed("gmapping", "slam_gmapping") is not None:
        return
    package = tmp_path / "gmapping"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>gmapping</name><version>0.0.0</version></package>")
    program = package / "slam_gmapping"
    source = (Path(__file__).parent / "simple_mapper.py").read_text()
    program.write_text(f"#!{sys.executable}\n{source}")
    program.chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{os.environ['ROS_PACKAGE_PATH']}:{tmp_path}")


def mapped_walls(world: Program, folder: Path) -> np.ndarray:
    """Return the centres of the map's occupied cells in the frame of its map [m]."""
    env = os.environ | {"ROS_MASTER_URI": f"http://localhost:{world.port}", "ROS_HOME": str(folder / "home")}
    subprocess.run((sys.executable, "-c", SAVE), cwd=folder, env=env, check=True, timeout=TIMEOUT_S)
    return np.load(folder / "walls.npy")


@pytest.mark.usefixtures("mapper")
def test_map_of_the_arena_has_the_walls_of_its_floor_plan(tmp_path: Path) -> None:
    command = (*ROSLAUNCH, "robotteamsim", "mapping.launch", "speed:=5", "rviz:=false", f"set:={NO_DRIFT}")
    with running(command, tmp_path) as world:
        world.wait_for(lambda line: "all areas are explored" in line, "the end of the mission")
        walls_m = mapped_walls(world, tmp_path)
    scenario = load(SCENARIO)
    x_m, y_m, yaw_rad = scenario.robots.start
    assert yaw_rad == 0.0
    walls_m += x_m, y_m
    outlines = obstacles(scenario.plan).boundary
    mapped = shapely.MultiPoint(walls_m)
    near = shapely.dwithin(shapely.points(walls_m), outlines, NEAR_M)
    assert np.mean(near) > 0.98
    inside = shapely.box(*scenario.plan.bounds.min, *scenario.plan.bounds.max).buffer(-0.01)
    faces = outlines.intersection(inside)
    assert faces.intersection(mapped.buffer(NEAR_M)).length > 0.9 * faces.length
