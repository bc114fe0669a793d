"""The node `scene`: converts the topics of a run, or of a bag, to markers for rviz."""

import time
from collections.abc import Iterable, Sequence

import numpy as np
import shapely
from geometry_msgs.msg import Point, TransformStamped
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import PointCloud2
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from robotteamsim import _ros_transport as roscpp
from robotteamsim import msg
from robotteamsim.recording.hazard_messages import FIRE_GRID, SMOKE_GRID
from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.scene import fire as scene_fire
from robotteamsim.ros.scene import laser as scene_laser
from robotteamsim.ros.scene import mission as scene_mission
from robotteamsim.ros.scene import objects as scene_objects
from robotteamsim.ros.scene import plan as scene_plan
from robotteamsim.ros.scene import sensors as scene_sensors
from robotteamsim.ros.scene import team as scene_team
from robotteamsim.ros.scene.feed import Feed, robot_topics
from robotteamsim.ros.scene.legend import legend_markers
from robotteamsim.ros.scene.lettering import Lettering, Written
from robotteamsim.ros.scene.network import NetworkFeed
from robotteamsim.ros.scene.poses import PoseFeed, TfPoses, TruePoses
from robotteamsim.ros.scene.robot import RobotFeed
from robotteamsim.ros.scene.shapes import FRAME, Shown
from robotteamsim.ros.scene.view import unit
from robotteamsim.ros.transport.node import is_running, parameter, published_topics, run, wait_for_shutdown
from robotteamsim.ros.transport.presence import ROBOTS
from robotteamsim.ros.transport.settings import read_settings
from robotteamsim.ros.transport.tf_pose import TfPose
from robotteamsim.ros.transport.topics import Output
from robotteamsim.scenario import Bounds, Scenario, occupancy_grid
from robotteamsim.scenario.plan import OCCUPIED, grid_shape
from robotteamsim.scenario.sections import Robot
from robotteamsim.view.frame import Gait, enclosed_of, fallen_of, gait_now, gait_of
from robotteamsim.world.placement import placed_robots

DRAW_PERIOD_S = 0.1
TRAIL_PERIOD_S = 0.5
DISCOVERY_PERIOD_S = 0.5
IDLE_SHARE = 4.0
"""After each update the node waits for this multiple of its duration, up to a limit: more robots, fewer updates."""
MAX_IDLE_S = 0.5
RESEND_PERIOD_S = 5.0
"""rviz deletes all markers when time jumps backwards, and with its Reset button."""
RESEND_DELAY_S = 1.0
"""Time for rviz to notice that time has jumped backwards [s, wall]."""
TRAIL_POINTS = 6_000
"""Of all robots together."""
WALL_HEIGHT_M = 1.1
"""Where walls are cut by default; lower in small buildings, where so high walls would hide the floor."""
LOW_WALLS_PER_UNIT_M = 3.0
SENSORS = ("sonars", "gps")
"""Layers of additional sensors."""


def main() -> None:
    """Run the node. Its parameter ~wall_height_m is the height at which walls are cut, to look in from above."""
    run("scene", _serve)


def _serve() -> None:
    scenario = read_settings().placed
    scene = Scene(scenario, parameter("~wall_height_m", wall_height(scenario.plan.bounds)))
    while is_running():
        started_s = time.monotonic()
        scene.step(started_s)
        drawing_s = time.monotonic() - started_s
        wait_for_shutdown(max(DRAW_PERIOD_S - drawing_s, min(IDLE_SHARE * drawing_s, MAX_IDLE_S)))


def wall_height(bounds: Bounds) -> float:
    """Return the default height at which the walls of a building are cut [m]."""
    return min(WALL_HEIGHT_M, LOW_WALLS_PER_UNIT_M * unit(bounds))


class Canvas:
    """One latched topic of markers, and its current contents."""

    def __init__(self, topic: str) -> None:
        self._output = Output(topic, MarkerArray, latched=True)
        self._shown = Shown()
        self.markers: list[Marker] = []
        """The contents of the topic."""

    def draw(self, markers: Iterable[Marker]) -> None:
        """Replace the contents of the topic."""
        self.markers = list(markers)
        self._output.publish(MarkerArray(self._shown.update(self.markers)))

    @property
    def watched(self) -> bool:
        """Whether the topic has a subscriber now."""
        return self._output.num_subscribers > 0


_LAYERS = (
    "building",
    "doors",
    "fire",
    "smoke",
    "voice",
    "areas",
    "victims",
    "trails",
    "links",
    "robots",
    "headline",
    *SENSORS,
)


class Scene:
    """Publishes markers when something has changed."""

    def __init__(self, scenario: Scenario, wall_height_m: float) -> None:
        self._scenario = scenario
        self._wall_height_m = wall_height_m
        self._lettering = Lettering.of(scenario, wall_height_m)
        self._placed = placed_robots(scenario)
        self._gaits = {victim.name: gait_of(victim) for victim in scenario.mission.victims}
        self._fallen: frozenset[str] = frozenset()
        self._enclosed: frozenset[str] = frozenset()
        self._canvas = {layer: Canvas(f"/scene/{layer}") for layer in _LAYERS}
        self._laser = Output("/scene/laser", PointCloud2)
        self._transforms = roscpp.TransformListener() if scenario.control.localisation == "tf" else None
        self._robots: dict[int, RobotFeed] = {}
        self._missing: set[int] = set()
        self._status = Feed("/mission/status", msg.MissionStatus)
        self._events = Feed("/mission/events", msg.MissionEvent, keep=1000)
        self._doors = Feed("/world/doors", msg.Doors)
        self._has_doors = False
        self._areas = Feed("/mission/areas", msg.Areas)
        self._victims = Feed("/mission/victims", msg.Victims)
        self._people = Feed("/world/people", msg.People)
        self._presence = Feed(ROBOTS, msg.Robots)
        self._absent: frozenset[int] = frozenset()
        self._network = NetworkFeed(scenario.num_robots)
        self._voice = Feed("/voice_map/values", msg.FloatMap)
        has_fire = scenario.fire is not None
        self._fire = Feed(FIRE_GRID, OccupancyGrid) if has_fire else None
        self._smoke = Feed(SMOKE_GRID, OccupancyGrid) if has_fire else None
        self._links: list[scene_team.LinkView] = []
        self._scans: dict[tuple[int, str], scene_laser.ScanView] = {}
        self._mission: msg.MissionStatus | None = None
        self._headline = ""
        self._stamp_ns = 0
        self._discovery_due_s = self._trails_due_s = self._resend_due_s = 0.0
        self._trails_stale = False
        self._numbers: dict[int, Written] = {}
        self._shown_areas: Sequence[msg.Area] = ()
        self._shown_victims: Sequence[msg.Victim] = ()
        self._objects = Feed("/world/objects", MarkerArray) if scenario.objects else None
        self._covered: shapely.Geometry = shapely.MultiPolygon()
        self._frame = _publish_frame(scenario.plan.bounds)
        self._draw_start()

    def _draw_start(self) -> None:
        mission, plan = self._scenario.mission, self._scenario.plan
        self._canvas["building"].draw(scene_plan.building_markers(plan, self._wall_height_m))
        self._draw_doors(scene_plan.openings_at_start(plan))
        areas = [msg.Area(name=a.name, center=Point(*a.center, 0.0), radius_m=a.radius_m) for a in mission.areas]
        self._draw_areas(areas)
        waiting = [msg.Victim(victim.name, Point(*victim.position, 0.0), "waiting") for victim in mission.victims]
        self._draw_victims(waiting)
        for layer in ("fire", "smoke", "voice", "trails", "links", "robots", *SENSORS):
            self._canvas[layer].draw([])
        self._canvas["headline"].draw(legend_markers(self._scenario))

    def _draw_areas(self, areas: Sequence[msg.Area]) -> None:
        self._shown_areas = areas
        self._area_numbers = scene_mission.area_numbers(areas, self._lettering, self._covered)
        self._canvas["areas"].draw(scene_mission.area_markers(areas, self._lettering, self._area_numbers))

    def _draw_victims(self, victims: Sequence[msg.Victim]) -> None:
        self._shown_victims = victims
        distance_m = self._scenario.mission.save_distance_m
        gaits = self._gaits_now()
        names = scene_mission.victim_names(victims, distance_m, self._lettering, self._area_numbers, gaits)
        self._names = names
        markers = scene_mission.victim_markers(victims, distance_m, self._lettering, names, gaits)
        self._canvas["victims"].draw(markers)

    def _gaits_now(self) -> dict[str, Gait]:
        return {name: gait_now(name, gait, self._fallen, self._enclosed) for name, gait in self._gaits.items()}

    def _draw_doors(self, openings: dict[str, float]) -> None:
        self._openings = openings
        self._canvas["doors"].draw(scene_plan.door_markers(self._scenario.plan, openings, self._wall_height_m))

    def step(self, now_s: float) -> None:
        """Process new messages and draw them; now_s is wall time, as in rviz."""
        if now_s >= self._discovery_due_s:
            self._discovery_due_s = now_s + DISCOVERY_PERIOD_S
            self._discover()
            self._follow_objects()
        if now_s >= self._resend_due_s:
            self._resend_due_s = now_s + RESEND_PERIOD_S
            for canvas in self._canvas.values():
                canvas.draw(canvas.markers)
        self._draw_mission()
        self._draw_voice()
        self._draw_hazards()
        self._draw_team(now_s)
        self._draw_headline()
        self._draw_laser()

    def _note_time(self, now_s: float) -> None:
        """Restart when the world does: doors are as in the plan again."""
        stamp_ns = max((robot.stamp_ns for robot in self._robots.values()), default=0)
        if stamp_ns < self._stamp_ns:
            self._resend_due_s = now_s + RESEND_DELAY_S
            self._draw_doors(scene_plan.openings_at_start(self._scenario.plan))
            self._fallen = frozenset()
        self._stamp_ns = stamp_ns

    def _discover(self) -> None:
        """Follow the published robots; the last ones stay on display when a run or a bag has ended."""
        published = published_topics()
        with_truth = robot_topics(published)
        found = with_truth if self._transforms is None else robot_topics(published, "odom") | with_truth
        if not found:
            return
        gone = self._robots.keys() - found.keys()
        for robot_id in gone & self._missing:  # twice in a row: an ending run unregisters its topics one by one
            self._robots.pop(robot_id).close()
            self._scans = {key: scan for key, scan in self._scans.items() if key[0] != robot_id}
        self._missing = gone
        for robot_id in found.keys() - self._robots.keys():
            robot = self._placed[robot_id] if robot_id < len(self._placed) else Robot()
            poses = self._pose_feed(robot_id, found[robot_id], robot_id in with_truth)
            several_swarms, base = self._scenario.control.swarms.max > 1, self._scenario.base == robot_id
            role = self._scenario.role_of(robot_id)
            self._robots[robot_id] = RobotFeed(robot_id, found[robot_id], robot, poses, several_swarms, base, role)
        self._robots = dict(sorted(self._robots.items()))

    def _pose_feed(self, robot_id: int, prefix: str, has_truth: bool) -> PoseFeed:
        if has_truth or self._transforms is None:
            return TruePoses(prefix)
        tf = TfPose(self._transforms, robot_name(robot_id), self._scenario.control.tf_timeout_s)
        return TfPoses(prefix, self._transforms, tf)

    def _draw_mission(self) -> None:
        areas, victims, people = self._areas.newest(), self._victims.newest(), self._people.newest()
        if areas is not None:
            self._draw_areas(areas.areas)
        events = self._events.take()
        enclosed = self._enclosed if people is None else enclosed_of(people.people)
        seen = () if victims is None else victims.victims
        # Events are not latched: a scene that starts late knows earlier collapses by the states.
        fallen = self._fallen | fallen_of(events) | {victim.name for victim in seen if victim.state == "collapsed"}
        if victims is not None or (enclosed, fallen) != (self._enclosed, self._fallen):
            self._enclosed, self._fallen = enclosed, fallen
            self._draw_victims(self._shown_victims if victims is None else victims.victims)
        changes = dict(filter(None, map(scene_plan.door_change, events)))
        doors = self._doors.newest()
        if doors is not None:
            self._has_doors, changes = True, {door.name: door.opening for door in doors.doors}
        elif self._has_doors:  # another kind of world may only have events
            changes = {}
        openings = self._openings | {name: changes[name] for name in self._openings if name in changes}
        if openings != self._openings:
            self._draw_doors(openings)

    def _follow_objects(self) -> None:
        """Move the numbers of areas away from objects."""
        message = self._objects.newest() if self._objects else None
        if message is not None:
            self._covered = scene_objects.covered(message.markers, self._lettering.eye_m)
            self._draw_areas(self._shown_areas)
            self._draw_victims(self._shown_victims)

    def _texts(self) -> list[shapely.Geometry]:
        """Return what the numbers of robots avoid, besides walls and robots."""
        return [self._covered, *(text.box for text in (*self._names, *self._area_numbers))]

    def _draw_headline(self) -> None:
        self._mission = status = self._status.newest() or self._mission
        if status is None:
            return
        words = scene_mission.headline_words(status, self._network.num_endangered)
        if words != self._headline:
            self._headline = words
            bounds = self._scenario.plan.bounds
            headline = scene_mission.headline_marker(words, bounds, self._lettering)
            self._canvas["headline"].draw([headline, *legend_markers(self._scenario)])

    def _draw_voice(self) -> None:
        voice = self._voice.newest()
        if voice is not None:
            levels_db = np.asarray(voice.data).reshape(voice.height, voice.width)
            origin_m = (voice.origin.x, voice.origin.y)
            plan = self._scenario.plan
            same = plan.bounds.min == origin_m and grid_shape(plan, voice.resolution_m) == levels_db.shape
            solid = occupancy_grid(plan, voice.resolution_m).cells == OCCUPIED if same else None
            self._canvas["voice"].draw(scene_mission.voice_markers(origin_m, voice.resolution_m, levels_db, solid))

    def _draw_hazards(self) -> None:
        for layer, feed, markers_of in (
            ("fire", self._fire, scene_fire.fire_markers),
            ("smoke", self._smoke, scene_fire.smoke_markers),
        ):
            grid = feed.newest() if feed else None
            if grid is not None:
                place = grid.info.origin.position
                cells = np.array(grid.data, dtype=np.int8).reshape(grid.info.height, grid.info.width)
                self._canvas[layer].draw(markers_of((place.x, place.y), grid.info.resolution, cells))

    def _draw_team(self, now_s: float) -> None:
        num_seen = sum(robot.view() is not None for robot in self._robots.values())
        trail_points = max(100, TRAIL_POINTS // max(1, num_seen))
        changed = [robot.look(trail_points) for robot in self._robots.values()]
        changed.append(self._follow_presence())
        has_news = self._network.look()
        if any(changed) or has_news:
            self._note_time(now_s)
            views = [view for view in (robot.view() for robot in self._seen().values()) if view is not None]
            positions_m = {view.robot_id: (view.pose.x_m, view.pose.y_m) for view in views}
            if has_news:
                self._links = self._network.links(positions_m)
            self._numbers = scene_team.team_numbers(views, self._lettering, self._texts(), self._numbers)
            self._canvas["robots"].draw(scene_team.team_markers(views, self._lettering, self._numbers))
            self._canvas["links"].draw(scene_team.link_markers(self._links, positions_m, self._lettering))
            self._draw_sensors()
            self._trails_stale = True
        if self._trails_stale and now_s >= self._trails_due_s:
            self._trails_stale, self._trails_due_s = False, now_s + TRAIL_PERIOD_S
            trails = {robot_id: robot.trail.points_m for robot_id, robot in self._robots.items()}
            self._canvas["trails"].draw(
                scene_team.trail_marker(robot_id, points, self._lettering.unit)
                for robot_id, points in trails.items()
                if len(points) > 1
            )

    def _follow_presence(self) -> bool:
        """Return whether robots have left or arrived; the trails of robots that left stay."""
        message = self._presence.newest()
        absent = self._absent if message is None else frozenset(i for i, here in enumerate(message.present) if not here)
        if absent == self._absent:
            return False
        for robot_id in self._absent - absent:
            if robot_id in self._robots:
                self._robots[robot_id].trail = scene_team.Trail()
        self._absent = absent
        self._scans = {key: scan for key, scan in self._scans.items() if key[0] not in absent}
        return True

    def _seen(self) -> dict[int, RobotFeed]:
        """Return the robots that are present."""
        return {robot_id: robot for robot_id, robot in self._robots.items() if robot_id not in self._absent}

    def _draw_sensors(self) -> None:
        watched = self._canvas["sonars"].watched
        sonars = {robot_id: robot.sonars(watched) for robot_id, robot in self._seen().items()}
        fixes = {robot_id: robot.fixes() for robot_id, robot in self._seen().items()}
        for layer, markers in (
            ("sonars", scene_sensors.sonar_markers(sonars)),
            ("gps", scene_sensors.fix_markers(fixes)),
        ):
            if markers or self._canvas[layer].markers:
                self._canvas[layer].draw(markers)

    def _draw_laser(self) -> None:
        fresh = {
            (robot_id, name): scan
            for robot_id, robot in self._seen().items()
            for name, scan in robot.scans(self._laser.wanted).items()
        }
        if fresh:
            self._scans |= fresh
            self._laser.publish(scene_laser.cloud([self._scans[key] for key in sorted(self._scans)]))


def _publish_frame(bounds: Bounds) -> Output:
    """Publish the frame `building` at the centre of the plan, at which rviz's camera looks.

    This also defines `map`, which the world may not publish; rviz warns if its fixed frame does not exist.
    """
    transform = TransformStamped(child_frame_id="building")
    transform.header.frame_id = FRAME
    transform.transform.translation.x = (bounds.min[0] + bounds.max[0]) / 2.0
    transform.transform.translation.y = (bounds.min[1] + bounds.max[1]) / 2.0
    transform.transform.rotation.w = 1.0
    output = Output("/tf_static", TFMessage, latched=True)
    output.publish(TFMessage([transform]))
    return output
