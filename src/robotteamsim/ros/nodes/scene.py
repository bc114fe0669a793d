"""The node `scene`: draws the public topics of a run, or of a bag, as markers for rviz."""

import re
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeVar

import numpy as np
import rospy
import shapely
import tf2_ros
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from visualization_msgs.msg import Marker, MarkerArray

from robotteamsim import msg
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.launched import read_ros1_scenario
from robotteamsim.recording.topics.world import FIRE, SMOKE
from robotteamsim.ros.master import wait_for_master
from robotteamsim.ros.scene.building import building_markers, door_markers, openings_at_start
from robotteamsim.ros.scene.maps import fire_markers, smoke_markers, voice_markers
from robotteamsim.ros.scene.mission import (
    VictimPictures,
    area_markers,
    headline_marker,
    headline_words,
    legend_markers,
)
from robotteamsim.ros.scene.shapes import FRAME, WHITE, marker, unit
from robotteamsim.ros.scene.team import Links, RobotPicture, link_markers, links_of, team_markers, trail_marker
from robotteamsim.ros.transforms import TfTransforms
from robotteamsim.scenario import Bounds, Scenario
from robotteamsim.scenario.sections import Robot
from robotteamsim.setup import resolve

DRAW_PERIOD_S = 0.1
IDLE_RATIO = 4.0
"""After each update the node waits for this multiple of its duration, up to a limit: more robots, fewer updates."""
MAX_IDLE_S = 0.5
DISCOVERY_PERIOD_S = 0.5
TRAIL_PERIOD_S = 0.5
RESEND_PERIOD_S = 3.0
"""rviz deletes all markers when time jumps backwards, and with its Reset button."""
REPORT_S = 10.0
"""Delay before a mistake in the scenario is reported: the world reports it at once, which ends the launch."""
TRAIL_POINTS = 6_000
"""Of all robots together."""
WALL_HEIGHT_M, LOW_WALLS_PER_UNIT_M = 1.1, 3.0
"""Where walls are cut by default; lower in small buildings, where so high walls would hide the floor."""
TEXT_ABOVE_WALLS_M = 0.8
"""Height of the middle of texts above walls, which would hide them, in a building of 60 x 40 m."""
UNREADABLE = (ValueError, KeyError, ArithmeticError, shapely.errors.ShapelyError)
T = TypeVar("T")
TRUTH, ODOMETRY = "base_pose_ground_truth", "odom"


def main() -> None:
    """Run the node. Its parameter ~wall_height_m is the height at which walls are cut, to look in from above."""
    wait_for_master()
    rospy.init_node("scene", disable_rostime=True)
    try:
        scenario = read_ros1_scenario(rospy.get_param)
    except RobotTeamSimError as error:
        rospy.rostime.wallsleep(REPORT_S)
        sys.exit(f"scene: {error}")
    scene = Scene(scenario, float(rospy.get_param("~wall_height_m", wall_height(scenario.plan.bounds))))
    while not rospy.is_shutdown():
        started_s = time.monotonic()
        scene.step(started_s)
        drawing_s = time.monotonic() - started_s
        rospy.rostime.wallsleep(max(DRAW_PERIOD_S - drawing_s, min(IDLE_RATIO * drawing_s, MAX_IDLE_S)))


def wall_height(bounds: Bounds) -> float:
    """Return the default height at which the walls of a building are cut [m]."""
    return min(WALL_HEIGHT_M, LOW_WALLS_PER_UNIT_M * unit(bounds))


class Newest(Generic[T]):
    """What the newest message of a topic contains, if it was not drawn yet."""

    def __init__(self, topic: str, message_class: Any, read: Callable[[Any], T]) -> None:
        """Subscribe. Args: read: returns what is drawn, or raises one of UNREADABLE."""
        self._topic, self._read = topic, read
        self._messages: deque[Any] = deque(maxlen=1)
        rospy.Subscriber(topic, message_class, self._messages.append, queue_size=1, buff_size=2**24)

    def take(self) -> T | None:
        """Return it once; None if there is no new message, or one that does not fit to the scenario."""
        try:
            return self._read(self._messages.pop()) if self._messages else None
        except UNREADABLE as error:
            rospy.logwarn_throttle(60.0, f"{self._topic}: ignoring a message that cannot be drawn: {error!r}")
            return None


class Layer:
    """A latched topic of markers."""

    def __init__(self, name: str, markers: Iterable[Marker] = ()) -> None:
        self._publisher = rospy.Publisher(f"/scene/{name}", MarkerArray, queue_size=1, latch=True)
        self._markers: list[Marker] = []
        self.draw(markers, gone=[_deletion("", 0, Marker.DELETEALL)])  # those of an earlier run

    def draw(self, markers: Iterable[Marker], gone: Iterable[Marker] = ()) -> None:
        """Replace the contents of the topic. Args: gone: further deletions."""
        found = list(markers)
        left = {(item.ns, item.id): None for item in self._markers}  # in their order
        for item in found:
            left.pop((item.ns, item.id), None)
        deletions = [*gone, *(_deletion(*key, Marker.DELETE) for key in left)]
        self._publisher.publish(MarkerArray(deletions + found))
        self._markers = found

    def draw_again(self) -> None:
        """Publish the contents again."""
        self._publisher.publish(MarkerArray(self._markers))


def _deletion(namespace: str, marker_id: int, action: int) -> Marker:
    result = marker(namespace, marker_id, Marker.ARROW, WHITE)
    result.action = action
    return result


class Team:
    """The robots, their trails and links; each robot is drawn from its first pose on."""

    def __init__(self, scenario: Scenario, text_z_m: float) -> None:
        """Args: text_z_m: height of texts, above the walls."""
        self._scenario, self._text_z_m, self._size = scenario, text_z_m, unit(scenario.plan.bounds)
        self._models = resolve(scenario).robots
        self._robots: dict[int, RobotPicture] = {}
        self._statuses: dict[int, Newest[msg.ControllerStatus]] = {}
        self._present = Newest("/world/robots", msg.Robots, lambda message: bytes(message.present))
        self._absent: set[int] = set()
        self._newest_links = Newest("/network/links", msg.NetworkLinks, links_of)
        self._links = Links()
        self.layers = {name: Layer(name) for name in ("trails", "links", "robots")}
        self._transforms = TfTransforms() if scenario.control.localisation == "tf" else None
        self._changed = False
        self._trails_due_s = 0.0

    def discover(self) -> None:
        """Subscribe to the topics of further robots; a single robot without a namespace is robot 0."""
        names = TRUTH if self._transforms is None else f"{TRUTH}|{ODOMETRY}"
        for topic, _ in rospy.get_published_topics():
            found = re.fullmatch(rf"(/(?:robot_(\d+)/)?)({names})", topic)
            if found and int(found[2] or 0) not in self._robots:
                self._add(int(found[2] or 0), found[1])

    def _add(self, robot_id: int, prefix: str) -> None:
        scenario = self._scenario
        model = self._models[robot_id] if robot_id < len(self._models) else Robot()
        robot = RobotPicture(robot_id, model, scenario.role_of(robot_id), scenario.base == robot_id)
        if self._transforms is None:
            rospy.Subscriber(prefix + TRUTH, Odometry, self._read_truth, callback_args=robot, buff_size=2**16)
        self._statuses[robot_id] = Newest(f"{prefix}controller/status", msg.ControllerStatus, lambda message: message)
        self._robots = dict(sorted([*self._robots.items(), (robot_id, robot)]))

    def _read_truth(self, message: Odometry, robot: RobotPicture) -> None:
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        self._move(robot, message.header.stamp.to_sec(), PoseReading(place.x, place.y, turn.z, turn.w).pose)

    def _move(self, robot: RobotPicture, time_s: float, pose: Pose) -> None:
        if np.isfinite((pose.x_m, pose.y_m, pose.yaw_rad)).all():
            robot.move(time_s, pose)
            self._changed = True

    def _look_up(self, transforms: TfTransforms) -> None:
        for robot_id, robot in self._robots.items():
            found, _ = transforms.newest(FRAME, f"{robot_name(robot_id)}/base_link")
            if found is not None:
                stamp_ns, *pose = found
                self._move(robot, stamp_ns / 1e9, Pose(*pose))

    def update(self, now_s: float) -> None:
        """Draw new messages; trails twice per second [s, wall]."""
        if self._transforms is not None:
            self._look_up(self._transforms)
        self._read()
        if not self._changed:
            return
        self._changed = False
        seen = [robot for robot in self._robots.values() if robot.pose and robot.robot_id not in self._absent]
        self.layers["robots"].draw(team_markers(seen, self._size, self._text_z_m))
        positions_m = {robot.robot_id: (robot.pose.x_m, robot.pose.y_m) for robot in seen if robot.pose}
        self.layers["links"].draw(link_markers(self._links, positions_m, self._size))
        if now_s < self._trails_due_s:
            self._changed = True
            return
        self._trails_due_s = now_s + TRAIL_PERIOD_S
        trails = {robot.robot_id: list(robot.trail_m) for robot in self._robots.values()}
        points = max(100, TRAIL_POINTS // max(1, len(trails)))
        self.layers["trails"].draw(
            trail_marker(robot_id, trail[-points:], self._size) for robot_id, trail in trails.items() if len(trail) > 1
        )

    def _read(self) -> None:
        """Note what robots, controllers and the network have published."""
        present, links = self._present.take(), self._newest_links.take()
        if present is not None:
            absent = {robot_id for robot_id, is_present in enumerate(present) if not is_present}
            for robot_id in self._absent - absent & self._robots.keys():
                self._robots[robot_id].trail_m.clear()
            self._changed |= absent != self._absent
            self._absent = absent
        if links is not None:
            self._links, self._changed = links, True
        several_swarms = self._scenario.control.several_swarms
        for robot_id, newest in self._statuses.items():
            status = newest.take()
            if status is not None:
                robot = self._robots[robot_id]
                robot.excluded, robot.swarm = status.excluded, status.swarm if several_swarms else None


class Scene:
    """Publishes markers when something has changed."""

    def __init__(self, scenario: Scenario, wall_height_m: float) -> None:
        scenario = resolve(scenario).scenario  # with the people whom the seed draws
        plan, size = scenario.plan, unit(scenario.plan.bounds)
        text_z_m = wall_height_m + TEXT_ABOVE_WALLS_M * size
        victims = VictimPictures(scenario, text_z_m)
        at_start, legend = openings_at_start(plan), list(legend_markers(scenario))

        def draw_doors(doors: msg.Doors) -> list[Marker]:
            openings = at_start | {door.name: door.opening for door in doors.doors}
            return door_markers(plan, openings, wall_height_m)

        def draw_headline(status: msg.MissionStatus) -> list[Marker]:
            return [headline_marker(headline_words(status), scenario), *legend]

        self._pictures = (
            (Newest("/world/doors", msg.Doors, draw_doors), Layer("doors", draw_doors(msg.Doors()))),
            (Newest("/mission/areas", msg.Areas, lambda found: list(area_markers(found.areas, size))), Layer("areas")),
            (
                Newest("/mission/victims", msg.Victims, lambda found: list(victims.markers(found.victims))),
                Layer("victims"),
            ),
            (Newest("/mission/status", msg.MissionStatus, draw_headline), Layer("headline", legend)),
            (Newest("/voice_map/values", msg.FloatMap, voice_markers), Layer("voice")),
            (Newest(FIRE.name, OccupancyGrid, fire_markers), Layer("fire")),
            (Newest(SMOKE.name, OccupancyGrid, smoke_markers), Layer("smoke")),
        )
        self._team = Team(scenario, text_z_m)
        building = Layer("building", building_markers(plan, wall_height_m))
        self._layers = [building, *(layer for _, layer in self._pictures), *self._team.layers.values()]
        self._discovery_due_s = 0.0
        self._resend_due_s = RESEND_PERIOD_S + time.monotonic()
        _publish_frame(plan.bounds)

    def step(self, now_s: float) -> None:
        """Draw new messages; now_s is wall time, as in rviz."""
        if now_s >= self._discovery_due_s:
            self._discovery_due_s = now_s + DISCOVERY_PERIOD_S
            self._team.discover()
        for newest, layer in self._pictures:
            markers = newest.take()
            if markers is not None:
                layer.draw(markers)
        self._team.update(now_s)
        if now_s >= self._resend_due_s:
            self._resend_due_s = now_s + RESEND_PERIOD_S
            for layer in self._layers:
                layer.draw_again()


def _publish_frame(bounds: Bounds) -> None:
    """Publish the frame `building` at the centre of the plan, at which rviz's camera looks.

    This also defines `map`, which the world may not publish; rviz warns if its fixed frame does not exist.
    """
    transform = TransformStamped(child_frame_id="building")
    transform.header.frame_id = FRAME
    transform.transform.translation.x = (bounds.min[0] + bounds.max[0]) / 2.0
    transform.transform.translation.y = (bounds.min[1] + bounds.max[1]) / 2.0
    transform.transform.rotation.w = 1.0
    tf2_ros.StaticTransformBroadcaster().sendTransform(transform)
