"""The commands of the navigator for single observations, and its escapes, by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.control.driving.driver import places_of
from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.control.driving.navigation import Navigator
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.controllers.driving import NavigatorTuning
from robotteamsim.scenario.drives import CarDrive, Drive
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.sections import PlacedRobot

TUNING = NavigatorTuning()
POSE = Pose(6.0, 6.0, 0.0)
CAR = CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.6)


def grid_of(*blocks: Block):
    plan = FloorPlan(name="hall", bounds=Bounds(max=(12.0, 12.0)), blocks=blocks)
    return KnownMap(Building(plan), 0.2, ()).grid


class Driver:
    """A robot at `POSE` that asks for commands, and what it saw of its teammates."""

    def __init__(self, robot_id=3, mode="path", drive=None, grid=None):
        self.body = PlacedRobot(start_pose=(6.0, 6.0, 0.0), drive=drive or Drive())
        self.navigator = Navigator(self.body, robot_id, mode, TUNING)
        self.grid = grid or grid_of()
        self.teammates = {}

    def command(self, goal, time_s=0.0, near=None, pose=POSE, speed_mps=0.5) -> Twist:
        """Return the command; `near` has an obstacle over those beams, by heading [rad] and range [m]."""
        laser = self.body.laser
        ranges_m = np.full(laser.beams, laser.range_max_m)
        if near is not None:
            low_rad, high_rad, range_m = near
            angles_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, laser.beams)
            ranges_m[(low_rad <= angles_rad) & (angles_rad <= high_rad)] = range_m
        stamp_ns = round(time_s * 1e9)
        others = places_of(lambda: self.teammates)
        return self.navigator.drive(self.grid, pose, ranges_m, goal, speed_mps, stamp_ns, others)

    def headings_after(self, goal, end_s) -> dict[float, float]:
        """Return the turn rates of a robot that does not move, by time [s] in steps of 0.5 s."""
        return {0.5 * i: self.command(goal, 0.5 * i).angular_z_radps for i in range(round(2.0 * end_s) + 1)}


def test_robot_turns_by_the_gain_and_drives_as_fast_as_it_can_brake():
    # Off by 0.2 rad, 0.05 m away: sqrt(2 * 1.0 m/s^2 * 0.08 m) = 0.4 m/s.
    goal = (6.0 + 0.08 * math.cos(0.2), 6.0 + 0.08 * math.sin(0.2))
    command = Driver().command(goal)
    assert command.linear_x_mps == pytest.approx(0.4 * math.cos(0.2))
    assert command.angular_z_radps == pytest.approx(3.0 * 0.2)
    assert Driver().command((9.0, 6.0)) == Twist(0.5, 0.0, 0.0)
    assert Driver().command((6.04, 6.0)) == Twist()


def test_robot_turns_on_the_spot_beyond_the_heading_error_and_within_its_turn_rate():
    turn = Driver().command((6.0, 9.0))
    assert (turn.linear_x_mps, turn.angular_z_radps) == (0.0, Drive().max_turn_radps)
    assert Driver().command((6.0, 3.0)).angular_z_radps == -Drive().max_turn_radps


def test_car_manoeuvres_forward_where_there_is_room_and_backward_elsewhere():
    assert Driver(drive=CAR).command((6.0, 9.0)).linear_x_mps == TUNING.manoeuvring_mps
    assert Driver(drive=CAR).command((6.0, 9.0), near=(-0.3, 0.3, 0.3)).linear_x_mps == -TUNING.manoeuvring_mps
    assert Driver(drive=CAR).command((6.0, 9.0), speed_mps=0.1).linear_x_mps == 0.1


def test_robot_passes_an_obstacle_on_the_right_and_stays_on_that_side():
    driver = Driver()
    assert driver.command((9.0, 6.0), near=(-0.3, 0.3, 0.4)).angular_z_radps < 0.0
    # The left would be a little nearer to the goal now; to change sides costs more.
    assert driver.command((9.0, 6.0), near=(-0.35, 0.3, 0.4)).angular_z_radps < 0.0
    assert Driver().command((9.0, 6.0), near=(-1.2, 0.1, 0.4)).angular_z_radps > 0.0


def test_robot_without_progress_escapes_after_the_timeout_and_then_tries_again():
    turns_radps = Driver().headings_after((9.0, 6.0), 9.0)
    escaping = {time_s for time_s, turn_radps in turns_radps.items() if turn_radps != 0.0}
    begin_s = TUNING.stuck_timeout_s + 0.5
    assert escaping == {begin_s + 0.5 * i for i in range(round(2.0 * TUNING.escape_time_s))}


@pytest.mark.parametrize(("teammate", "begins_s"), [(2, 2.5), (4, 4.5)])
def test_robot_yields_earlier_to_a_teammate_of_lower_id(teammate, begins_s):
    driver = Driver()
    driver.teammates = {teammate: (6.9, 6.0)}
    turns_radps = driver.headings_after((9.0, 6.0), 5.0)
    assert min(time_s for time_s, turn_radps in turns_radps.items() if turn_radps != 0.0) == begins_s


def test_robot_that_moves_or_has_arrived_does_not_escape():
    moving, waiting = Driver(), Driver()
    for i in range(20):
        pose = Pose(1.0 + 0.25 * i, 6.0, 0.0)
        assert moving.command((11.0, 6.0), float(i), pose=pose).angular_z_radps == 0.0
        assert waiting.command((6.04, 6.0), float(i)) == Twist()


def escape_rad(driver) -> float:
    """Return the direction of the first escape, found by turning the robot until it drives straight ahead."""
    driver.command((9.0, 6.0), 0.0)
    driver.command((9.0, 6.0), 4.5)
    headings_rad = np.arange(-180, 180, 0.5) * math.pi / 180.0
    off_rad = [abs(driver.command((9.0, 6.0), 4.5, pose=Pose(6.0, 6.0, yaw)).angular_z_radps) for yaw in headings_rad]
    return float(headings_rad[np.argmin(off_rad)])


def test_robots_escape_in_different_directions():
    # Robot i begins with direction 5 i of 16, and its first attempt takes the first free one.
    for robot_id in (0, 1, 2, 3):
        difference_rad = escape_rad(Driver(robot_id)) - math.tau * 5 * robot_id / 16
        assert math.cos(difference_rad) == pytest.approx(1.0)


def test_escape_leads_neither_into_a_wall_nor_to_a_teammate():
    block = Block(name="north", polygon=((5.0, 6.3), (7.0, 6.3), (7.0, 7.0), (5.0, 7.0)))
    for teammates in ({}, {9: (5.0, 6.0), 8: (7.0, 6.0)}):
        driver = Driver(robot_id=1, grid=grid_of(block))
        driver.teammates = teammates
        away_rad = escape_rad(driver)
        assert math.sin(away_rad) < 0.1
        assert all(
            math.dist((6.0 + 0.7 * math.cos(away_rad), 6.0 + 0.7 * math.sin(away_rad)), other) > 0.8
            for other in teammates.values()
        )
