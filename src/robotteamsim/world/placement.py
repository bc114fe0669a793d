"""Start poses of robots, and checks that robots, objects, areas and victims have room in the plan."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from robotteamsim.errors import PlacementError
from robotteamsim.scenario.base import PlanarPose, Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.firefighters import Firefighters, centre_body
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Mission, PlacedRobot, Robot, Team, Victim
from robotteamsim.world.clearance import TOUCH_M, Solids, check_inside, overlaps, point_text
from robotteamsim.world.formation import formation

Robots = Team | tuple[PlacedRobot, ...]


class _Members(NamedTuple):
    """The parts of a scenario that have a body: robots, firefighters, and a command centre at a place.

    seed: of random start poses; 0 if there are none, so that missions of different seeds share a placement.
    """

    robots: Robots
    firefighters: Firefighters | None
    centre: Point | None
    seed: int

    @classmethod
    def of(cls, scenario: Scenario) -> _Members:
        centre = scenario.command_centre
        teams = [team for team in (scenario.robots, scenario.firefighters) if isinstance(team, Team)]
        seed = scenario.run.seed if any(team.formation == "random" for team in teams) else 0
        return cls(scenario.robots, scenario.firefighters, centre if isinstance(centre, tuple) else None, seed)


def placed_robots(scenario: Scenario, building: Building) -> tuple[PlacedRobot, ...]:
    """Return every member of the team with its start pose, in id order: robots, firefighters, command centre.

    A team takes its `start_poses` first; the others are in its formation, see `formation`.

    Raises: PlacementError: a given pose touches a solid, lies outside or within another robot, or there is not enough
            room; one line with file or --set, key and value.
    """
    with _blamed(scenario):
        return building.shared(_placed, _Members.of(scenario))


def check_places(scenario: Scenario, building: Building) -> None:
    """Check that all robots, objects, areas and victims of a scenario have room in its plan.

    Raises: PlacementError: one line with file or --set, key, value and the obstacle.
    """
    with _blamed(scenario):
        members = _Members.of(scenario)
        building.shared(_check, members, scenario.mission, scenario.objects, scenario.schedule)
        _check_walkers(scenario.mission, scenario.people.radius_m)


def check_mission(plan: FloorPlan, mission: Mission) -> None:
    """Raise PlacementError, with the key, when an area or a victim is in a solid or outside the plan.

    The same holds for the paths of victims, who can walk through doors, but not through walls and blocks.
    """
    still = Solids(plan)
    spots = [(f"mission.areas.{i}.center", area.center) for i, area in enumerate(mission.areas)]
    spots += [(f"mission.victims.{i}.position", victim.position) for i, victim in enumerate(mission.victims)]
    spots += [(f"mission.exits.{i}.center", leaves.center) for i, leaves in enumerate(mission.exits)]
    for key, point in spots:
        _check_spot(plan, still, key, point)
    for i, victim in enumerate(mission.victims):
        _check_walk(plan, f"mission.victims.{i}", victim)


def _check_walkers(mission: Mission, radius_m: float) -> None:
    """Check that people who flee or follow, and so have a body, do not start within each other."""
    walkers = [(i, victim) for i, victim in enumerate(mission.victims) if victim.flees or victim.can_walk]
    for (_, first), (i, second) in itertools.combinations(walkers, 2):
        if math.dist(first.position, second.position) < 2.0 * radius_m:
            key = f"mission.victims.{i}.position"
            place = f"{point_text(second.position)}: '{second.name}' of radius {radius_m:g} m"
            raise PlacementError(f"{key}: {place} overlaps '{first.name}'", key)


def _check_walk(plan: FloorPlan, key: str, victim: Victim) -> None:
    if victim.wander is not None and not victim.wander.contains(victim.position):
        place = point_text(victim.position)
        raise PlacementError(f"{key}.position: {place} lies outside the region of wander", f"{key}.position")
    if not victim.path:
        return
    still = Solids(plan, doors=False)
    for end_key, start, end in victim.legs():
        check_inside(plan, f"{key}.{end_key}", end)
        hit = still.on_line(start, end)
        if hit:
            line = f"the line from {point_text(start)} to {point_text(end)}"
            raise PlacementError(f"{key}.{end_key}: {line} crosses {hit.kind} '{hit.name}'", f"{key}.{end_key}")


def check_objects(plan: FloorPlan, objects: Sequence[MovableObject], robots: Sequence[PlacedRobot]) -> None:
    """Raise PlacementError, with the key, when an object is in a solid, an object or a robot, or outside the plan."""
    if not objects:
        return
    still, placed = Solids(plan), [obj.body_at(obj.pose) for obj in objects]
    for i, (obj, body) in enumerate(zip(objects, placed, strict=True)):
        key = f"objects.{i}.pose"
        place = f"{key}: {point_text(obj.pose[:2])}: {obj.kind} '{obj.name}'"
        if not plan.bounds.contains(obj.pose[:2]):
            raise PlacementError(f"{place} lies outside the plan, {plan.bounds}", key)
        if hit := still.under_body(body, TOUCH_M):
            raise PlacementError(f"{place} {overlaps(hit)}", key)
        for other, other_body in zip(objects[:i], placed[:i], strict=True):
            if body.overlaps(other_body, TOUCH_M):
                raise PlacementError(f"{place} overlaps {other.kind} '{other.name}'", key)
        for robot_id, robot in enumerate(robots):
            is_near = math.dist(obj.pose[:2], robot.start_pose[:2]) < obj.reach_m + robot.reach_m
            if robot.present and is_near and body.overlaps(robot.body_at(robot.start_pose), TOUCH_M):
                raise PlacementError(f"{place} overlaps robot {robot_id} at its start pose", key)


def _check_spot(plan: FloorPlan, still: Solids, key: str, point: tuple[float, float]) -> None:
    check_inside(plan, key, point)
    hit = still.at_point(point)
    if hit:
        raise PlacementError(f"{key}: {point_text(point)} lies in {hit.kind} '{hit.name}'", key)


@contextmanager
def _blamed(scenario: Scenario) -> Iterator[None]:
    """Add the file or the --set to errors about a key."""
    try:
        yield
    except PlacementError as error:
        raise PlacementError(scenario.origin.line(str(error), error.key), error.key) from None


def _placed(building: Building, members: _Members) -> tuple[PlacedRobot, ...]:
    plan, (robots, firefighters, centre, seed) = building.plan, members
    placed = _placed_team(building, robots, "robots", seed) if isinstance(robots, Team) else _checked_list(plan, robots)
    if firefighters is not None:
        placed += _placed_team(building, firefighters, "firefighters", seed, placed)
    if centre is not None:
        body = centre_body(centre)
        _check_poses(plan, [body.start_pose], [body], ["command_centre"], "the command centre", placed)
        placed += (body,)
    return placed


def _checked_list(plan: FloorPlan, robots: tuple[PlacedRobot, ...]) -> tuple[PlacedRobot, ...]:
    poses = [robot.start_pose for robot in robots]
    _check_poses(plan, poses, robots, [f"robots.{i}.start_pose" for i in range(len(poses))])
    return robots


def _placed_team(
    building: Building, team: Team, section: str, seed: int, others: Sequence[PlacedRobot] = ()
) -> tuple[PlacedRobot, ...]:
    poses = list(team.start_poses[: team.count])
    keys = [f"{section}.start_poses.{i}" for i in range(len(poses))]
    _check_poses(building.plan, poses, [team] * len(poses), keys, f"{section.removesuffix('s')} {{}}", others)
    if len(poses) < team.count:
        poses += formation(building, team, taken=poses, others=others, section=section, seed=seed)
    shared = {key: getattr(team, key) for key in Robot.model_fields}
    at_start = team.count - team.reserve
    return tuple(PlacedRobot(**shared, start_pose=pose, present=i < at_start) for i, pose in enumerate(poses))


def _check(
    building: Building,
    members: _Members,
    mission: Mission,
    objects: tuple[MovableObject, ...],
    schedule: tuple[ScheduledEvent, ...],
) -> None:
    plan = building.plan
    check_mission(plan, mission)
    placed = building.shared(_placed, members)
    check_objects(plan, objects, placed)
    _check_schedule(plan, schedule, placed)


def _check_schedule(plan: FloorPlan, schedule: Sequence[ScheduledEvent], robots: Sequence[PlacedRobot]) -> None:
    """Check that nobody is put into a wall or outside; doors, objects and robots may move until then."""
    still = Solids(plan, doors=False)
    for index, event in enumerate(schedule):
        if event.position is not None:
            _check_spot(plan, still, f"schedule.{index}.position", event.position)
        if event.pose is None or event.robot_id is None:
            continue
        key = f"schedule.{index}.pose"
        place = f"{key}: {point_text(event.pose[:2])}: robot {event.robot_id}"
        if not plan.bounds.contains(event.pose[:2]):
            raise PlacementError(f"{place} lies outside the plan, {plan.bounds}", key)
        if hit := still.under_body(robots[event.robot_id].body_at(event.pose), 0.0):
            raise PlacementError(f"{place} {overlaps(hit)}", key)


def _check_poses(
    plan: FloorPlan,
    poses: list[PlanarPose],
    robots: Sequence[Robot],
    keys: list[str],
    what: str = "robot {}",
    others: Sequence[PlacedRobot] = (),
) -> None:
    """Raise PlacementError, with its key, for a pose in a solid, outside, in an earlier one, or in another robot.

    Args: what: how messages call one of them, with its index. others: that are placed already, in id order.
    """
    still = Solids(plan)
    reaches_m = [robot.reach_m for robot in robots]
    present = [not isinstance(robot, PlacedRobot) or robot.present for robot in robots]
    for i, (pose, robot, key) in enumerate(zip(poses, robots, keys, strict=True)):
        point = pose[:2]
        check_inside(plan, key, point)
        hit = still.under_robot(robot, pose)
        if hit:
            radius = "" if robot.footprint_m else f"of radius {robot.radius_m:g} m "
            raise PlacementError(f"{key}: {point_text(point)}: {what.format(i)} {radius}{overlaps(hit)}", key)
        for j in range(i):
            is_near = math.dist(point, poses[j][:2]) < reaches_m[i] + reaches_m[j]
            if is_near and present[i] and present[j] and _overlap(robot, pose, robots[j], poses[j]):
                text = f"{what.format(i)} overlaps {what.format(j)}"
                raise PlacementError(f"{key}: {point_text(point)}: {text}", key)
        for robot_id, other in enumerate(others):
            is_near = math.dist(point, other.start_pose[:2]) < reaches_m[i] + other.reach_m
            if is_near and other.present and _overlap(robot, pose, other, other.start_pose):
                raise PlacementError(f"{key}: {point_text(point)}: {what.format(i)} overlaps robot {robot_id}", key)


def _overlap(robot: Robot, pose: PlanarPose, other: Robot, other_pose: PlanarPose) -> bool:
    """Whether two robots whose discs overlap do so themselves."""
    if not robot.footprint_m and not other.footprint_m:
        return True
    return robot.body_at(pose).overlaps(other.body_at(other_pose), 0.0)
