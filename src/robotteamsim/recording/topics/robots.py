"""The topics of each robot's body: odometry, laser, contact; and tf."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.message_parts import MAP_FRAME, Make, header, robot_frame
from robotteamsim.recording.topics.base import (
    Source,
    Topic,
    When,
    check_finite,
    check_place,
    pose,
    quaternion,
    twist,
)
from robotteamsim.scenario.sections import Laser, Robot
from robotteamsim.scenario.sensors.base import Frame
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.simulation import StepRecord

# Indices of the nine covariances of x, y and yaw among the 36 of (x, y, z, roll, pitch, yaw), and the element of the
# triangle that each one is. All others are 0: the floor is level, so z, roll and pitch are known.
_PLANE_OF_36 = np.array([0, 1, 5, 6, 7, 11, 30, 31, 35])
_OF_TRIANGLE = np.array([0, 1, 2, 1, 3, 4, 2, 4, 5])
_IDENTITY = PoseReading(0.0, 0.0, 0.0, 1.0)


class ContactReading(msgspec.Struct, frozen=True):
    """What a robot touches: the directions of contacts in `base_link`, ascending [rad]."""

    in_contact: bool = False
    angles_rad: tuple[float, ...] = ()


def odometry(make: Make, time_ns: int, robot_id: int, reading: OdometryReading) -> Any:
    """nav_msgs/Odometry for `odom`."""
    return _odometry(make, time_ns, robot_frame(robot_id, "odom"), robot_id, reading)


def ground_truth(make: Make, time_ns: int, robot_id: int, reading: RobotReading) -> Any:
    """nav_msgs/Odometry, of `base_pose_ground_truth`."""
    return _odometry(make, time_ns, MAP_FRAME, robot_id, OdometryReading(reading.ground_truth, reading.twist))


def _odometry(make: Make, time_ns: int, frame: str, robot_id: int, reading: OdometryReading) -> Any:
    pose_covariance = pose_covariances(np.array(reading.pose_covariance))
    twist_covariance = twist_covariances(np.array(reading.twist_variances))
    return make(
        "nav_msgs/Odometry",
        header=header(make, time_ns, frame),
        child_frame_id=robot_frame(robot_id, "base_footprint"),
        pose=make("geometry_msgs/PoseWithCovariance", pose=pose(make, reading.pose), covariance=pose_covariance),
        twist=make("geometry_msgs/TwistWithCovariance", twist=twist(make, reading.twist), covariance=twist_covariance),
    )


def pose_covariances(triangles: np.ndarray) -> np.ndarray:
    """Return `OdometryReading.pose_covariance`, shape (..., 6), in the layout of ROS, shape (..., 36)."""
    covariances = np.zeros((*triangles.shape[:-1], 36))
    covariances[..., _PLANE_OF_36] = triangles[..., _OF_TRIANGLE]
    return covariances


def twist_covariances(variances: np.ndarray) -> np.ndarray:
    """Return `OdometryReading.twist_variances`, shape (..., 3), in the layout of ROS, shape (..., 36)."""
    covariances = np.zeros((*variances.shape[:-1], 36))
    covariances[..., [0, 7, 35]] = variances
    return covariances


def read_odometry(message: Any) -> OdometryReading:
    """Return pose and twist in the plane of `odom` or `base_pose_ground_truth`; height, roll and pitch are ignored.

    Raises: ValueError: numbers that are not finite, or too far away.
    """
    place, speed = message.pose.pose, message.twist.twist
    of_pose, of_twist = message.pose.covariance, message.twist.covariance
    check_place("position", place.position.x, place.position.y)
    check_finite("orientation", place.orientation.z, place.orientation.w)
    check_finite("twist", speed.linear.x, speed.linear.y, speed.angular.z)
    return OdometryReading(
        PoseReading(place.position.x, place.position.y, place.orientation.z, place.orientation.w),
        Twist(speed.linear.x, speed.linear.y, speed.angular.z),
        pose_covariance=(of_pose[0], of_pose[1], of_pose[5], of_pose[7], of_pose[11], of_pose[35]),
        twist_variances=(of_twist[0], of_twist[7], of_twist[35]),
    )


def scan(make: Make, time_ns: int, robot_id: int, laser: Laser, ranges_m: np.ndarray, step_s: float = 0.0) -> Any:
    """sensor_msgs/LaserScan, of `base_scan`. Args: step_s: time between two scans [s]; 0: unknown."""
    return laser.scan(make, header(make, time_ns, robot_frame(robot_id, "base_laser_link")), ranges_m, step_s)


def read_ranges_m(message: Any, beams: int) -> np.ndarray:
    """Return the ranges of a scan, float32, shape (beams,) [m]; NaN and infinity are valid (REP-117).

    Raises: ValueError: another number of ranges.
    """
    if len(message.ranges) != beams:
        raise ValueError(f"ranges: {len(message.ranges)} entries; expected {beams}, the beams of the scenario's laser")
    return np.array(message.ranges, dtype=np.float32)


def contact(make: Make, time_ns: int, robot_id: int, in_contact: bool, angles_rad: tuple[float, ...] = ()) -> Any:
    """robotteamsim/Contact."""
    return make(
        "robotteamsim/Contact",
        header=header(make, time_ns, robot_frame(robot_id, "base_link")),
        in_contact=bool(in_contact),
        angles_rad=np.array(angles_rad, dtype=np.float64),
    )


def read_contact(message: Any) -> ContactReading:
    """Return what a robot touches. Raises: ValueError: angles that are not finite."""
    check_finite("angles_rad", *message.angles_rad)
    return ContactReading(bool(message.in_contact), tuple(message.angles_rad))


def transforms(
    make: Make,
    time_ns: int,
    robots: Sequence[Robot],
    odometry: Iterable[OdometryReading | None],
    origins: Sequence[PoseReading] = (),
) -> Any:
    """tf2_msgs/TFMessage: the `robot_transforms` of all robots, in id order; None for an absent robot.

    Args: origins: of each odometry in `map`, for the `localization` of each robot; empty: without.
    """
    links = []
    for robot_id, (robot, reading) in enumerate(zip(robots, odometry, strict=True)):
        if reading is not None:
            links += [localization(make, time_ns, robot_id, origins[robot_id])] if origins else []
            links += robot_transforms(make, time_ns, robot_id, robot, reading)
    return make("tf2_msgs/TFMessage", transforms=links)


def odometry_origin(reading: RobotReading) -> PoseReading:
    """Return the origin of a robot's odometry in `map`."""
    if math.isnan(reading.ground_truth.x_m):
        return _IDENTITY  # of a robot that is not present; it is not published
    return PoseReading.from_pose(reading.ground_truth.pose @ reading.odometry.pose.pose.inverse())


def robot_transforms(make: Make, time_ns: int, robot_id: int, robot: Robot, odometry: OdometryReading) -> list[Any]:
    """geometry_msgs/TransformStamped[]: odom -> base_footprint -> base_link -> base_laser_link.

    The frames of additional sensors follow, base_link -> <name>_link -> <name>_optical_frame of cameras.
    """
    laser = PoseReading(robot.laser.forward_m, robot.laser.left_m, 0.0, 1.0)
    links = [
        _transform(make, time_ns, robot_id, "odom", "base_footprint", odometry.pose),
        _transform(make, time_ns, robot_id, "base_footprint", "base_link", _IDENTITY),
        _transform(make, time_ns, robot_id, "base_link", "base_laser_link", laser, robot.laser.height_m),
    ]
    frames = (frame for sensor in robot.sensors for frame in sensor.frames())
    return [*links, *(_sensor_transform(make, time_ns, robot_id, frame) for frame in frames)]


def localization(make: Make, time_ns: int, robot_id: int, place: PoseReading) -> Any:
    """geometry_msgs/TransformStamped: map -> odom, for an odometry that began at `place`."""
    return make(
        "geometry_msgs/TransformStamped",
        header=header(make, time_ns, MAP_FRAME),
        child_frame_id=robot_frame(robot_id, "odom"),
        transform=_pose_as_transform(make, place, 0.0),
    )


def _transform(
    make: Make, time_ns: int, robot_id: int, parent: str, child: str, place: PoseReading, height_m: float = 0.0
) -> Any:
    return make(
        "geometry_msgs/TransformStamped",
        header=header(make, time_ns, robot_frame(robot_id, parent)),
        child_frame_id=robot_frame(robot_id, child),
        transform=_pose_as_transform(make, place, height_m),
    )


def _sensor_transform(make: Make, time_ns: int, robot_id: int, frame: Frame) -> Any:
    (x, y, z), (qx, qy, qz, qw) = frame.position_m, frame.rotation
    return make(
        "geometry_msgs/TransformStamped",
        header=header(make, time_ns, robot_frame(robot_id, frame.parent)),
        child_frame_id=robot_frame(robot_id, frame.name),
        transform=make(
            "geometry_msgs/Transform",
            translation=make("geometry_msgs/Vector3", x=x, y=y, z=z),
            rotation=make("geometry_msgs/Quaternion", x=qx, y=qy, z=qz, w=qw),
        ),
    )


def _pose_as_transform(make: Make, place: PoseReading, height_m: float) -> Any:
    return make(
        "geometry_msgs/Transform",
        translation=make("geometry_msgs/Vector3", x=place.x_m, y=place.y_m, z=height_m),
        rotation=quaternion(make, place),
    )


def _of_all(source: Source, record: StepRecord) -> tuple[Sequence[Robot], list[OdometryReading | None]]:
    present = [
        reading.odometry if record.is_there(robot_id) else None for robot_id, reading in enumerate(record.readings)
    ]
    return source.setup.robots, present


TF = Topic("/tf", "tf2_msgs/TFMessage", When.STEP, _of_all, transforms)
ODOM = Topic(
    "odom",
    "nav_msgs/Odometry",
    When.STEP,
    lambda _, step, i: (i, step.readings[i].odometry),
    odometry,
    read=lambda message, *_: read_odometry(message),
)
SCAN = Topic(
    "base_scan",
    "sensor_msgs/LaserScan",
    When.STEP,
    lambda source, step, i: (
        i,
        source.setup.robots[i].laser,
        step.state.ranges_of(i),  # not the array that a controller has, which could change its shape
        source.setup.scenario.run.step_s,
    ),
    scan,
    read=lambda message, setup, i: read_ranges_m(message, setup.robots[i].laser.beams),
)
TRUTH = Topic(
    "base_pose_ground_truth",
    "nav_msgs/Odometry",
    When.STEP,
    lambda _, step, i: (i, step.readings[i]),
    ground_truth,
    read=lambda message, *_: read_odometry(message),
)
CONTACT = Topic(
    "contact",
    "robotteamsim/Contact",
    When.STEP,
    lambda _, step, i: (i, step.readings[i].in_contact, step.readings[i].contact_angles_rad),
    contact,
    read=lambda message, *_: read_contact(message),
)
BODY_TOPICS = (ODOM, SCAN, TRUTH, CONTACT)
"""What a robot senses; the sensors of `robots.sensors` have their topics in their own classes."""
