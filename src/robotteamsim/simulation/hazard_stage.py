"""Fire and smoke between the world and the sensors: doors burn through, robots and firefighters fail."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Twist
from robotteamsim.hazards import HazardField, Hazards, HazardSource, HeatStress
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation.firefighters import FirefighterHealth
from robotteamsim.world.contract import AnyWorld


class HazardStage:
    """Fire and smoke of one trial, and what they do to the world. The headless loop and the world node step it."""

    def __init__(self, scenario: Scenario, world: AnyWorld) -> None:
        """Prepare. Raises: ScenarioError: fuel or an ignition is in the wrong place; one line with file, key, value."""
        assert scenario.fire is not None
        self._world = world
        self._update_s = scenario.fire.update_s
        self.hazards = make_hazards(scenario)
        self._stress = HeatStress(scenario.fire, world.num_robots)
        self._firefighters = FirefighterHealth(scenario)
        self.failed: frozenset[int] = frozenset()
        """The absent robots and firefighters that have failed or collapsed; the same object until that changes."""

    @property
    def field(self) -> HazardField:
        """Fire, smoke and temperature as of the last update."""
        return self.hazards.field

    def slowed(self, twists: Sequence[Twist]) -> Sequence[Twist]:
        """Return the commands of a step as firefighters can follow them in the smoke of the last update."""
        return self._firefighters.slowed(twists)

    def step(self) -> bool:
        """Advance to the world's current step, just made; return whether this was an update of fire and smoke."""
        if self.failed and self._world.present is not None:
            still = frozenset(robot_id for robot_id in self.failed if not self._world.present[robot_id])
            self.failed = self.failed if still == self.failed else still
        elif self.failed:
            self.failed = frozenset()
        if not self.hazards.step(self._world.sim_time_ns, self._world.door_states()):
            return False
        for name in self.hazards.burnt_doors():
            if self._world.door_states()[name].closed:
                self._world.set_door(name, closed=False)
        positions_m = self._world.positions_m()
        failing = self._firefighters.expose(positions_m, self.field, self._update_s)
        failing += self._stress.expose(self._firefighters.without(positions_m), self.field, self._update_s)
        for robot_id in failing:
            self._world.remove_robot(robot_id)
        if failing:
            self.failed |= frozenset(failing)
        return True

    def ignite(self, position_m: Point) -> None:
        """Set fire to a place in `map` [m]. Raises: ValueError: nothing burns there."""
        self.hazards.ignite(position_m)


def check_fire(scenario: Scenario) -> None:
    """Check fuel and ignitions of a scenario. Raises: ScenarioError: one line with file, key and value."""
    if scenario.fire is not None:
        make_hazards(scenario)


def make_hazards(scenario: Scenario) -> HazardSource:
    """Return the source of fire and smoke of a scenario: simulated, or the results of FDS.

    Raises: ScenarioError: fuel, an ignition, or the folder of FDS is wrong; one line with file, key and value.
    """
    assert scenario.fire is not None
    try:
        if scenario.fire.fds is not None:
            from robotteamsim.hazards.fds import FdsHazards

            return FdsHazards(scenario)
        return Hazards(scenario)
    except PlacementError as error:
        raise PlacementError(scenario.origin.line(str(error), error.key), error.key) from None
