"""The topics of one robot, as received by the node `scene`."""

from collections import deque
from collections.abc import Iterable

from sensor_msgs.msg import LaserScan, NavSatFix, Range

from robotteamsim.geometry import Pose
from robotteamsim.msg import Contact, ControllerStatus
from robotteamsim.ros.scene import team as scene_team
from robotteamsim.ros.scene.feed import Feed
from robotteamsim.ros.scene.laser import ScanView
from robotteamsim.ros.scene.poses import PoseFeed
from robotteamsim.ros.scene.sensors import FixView, SonarView
from robotteamsim.ros.transport import msg_conversion
from robotteamsim.scenario.scenario import Role
from robotteamsim.scenario.sections import Laser, Robot
from robotteamsim.scenario.sensors import MountedLaser
from robotteamsim.sensing.gps import tangent

FIXES_KEPT = 30


class RobotFeed:
    """The latest messages of one robot."""

    def __init__(
        self,
        robot_id: int,
        prefix: str,
        robot: Robot,
        poses: PoseFeed,
        several_swarms: bool = False,
        base: bool = False,
        role: Role = "robot",
    ) -> None:
        self._id = robot_id
        self._several_swarms = several_swarms
        self._base = base
        self._role: Role = role
        self._swarm: int | None = None
        self._prefix = prefix
        self._robot = robot
        self._poses = poses
        self._status = Feed(f"{prefix}controller/status", ControllerStatus)
        self._contact = Feed(f"{prefix}contact", Contact)
        self._fix = Feed(f"{prefix}fix", NavSatFix, keep=FIXES_KEPT) if robot.gps else None
        self._lasers = {"base_scan": robot.laser, **{laser.name: laser for laser in robot.lasers}}
        self._scans = _Wanted(prefix, self._lasers, LaserScan)
        self._sonars = _Wanted(prefix, [sonar.name for sonar in robot.sonars], Range)
        self._sonars_m: dict[str, float] = {}
        self._recent: dict[int, Pose] = {}
        self._excluded = False
        self._goal_m: tuple[float, float] | None = None
        self._contact_angles_rad: tuple[float, ...] = ()
        self._fixes: deque[FixView] = deque(maxlen=FIXES_KEPT)
        self.stamp_ns = 0
        self.trail = scene_team.Trail()

    def look(self, trail_points: int) -> bool:
        """Process new messages; return whether there were any."""
        poses = self._poses.take(at_most=20)
        for stamp_ns, pose in poses:
            self.trail.add(pose.x_m, pose.y_m, 1e-9 * stamp_ns, self._robot.drive.max_speed_mps, trail_points)
            if stamp_ns < self.stamp_ns:
                self._recent.clear()
                self._fixes.clear()
                self._sonars_m.clear()
            self.stamp_ns = stamp_ns
            self._recent[stamp_ns] = pose
        for old in list(self._recent)[:-10]:
            del self._recent[old]
        status = self._status.newest()
        if status is not None:
            self._excluded = status.excluded
            self._goal_m = (status.goal.x, status.goal.y) if status.has_goal else None
            self._swarm = status.swarm if self._several_swarms else None
        contact = self._contact.newest()
        if contact is not None:
            self._contact_angles_rad = tuple(contact.angles_rad)
        return bool(poses) or status is not None

    def view(self) -> scene_team.RobotView | None:
        """Return the view of the robot; None before its first pose."""
        if not self._recent:
            return None
        robot = self._robot
        return scene_team.RobotView(
            self._id,
            self._newest_pose,
            robot.reach_m,
            robot.height_m,
            self._excluded,
            corners_m=robot.corners_m,
            contact_angles_rad=self._contact_angles_rad,
            lasers_m=tuple((mount.x_m, mount.y_m) for mount in map(_mount, self._lasers.values())),
            swarm=self._swarm,
            base=self._base,
            goal_m=self._goal_m,
            role=self._role,
        )

    def scans(self, wanted: bool) -> dict[str, ScanView]:
        """Return new scans with their poses, by topic; the topics are subscribed to only while rviz shows them."""
        return {
            name: self._scan_view(self._lasers[name], scan)
            for name, scan in self._scans.newest(wanted).items()
            if self._recent
        }

    def sonars(self, wanted: bool) -> list[SonarView]:
        """Return the last range of each sonar at the robot's current pose; subscribed to only while rviz shows them."""
        self._sonars_m |= {name: message.range for name, message in self._sonars.newest(wanted).items()}
        if not self._recent:
            return []
        return [
            SonarView(
                self._newest_pose @ Pose(sonar.forward_m, sonar.left_m, sonar.yaw_rad),
                min(sonar.height_m, self._robot.height_m),
                sonar.opening_rad,
                sonar.range_max_m,
                self._sonars_m[sonar.name],
            )
            for sonar in self._robot.sonars
            if sonar.name in self._sonars_m
        ]

    def fixes(self) -> tuple[FixView, ...]:
        """Return the last fixes of its GPS, oldest first, in the map frame."""
        gps = self._robot.gps
        if gps is not None and self._fix is not None:
            for message in self._fix.take():
                fix = msg_conversion.fix(message)
                datum = gps.datum_lat_deg, gps.datum_lon_deg
                place_m = tangent(fix.latitude_deg, fix.longitude_deg, fix.altitude_m, *datum)
                self._fixes.append(FixView(place_m, fix.variance_m2**0.5))
        return tuple(self._fixes)

    def close(self) -> None:
        """Unsubscribe from all topics."""
        for feed in (self._poses, self._status, self._contact, self._fix, self._scans, self._sonars):
            if feed is not None:
                feed.close()

    @property
    def _newest_pose(self) -> Pose:
        return next(reversed(self._recent.values()))

    def _scan_view(self, laser: Laser, scan: LaserScan) -> ScanView:
        base = self._recent.get(msg_conversion.stamp_ns(scan), self._newest_pose)
        return ScanView(self._id, base @ _mount(laser), laser.height_m, scan)


class _Wanted:
    """Topics of one type that are subscribed to only while rviz shows them."""

    def __init__(self, prefix: str, names: Iterable[str], message_class: type) -> None:
        self._prefix, self._names, self._class = prefix, tuple(names), message_class
        self._feeds: dict[str, Feed] = {}

    def newest(self, wanted: bool) -> dict[str, LaserScan | Range]:
        """Return the new messages by topic."""
        if not wanted:
            self.close()
        elif not self._feeds:
            self._feeds = {name: Feed(self._prefix + name, self._class) for name in self._names}
        newest = {name: feed.newest() for name, feed in self._feeds.items()}
        return {name: message for name, message in newest.items() if message is not None}

    def close(self) -> None:
        """Unsubscribe."""
        for feed in self._feeds.values():
            feed.close()
        self._feeds = {}


def _mount(laser: Laser) -> Pose:
    """Return the position of a laser in base_link."""
    if isinstance(laser, MountedLaser):
        return Pose(laser.forward_m, laser.left_m, laser.yaw_rad)
    return Pose(laser.forward_m, 0.0, 0.0)
