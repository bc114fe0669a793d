"""The stages of a step around the world, in their order: schedule, hazards, people, hearing, network.

Each is a class with one `step`, which returns what the stages after it need.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping, Sequence
from typing import Protocol

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.hazards import HazardField, HazardSource, HeatStress, Ignited, walking_speed_share
from robotteamsim.hazards.hazards import make_hazards
from robotteamsim.interface import Assistance
from robotteamsim.mission.status import OUT_OF_DANGER, VictimState
from robotteamsim.network import Message, Network, NetworkState
from robotteamsim.propagation import FieldMap, RadioField
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.fire import REPLAN_NS, Block
from robotteamsim.scenario.schedule import ScheduledEvent, in_order
from robotteamsim.sensing.voice import VoiceSensor
from robotteamsim.setup import Setup
from robotteamsim.simulation.firefighters import FirefighterHealth
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.people import People, PersonState
from robotteamsim.world.walking import Walkers


class _Changeable(Protocol):
    """What a schedule can change; see the methods of `Simulation`."""

    def remove_robot(self, robot_id: int) -> None: ...
    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None: ...
    def take_passage(self, robot_id: int, level: str) -> None: ...
    def set_door(self, name: str, closed: bool) -> None: ...
    def set_light(self, name: str, lit: bool) -> None: ...
    def set_noise_db(self, noise_db: float) -> None: ...
    def set_victim(self, name: str, position_m: Point) -> None: ...
    def ignite(self, position_m: Point) -> None: ...


class ScheduleStage:
    """Changes the simulation before a step, as somebody who calls its methods.

    Each event takes effect in the first step that begins at its time or later, in order of time. A robot whose place is
    occupied arrives as soon as it is free, unless it is removed before. Events that no longer apply, because the robot
    is already absent or present, or on its level, are skipped.
    """

    def __init__(self, schedule: Sequence[ScheduledEvent]) -> None:
        self._upcoming = deque(event for _, event in in_order(schedule))
        self._waiting: list[ScheduledEvent] = []
        """Spawns that are due, of robots whose place is occupied."""

    def step(self, begin_ns: int, changed: _Changeable) -> None:
        """Apply to a simulation the events that are due in the step that begins at this time [ns]."""
        due, self._waiting = self._waiting, []
        while self._upcoming and round(self._upcoming[0].at_s * 1e9) <= begin_ns:
            due.append(self._upcoming.popleft())
        for event in due:
            self._apply(event, changed)

    def _apply(self, event: ScheduledEvent, changed: _Changeable) -> None:
        if event.robot_id is not None:
            self._change_robot(event, changed)
        elif event.door is not None:
            changed.set_door(event.door, bool(event.closed))
        elif event.light is not None:
            changed.set_light(event.light, bool(event.lit))
        elif event.noise_db is not None:
            changed.set_noise_db(event.noise_db)
        elif event.victim is not None and event.position is not None:
            changed.set_victim(event.victim, event.position)
        elif event.ignite is not None:
            changed.ignite(event.ignite)

    def _change_robot(self, event: ScheduledEvent, changed: _Changeable) -> None:
        try:
            if event.remove is not None:
                self._waiting = [spawn for spawn in self._waiting if spawn.spawn != event.remove]
                changed.remove_robot(event.remove)
            elif event.spawn is not None:
                changed.spawn_robot(event.spawn, event.pose and Pose(*event.pose))
            elif event.take_passage is not None and event.level is not None:
                changed.take_passage(event.take_passage, event.level)
        except PlacementError:
            self._waiting.append(event)
        except ValueError:  # The robot is already absent, present, or on this level.
            pass


class NoHazards:
    """The hazards of a scenario in which nothing can burn: what `FireStage` has, without effect."""

    source: None = None
    field: None = None
    is_updated = False
    failed: frozenset[int] = frozenset()
    burnt_doors: tuple[str, ...] = ()
    ignited: tuple[Ignited, ...] = ()

    def slowed(self, twists: Sequence[Twist]) -> Sequence[Twist]:
        """Return the commands as they are."""
        return twists

    def step(self) -> None:
        """Do nothing."""

    def ignite(self, position_m: Point) -> None:
        """Raises: ValueError: the scenario has no fire."""
        raise ValueError("ignite: the scenario has no section 'fire'")


class FireStage:
    """Fire and smoke, and what they do to the world: doors burn through, robots and firefighters fail.

    source:      simulates them.
    field:       fire, smoke and temperature as of the last update.
    is_updated:  whether `field` was updated in the last step.
    failed:      the absent robots and firefighters that have failed or collapsed.
    burnt_doors: the names of the doors that have burnt through.
    """

    def __init__(self, setup: Setup, world: AnyWorld) -> None:
        scenario = setup.scenario
        assert scenario.fire is not None
        self._world = world
        self._update_s = scenario.fire.update_s
        self.source: HazardSource = make_hazards(scenario, setup.building)
        self.field = self.source.field
        self.is_updated = False
        self.failed: frozenset[int] = frozenset()
        self.burnt_doors: tuple[str, ...] = ()
        self._stress = HeatStress(scenario.fire, world.num_robots)
        self._firefighters = FirefighterHealth(scenario)

    @property
    def ignited(self) -> tuple[Ignited, ...]:
        """What has begun to burn so far, in order."""
        return self.source.ignited

    def slowed(self, twists: Sequence[Twist]) -> Sequence[Twist]:
        """Return the commands of a step as firefighters can follow them in the smoke of the last update."""
        return self._firefighters.slowed(twists)

    def step(self) -> None:
        """Advance to the world's current step, just made."""
        world = self._world
        self.failed = frozenset(robot_id for robot_id in self.failed if not world.present[robot_id])
        self.is_updated = self.source.step(world.sim_time_ns, world.door_states())
        self.field = field = self.source.field
        if not self.is_updated:
            return
        self.burnt_doors = self.source.burnt_doors()
        for name in self.burnt_doors:
            if world.door_states()[name].closed:
                world.set_door(name, closed=False)
        positions_m = world.positions_m()
        failing = self._firefighters.expose(positions_m, field, self._update_s)
        failing += self._stress.expose(self._firefighters.without(positions_m), field, self._update_s)
        for robot_id in failing:
            world.remove_robot(robot_id)
        self.failed |= frozenset(failing)

    def ignite(self, position_m: Point) -> None:
        """Set fire to a place in `map` [m]. Raises: ValueError: nothing burns there."""
        self.source.ignite(position_m)


class PeopleStage:
    """The victims who move: people who flee or are helped, or else victims who walk along their paths.

    They move after the world, by what the mission knew at the end of the last step.
    """

    def __init__(self, setup: Setup, world: AnyWorld) -> None:
        scenario = setup.scenario
        self._world = world
        self._people = People(scenario, setup.robots, setup.building) if scenario.moves_people else None
        self._walkers = Walkers(scenario)
        self._collapsed: set[str] = set()
        self._hot: set[Block] = set()
        self._next_ns = 0

    @property
    def version(self) -> int:
        """Number of updates of `states`."""
        return 0 if self._people is None else self._people.version

    @property
    def states(self) -> tuple[PersonState, ...]:
        """The people as of the last update; empty if victims only walk."""
        return () if self._people is None else self._people.states

    def step(
        self, victims: Sequence[VictimState], assistance: Sequence[Assistance], field: HazardField | None
    ) -> Mapping[str, Point]:
        """Move everybody for the world's current step; return new positions by name [m], if they are due.

        Args: victims, assistance: of the mission after the step before.
              field: fire and smoke; None if nothing can burn.
        """
        world, people = self._world, self._people
        if people is None:
            return self._walkers.positions_due(world.sim_time_ns)
        states = list(zip(people.names, victims, strict=False))
        collapsed = [name for name, state in states if state == "collapsed"]
        collapsed += [helped.victim for helped in assistance if helped.collapsed]
        for name in collapsed:
            if name not in self._collapsed:
                self._collapsed.add(name)
                people.collapse(name)
        if field is not None:
            self._feel(people, field, world.sim_time_ns)
        settled = {name for name, state in states if state in OUT_OF_DANGER}
        settled |= {helped.victim for helped in assistance if not helped.moving}
        helpers = {helped.victim: helped.robot_id for helped in assistance if helped.moving}
        before = people.states
        people.step(world.sim_time_ns, world.positions_m(), world.door_states(), helpers, settled)
        now = people.states
        return {} if now == before else {person.name: person.position_m for person in now}

    def _feel(self, people: People, field: HazardField, sim_time_ns: int) -> None:
        """Let smoke slow everybody down [frantzich2003], and nobody flee through heat, which all of them see."""
        extinction_per_m = field.extinction_per_m(people.positions_m)
        people.slow_down(walking_speed_share(extinction_per_m).tolist())
        if sim_time_ns < self._next_ns:
            return
        self._next_ns = sim_time_ns + REPLAN_NS
        known = self._hot | field.hot_blocks(field.fire.heat.block_c)
        if known != self._hot:
            self._hot = known
            people.avoid(tuple(sorted(known)))

    def place(self, name: str, position_m: Point) -> None:
        """Add a victim, or move the one of that name [m, map], who then stays there."""
        self._walkers.stop(name)
        if self._people is not None:
            self._people.place(name, position_m)
        self._collapsed.discard(name)


class HearingStage:
    """What the robots hear of the victims who call."""

    def __init__(self, setup: Setup) -> None:
        scenario = setup.scenario
        self.sensor = VoiceSensor(scenario.plan, scenario.voice, scenario.mission.victims, scenario.run.seed)
        """The sensor of voices."""
        self._map_version = -1
        self.new_map: FieldMap | None = None
        """The voice map after the first step and after each in which it has changed, else None."""

    def step(self, state: _core.state.State, moved: Mapping[str, Point], silent: Collection[str]) -> None:
        """Write what each robot hears into a state, in which the robots are where they are.

        Args: moved:  new positions of victims, by name [m, map].
              silent: names of the victims who are silent as of the last step.
        """
        for name, position_m in moved.items():
            self.sensor.move_victim(name, position_m)
        self.silence(silent)
        self.sensor.hear(state)

    def silence(self, silent: Collection[str]) -> None:
        """Let these victims be silent from this step on, and all others call."""
        self.sensor.set_silenced(silent)
        self.new_map = self.sensor.map() if self.sensor.version != self._map_version else None
        self._map_version = self.sensor.version


class NetworkStage:
    """The radio network of the robots that are present."""

    def __init__(self, setup: Setup, world: AnyWorld) -> None:
        scenario = setup.scenario
        self._world = world
        self.radio = RadioField(scenario.plan, scenario.radio)
        """How radio fades in the building."""
        run = scenario.run
        self.network = Network(self.radio, scenario.network, scenario.team_size, seed=run.seed, step_ns=run.step_ns)
        self._team_version = -1

    def step(
        self, state: _core.state.State, outboxes: Sequence[Sequence[Message]]
    ) -> tuple[NetworkState, Sequence[Sequence[Message]]]:
        """Write the links into a state; return the network, and the messages that each robot receives, in id order.

        Args: outboxes: messages sent in the last step, one sequence per robot in id order.
        """
        if self._world.team_version != self._team_version:
            self._team_version = self._world.team_version
            self.network.follow_team(self._world.present)
        return self.network.step(state, outboxes)
