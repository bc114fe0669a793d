"""Exercise 4: a controller that keeps a wall half a metre to its right."""

import robotteamsim as rts


class WallFollower:
    def __init__(self, robot_id, scenario):
        pass

    def step(self, observation, inbox, task):
        ranges_m = observation.robot.ranges_m  # from right to left
        # Yours: rts.Decision(rts.Twist(forward [m/s], 0.0, turn to the left [rad/s])), depending on ranges_m.
        return rts.Decision()
