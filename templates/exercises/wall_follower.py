"""Exercise 4: a controller that keeps a wall half a metre to its right."""

import robotteamsim as rts


class WallFollower:
    def __init__(self, robot_id, scenario):
        pass

    def step(self, observation, inbox, task):
        # Yours: rts.Decision(rts.Twist(forward [m/s], 0.0, turn to the left [rad/s])), depending on
        # observation.robot.ranges_m, which are from right to left.
        return rts.Decision()
