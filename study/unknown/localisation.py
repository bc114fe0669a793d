"""How exactly robots localise themselves by laser in a known building, and whether they find themselves again.

Robots drive by their true poses, and their localisers run beside them, so that each mission has the same paths whatever
they believe. Teammates report their true positions once a second. With --carry, robot 0 is set to where another robot
was, at a time of its own in each mission, and driven on from there.
Usage: python -m study.unknown.localisation SCENARIO... [--missions 20] [--seconds 400] [--carry] [--set KEY=VALUE]
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.interface import Observation
from robotteamsim.maps.laser_localiser import LaserLocaliser
from robotteamsim.maps.teammates import Teammates
from robotteamsim.rng import stream
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import RobotReading, VoiceReading
from robotteamsim.simulation import Simulation

WRONG_M = 1.0
"""A robot that is tracking with a larger error is wrong."""
WITHIN_M = 20.0

_NO_VOICE = VoiceReading(0.0, False, (0.0, 0.0), 0.0)


class Follower:
    """One robot's localiser, and its errors."""

    def __init__(self, robot_id: int, simulation: Simulation) -> None:
        self._robot_id = robot_id
        self._localiser = LaserLocaliser(robot_id, simulation.setup)
        self._teammates = Teammates(robot_id, simulation.setup)
        self.errors: list[tuple[float, float]] = []
        self.carried = False
        self.lost_steps = self.wrong_steps = 0
        self.driven_m, self.found_m = 0.0, math.inf

    def carry(self) -> None:
        """Begin again: the robot is carried elsewhere now."""
        self.carried, self.errors, self.lost_steps, self.wrong_steps = True, [], 0, 0
        self.driven_m, self.found_m = 0.0, math.inf

    def step(self, time_ns: int, readings: Sequence[RobotReading]) -> None:
        """Follow a step."""
        if time_ns % 1_000_000_000 == 0:
            for robot_id, reading in enumerate(readings):
                self._teammates.note(robot_id, (reading.true_pose.x_m, reading.true_pose.y_m), time_ns)
        observation = Observation(self._robot_id, time_ns, readings[self._robot_id], _NO_VOICE)
        pose = self._localiser.pose(observation, self._teammates.discs(time_ns))
        apart = observation.robot.true_pose.inverse() @ pose
        error_m = math.hypot(apart.x_m, apart.y_m)
        self.errors.append((error_m, abs(math.degrees(apart.yaw_rad))))
        tracking = self._localiser.localisation.state == "tracking"
        self.lost_steps += not tracking
        # A robot that is carried needs some metres to notice; after that, it must not be wrong again.
        self.wrong_steps += tracking and error_m > WRONG_M and (not self.carried or self.lost_steps > 0)
        self.driven_m += math.hypot(observation.robot.twist.linear_x_mps, observation.robot.twist.linear_y_mps) * 0.1
        if tracking and self.lost_steps and error_m <= WRONG_M:
            self.found_m = min(self.found_m, self.driven_m)


def main() -> None:
    """Run the missions and print a line for each scenario."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", nargs="+")
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=400.0)
    parser.add_argument("--first-seed", type=int, default=5000)
    parser.add_argument("--carry", action="store_true")
    parser.add_argument("--set", action="append", default=[])
    options = parser.parse_args()
    for name in options.scenario:
        followers = []
        for seed in range(options.first_seed, options.first_seed + options.missions):
            scenario = load(name, [*options.set, f"run.seed={seed}", "run.step_s=0.1"])
            followers += mission(Simulation(scenario), options.seconds, options.carry)
        lost = sum(follower.lost_steps > 0 for follower in followers)
        wrong = sum(follower.wrong_steps > 0 for follower in followers)
        said = f"{name}: {len(followers)} robots; said lost {lost}, wrong {wrong}"
        if options.carry:
            print(f"{said}; found within {WITHIN_M:g} m: {sum(follower.found_m <= WITHIN_M for follower in followers)}")
        else:
            errors = np.array([error for follower in followers for error in follower.errors])
            (middle_m, middle_deg), (high_m, high_deg) = np.percentile(errors, (50, 95), axis=0)
            print(f"{said}; median {middle_m:.3f} m {middle_deg:.2f} deg, 95 % {high_m:.3f} m {high_deg:.2f} deg")


def mission(simulation: Simulation, seconds: float, carry: bool) -> list[Follower]:
    """Run one mission, and return the robots that were followed: robot 0 alone if it is carried."""
    scenario = simulation.scenario
    count = 1 if carry else scenario.num_robots
    followers = [Follower(robot_id, simulation) for robot_id in range(count) if robot_id != scenario.base]
    carried_step = int(stream(scenario.run.seed, "carry").integers(1000, 2000))
    places = []
    for step in range(round(seconds / scenario.run.step_s)):
        record = simulation.step()
        readings = list(record.state.readings()[: scenario.num_robots])
        for follower in followers:
            follower.step(record.sim_time_ns, readings)
        places.append(readings[-1].true_pose)
        if carry and step == carried_step:
            # Where the last robot was half of the time ago: elsewhere, and free by now.
            simulation.world.set_pose(0, places[carried_step // 2])
            for follower in followers:
                follower.carry()
    return followers


if __name__ == "__main__":
    main()
