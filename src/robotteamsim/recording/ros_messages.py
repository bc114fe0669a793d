"""Conversion of our values to ROS messages, shared by bags written without ROS and by the nodes.

Every function takes `make`, which builds a message of a named type from all of its attributes: `BagTypes` builds those
of rosbags, and the nodes pass a factory for their own message classes. Numeric arrays are passed as NumPy arrays of the
attribute's type; a factory converts them if its classes need something else.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Protocol

import msgspec
import numpy as np

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Discovery, SwarmContext
from robotteamsim.mission.status import DeliveredDiscoveries, Event, MissionStatus, VictimState
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.sections import Area, Laser, Robot, Victim
from robotteamsim.scenario.sensors import Camera, LightSensor
from robotteamsim.sensing.readings import OdometryReading, RobotReading, TeamReadings, VoiceReading
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState

MAP_FRAME = "map"

# Indices of the nine covariances of x, y and yaw among the 36 of (x, y, z, roll, pitch, yaw), and the element of the
# triangle that each one is. All others are 0: the floor is level, so z, roll and pitch are known.
_PLANE_OF_36 = np.array([0, 1, 5, 6, 7, 11, 30, 31, 35])
_OF_TRIANGLE = np.array([0, 1, 2, 1, 3, 4, 2, 4, 5])
_IDENTITY = PoseReading(0.0, 0.0, 0.0, 1.0)
_NOTHING_DELIVERED = DeliveredDiscoveries()


class Make(Protocol):
    """Builds messages."""

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message of a type such as "nav_msgs/Odometry"; every attribute is given."""

    def time(self, time_ns: int) -> Any:
        """Return the stamp of a time [ns]."""


def robot_name(robot_id: int) -> str:
    """Return the namespace and frame prefix of a robot: robot_0."""
    return f"robot_{robot_id}"


def robot_frame(robot_id: int, frame: str) -> str:
    """Return the tf2 name of a robot's frame: robot_0/base_link."""
    return f"robot_{robot_id}/{frame}"


def header(make: Make, time_ns: int, frame: str) -> Any:
    """std_msgs/Header."""
    return make("std_msgs/Header", seq=0, stamp=make.time(time_ns), frame_id=frame)


def point(make: Make, position_m: tuple[float, float]) -> Any:
    """geometry_msgs/Point on the floor."""
    return make("geometry_msgs/Point", x=float(position_m[0]), y=float(position_m[1]), z=0.0)


def pose(make: Make, reading: PoseReading) -> Any:
    """geometry_msgs/Pose."""
    return make(
        "geometry_msgs/Pose", position=point(make, (reading.x_m, reading.y_m)), orientation=_quaternion(make, reading)
    )


def clock(make: Make, time_ns: int) -> Any:
    """rosgraph_msgs/Clock."""
    return make("rosgraph_msgs/Clock", clock=make.time(time_ns))


def twist(make: Make, command: Twist) -> Any:
    """geometry_msgs/Twist, of `cmd_vel`."""
    return make(
        "geometry_msgs/Twist",
        linear=make("geometry_msgs/Vector3", x=command.linear_x_mps, y=command.linear_y_mps, z=0.0),
        angular=make("geometry_msgs/Vector3", x=0.0, y=0.0, z=command.angular_z_radps),
    )


def twist_stamped(make: Make, time_ns: int, robot_id: int, command: Twist) -> Any:
    """geometry_msgs/TwistStamped, of `cmd_vel_stamped`: carries the stamp of the step it answers."""
    return make(
        "geometry_msgs/TwistStamped",
        header=header(make, time_ns, robot_frame(robot_id, "base_link")),
        twist=twist(make, command),
    )


def odometry(make: Make, time_ns: int, robot_id: int, reading: OdometryReading) -> Any:
    """nav_msgs/Odometry for `odom`."""
    return _odometry(make, time_ns, robot_frame(robot_id, "odom"), robot_id, reading)


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


def ground_truth(make: Make, time_ns: int, robot_id: int, reading: RobotReading) -> Any:
    """nav_msgs/Odometry, of `base_pose_ground_truth`."""
    return _odometry(make, time_ns, MAP_FRAME, robot_id, OdometryReading(reading.ground_truth, reading.twist))


def scan(
    make: Make, time_ns: int, robot_id: int, laser: Laser, ranges_m: np.ndarray, frame: str = "base_laser_link"
) -> Any:
    """sensor_msgs/LaserScan, of `base_scan` and of further lasers."""
    return make(
        "sensor_msgs/LaserScan",
        header=header(make, time_ns, robot_frame(robot_id, frame)),
        angle_min=laser.angle_min_rad,
        angle_max=laser.angle_max_rad,
        angle_increment=(laser.angle_max_rad - laser.angle_min_rad) / max(laser.beams - 1, 1),
        time_increment=0.0,
        scan_time=0.0,
        range_min=laser.range_min_m,
        range_max=laser.range_max_m,
        ranges=np.asarray(ranges_m, dtype=np.float32),
        intensities=np.zeros(0, dtype=np.float32),
    )


def contact(make: Make, time_ns: int, robot_id: int, in_contact: bool, angles_rad: tuple[float, ...] = ()) -> Any:
    """robotteamsim/Contact."""
    return make(
        "robotteamsim/Contact",
        header=header(make, time_ns, robot_frame(robot_id, "base_link")),
        in_contact=bool(in_contact),
        angles_rad=np.array(angles_rad, dtype=np.float64),
    )


def transforms(make: Make, time_ns: int, robots: Sequence[Robot], odometry: Iterable[OdometryReading | None]) -> Any:
    """tf2_msgs/TFMessage: the `robot_transforms` of all robots, in id order; None for an absent robot."""
    return make(
        "tf2_msgs/TFMessage",
        transforms=[
            transform
            for robot_id, (robot, reading) in enumerate(zip(robots, odometry, strict=True))
            if reading is not None
            for transform in robot_transforms(make, time_ns, robot_id, robot, reading)
        ],
    )


def robot_transforms(make: Make, time_ns: int, robot_id: int, robot: Robot, odometry: OdometryReading) -> list[Any]:
    """geometry_msgs/TransformStamped[]: odom -> base_footprint -> base_link -> base_laser_link.

    The frames of further sensors follow, base_link -> <name>_link, and of cameras <name>_link -> <name>_optical_frame.
    """
    laser = PoseReading(robot.laser.forward_m, 0.0, 0.0, 1.0)
    links = [
        _transform(make, time_ns, robot_id, "odom", "base_footprint", odometry.pose),
        _transform(make, time_ns, robot_id, "base_footprint", "base_link", _IDENTITY),
        _transform(make, time_ns, robot_id, "base_link", "base_laser_link", laser, robot.laser.height_m),
    ]
    for mount in robot.mounts:
        place = PoseReading.from_pose(Pose(mount.forward_m, mount.left_m, mount.yaw_rad))
        frame = f"{mount.name}_link"
        link = _transform(make, time_ns, robot_id, "base_link", frame, place, mount.height_m)
        if isinstance(mount, LightSensor):
            link.transform.rotation = _pitched(make, mount.yaw_rad, mount.pitch_rad)
        links.append(link)
    return [*links, *(_optical_transform(make, time_ns, robot_id, camera) for camera in robot.cameras)]


def optical_frame(camera: Camera) -> str:
    """Return the frame of a camera's images, as in REP 103: z forward, x to the right, y down."""
    return f"{camera.name}_optical_frame"


def localization(make: Make, time_ns: int, robot_id: int, place: PoseReading) -> Any:
    """geometry_msgs/TransformStamped: map -> odom, for an odometry that began at `place`."""
    return make(
        "geometry_msgs/TransformStamped",
        header=header(make, time_ns, MAP_FRAME),
        child_frame_id=robot_frame(robot_id, "odom"),
        transform=_pose_as_transform(make, place, 0.0),
    )


def occupancy_grid(make: Make, time_ns: int, grid: OccupancyGrid) -> Any:
    """nav_msgs/OccupancyGrid, of `map`."""
    return _grid(make, time_ns, grid.origin_m, grid.resolution_m, grid.cells)


def field_map_picture(make: Make, time_ns: int, field: FieldMap) -> Any:
    """nav_msgs/OccupancyGrid of a map of levels, or of a belief in per cent, for rviz: integers from 0 to 100."""
    levels = np.clip(np.round(field.values), 0, 100).astype(np.int8)
    return _grid(make, time_ns, field.origin_m, field.resolution_m, levels)


def radio_map_picture(make: Make, time_ns: int, field: FieldMap) -> Any:
    """nav_msgs/OccupancyGrid of a map of signal strengths, for rviz: 0 at -100 dBm and below, 100 at 0 dBm."""
    return field_map_picture(make, time_ns, FieldMap(field.origin_m, field.resolution_m, field.values + 100.0))


def field_map(make: Make, time_ns: int, field: FieldMap, quantity: str, unit: str) -> Any:
    """robotteamsim/FloatMap, such as quantity "voice_level" in unit "dB"."""
    rows, columns = field.values.shape
    return make(
        "robotteamsim/FloatMap",
        header=header(make, time_ns, MAP_FRAME),
        quantity=quantity,
        unit=unit,
        resolution_m=field.resolution_m,
        width=columns,
        height=rows,
        origin=point(make, field.origin_m),
        data=np.asarray(field.values, dtype=np.float32).ravel(),
    )


def voice(make: Make, time_ns: int, reading: VoiceReading) -> Any:
    """robotteamsim/Voice."""
    return make(
        "robotteamsim/Voice",
        header=header(make, time_ns, MAP_FRAME),
        level_db=float(reading.level_db),
        heard=bool(reading.heard),
        local_best=point(make, reading.local_best_m),
        local_best_level_db=float(reading.local_best_level_db),
    )


def team_voices(make: Make, time_ns: int, voices: Sequence[VoiceReading]) -> Any:
    """robotteamsim/TeamVoices. Args: voices: of each robot, by id."""
    return make(
        "robotteamsim/TeamVoices",
        header=header(make, time_ns, MAP_FRAME),
        level_db=[voice.level_db for voice in voices],
        heard=bytes(voice.heard for voice in voices),
        local_best=[coordinate_m for voice in voices for coordinate_m in voice.local_best_m],
        local_best_level_db=[voice.local_best_level_db for voice in voices],
    )


def controller_status(make: Make, time_ns: int, robot_id: int, decision: Decision) -> Any:
    """robotteamsim/ControllerStatus."""
    return make(
        "robotteamsim/ControllerStatus",
        header=header(make, time_ns, MAP_FRAME),
        robot_id=robot_id,
        excluded=bool(decision.excluded),
        swarm=int(decision.swarm),
        has_goal=decision.goal_m is not None,
        goal=point(make, decision.goal_m or (0.0, 0.0)),
        local_best=float(decision.local_best),
        search_counter=int(decision.search_counter),
        context=[] if decision.context is None else [swarm_context(make, decision.context)],
        fault=decision.fault,
        done=decision.done,
    )


def swarm_context(make: Make, context: SwarmContext) -> Any:
    """robotteamsim/SwarmContext."""
    return make("robotteamsim/SwarmContext", **msgspec.structs.asdict(context))


def mission_status(make: Make, time_ns: int, scenario_name: str, status: MissionStatus, noise_db: float) -> Any:
    """robotteamsim/MissionStatus."""
    task, delivered = status.task, status.delivered or _NOTHING_DELIVERED
    return make(
        "robotteamsim/MissionStatus",
        header=header(make, time_ns, MAP_FRAME),
        scenario=scenario_name,
        state=status.state,
        end=status.end,
        time_s=status.time_s,
        explored=np.array(status.explored, dtype=np.uint8),
        victims=list(status.victims),
        target_area=status.target_area,
        endangered_links=status.endangered_links,
        noise_db=float(noise_db),
        running=task.running,
        epoch=task.epoch,
        has_area=task.area_center_m is not None,
        area_center=point(make, task.area_center_m or (0.0, 0.0)),
        area_radius_m=float(task.area_radius_m),
        has_base=status.delivered is not None,
        discoveries_delivered=delivered.count,
        mean_delivery_delay_s=delivered.mean_delay_s,
        max_delivery_delay_s=delivered.max_delay_s,
        undelivered=[_discovery(make, discovery) for discovery in task.undelivered],
        assistance=[
            make("robotteamsim/Assistance", **msgspec.structs.asdict(assistance)) for assistance in task.assistance
        ],
    )


def _discovery(make: Make, discovery: Discovery) -> Any:
    return make(
        "robotteamsim/Discovery",
        kind=discovery.kind,
        name=discovery.name,
        robot_id=discovery.robot_id,
        position=point(make, discovery.position_m),
        time_s=discovery.time_s,
    )


def mission_event(make: Make, time_ns: int, event: Event) -> Any:
    """robotteamsim/MissionEvent."""
    return make(
        "robotteamsim/MissionEvent",
        header=header(make, time_ns, MAP_FRAME),
        **msgspec.structs.asdict(event),
    )


def victims(make: Make, time_ns: int, all_victims: Sequence[Victim], states: Sequence[VictimState]) -> Any:
    """robotteamsim/Victims."""
    return make(
        "robotteamsim/Victims",
        header=header(make, time_ns, MAP_FRAME),
        victims=[
            make("robotteamsim/Victim", name=victim.name, position=point(make, victim.position), state=state)
            for victim, state in zip(all_victims, states, strict=True)
        ],
    )


def people(make: Make, time_ns: int, states: Sequence[PersonState]) -> Any:
    """robotteamsim/People."""
    return make(
        "robotteamsim/People",
        header=header(make, time_ns, MAP_FRAME),
        people=[
            make("robotteamsim/Person", name=one.name, position=point(make, one.position_m), motion=one.motion)
            for one in states
        ],
    )


def doors(make: Make, time_ns: int, states: DoorStates) -> Any:
    """robotteamsim/Doors."""
    return make(
        "robotteamsim/Doors",
        header=header(make, time_ns, MAP_FRAME),
        doors=[
            make("robotteamsim/Door", name=name, closed=door.closed, opening=float(door.opening), motion=door.motion)
            for name, door in states.items()
        ],
    )


MISHAPS: tuple[Mishap | None, ...] = (None, "tipped_over", "left_world")
"""Each value of `mishaps` in robotteamsim/Robots."""


def team_state(make: Make, time_ns: int, readings: TeamReadings) -> Any:
    """robotteamsim/TeamState."""
    return make(
        "robotteamsim/TeamState",
        header=header(make, time_ns, MAP_FRAME),
        poses=readings.ground_truth.ravel(),
        twists=readings.twists.ravel(),
        in_contact=readings.in_contact.astype(np.uint8),
    )


def robots(
    make: Make,
    time_ns: int,
    present: np.ndarray | None,
    arrivals: Sequence[int],
    mishaps: Mapping[int, Mishap] = MappingProxyType({}),
    failed: Collection[int] = (),
    loads: Mapping[int, str] = MappingProxyType({}),
) -> Any:
    """robotteamsim/Robots.

    Args: present: bool, shape (n,); None if all robots are present.  mishaps, loads: by id.
    """
    numbers = [MISHAPS.index(mishaps.get(robot_id)) for robot_id in range(len(arrivals))] if mishaps else []
    return make(
        "robotteamsim/Robots",
        header=header(make, time_ns, MAP_FRAME),
        present=np.ones(len(arrivals), dtype=np.uint8) if present is None else present.astype(np.uint8),
        mishaps=np.array(numbers, dtype=np.uint8),
        arrivals=np.array(arrivals, dtype=np.uint32),
        failed_by_heat=np.array([robot_id in failed for robot_id in range(len(arrivals))], dtype=np.uint8),
        loads=[loads.get(robot_id, "") for robot_id in range(len(arrivals))] if loads else [],
    )


def areas(make: Make, time_ns: int, all_areas: Sequence[Area], status: MissionStatus) -> Any:
    """robotteamsim/Areas."""
    return make(
        "robotteamsim/Areas",
        header=header(make, time_ns, MAP_FRAME),
        areas=[
            make(
                "robotteamsim/Area",
                name=area.name,
                center=point(make, area.center),
                radius_m=area.radius_m,
                explored=status.explored[index],
                target=index == status.target_area,
            )
            for index, area in enumerate(all_areas)
        ],
    )


def _quaternion(make: Make, reading: PoseReading) -> Any:
    return make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=reading.qz, w=reading.qw)


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


def _transform(
    make: Make, time_ns: int, robot_id: int, parent: str, child: str, place: PoseReading, height_m: float = 0.0
) -> Any:
    return make(
        "geometry_msgs/TransformStamped",
        header=header(make, time_ns, robot_frame(robot_id, parent)),
        child_frame_id=robot_frame(robot_id, child),
        transform=_pose_as_transform(make, place, height_m),
    )


def _optical_transform(make: Make, time_ns: int, robot_id: int, camera: Camera) -> Any:
    return make(
        "geometry_msgs/TransformStamped",
        header=header(make, time_ns, robot_frame(robot_id, f"{camera.name}_link")),
        child_frame_id=robot_frame(robot_id, optical_frame(camera)),
        transform=make(
            "geometry_msgs/Transform",
            translation=make("geometry_msgs/Vector3", x=0.0, y=0.0, z=0.0),
            rotation=make("geometry_msgs/Quaternion", x=-0.5, y=0.5, z=-0.5, w=0.5),
        ),
    )


def _pitched(make: Make, yaw_rad: float, pitch_rad: float) -> Any:
    """Return the rotation of a frame whose x axis points to yaw_rad and upwards by pitch_rad."""
    cos_yaw, sin_yaw = math.cos(0.5 * yaw_rad), math.sin(0.5 * yaw_rad)
    cos, sin = math.cos(0.5 * pitch_rad), math.sin(0.5 * pitch_rad)
    return make("geometry_msgs/Quaternion", x=sin_yaw * sin, y=-cos_yaw * sin, z=sin_yaw * cos, w=cos_yaw * cos)


def _pose_as_transform(make: Make, place: PoseReading, height_m: float) -> Any:
    return make(
        "geometry_msgs/Transform",
        translation=make("geometry_msgs/Vector3", x=place.x_m, y=place.y_m, z=height_m),
        rotation=_quaternion(make, place),
    )


def _grid(make: Make, time_ns: int, origin_m: tuple[float, float], resolution_m: float, cells: np.ndarray) -> Any:
    rows, columns = cells.shape
    origin = PoseReading(float(origin_m[0]), float(origin_m[1]), 0.0, 1.0)
    return make(
        "nav_msgs/OccupancyGrid",
        header=header(make, time_ns, MAP_FRAME),
        info=make(
            "nav_msgs/MapMetaData",
            map_load_time=make.time(time_ns),
            resolution=resolution_m,
            width=columns,
            height=rows,
            origin=pose(make, origin),
        ),
        data=np.asarray(cells, dtype=np.int8).ravel(),
    )
