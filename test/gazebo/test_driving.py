"""One robot of Gazebo, driven by its velocity or its wheels: commands, contacts, doors, frames."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from running import ROSLAUNCH, TIMEOUT_S, environment, running

START = "robots.start=[53.0,37.45,0.0]"
"""In front of stair_door."""
DOOR_M = 54.375 - 0.03
"""The face of its leaf, which is 6 cm thick."""
LASER_M = 53.0 + 0.1
RADIUS_M = 0.2


@pytest.fixture(scope="module", params=["velocity", "wheels"])
def found(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, gazebo: tuple[str, ...]
) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp(request.param)
    arguments = (
        "robots:=1",
        "speed:=2",
        "controllers:=false",
        f"set:={START}",
        f"drive:={request.param}",
        "rviz:=false",
    )
    with running((*ROSLAUNCH, "robotteamsim", "scenario.launch", *arguments, *gazebo), folder) as program:
        helpers = os.pathsep.join((str(Path(__file__).parents[1] / "ros"), os.environ.get("PYTHONPATH", "")))
        env = environment(folder, program.port) | {"PYTHONPATH": helpers}
        script = Path(__file__).with_name("drive_to_door.py")
        subprocess.run((sys.executable, str(script), "found.json"), cwd=folder, env=env, check=True, timeout=TIMEOUT_S)
    return json.loads((folder / "found.json").read_text()) | {"drive": request.param}


def test_command_holds_for_eight_tenths_of_a_second(found: dict[str, Any]) -> None:
    assert found["moving_steps"] in ((8,) if found["drive"] == "velocity" else (7, 8, 9))
    assert found["distance_m"] == pytest.approx(0.4, abs=0.002 if found["drive"] == "velocity" else 0.1)


def test_odometry_starts_at_zero_and_follows_the_motion(found: dict[str, Any]) -> None:
    assert found["odometry_m"] == pytest.approx(found["distance_m"], abs=0.03)


def test_command_that_is_not_finite_is_ignored(found: dict[str, Any]) -> None:
    assert abs(found["after_nan"]) < 0.01


def test_positive_turn_is_counter_clockwise(found: dict[str, Any]) -> None:
    assert 0.2 < found["turned_rad"] < 0.6


def test_robot_stops_at_a_closed_door_and_feels_it_ahead(found: dict[str, Any]) -> None:
    assert found["closed_before"] == {"plant_door": False, "stair_door": True}
    assert found["ahead_closed_m"] == pytest.approx(DOOR_M - LASER_M, abs=0.02)
    assert found["stopped_at_m"] == pytest.approx(DOOR_M - RADIUS_M, abs=0.02)
    assert min(map(abs, found["contact_angles_rad"])) < 0.3


def test_service_opens_a_door_for_the_laser_and_rejects_an_unknown_one(found: dict[str, Any]) -> None:
    assert found["accepted"]
    assert found["ahead_open_m"] > 3.0
    assert found["refusal"] == [False, "unknown door 'no_such_door'; known: plant_door, stair_door"]


def test_frames_of_the_robot_are_those_of_our_own_world(found: dict[str, Any]) -> None:
    names = ("base_footprint", "base_laser_link", "base_link", "odom")
    assert found["frames"] == [f"robot_0/{name}" for name in names]
