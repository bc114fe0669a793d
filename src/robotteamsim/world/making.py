"""Makes the world that a scenario asks for."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.world import World


def make_world(scenario: Scenario, robots: Sequence[PlacedRobot]) -> AnyWorld:
    """Return the world of `run.world` with these robots, in id order.

    Raises: PlacementError: a robot or object has no room.
            ModuleNotFoundError: the package that computes this world is not installed; see `robotteamsim.extras`.
    """
    plan, run, objects = scenario.plan, scenario.run, scenario.objects
    if run.world == "box2d":
        return World(plan, robots, run, objects=objects)
    # MuJoCo is an extra, and its import takes a while.
    from robotteamsim.world.mujoco.world import MujocoWorld

    return MujocoWorld(plan, robots, run, objects=objects)
