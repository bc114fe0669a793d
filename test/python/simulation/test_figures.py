from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.control.controller import Decision
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.simulation.figures import TeamFigures


def reading(x_m: float, y_m: float, in_contact: bool = False) -> RobotReading:
    pose = PoseReading(x_m, y_m, 0.0, 1.0)
    return RobotReading(pose, Twist(), OdometryReading(pose, Twist()), np.zeros(1, np.float32), in_contact)


def test_distance_contact_and_exclusion_are_added_up_per_robot():
    figures = TeamFigures(2, step_s=0.1)
    for x in (0.0, 3.0, 3.0):
        readings = [reading(x, 0.0, in_contact=x > 0.0), reading(0.0, x)]
        figures.update(readings, [Decision(), Decision(excluded=True)], running=True)
    first, second = figures.result()
    assert (first.distance_m, second.distance_m) == (3.0, 3.0)
    assert (first.contact_s, second.contact_s) == (pytest.approx(0.2), 0.0)
    assert (first.excluded_s, second.excluded_s) == (0.0, pytest.approx(0.3))


def test_longest_stay_is_the_longest_time_within_half_a_metre_while_the_mission_runs():
    figures = TeamFigures(1, step_s=1.0)
    walk = [0.0, 0.3, 0.4, 1.0, 1.2, 2.0]  # three steps near 0, two near 1, one at 2
    for x in walk:
        figures.update([reading(x, 0.0)], [Decision()], running=True)
    for _ in range(10):
        figures.update([reading(2.0, 0.0)], [Decision()], running=False)
    assert figures.result()[0].longest_stay_s == 3.0
