"""Scans of a robot in a hall of 12 x 8 m whose walls are 0.2 m thick."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.nodes.scan_check import ScanCheck
from robotteamsim.scenario import Bounds, Door, FloorPlan
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.sections import Laser

S = 10**9
LASER = Laser(beams=91)
ANGLES_RAD = np.linspace(-math.pi / 2.0, math.pi / 2.0, 91)
CORNERS = ((0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0))
HALL = FloorPlan(
    name="hall",
    bounds=Bounds(max=(12.0, 8.0)),
    walls=tuple(Wall(name=f"wall_{i}", start=CORNERS[i], end=CORNERS[(i + 1) % 4], thickness_m=0.2) for i in range(4)),
)
GATED = HALL.model_copy(update={"doors": (Door(name="gate", start=(8.0, 0.1), end=(8.0, 7.9), closed=True),)})
MIDDLE, CORNER = Pose(6.0, 4.0, 0.0), Pose(11.0, 1.0, -0.5)
NOTHING_M = np.full(91, LASER.range_max_m, np.float32)


def scan_m(pose: Pose) -> np.ndarray:
    """Return the ranges to the insides of the walls, at 0.1 m from the borders."""
    laser = pose @ Pose(LASER.forward_m, 0.0, 0.0)
    cos, sin = np.cos(laser.yaw_rad + ANGLES_RAD), np.sin(laser.yaw_rad + ANGLES_RAD)
    with np.errstate(divide="ignore"):
        along_x = np.where(cos > 0.0, 11.9 - laser.x_m, 0.1 - laser.x_m) / cos
        along_y = np.where(sin > 0.0, 7.9 - laser.y_m, 0.1 - laser.y_m) / sin
    return np.minimum(np.minimum(along_x, along_y), LASER.range_max_m).astype(np.float32)


def lines(check: ScanCheck, *scans: tuple[Pose, np.ndarray]) -> list[str]:
    """Return what the check says of steps of 1 s with these poses from tf and scans."""
    return [check.follow(i * S, PoseReading.from_pose(pose), ranges_m) for i, (pose, ranges_m) in enumerate(scans)]


@pytest.mark.parametrize(
    ("plan", "smoke", "located", "ranges_m"),
    [
        (HALL, False, CORNER, scan_m(CORNER)),
        (HALL, False, CORNER @ Pose(0.15, -0.1, 0.05), scan_m(CORNER)),
        (HALL, False, CORNER, np.full(91, 0.3, np.float32)),
        (HALL, False, CORNER, np.full(91, math.nan, np.float32)),
        (HALL, True, CORNER, NOTHING_M),
        (GATED, False, MIDDLE, scan_m(MIDDLE)),
        (HALL, False, CORNER, NOTHING_M[1:]),
    ],
    ids=["right", "almost right", "among people", "no numbers", "in smoke", "through a door", "another laser"],
)
def test_scan_that_may_fit_is_no_contradiction(
    plan: FloorPlan, smoke: bool, located: Pose, ranges_m: np.ndarray
) -> None:
    assert lines(ScanCheck("robot_1", plan, LASER, smoke), *(10 * [(located, ranges_m)])) == 10 * [""]


@pytest.mark.parametrize("ranges_m", [NOTHING_M, np.full(91, math.inf, np.float32), scan_m(MIDDLE)])
def test_beams_through_walls_for_5_s_are_one_line_until_scans_fit_again(ranges_m: np.ndarray) -> None:
    wrong, right = (CORNER, ranges_m), (CORNER, scan_m(CORNER))
    answers = lines(ScanCheck("robot_1", HALL, LASER), *(8 * [wrong]), right, *(5 * [wrong]))
    assert [i for i, line in enumerate(answers) if line] == [4, 13]
    assert answers[4].startswith("robot_1: ")
    assert answers[4].endswith(
        "% of its laser beams go through walls of the floor plan at its pose from tf, (11.0, 1.0); "
        "is its initial pose right?"
    )


def test_robot_that_is_located_outside_the_bounds_is_reported() -> None:
    assert lines(ScanCheck("robot_1", HALL, LASER), *(5 * [(Pose(40.0, 4.0, 0.0), NOTHING_M)]))[-1]


def test_share_of_beams_is_that_of_the_walls_ahead() -> None:
    # The laser is 1.4 m from a wall. Of beams of 3 m, those go through it by 0.5 m that are within 55.9 degrees of its
    # normal: 55 of 91, which are 2 degrees apart.
    check, at_wall = ScanCheck("robot_1", HALL, LASER), Pose(10.4, 4.0, 0.0)
    line = lines(check, *(5 * [(at_wall, np.full(91, 3.0, np.float32))]))[-1]
    assert line.startswith("robot_1: 60% ")


def test_restart_forgets_the_scans() -> None:
    check = ScanCheck("robot_1", HALL, LASER)
    lines(check, *(4 * [(CORNER, NOTHING_M)]))
    check.restart()
    assert lines(check, *(4 * [(CORNER, NOTHING_M)])) == 4 * [""]
