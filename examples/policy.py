"""A policy drives the team: two numbers per decision, forward and turn, from the vector that a network would see."""

import numpy as np

import robotteamsim as rts
from robotteamsim.learning import PolicyController


class Policy(PolicyController):
    """Drives on where the laser is free, and turns where it is not. Your trained network takes the place of this."""

    def choose(self, vector):
        left, ahead, right = vector[121:181].mean(), vector[60:121].min(), vector[:60].mean()
        turn = 0.0 if ahead > 0.15 else np.copysign(1.0, left - right)
        return np.array([ahead, turn], np.float32)


if __name__ == "__main__":
    for algorithm in ("policy:Policy", "random_walk"):
        settings = [f"control.algorithm={algorithm}", "run.seed=7", "mission.time_limit_s=120"]
        result = rts.Simulation(rts.load("garage_sar", settings)).run()
        driven_m = sum(robot.distance_m for robot in result.robots)
        print(f"{algorithm}: {result.areas_explored} areas, {result.victims_saved} victims, {driven_m:.0f} m driven")
