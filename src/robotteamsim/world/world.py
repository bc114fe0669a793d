"""The world of Box2D, bodies in the plane, and the choice of a scenario's world."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint
from pkgutil import resolve_name

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.own_parts import PartError, class_below, load_part
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors.base import Fan
from robotteamsim.scenario.worlds import ENTRY_POINTS, OURS, WORLDS
from robotteamsim.wording import described, place_of
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.core_parts import core_fan, core_object, core_robot, core_solids


class World(AnyWorld):
    """A floor plan with robots and objects: static walls, doors, round or polygonal bodies with drives.

    Commands are twists in `base_link`: the drive approaches them within its acceleration and speed limits in every
    physics substep; only omnidirectional drives can move sideways. Box2D solves contacts without friction: a contact
    removes the velocity component that presses a robot into something, so a robot slides along a wall that it meets at
    an angle, and pushes robots. A robot without contact moves in double precision exactly as its drive computes.

    `AnyWorld` documents the members.
    """

    core: _core.world.World
    """The C++ world."""

    def caster(self, fan: Fan) -> Callable[[Sequence[int]], np.ndarray]:
        """See `AnyWorld.caster`."""
        return functools.partial(fan_caster(self.plan, fan).cast, self.core)

    def _make_physics(self, run: Run) -> _core.world.World:
        still, leaves = core_solids(self.plan)
        bodies, models = [core_robot(robot) for robot in self._robots], [core_object(obj) for obj in self._objects]
        self.core = _core.world.World(still, leaves, bodies, run.step_s, run.physics_substeps, models)
        return self.core

    def _add_body(self, obj: MovableObject) -> None:
        self.core.add_object(core_object(obj))


# Worlds on one plan share casters, because they store visible edges per cell.
@functools.lru_cache(maxsize=64)
def fan_caster(plan: FloorPlan, fan: Fan) -> _core.world.FanCaster:
    """Return what casts these beams in worlds on a plan."""
    return _core.world.FanCaster(core_fan(fan), *core_solids(plan))


def make_world(scenario: Scenario, robots: Sequence[PlacedRobot]) -> AnyWorld:
    """Return the world of `run.world` with these robots, in id order.

    Raises: PlacementError: a robot or object has no room.
            ModuleNotFoundError: the package that computes this world is not installed; see `robotteamsim.extras`.
            ScenarioError: the world of a user's package cannot be made.
    """
    name, place = scenario.run.world, WORLDS[scenario.run.world]
    if name in OURS:
        return _made(resolve_name(place), scenario, robots)
    try:
        return _made(class_below(AnyWorld, load_part(EntryPoint(name, place, ENTRY_POINTS))), scenario, robots)
    except (KeyboardInterrupt, PlacementError):
        raise
    except BaseException as error:  # Any error in the user's module is reported in one line.
        problem = error if isinstance(error, PartError) else f"{described(error)} ({place_of(error)[1]})"
        raise ScenarioError(f"{scenario.name}: run.world: {name} of {place}: {problem}") from None


def _made(world: Callable[..., AnyWorld], scenario: Scenario, robots: Sequence[PlacedRobot]) -> AnyWorld:
    return world(scenario.plan, robots, scenario.run, objects=scenario.objects)
