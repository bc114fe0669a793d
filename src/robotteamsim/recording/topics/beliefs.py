"""The topics of what each robot believes: where it is, and what is there."""

from __future__ import annotations

from typing import Any, get_args

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.interface import Estimate, Localisation
from robotteamsim.interface.localisation import LocalisationState
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header
from robotteamsim.recording.topics.base import (
    Topic,
    When,
    check_finite,
    check_place,
    occupancy_grid,
    pose,
    read_occupancy_grid,
)
from robotteamsim.recording.topics.robots import TF, full_covariance, localization, odometry_origin, plane_covariance
from robotteamsim.scenario import Scenario
from robotteamsim.sensing.readings import OdometryReading


def _localises(scenario: Scenario) -> bool:
    return scenario.control.localises


def _has_particles(scenario: Scenario) -> bool:
    return scenario.control.localisation == "laser" and not _maps(scenario)


def _maps(scenario: Scenario) -> bool:
    return scenario.control.map == "unknown"


def believed_pose(time_ns: int, believed: Localisation) -> RosMessage:
    """geometry_msgs/PoseWithCovarianceStamped, of `amcl_pose`: the most likely place."""
    return {"header": header(time_ns, MAP_FRAME), "pose": _estimate(believed.estimates[0])}


def localisation(time_ns: int, robot_id: int, believed: Localisation) -> RosMessage:
    """robotteamsim/Localisation."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "robot_id": robot_id,
        "state": believed.state,
        "estimates": [_estimate(one) for one in believed.estimates],
    }


def _estimate(estimate: Estimate) -> RosMessage:
    """geometry_msgs/PoseWithCovariance."""
    return {"pose": pose(PoseReading.from_pose(estimate.pose)), "covariance": full_covariance(estimate.covariance)}


def read_localisation(message: Any) -> Localisation:
    """Return where a robot believes to be. Raises: ValueError: an unknown state, no place, or an impossible one."""
    if message.state not in get_args(LocalisationState):
        raise ValueError(f"state {message.state!r:.60}; expected {', '.join(get_args(LocalisationState))}")
    if not message.estimates:
        raise ValueError("no estimates; expected at least one")
    return Localisation(message.state, tuple(map(_read_estimate, message.estimates)))


def _read_estimate(message: Any) -> Estimate:
    covariance = plane_covariance(message.covariance)
    check_finite("estimate", *covariance)
    return Estimate(_read_pose("estimate", message.pose), covariance)


def particle_cloud(time_ns: int, particles: tuple[Pose, ...]) -> RosMessage:
    """geometry_msgs/PoseArray, of `particlecloud`: where the robot may be, each as likely as any other."""
    return {"header": header(time_ns, MAP_FRAME), "poses": [pose(PoseReading.from_pose(one)) for one in particles]}


def read_particle_cloud(message: Any) -> tuple[Pose, ...]:
    """Return where a robot may be. Raises: ValueError: an impossible place."""
    return tuple(_read_pose("particle", one) for one in message.poses)


def _read_pose(name: str, place: Any) -> Pose:
    check_place(name, place.position.x, place.position.y)
    check_finite(name, place.orientation.z, place.orientation.w)
    return PoseReading(place.position.x, place.position.y, place.orientation.z, place.orientation.w).pose


def origin_transform(time_ns: int, robot_id: int, odometry: OdometryReading, believed: Localisation) -> RosMessage:
    """tf2_msgs/TFMessage: map -> odom of a robot, by the pose that it believes."""
    return {"transforms": [localization(time_ns, robot_id, odometry_origin(believed.pose, odometry))]}


LOCALISATION = Topic(
    "localisation",
    "robotteamsim/Localisation",
    When.STEP,
    lambda _, step, i: None if (believed := step.decisions[i].localisation) is None else (i, believed),
    localisation,
    is_in=_localises,
    read=lambda message, *_: read_localisation(message),
)
AMCL_POSE = Topic(
    "amcl_pose",
    "geometry_msgs/PoseWithCovarianceStamped",
    When.STEP,
    lambda _, step, i: None if (believed := step.decisions[i].localisation) is None else (believed,),
    believed_pose,
    latched=True,
    is_in=_localises,
)
FOUND_MAP = Topic(
    "map",
    "nav_msgs/OccupancyGrid",
    When.SHOWN,
    lambda _, step, i: None if (found := step.decisions[i].found) is None else (found,),
    occupancy_grid,
    latched=True,
    is_in=_maps,
    read=lambda message, *_: read_occupancy_grid(message),
)
PARTICLES = Topic(
    "particlecloud",
    "geometry_msgs/PoseArray",
    When.CLOUD,
    lambda _, step, i: None if (particles := step.decisions[i].particles) is None else (particles,),
    particle_cloud,
    latched=True,
    is_in=_has_particles,
    read=lambda message, *_: read_particle_cloud(message),
)
BELIEF_TOPICS = (LOCALISATION, AMCL_POSE, FOUND_MAP, PARTICLES)
"""What a robot that localises itself believes, next to what its controller decides."""

ORIGIN = Topic(
    TF.name,
    TF.type_name,
    When.STEP,
    lambda _, step, i: (
        None if (believed := step.decisions[i].localisation) is None else (i, step.readings[i].odometry, believed)
    ),
    origin_transform,
    is_in=_localises,
)
"""The part of /tf that such a robot publishes."""
