"""The scenario: one YAML file, one typed model."""

from __future__ import annotations

import html
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, PrivateAttr, Tag, model_validator

from robotteamsim.scenario.base import Many, Model, Name, by_index, check_names, wrong
from robotteamsim.scenario.controllers import AnyControl
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.firefighters import Firefighters
from robotteamsim.scenario.floor_plan import Block, FloorPlan, Wall
from robotteamsim.scenario.levels import Traveller, served_levels
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.origin import Origin
from robotteamsim.scenario.people import People
from robotteamsim.scenario.plan import too_many_cells
from robotteamsim.scenario.radio_presets import with_preset
from robotteamsim.scenario.rescue import CommandCentre, Relays
from robotteamsim.scenario.schedule import ScheduledEvent, check_schedule
from robotteamsim.scenario.sections import Mission, Network, PlacedRobot, Radio, Run, Team, Voice
from robotteamsim.wording import counted

MAX_ROBOTS = 3000
MAX_OBJECTS = 1000
MAX_EVENTS = 1000

Role = Literal["robot", "firefighter", "command_centre"]


def _robots_form(value: Any) -> str | None:
    """A mapping is read as a team and a list as a list, so that errors are reported for the form that was used."""
    if isinstance(value, (dict, Team)):
        return "<team>"
    return "<list>" if isinstance(value, (list, tuple)) else None


Robots = Annotated[
    Annotated[Team, Tag("<team>")]
    | Annotated[Many[PlacedRobot], Field(min_length=1, max_length=MAX_ROBOTS), Tag("<list>")],
    Discriminator(_robots_form),
]


class Scenario(Model):
    """Everything that one trial depends on. In YAML `plan` is a path, here it is the loaded plan."""

    name: Name = Field(description="shown in tables and results")
    plan: FloorPlan = Field(description="floor plan file, or map_server yaml, relative to this file")
    robots: Robots = Field(
        default=Team(count=0), description="a team of equal robots, or a list; default: none, to study how people leave"
    )
    command_centre: CommandCentre | None = Field(
        default=None, description="id of a robot that stands still, or [x, y]: receives reports and sends orders"
    )
    firefighters: Firefighters | None = Field(
        default=None, description="people who bring victims to the command centre or to exits"
    )
    relays: Relays = Relays()
    people: People = People()
    radio: Radio = Radio()
    voice: Voice = Voice()
    network: Network = Network()
    control: AnyControl = Field(default=RdpsoControl(), description="the controller of each robot, and its keys")
    mission: Mission = Mission()
    objects: Many[MovableObject] = Field(
        default=(), max_length=MAX_OBJECTS, description="boxes and barrels that robots push"
    )
    schedule: Many[ScheduledEvent] = Field(
        default=(),
        max_length=MAX_EVENTS,
        description="changes while the world runs: robots, doors, noise, victims, fire",
    )
    fire: Fire | None = Field(default=None, description="fire and smoke; none by default")
    run: Run = Run()

    _plan_file: tuple[FloorPlan, str] | None = PrivateAttr(default=None)
    _origin: Origin = PrivateAttr(default=Origin())

    @model_validator(mode="before")
    @classmethod
    def _apply_radio_preset(cls, data: Any) -> Any:
        """The thresholds of a preset, which are in another section than its name."""
        if not isinstance(data, dict):
            return data
        radio = data.get("radio")
        name = radio.preset if isinstance(radio, Radio) else radio.get("preset") if isinstance(radio, dict) else None
        network = with_preset("network", data.get("network", {}), name)
        return data if network in ({}, None) else {**data, "network": network}

    @model_validator(mode="after")
    def _check(self) -> Scenario:
        materials = {*self.radio.materials, *(material.name for material in self.plan.materials)}
        known = ", ".join(sorted(materials)) or "none"
        elements: tuple[Wall | Block, ...] = (*self.plan.walls, *self.plan.blocks)
        for element in elements:
            if element.material is not None and element.material not in materials:
                text = f"has no '{element.material}', the material of '{element.name}' in the plan; known: {known}"
                raise wrong("radio.materials", text)
        if problem := too_many_cells(self.plan, self.voice.map_resolution_m):
            raise wrong("voice.map_resolution_m", problem)
        self._check_third_dimension()
        self._check_roles()
        self.control.check_number(self.num_robots)
        if self.mission.area_order == "search" and not self.control.values_areas:
            text = f"'search' needs control.algorithm search, which values areas, not {self.control.algorithm}"
            raise wrong("mission.area_order", text)
        self._check_map()
        check_names(by_index("objects", self.objects))
        if self.team_size and not any(self.present_at_start):
            raise wrong("robots", "none of them is present at the start")
        doors = [door.name for door in self.plan.doors]
        lights = [light.name for light in self.run.mujoco.lights]
        check_schedule(self.schedule, self.present_at_start, doors, lights, self.levels_of)
        self._check_fire(doors)
        base, last = self.mission.base, self.num_robots - 1
        if base is not None and base > last:
            raise wrong("mission.base", f"there is no robot {base}; expected 0 to {last}")
        if base is not None and last == 0:
            raise wrong("mission.base", "is the only robot; expected at least one other robot to search")
        return self

    def _check_third_dimension(self) -> None:
        """Raise the error of what does not exist in the selected world, or has no place there."""
        robots = (self.robots,) if isinstance(self.robots, Team) else self.robots
        if self.run.world == "box2d":
            for key, robot in zip(self._robot_keys, robots, strict=True):
                for index, sensor in enumerate(robot.sensors):
                    if sensor.needs_mujoco:
                        text = f"{sensor.kind} '{sensor.name}' needs run.world mujoco, not box2d"
                        raise wrong(f"{key}.sensors.{index}", text)
            if any(robot.gripper for robot in robots):
                raise wrong("robots.gripper", "need run.world mujoco, not box2d")
        for key, used in (("ramps", self.run.mujoco.ramps), ("lights", self.run.mujoco.lights)):
            if used and self.run.world != "mujoco":
                raise wrong(f"run.mujoco.{key}", f"need run.world mujoco, not {self.run.world}")
        places = [(f"ramps.{i}.from", ramp.start) for i, ramp in enumerate(self.run.mujoco.ramps)]
        places += [(f"ramps.{i}.to", ramp.end) for i, ramp in enumerate(self.run.mujoco.ramps)]
        places += [(f"lights.{i}.position", light.position) for i, light in enumerate(self.run.mujoco.lights)]
        for key, (x, y) in places:
            if not self.plan.bounds.contains((x, y)):
                raise wrong(f"run.mujoco.{key}", f"[{x:g}, {y:g}] lies outside the bounds {self.plan.bounds}")

    def _check_fire(self, doors: list[str]) -> None:
        """Raise the error of a fire that contradicts the plan or the rest of the scenario."""
        for index, event in enumerate(self.schedule):
            if event.ignite is not None and self.fire is None:
                raise wrong(f"schedule.{index}.ignite", "there is no section 'fire' with fuel")
            if event.ignite is not None and self.fire is not None and self.fire.fds is not None:
                raise wrong(f"schedule.{index}.ignite", "not allowed with fire.fds, whose fire is already computed")
        if self.fire is None:
            return
        for index, name in enumerate(self.fire.fireproof):
            if name not in doors:
                known = ", ".join(doors) or "none"
                raise wrong(f"fire.fireproof.{index}", f"there is no door '{name}'; known: {known}")
        if self.run.world != "box2d":
            raise wrong("fire", f"needs run.world box2d, not {self.run.world}")
        if self.fire.update_ns < self.run.step_ns:
            raise wrong("fire.update_s", f"{self.fire.update_s:g} is below run.step_s, {self.run.step_s:g}")
        if self.firefighters is not None and self.firefighters.block_c < self.fire.heat.block_c:
            limits = f"{self.firefighters.block_c:g} is below fire.heat.block_c, {self.fire.heat.block_c:g}"
            raise wrong("firefighters.block_c", f"{limits}, the least temperature that thermal cameras show")

    def _check_map(self) -> None:
        """Raise the error of a team that cannot map its building."""
        control = self.control
        if control.map not in control.maps:
            expected = " or ".join(f"'{name}'" for name in control.maps)
            raise wrong("control.map", f"'{control.map}' with algorithm {control.algorithm}; expected {expected}")
        if control.map == "known":
            if control.mapping.starts == "unknown":
                raise wrong("control.mapping.starts", "'unknown' needs control.map 'unknown'")
            return
        if control.mapping.starts == "unknown" and control.localisation != "laser":
            text = f"'unknown' is not possible with localisation {control.localisation}; expected 'laser'"
            raise wrong("control.mapping.starts", text)
        cannot = {"levels": self.plan.levels, "firefighters": self.firefighters, "relays": self.relays.count}
        cannot["localisation tf"] = control.localisation == "tf"
        for what, given in cannot.items():
            if given:
                raise wrong("control.map", f"'unknown' is not possible with {what}; expected 'known'")

    def _check_roles(self) -> None:
        """Raise the error of robots, firefighters, command centre and victims that do not fit together."""
        robots, mission, centre = self.num_robots, self.mission, self.command_centre
        if robots == 0 and self.firefighters is None:
            self._check_without_team()
        if isinstance(centre, int) and centre >= robots:
            raise wrong("command_centre", f"there is no robot {centre}; expected 0 to {robots - 1}, or [x, y]")
        if centre is not None and mission.base is not None:
            raise wrong("mission.base", "not allowed together with command_centre")
        if self.firefighters is not None and centre is None:
            raise wrong("command_centre", "missing; firefighters need the id of a robot, or [x, y]")
        if self.firefighters is None and mission.saved_by == "firefighter":
            raise wrong("mission.saved_by", "'firefighter' needs the section firefighters, which is missing")
        if self.firefighters is not None and mission.saved_by != "firefighter":
            raise wrong(
                "mission.saved_by", f"'{mission.saved_by}' is not allowed with firefighters; expected 'firefighter'"
            )
        if self.relays.count > robots:
            raise wrong("relays.count", f"{self.relays.count} is above the number of robots, {robots}")
        self._check_people()

    def _check_without_team(self) -> None:
        """Raise the error of a scenario without robots and firefighters that is no study of how people leave."""
        if not self.mission.exits:
            if "robots" in self.model_fields_set:
                raise wrong("robots.count", "0 is below 1")
            raise wrong("robots", "missing; expected a team of equal robots, or a list")
        needed = {
            "command_centre": self.command_centre is not None,
            "mission.base": self.mission.base is not None,
            "mission.areas": self.mission.areas,
            "mission.random_victims": self.mission.random_victims,
            "mission.coverage": self.mission.coverage,
        }
        for key, used in needed.items():
            if used:
                raise wrong(key, "needs robots or firefighters; there are none")

    def _check_people(self) -> None:
        """Raise the error of people who have nowhere to flee to, or the name of another."""
        mission, groups = self.mission, self.people.groups
        flees = {f"mission.victims.{index}": victim.flees for index, victim in enumerate(mission.victims)}
        flees |= {f"people.groups.{index}": group.flees for index, group in enumerate(groups)}
        fleeing = next((key for key, do_flee in flees.items() if do_flee), None)
        if fleeing and not mission.exits:
            raise wrong(f"{fleeing}.flees", "there is no exit; expected at least one in mission.exits")
        known = {victim.name for victim in mission.victims}
        known |= {f"random_{number}" for number in range(1, mission.random_victims + 1)}
        for index, group in enumerate(groups):
            if double := known.intersection(group.names):
                raise wrong(f"people.groups.{index}.name", f"'{min(double)}' is the name of another victim")
            known.update(group.names)

    @property
    def _robot_keys(self) -> tuple[str, ...]:
        """The keys of `robots` that describe a robot."""
        return ("robots",) if isinstance(self.robots, Team) else tuple(f"robots.{i}" for i in range(len(self.robots)))

    @property
    def num_robots(self) -> int:
        """Number of robots, present at the start or not."""
        return self.robots.count if isinstance(self.robots, Team) else len(self.robots)

    @property
    def searcher_ids(self) -> tuple[int, ...]:
        """The ids of the robots that are neither the base nor a relay, present at the start or not."""
        return tuple(i for i in range(self.num_robots - self.relays.count) if i != self.base)

    def hot_for_c(self, robot_id: int) -> float:
        """Return from which temperature on a member of the team avoids places, if they sense heat [degC]."""
        if self.firefighters is not None and robot_id in self.firefighter_ids:
            return self.firefighters.block_c
        return (self.fire or Fire()).heat.block_c

    @property
    def num_firefighters(self) -> int:
        """Number of firefighters, present at the start or not."""
        return 0 if self.firefighters is None else self.firefighters.count

    @property
    def team_size(self) -> int:
        """Number of robots, firefighters and, unless it is a robot, the command centre; their ids are in this order."""
        return self.num_robots + self.num_firefighters + isinstance(self.command_centre, tuple)

    @property
    def firefighter_ids(self) -> range:
        """The ids of the firefighters."""
        return range(self.num_robots, self.num_robots + self.num_firefighters)

    @property
    def base(self) -> int | None:
        """Id of the command centre or base, which discoveries are delivered to; None if there is none."""
        if self.command_centre is None:
            return self.mission.base
        return self.command_centre if isinstance(self.command_centre, int) else self.team_size - 1

    def role_of(self, robot_id: int) -> Role:
        """Return the role of a member of the team. A base, which gives no orders, is a robot."""
        if robot_id in self.firefighter_ids:
            return "firefighter"
        return "command_centre" if self.command_centre is not None and robot_id == self.base else "robot"

    def levels_of(self, robot_id: int) -> list[str]:
        """Return the names of the levels to which a member of the team can go."""
        return served_levels(self.plan.levels, self.plan.passages, self.travels_as(robot_id))

    def travels_as(self, robot_id: int) -> Traveller:
        """Return whose passages a member of the team uses: firefighters, and the centre that sends them, people's."""
        return "robots" if self.role_of(robot_id) == "robot" else "people"

    @property
    def roles(self) -> tuple[Role, ...]:
        """The role of each member of the team, in id order."""
        return tuple(map(self.role_of, range(self.team_size)))

    def name_of(self, robot_id: int) -> str:
        """Return the name of a member of the team for texts, such as "robot 2"."""
        role = self.role_of(robot_id)
        return "the command centre" if role == "command_centre" else f"{role} {robot_id}"

    @property
    def moves_people(self) -> bool:
        """Whether the world moves people; otherwise victims only walk as their `path` or `wander` says."""
        if self.mission.saved_by == "firefighter" or any(victim.flees for victim in self.mission.victims):
            return True
        return any(group.flees for group in self.people.groups)

    @property
    def num_victims(self) -> int:
        """Number of victims at the start, those included whom the seed draws."""
        drawn = self.mission.random_victims + sum(group.count for group in self.people.groups)
        return len(self.mission.victims) + drawn

    @property
    def has_egress(self) -> bool:
        """Whether missions report how people leave: there is a fire, or an exit."""
        return self.fire is not None or bool(self.mission.exits)

    @property
    def present_at_start(self) -> tuple[bool, ...]:
        """Whether each member of the team is present at the start, in id order."""
        robots = _present(self.robots) if isinstance(self.robots, Team) else [robot.present for robot in self.robots]
        firefighters = [] if self.firefighters is None else _present(self.firefighters)
        return (*robots, *firefighters, *([True] if isinstance(self.command_centre, tuple) else []))

    @property
    def plan_file(self) -> str | None:
        """The file of `plan`; None if the plan did not come from a file or was changed."""
        return self._plan_file[1] if self._plan_file and self._plan_file[0] == self.plan else None

    @property
    def origin(self) -> Origin:
        """Its source, which errors found later name."""
        return self._origin

    def __repr__(self) -> str:
        team, mission = counted(self.num_robots, "robot"), self.mission
        people = f"{counted(len(mission.areas), 'area')}, {counted(self.num_victims, 'victim')}"
        return f"<Scenario {self.name}: {team}, {people}, plan {self.plan.name}, seed {self.run.seed}>"

    def _repr_html_(self) -> str:
        """Return the text of `robotteamsim scenario show`, folded, for notebooks."""
        from robotteamsim.scenario.loading import dump

        summary, text = html.escape(repr(self)), html.escape(dump(self))
        return f"<details><summary>{summary}</summary><pre>{text}</pre></details>"

    def read_from(self, origin: Origin, plan_file: str | None) -> Scenario:
        """Return this scenario with its source and the file of its plan; None if it has no such file."""
        scenario = self.model_copy()
        scenario._origin = origin
        scenario._plan_file = None if plan_file is None else (self.plan, plan_file)
        return scenario


def _present(team: Team) -> list[bool]:
    return [index < team.count - team.reserve for index in range(team.count)]
