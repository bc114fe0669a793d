"""The node `scene`: draws the public topics of a run, or of a bag, as markers for rviz."""

import logging
import re
import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeVar

import shapely

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Pose
from robotteamsim.interface import Decision
from robotteamsim.message_parts import BUILDING_FRAME, MAP_FRAME, header, robot_name
from robotteamsim.nodes.inputs import Input
from robotteamsim.nodes.launched import read_scenario
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.scene.building import building_markers, door_markers, openings_at_start
from robotteamsim.nodes.scene.found import FoundPicture
from robotteamsim.nodes.scene.maps import fire_markers, smoke_markers, voice_markers
from robotteamsim.nodes.scene.mission import (
    VictimPictures,
    area_markers,
    headline_marker,
    headline_words,
    legend_markers,
)
from robotteamsim.nodes.scene.shapes import WHITE, unit
from robotteamsim.nodes.scene.team import RobotPicture, link_markers, team_markers, trail_marker
from robotteamsim.nodes.settings import OTHERS_REPORT_S
from robotteamsim.nodes.transforms import Transforms
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.base import read_field_map, read_occupancy_grid
from robotteamsim.recording.topics.beliefs import FOUND_MAP
from robotteamsim.recording.topics.decisions import STATUS, read_decision
from robotteamsim.recording.topics.markers import ARRAY, ARROW, DELETE, DELETE_ALL, Marker, array_message
from robotteamsim.recording.topics.mission import (
    AREAS,
    MISSION_STATUS,
    VICTIMS,
    read_areas,
    read_status,
    read_victims,
)
from robotteamsim.recording.topics.radio import NETWORK_LINKS, VOICE_MAP, PublishedNetwork, read_network_links
from robotteamsim.recording.topics.robots import ODOM, TF, TRUTH, read_odometry
from robotteamsim.recording.topics.world import DOORS, FIRE, LEVEL_FRAMES, ROBOTS, SMOKE, read_doors, read_robots
from robotteamsim.scenario import Bounds, Scenario
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.sections import Robot
from robotteamsim.setup import resolve

logger = logging.getLogger(__name__)

DRAW_PERIOD_S = 0.1
IDLE_RATIO = 4.0
"""After each update the node waits for this multiple of its duration, up to a limit: more robots, fewer updates."""
MAX_IDLE_S = 0.5
DISCOVERY_PERIOD_S = 0.5
TRAIL_PERIOD_S = 0.5
RESEND_PERIOD_S = 3.0
"""rviz deletes all markers when time jumps backwards, and with its Reset button."""
TRAIL_POINTS = 6_000
"""Of all robots together."""
WALL_HEIGHT_M, LOW_WALLS_PER_UNIT_M = 1.1, 3.0
"""Where walls are cut by default; lower in small buildings, where so high walls would hide the floor."""
TEXT_ABOVE_WALLS_M = 0.8
"""Height of the middle of texts above walls, which would hide them, in a building of 60 x 40 m."""
UNREADABLE = (ValueError, KeyError, ArithmeticError, shapely.errors.ShapelyError)
T = TypeVar("T")


def serve(node: Node) -> None:
    """Draw until the node is shut down. Its parameter ~wall_height_m is the height at which walls are cut, to look in.

    Raises: ParameterError, PlacementError, ScenarioError.
    """
    try:
        scenario = read_scenario(node.setting, node.setting_name)
        scene = Scene(node, scenario, node.parameter("~wall_height_m", wall_height(scenario.plan.bounds)))
    except RobotTeamSimError:
        node.wait_for_shutdown(OTHERS_REPORT_S)
        raise
    while node.is_running():
        started_s = time.monotonic()
        scene.step(started_s)
        drawing_s = time.monotonic() - started_s
        node.wait_for_shutdown(max(DRAW_PERIOD_S - drawing_s, min(IDLE_RATIO * drawing_s, MAX_IDLE_S)))


def wall_height(bounds: Bounds) -> float:
    """Return the default height at which the walls of a building are cut [m]."""
    return min(WALL_HEIGHT_M, LOW_WALLS_PER_UNIT_M * unit(bounds))


class Newest(Generic[T]):
    """What the newest message of a topic contains, if it was not drawn yet."""

    def __init__(self, node: Node, topic: Topic, read: Callable[[Any], T], *, prefix: str = "") -> None:
        """Subscribe. Args: read: returns what is drawn, or raises one of UNREADABLE.  prefix: of the topic's name."""
        self._node, self._topic, self._type_name, self._read = node, prefix + topic.name, topic.type_name, read
        self._messages: deque[bytes] = deque(maxlen=1)
        self._is_warned = False
        node.listen(self._topic, self._type_name, self._messages.append, latched=topic.latched, queue_size=1)

    def take(self) -> T | None:
        """Return it once; None if there is no new message, or one that does not fit to the scenario."""
        try:
            return self._read(self._node.read(self._type_name, self._messages.pop())[1]) if self._messages else None
        except UNREADABLE as error:
            if not self._is_warned:
                self._is_warned = True
                logger.warning("%s: ignoring messages that cannot be drawn: %r", self._topic, error)
            return None


class Layer:
    """A latched topic of markers."""

    def __init__(self, node: Node, name: str, markers: Iterable[Marker] = ()) -> None:
        self._output = node.output(f"/scene/{name}", ARRAY, latched=True)
        self._shown: dict[tuple[str, int], None] = {}
        self.draw(markers, gone=[_deletion("", 0, DELETE_ALL)])  # those of an earlier run

    def draw(self, markers: Iterable[Marker], gone: Iterable[Marker] = ()) -> None:
        """Replace the contents of the topic. Args: gone: further deletions."""
        found = list(markers)
        shown = dict.fromkeys((item.ns, item.id) for item in found)
        deletions = [*gone, *(_deletion(*key, DELETE) for key in self._shown if key not in shown)]
        message = array_message(deletions + found)
        self._output.publish(message)
        self._again = {"markers": message["markers"][len(deletions) :]}
        self._shown = shown

    def draw_again(self) -> None:
        """Publish the contents again."""
        self._output.publish(self._again)


def _deletion(namespace: str, marker_id: int, action: int) -> Marker:
    return Marker(namespace, marker_id, ARROW, WHITE, action=action)


class Team:
    """The robots, their trails and links; each robot is drawn from its first pose on."""

    def __init__(self, node: Node, scenario: Scenario, text_z_m: float) -> None:
        """Args: text_z_m: height of texts, above the walls."""
        self._node = node
        self._scenario, self._text_z_m, self._size = scenario, text_z_m, unit(scenario.plan.bounds)
        self._models = resolve(scenario).robots
        self._robots: dict[int, RobotPicture] = {}
        self._found: dict[int, tuple[int, float, float, float]] = {}
        """The last pose of each robot from tf."""
        self._statuses: dict[int, Newest[Decision]] = {}
        self._presence = Newest(node, ROBOTS, read_robots)
        self._absent: set[int] = set()
        self._newest_links = Newest(node, NETWORK_LINKS, read_network_links)
        self._links: PublishedNetwork | None = None
        self.layers = {name: Layer(node, name) for name in ("trails", "links", "robots")}
        self._transforms = Transforms(node) if scenario.control.localisation == "tf" else None
        self._changed = False
        self._trails_due_s = 0.0

    def discover(self) -> None:
        """Subscribe to the topics of further robots; a single robot without a namespace is robot 0."""
        names = TRUTH.name if self._transforms is None else f"{TRUTH.name}|{ODOM.name}"
        for topic in self._node.topics():
            found = re.fullmatch(rf"(/(?:robot_(\d+)/)?)({names})", topic)
            if found and int(found[2] or 0) not in self._robots:
                self._add(int(found[2] or 0), found[1])

    def _add(self, robot_id: int, prefix: str) -> None:
        scenario = self._scenario
        model = self._models[robot_id] if robot_id < len(self._models) else Robot()
        robot = RobotPicture(robot_id, model, scenario.role_of(robot_id), scenario.base == robot_id)
        if self._transforms is None:
            truth = Input(self._node, prefix + TRUTH.name, TRUTH.type_name, read_odometry)
            truth.listen(lambda _, stamp_ns, seen: self._move(robot, stamp_ns / 1e9, seen.pose.pose))
        self._statuses[robot_id] = Newest(self._node, STATUS, read_decision, prefix=prefix)
        self._robots = dict(sorted([*self._robots.items(), (robot_id, robot)]))

    def _move(self, robot: RobotPicture, time_s: float, pose: Pose) -> None:
        robot.move(time_s, pose)
        self._changed = True

    def _look_up(self, transforms: Transforms) -> None:
        for robot_id, robot in self._robots.items():
            found, _ = transforms.newest(MAP_FRAME, f"{robot_name(robot_id)}/base_link")
            if found is not None and found != self._found.get(robot_id):
                self._found[robot_id] = found
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
        presence, links = self._presence.take(), self._newest_links.take()
        if presence is not None:
            absent = {robot_id for robot_id, is_present in enumerate(presence.present) if not is_present}
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


class Found:
    """What the robots of a team have found of a building that they do not know."""

    def __init__(self, node: Node, scenario: Scenario, wall_height_m: float) -> None:
        num_robots = scenario.team_size if FOUND_MAP.is_in(scenario) else 0
        names = (f"/{robot_name(robot_id)}/" for robot_id in range(num_robots))
        self._newest = [Newest(node, FOUND_MAP, read_occupancy_grid, prefix=name) for name in names]
        self._maps: dict[int, OccupancyGrid] = {}
        self._picture = FoundPicture(scenario.plan, wall_height_m)
        self.layer = Layer(node, "found")

    def update(self) -> None:
        """Draw new maps."""
        new = {robot_id: newest.take() for robot_id, newest in enumerate(self._newest)}
        if maps := {robot_id: grid for robot_id, grid in new.items() if grid is not None}:
            self._maps |= maps
            self.layer.draw(self._picture.markers(self._maps))


class Scene:
    """Publishes markers when something has changed."""

    def __init__(self, node: Node, scenario: Scenario, wall_height_m: float) -> None:
        scenario = resolve(scenario).scenario  # with the people whom the seed draws
        plan, size = scenario.plan, unit(scenario.plan.bounds)
        text_z_m = wall_height_m + TEXT_ABOVE_WALLS_M * size
        victims = VictimPictures(scenario, text_z_m)
        at_start, legend = openings_at_start(plan), list(legend_markers(scenario))

        def draw_doors(message: Any) -> list[Marker]:
            openings = at_start | {name: state.opening for name, state in read_doors(message).items()}
            return door_markers(plan, openings, wall_height_m)

        def draw_headline(message: Any) -> list[Marker]:
            return [headline_marker(headline_words(read_status(message)), scenario), *legend]

        doors = door_markers(plan, at_start, wall_height_m)
        self._pictures = [
            (Newest(node, topic, draw), Layer(node, layer, begin))
            for layer, topic, draw, begin in (
                ("doors", DOORS, draw_doors, doors),
                ("areas", AREAS, lambda message: list(area_markers(read_areas(message), size)), []),
                ("victims", VICTIMS, lambda message: list(victims.markers(read_victims(message))), []),
                ("headline", MISSION_STATUS, draw_headline, legend),
                ("voice", VOICE_MAP, lambda message: voice_markers(read_field_map(message)), []),
                ("fire", FIRE, lambda message: fire_markers(read_occupancy_grid(message)), []),
                ("smoke", SMOKE, lambda message: smoke_markers(read_occupancy_grid(message)), []),
            )
        ]
        self._team = Team(node, scenario, text_z_m)
        building = Layer(node, "building", building_markers(plan, wall_height_m))
        self._found = Found(node, scenario, wall_height_m)
        pictures = [layer for _, layer in self._pictures]
        self._layers = [building, self._found.layer, *pictures, *self._team.layers.values()]
        self._discovery_due_s = 0.0
        self._resend_due_s = RESEND_PERIOD_S + time.monotonic()
        _publish_frame(node, plan.bounds)

    def step(self, now_s: float) -> None:
        """Draw new messages; now_s is wall time, as in rviz."""
        if now_s >= self._discovery_due_s:
            self._discovery_due_s = now_s + DISCOVERY_PERIOD_S
            self._team.discover()
        for newest, layer in self._pictures:
            markers = newest.take()
            if markers is not None:
                layer.draw(markers)
        self._found.update()
        self._team.update(now_s)
        if now_s >= self._resend_due_s:
            self._resend_due_s = now_s + RESEND_PERIOD_S
            for layer in self._layers:
                layer.draw_again()


def _publish_frame(node: Node, bounds: Bounds) -> None:
    """Publish the frame `building` at the centre of the plan, at which rviz's camera looks.

    This also defines `map`, which the world may not publish; rviz warns if its fixed frame does not exist.
    """
    x, y = ((low + high) / 2.0 for low, high in zip(bounds.min, bounds.max, strict=True))
    place = {"translation": {"x": x, "y": y}, "rotation": {"w": 1.0}}
    frame = {"header": header(0, MAP_FRAME), "child_frame_id": BUILDING_FRAME, "transform": place}
    node.output(LEVEL_FRAMES.name, TF.type_name, latched=True).publish({"transforms": [frame]})
