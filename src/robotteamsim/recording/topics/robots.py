"""The topics of each robot's body: odometry, laser, contact; and tf."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, robot_frame
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

_IDENTITY = PoseReading(0.0, 0.0, 0.0, 1.0)


class ContactReading(msgspec.Struct, frozen=True):
    """What a robot touches: the directions of contacts in `base_link`, ascending [rad]."""

    in_contact: bool = False
    angles_rad: tuple[float, ...] = ()


def odometry(time_ns: int, robot_id: int, reading: OdometryReading) -> RosMessage:
    """nav_msgs/Odometry for `odom`."""
    return _odometry(time_ns, robot_frame(robot_id, "odom"), robot_id, reading)


def ground_truth(time_ns: int, robot_id: int, reading: RobotReading) -> RosMessage:
    """nav_msgs/Odometry, of `base_pose_ground_truth`."""
    return _odometry(time_ns, MAP_FRAME, robot_id, OdometryReading(reading.ground_truth, reading.twist))


def _odometry(time_ns: int, frame: str, robot_id: int, reading: OdometryReading) -> RosMessage:
    return {
        "header": header(time_ns, frame),
        "child_frame_id": robot_frame(robot_id, "base_footprint"),
        "pose": {"pose": pose(reading.pose), "covariance": full_covariance(reading.pose_covariance)},
        "twist": {"twist": twist(reading.twist), "covariance": _twist_covariance(reading)},
    }


def full_covariance(of_pose: Sequence[float]) -> list[float]:
    """Return the covariance of x, y, z, roll, pitch, yaw, row by row. The floor is level: z, roll, pitch are known.

    Args: of_pose: of x, y and yaw, as in `OdometryReading.pose_covariance`.
    """
    xx, xy, x_yaw, yy, y_yaw, yaw_yaw = of_pose
    of_x, of_y, of_yaw = (
        [xx, xy, 0.0, 0.0, 0.0, x_yaw],
        [xy, yy, 0.0, 0.0, 0.0, y_yaw],
        [x_yaw, y_yaw, 0.0, 0.0, 0.0, yaw_yaw],
    )
    return of_x + of_y + 18 * [0.0] + of_yaw


def plane_covariance(of_pose: Sequence[float]) -> tuple[float, ...]:
    """Return the covariance of x, y and yaw. Args: of_pose: as `full_covariance` returns it."""
    return tuple(float(of_pose[place]) for place in (0, 1, 5, 7, 11, 35))


def _twist_covariance(reading: OdometryReading) -> list[float]:
    """Return the covariance of the speeds along x, y, z and around them, row by row."""
    forward, left, turn = reading.twist_variances
    return [forward, *6 * [0.0], left, *27 * [0.0], turn]


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
        pose_covariance=plane_covariance(of_pose),
        twist_variances=tuple(float(of_twist[place]) for place in (0, 7, 35)),
    )


def scan(time_ns: int, robot_id: int, laser: Laser, ranges_m: np.ndarray, step_s: float = 0.0) -> RosMessage:
    """sensor_msgs/LaserScan, of `base_scan`. Args: step_s: time between two scans [s]; 0: unknown."""
    return laser.scan(header(time_ns, robot_frame(robot_id, "base_laser_link")), ranges_m, step_s)


def read_ranges_m(message: Any, beams: int) -> np.ndarray:
    """Return the ranges of a scan, float32, shape (beams,) [m]; NaN and infinity are valid (REP-117).

    Raises: ValueError: another number of ranges.
    """
    if len(message.ranges) != beams:
        raise ValueError(f"ranges: {len(message.ranges)} entries; expected {beams}, the beams of the scenario's laser")
    return np.array(message.ranges, dtype=np.float32)


def contact(time_ns: int, robot_id: int, in_contact: bool, angles_rad: tuple[float, ...] = ()) -> RosMessage:
    """robotteamsim/Contact."""
    return {
        "header": header(time_ns, robot_frame(robot_id, "base_link")),
        "in_contact": in_contact,
        "angles_rad": angles_rad,
    }


def read_contact(message: Any) -> ContactReading:
    """Return what a robot touches. Raises: ValueError: angles that are not finite."""
    check_finite("angles_rad", *message.angles_rad)
    return ContactReading(bool(message.in_contact), tuple(map(float, message.angles_rad)))


def transforms(
    time_ns: int,
    robots: Sequence[Robot],
    odometry: Iterable[OdometryReading | None],
    origins: Sequence[PoseReading | None],
) -> RosMessage:
    """tf2_msgs/TFMessage: the `robot_transforms` of all robots, in id order; None for an absent robot.

    Args: origins: of each odometry in `map`, for the `localization` of each robot; None: without.
    """
    links = []
    for robot_id, (robot, reading, origin) in enumerate(zip(robots, odometry, origins, strict=True)):
        if reading is not None:
            links += [] if origin is None else [localization(time_ns, robot_id, origin)]
            links += robot_transforms(time_ns, robot_id, robot, reading)
    return {"transforms": links}


def odometry_origin(pose: Pose, odometry: OdometryReading) -> PoseReading:
    """Return the origin of a robot's odometry in `map`. Args: pose: of the robot, true or believed."""
    return PoseReading.from_pose(pose @ odometry.pose.pose.inverse())


def robot_transforms(time_ns: int, robot_id: int, robot: Robot, odometry: OdometryReading) -> list[Any]:
    """geometry_msgs/TransformStamped[]: odom -> base_footprint -> base_link -> base_laser_link.

    The frames of additional sensors follow, base_link -> <name>_link -> <name>_optical_frame of cameras.
    """
    laser = PoseReading(robot.laser.forward_m, robot.laser.left_m, 0.0, 1.0)
    links = [
        _transform(time_ns, robot_id, "odom", "base_footprint", odometry.pose),
        _transform(time_ns, robot_id, "base_footprint", "base_link", _IDENTITY),
        _transform(time_ns, robot_id, "base_link", "base_laser_link", laser, robot.laser.height_m),
    ]
    frames = (frame for sensor in robot.sensors for frame in sensor.frames())
    return [*links, *(_sensor_transform(time_ns, robot_id, frame) for frame in frames)]


def localization(time_ns: int, robot_id: int, place: PoseReading) -> RosMessage:
    """geometry_msgs/TransformStamped: map -> odom, for an odometry that began at `place`."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "child_frame_id": robot_frame(robot_id, "odom"),
        "transform": _pose_as_transform(place, 0.0),
    }


def _transform(
    time_ns: int, robot_id: int, parent: str, child: str, place: PoseReading, height_m: float = 0.0
) -> RosMessage:
    return {
        "header": header(time_ns, robot_frame(robot_id, parent)),
        "child_frame_id": robot_frame(robot_id, child),
        "transform": _pose_as_transform(place, height_m),
    }


def _sensor_transform(time_ns: int, robot_id: int, frame: Frame) -> RosMessage:
    (x, y, z), (qx, qy, qz, qw) = frame.position_m, frame.rotation
    return {
        "header": header(time_ns, robot_frame(robot_id, frame.parent)),
        "child_frame_id": robot_frame(robot_id, frame.name),
        "transform": {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
        },
    }


def _pose_as_transform(place: PoseReading, height_m: float) -> RosMessage:
    return {
        "translation": {"x": place.x_m, "y": place.y_m, "z": height_m},
        "rotation": quaternion(place),
    }


def _of_all(
    source: Source, record: StepRecord
) -> tuple[Sequence[Robot], list[OdometryReading | None], list[PoseReading | None]]:
    present, origins = list[OdometryReading | None](), list[PoseReading | None]()
    for robot_id, (reading, decision) in enumerate(zip(record.readings, record.decisions, strict=True)):
        if source.setup.scenario.control.localises:
            pose = None if decision.localisation is None else decision.localisation.pose
        else:
            pose = reading.true_pose if source.localized else None
        present.append(reading.odometry if record.is_there(robot_id) else None)
        origins.append(None if pose is None else odometry_origin(pose, reading.odometry))
    return source.setup.robots, present, origins


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
