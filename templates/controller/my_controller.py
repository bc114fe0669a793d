"""A controller to start from: drive forward, turn away from obstacles, steer towards voices."""

import math

import robotteamsim as rts


class MyController:
    def __init__(self, robot_id, scenario):
        self.robot_id = robot_id
        self.near_m = 0.6
        self.heard_of = {}  # voice levels that teammates sent, by robot id

    def step(self, observation, inbox, task):
        for message in inbox:
            kind, _, text = message.payload.partition(" ")
            if kind == "level_db":  # others use the network, too
                self.heard_of[message.sender] = float(text)
        if not task.running:
            return rts.Decision()  # stands still
        robot, voice = observation.robot, observation.voice
        third = len(robot.ranges_m) // 3
        if robot.ranges_m[third:-third].min() < self.near_m:  # middle of the scan, which goes from right to left
            twist = rts.Twist(0.0, 0.0, 1.0)
        elif voice.heard:
            pose = robot.ground_truth.pose
            x_m, y_m = voice.local_best_m
            turn_rad = math.remainder(math.atan2(y_m - pose.y_m, x_m - pose.x_m) - pose.yaw_rad, math.tau)
            twist = rts.Twist(0.4, 0.0, max(-0.5, min(0.5, turn_rad)))
        else:
            twist = rts.Twist(0.4)
        update = rts.Message(self.robot_id, rts.EVERYBODY, f"level_db {voice.level_db}")
        return rts.Decision(twist, outbox=(update,) if voice.heard else (), local_best=voice.level_db)
