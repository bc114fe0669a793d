"""Solution 4: a controller that keeps a wall half a metre to its right."""

import robotteamsim as rts

WANTED_M = 0.5
FREE_M = 0.8


class WallFollower:
    def __init__(self, robot_id, scenario):
        pass

    def step(self, observation, inbox, task):
        if not task.running:
            return rts.Decision()
        ranges_m = observation.robot.ranges_m  # from right to left
        quarter = len(ranges_m) // 4
        right_m, ahead_m = ranges_m[:quarter].min(), ranges_m[quarter:-quarter].min()
        if ahead_m < FREE_M:
            return rts.Decision(rts.Twist(0.0, 0.0, 1.0))  # turn left, away from the obstacle
        turn_radps = max(-0.8, min(0.8, 2.0 * (WANTED_M - right_m)))
        return rts.Decision(rts.Twist(0.3, 0.0, turn_radps))
