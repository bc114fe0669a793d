"""Converts ROS messages to our values. `recording.ros_messages` does the reverse, also for bags."""

from collections.abc import Iterable, Sequence
from typing import Any

import geometry_msgs.msg
import msgspec
import nav_msgs.msg
import numpy as np
import rosgraph_msgs.msg
import sensor_msgs.msg
import std_msgs.msg
import tf2_msgs.msg
from genpy import Time

import robotteamsim.msg
from robotteamsim import _ros_transport as roscpp
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.hazards import BURNING, BURNT_OUT, NOT_BURNING, HazardField
from robotteamsim.interface import Assistance, Decision, Discovery, SwarmContext, Task
from robotteamsim.network.compact import CompactLinks, row_bytes
from robotteamsim.network.messages import Message, NetworkState, Refusal, Traffic
from robotteamsim.recording.hazard_messages import BURNING_VALUE, BURNT_OUT_VALUE
from robotteamsim.ros.transport.checks import check_finite, check_levels, check_place
from robotteamsim.scenario.fire import Fire
from robotteamsim.sensing.readings import Fix, HeatReading, OdometryReading, VoiceReading
from robotteamsim.world.doors import DoorState, DoorStates
from robotteamsim.world.people import PersonState

_PACKAGES = (std_msgs, geometry_msgs, nav_msgs, sensor_msgs, tf2_msgs, rosgraph_msgs, robotteamsim)


class RosTypes:
    """Builds messages of genpy's classes; the `make` of `recording.ros_messages`."""

    def __init__(self) -> None:
        self._classes: dict[str, Any] = {}

    def __call__(self, type_name: str, /, **fields: Any) -> Any:
        """Return a message of a type such as "nav_msgs/Odometry". Every field must be given."""
        message_class = self._classes.get(type_name) or self.message_class(type_name)
        # All fields are given, so the defaults that __init__ would fill in first are not needed.
        message = message_class.__new__(message_class)
        for name, value in fields.items():
            if type(value) is np.ndarray:  # uint8[] is bytes in genpy; other arrays are serialized fastest from lists.
                value = value.tobytes() if value.dtype == np.uint8 else value.tolist()
            setattr(message, name, value)
        return message

    def time(self, time_ns: int) -> Time:
        """Return the stamp of a time [ns]."""
        return Time(*divmod(time_ns, 10**9))

    def message_class(self, type_name: str) -> Any:
        """Return the class of a type such as "nav_msgs/Odometry"."""
        package_name, class_name = type_name.split("/")
        package = next(package for package in _PACKAGES if package.__name__ == package_name)
        return self._classes.setdefault(type_name, getattr(package.msg, class_name))


def stamp_ns(message: Any) -> int:
    """Return the stamp of a message with a header [ns]."""
    stamp = message.header.stamp
    return int(stamp.secs * 10**9 + stamp.nsecs)


def odometry_reading(message: nav_msgs.msg.Odometry) -> OdometryReading:
    """Return pose and twist in the plane of `odom` or `base_pose_ground_truth`; height, roll and pitch are ignored."""
    pose, twist = message.pose.pose, message.twist.twist
    of_pose, of_twist = message.pose.covariance, message.twist.covariance
    return OdometryReading(
        PoseReading(pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w),
        Twist(twist.linear.x, twist.linear.y, twist.angular.z),
        pose_covariance=(of_pose[0], of_pose[1], of_pose[5], of_pose[7], of_pose[11], of_pose[35]),
        twist_variances=(of_twist[0], of_twist[7], of_twist[35]),
    )


def read_odometry(data: bytes) -> OdometryReading:
    """Return pose and twist of a serialized nav_msgs/Odometry.

    Raises: ValueError: the bytes are too few, or pose or twist are not finite.
    """
    pose, velocity, pose_covariance, twist_variances = roscpp.read_odometry(data)
    check_place("position", *pose[:2])
    check_finite("orientation", *pose[2:])
    check_finite("twist", *velocity)
    return OdometryReading(PoseReading(*pose), Twist(*velocity), pose_covariance, twist_variances)


class ContactReading(msgspec.Struct, frozen=True, gc=False):
    """What a robot touches: the directions of contacts in `base_link`, ascending [rad]."""

    in_contact: bool = False
    angles_rad: tuple[float, ...] = ()


NO_CONTACT = ContactReading()


def read_contact(data: bytes) -> ContactReading:
    """Return a serialized Contact. Raises: ValueError: the bytes are too few, or an angle is not finite."""
    in_contact, angles_rad = roscpp.read_contact(data)
    check_finite("angles_rad", *angles_rad)
    return ContactReading(in_contact, angles_rad)


def read_ranges_m(data: bytes, beams: int | None = None) -> np.ndarray:
    """Return the ranges of a serialized sensor_msgs/LaserScan as float32, shape (beams,) [m].

    Raises: ValueError: the bytes are too few, or there is another number of ranges.
    """
    ranges_m = roscpp.read_ranges(data)
    if beams is not None and len(ranges_m) != beams:
        raise ValueError(f"ranges: {len(ranges_m)} entries; expected {beams}, the beams of the scenario's laser")
    return ranges_m


def read_twist(data: bytes) -> Twist:
    """Return a serialized geometry_msgs/Twist, which may hold NaN or infinity. Raises: ValueError."""
    return Twist(*roscpp.read_twist(data))


def read_twist_stamped(data: bytes) -> Twist:
    """Return the twist of a serialized geometry_msgs/TwistStamped, as `read_twist`."""
    return Twist(*roscpp.read_twist_stamped(data))


def fix(message: sensor_msgs.msg.NavSatFix) -> Fix:
    """Return a GPS fix."""
    return Fix(message.latitude, message.longitude, message.altitude, message.position_covariance[0])


def heat(message: robotteamsim.msg.Heat) -> HeatReading:
    """Return the reading of a thermal camera."""
    return HeatReading(message.temperature_c, tuple(_point(place) for place in message.hot))


def read_voice(data: bytes) -> VoiceReading:
    """Return a serialized Voice. Raises: ValueError: the bytes are too few, or a number is out of range."""
    level_db, heard, local_best_m, local_best_level_db = roscpp.read_voice(data)
    check_levels(level_db, local_best_level_db)
    check_place("local_best", *local_best_m)
    return VoiceReading(level_db, heard, local_best_m, local_best_level_db)


def team_voices(message: robotteamsim.msg.TeamVoices) -> tuple[VoiceReading, ...]:
    """Return what each robot hears, by id."""
    places_m = zip(message.local_best[::2], message.local_best[1::2], strict=True)
    found = zip(message.level_db, message.heard, places_m, message.local_best_level_db, strict=True)
    return tuple(VoiceReading(level_db, bool(heard), place_m, best_db) for level_db, heard, place_m, best_db in found)


def network_messages(received: Iterable[robotteamsim.msg.NetworkMessages]) -> list[Message]:
    """Return the messages of `network/tx` or `network/rx`, in their order."""
    return [Message(m.sender, m.receiver, m.payload) for batch in received for m in batch.messages]


def network_state(message: robotteamsim.msg.NetworkState) -> NetworkState:
    """Return the network of n robots."""
    shape = (message.num_robots, message.num_robots)

    def matrix(values: Sequence[Any], dtype: Any) -> np.ndarray:
        return np.array(values, dtype=dtype).reshape(shape)

    return NetworkState(
        rssi_dbm=matrix(message.rssi_dbm, np.float64),
        link=matrix(message.link, np.float64),
        adjacency=np.frombuffer(message.adjacency, dtype=np.uint8).reshape(shape).astype(bool),
        hop_count=matrix(message.hop_count, np.int32),
        break_matrix=matrix(message.break_matrix, np.float64),
        fiedler_value=message.fiedler_value,
        endangered=np.frombuffer(message.endangered, dtype=np.uint8).reshape(shape).astype(bool),
        traffic=_traffic(message),
    )


def network_links(message: robotteamsim.msg.NetworkLinks) -> CompactLinks:
    """Return the links of n robots."""
    shape = (message.num_robots, row_bytes(message.num_robots))
    pairs = (message.weakened_first, message.weakened_second)
    return CompactLinks(
        present=np.frombuffer(message.present, dtype=np.uint8) != 0,
        adjacency=np.frombuffer(message.adjacency, dtype=np.uint8).reshape(shape),
        endangered=np.frombuffer(message.endangered, dtype=np.uint8).reshape(shape),
        num_links=message.num_links,
        num_endangered=message.num_endangered,
        fiedler_value=message.fiedler_value,
        traffic=_traffic(message),
        weakened=np.array(pairs, dtype=np.int64).reshape(2, -1).T,
        weakened_rssi_dbm=np.array(message.weakened_rssi_dbm, dtype=np.float64),
    )


def _traffic(message: robotteamsim.msg.NetworkState | robotteamsim.msg.NetworkLinks) -> Traffic:
    return Traffic(
        delivered=message.delivered,
        lost=message.lost,
        cut_off=message.cut_off,
        mean_delay_s=message.mean_delay_s,
        refused=tuple(
            Refusal(sender, num_bytes, message.max_message_bytes)
            for sender, num_bytes in zip(message.refused_senders, message.refused_bytes, strict=True)
        ),
    )


def decision(message: robotteamsim.msg.ControllerStatus) -> Decision:
    """Return the published part of a decision; twist and outbox have topics of their own."""
    return Decision(
        excluded=message.excluded,
        swarm=message.swarm,
        goal_m=_point(message.goal) if message.has_goal else None,
        local_best=message.local_best,
        search_counter=message.search_counter,
        context=swarm_context(message),
        fault=message.fault,
        done=message.done,
    )


def swarm_context(message: robotteamsim.msg.ControllerStatus) -> SwarmContext | None:
    """Return the context in a status; None without adaptation."""
    if not message.context:
        return None
    return SwarmContext(*(getattr(message.context[0], key) for key in SwarmContext.__struct_fields__))


def task(message: robotteamsim.msg.MissionStatus) -> Task:
    """Return the task of the team."""
    return Task(
        running=message.running,
        epoch=message.epoch,
        area_center_m=_point(message.area_center) if message.has_area else None,
        area_radius_m=message.area_radius_m,
        undelivered=tuple(
            Discovery(find.kind, find.name, find.robot_id, _point(find.position), find.time_s)
            for find in message.undelivered
        ),
        assistance=tuple(Assistance(one.robot_id, one.victim, one.moving, one.collapsed) for one in message.assistance),
    )


class PeopleReader:
    """Reads the people that the world moves; while nobody has moved, the tuple is the same object."""

    def __init__(self) -> None:
        self._last: tuple[PersonState, ...] = ()

    def of(self, message: robotteamsim.msg.People) -> tuple[PersonState, ...]:
        """Return the people of a message."""
        people = tuple(PersonState(one.name, _point(one.position), one.motion) for one in message.people)
        if people != self._last:
            self._last = people
        return self._last


def _point(message: geometry_msgs.msg.Point) -> tuple[float, float]:
    return message.x, message.y


def door_states(message: robotteamsim.msg.Doors) -> DoorStates:
    """Return the states of the world's doors; the version is the message's stamp, so it increases with each change."""
    states = {door.name: DoorState(bool(door.closed), door.opening, door.motion) for door in message.doors}
    # 0 is the version at the start, before any message.
    return DoorStates(states, version=stamp_ns(message) + 1)


def hazard_field(
    fire: Fire,
    grid: nav_msgs.msg.OccupancyGrid,
    temperature: robotteamsim.msg.FloatMap,
    soot: robotteamsim.msg.FloatMap,
) -> HazardField:
    """Return fire, smoke and temperature. Raises: ValueError: the messages have different sizes."""
    shape = (grid.info.height, grid.info.width)
    if {shape} != {(values.height, values.width) for values in (temperature, soot)}:
        raise ValueError("the maps of fire and smoke have different sizes")
    cells = np.array(grid.data, dtype=np.int8).reshape(shape)
    states = np.select([cells == BURNING_VALUE, cells == BURNT_OUT_VALUE], [BURNING, BURNT_OUT], NOT_BURNING)
    return HazardField(
        _point(soot.origin),
        soot.resolution_m,
        np.array(temperature.data, dtype=np.float32).reshape(shape),
        np.array(soot.data, dtype=np.float32).reshape(shape),
        states.astype(np.uint8),
        fire,
    )
