"""A team whose readings are published, and the subscribers that compare them with what genpy makes of them."""

from __future__ import annotations

import numpy as np
from nav_msgs.msg import Odometry
from peers import Peer, Wire, wait_until
from robotteamsim.msg import Contact
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from robotteamsim.recording import ros_messages
from robotteamsim.ros.nodes.team_outputs import TeamOutputs
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.serialization import deserialized, serialized
from robotteamsim.scenario.sections import Laser, PlacedRobot
from robotteamsim.sensing.readings import TeamReadings

TIME_NS = 12_345_678_901
ROBOTS = 12
"""Names of robots have two lengths then."""


def make_robots() -> list[PlacedRobot]:
    """Robots with two kinds of lasers."""
    lasers = (Laser(), Laser(beams=7, forward_m=0.1))
    return [PlacedRobot(start_pose=(float(i), 0.0, 0.0), laser=lasers[i % 5 == 0]) for i in range(ROBOTS)]


def make_readings() -> TeamReadings:
    """Return readings of which no two are equal; some robots touch something."""
    robots = make_robots()
    generator = np.random.default_rng(5)
    angles = generator.uniform(-3.0, 3.0, (ROBOTS, 1))
    odometry = np.hstack((generator.normal(size=(ROBOTS, 2)), np.sin(angles), np.cos(angles)))
    positions_m = generator.normal(size=(ROBOTS, 2))
    truth = np.hstack((positions_m, np.sin(-angles), np.cos(-angles), generator.normal(size=(ROBOTS, 3))))
    in_contact = (np.arange(ROBOTS) % 4 > 1)[:, np.newaxis]
    return TeamReadings(
        rows=np.hstack((truth, odometry, generator.normal(size=(ROBOTS, 12)), in_contact)),
        ranges_m=[generator.uniform(0.1, 5.0, robot.laser.beams).astype(np.float32) for robot in robots],
        contact_angles_rad={2: (0.5,), 3: (-1.0, 1.0), 11: (3.0,)},
    )


TEAM_TOPICS = {"odom": Odometry, "base_pose_ground_truth": Odometry, "base_scan": LaserScan, "contact": Contact}


class TeamPeers:
    """Subscribers of all topics of a team, which are latched, and of its frames."""

    def __init__(self, robots: list[PlacedRobot], *, localized: bool) -> None:
        self.outputs = TeamOutputs(robots, latched=True, localized=localized)
        self.tf = Peer("/tf", TFMessage)
        wait_until(lambda: self.outputs._tf._topic.is_wanted, "the subscriber of /tf")

    @staticmethod
    def latched(robot_id: int, name: str) -> object:
        wire = Wire(f"/robot_{robot_id}/{name}", TEAM_TOPICS[name])
        return deserialized(TEAM_TOPICS[name], wire.next())


def expected_messages(make: RosTypes, robots: list[PlacedRobot], readings: TeamReadings, i: int) -> dict[str, object]:
    reading = readings[i]
    return {
        "odom": ros_messages.odometry(make, TIME_NS, i, reading.odometry),
        "base_pose_ground_truth": ros_messages.ground_truth(make, TIME_NS, i, reading),
        "base_scan": ros_messages.scan(make, TIME_NS, i, robots[i].laser, reading.ranges_m),
        "contact": ros_messages.contact(make, TIME_NS, i, reading.in_contact, reading.contact_angles_rad),
    }


def body(message: object) -> bytes:
    """Return the bytes of a message after its header's number, which counts what was published."""
    return serialized(message)[4:]
