"""Common settings of all nodes of a launch, from the parameter server."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cached_property

import rospy

from robotteamsim.control import foreign_code
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import robot_name
from robotteamsim.ros.launched import NOT_SET, PARAMETERS, ParameterError, read_scenario
from robotteamsim.ros.node import parameter, wait_for_shutdown
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.sections import Run
from robotteamsim.setup import Setup, resolve

SEED = f"{PARAMETERS}/seed"
"""The parameter of the seed for all nodes; a string, because XML-RPC has only 32-bit integers."""

OTHERS_REPORT_S = 10.0
"""Delay before a node other than the simulation reports a mistake in the settings [s, wall]."""
OLD_NAMES = {"per_robot": "nodes", "false": "none"}
HOSTED = ("nodes", "team", "inside", "none")
"""Where controllers run: a node for each robot, one for all, the node of the simulation, or none of this package."""
EVERYBODY = "all"


@dataclass(frozen=True)
class Settings:
    """Common settings of all nodes; docs/ros_api.md describes the parameters.

    elsewhere: ids of the robots that another world moves, such as Gazebo or the real one.
    mission:   whether the mission's topics are published.
    prefix:    whether topics and frames begin with robot_<id>/; without it, there is a single robot, as in stage_ros.
    """

    scenario: Scenario
    lockstep: bool = False
    controllers: str = "nodes"
    teleop: int = NOT_SET
    silence_limit_s: float = 5.0
    elsewhere: tuple[int, ...] = ()
    mission: bool = True
    prefix: bool = True

    def robot_topic(self, robot_id: int, name: str) -> str:
        """Return the full name of a robot's topic: /robot_0/odom, or /odom without a prefix."""
        return f"/{robot_name(robot_id)}/{name}" if self.prefix else f"/{name}"

    @property
    def controlled(self) -> range:
        """Ids of the robots whose controllers are nodes of this package."""
        return range(self.num_robots if self.controllers in ("nodes", "team") else 0)

    def is_driven_by_hand(self, robot_id: int) -> bool:
        """Whether a robot obeys `cmd_vel` of others than a controller of this package."""
        return self.controllers == "none" or robot_id == self.teleop

    @property
    def is_another_world(self) -> bool:
        """Whether time and all robots are elsewhere."""
        return len(self.elsewhere) == self.num_robots

    @property
    def by_tf(self) -> bool:
        """Whether the robots know their poses from tf."""
        return self.scenario.control.localisation == "tf"

    @property
    def num_robots(self) -> int:
        """Number of robots, firefighters and command centres, each with topics of its own."""
        return self.scenario.team_size

    @property
    def step_ns(self) -> int:
        """Length of a step [ns]."""
        return self.scenario.run.step_ns

    def with_seed(self, seed: int | str) -> Settings:
        """Return the same settings with another seed. Raises: ParameterError."""
        run = checked(Run, self.scenario.run.model_dump() | {"seed": seed}, ParameterError)
        return replace(self, scenario=self.scenario.model_copy(update={"run": run}))

    @cached_property
    def setup(self) -> Setup:
        """The resolved scenario. Raises: PlacementError, ScenarioError, see `resolve`."""
        return resolve(_with_instant_doors(self.scenario) if self.is_another_world else self.scenario)


def _with_instant_doors(scenario: Scenario) -> Scenario:
    """Return a scenario whose doors only follow those of another world, which reports when they have moved."""
    doors = tuple(door.model_copy(update={"motion": "instant"}) for door in scenario.plan.doors)
    return scenario.model_copy(update={"plan": scenario.plan.model_copy(update={"doors": doors})})


def read_settings(report_s: float = OTHERS_REPORT_S) -> Settings:
    """Return the settings from the parameter server.

    All nodes of a launch find the same mistake: the simulation reports it at once, which ends the launch.

    Args:   report_s: delay before a mistake is reported [s, wall].
    Raises: ParameterError, ScenarioError.
    """
    try:
        return _read_settings()
    except RobotTeamSimError:
        wait_for_shutdown(report_s)
        raise


def read_seed(settings: Settings) -> Settings:
    """Return the settings with the seed of the last reset, for a node that starts again. Raises: ParameterError."""
    text = parameter(SEED, "")
    try:
        return settings.with_seed(int(text) if re.fullmatch("-?[0-9]{1,20}", text) else text) if text else settings
    except ParameterError as error:
        raise ParameterError(f"{PARAMETERS}/{error}") from None


def _read_settings() -> Settings:
    scenario = read_scenario(parameter)
    hosted = parameter(f"{PARAMETERS}/controllers", "nodes").lower()
    settings = Settings(
        scenario,
        lockstep=parameter(f"{PARAMETERS}/lockstep", False),
        controllers=OLD_NAMES.get(hosted, hosted),
        teleop=parameter(f"{PARAMETERS}/teleop", NOT_SET),
        silence_limit_s=float(parameter(f"{PARAMETERS}/silence_limit_s", 5.0)),
        elsewhere=_elsewhere(scenario.team_size),
        mission=parameter(f"{PARAMETERS}/mission", True),
        prefix=parameter(f"{PARAMETERS}/prefix", True),
    )
    _check(settings)
    return read_seed(settings)


def _elsewhere(num_robots: int) -> tuple[int, ...]:
    text = parameter(f"{PARAMETERS}/elsewhere", "")
    if text == EVERYBODY:
        return tuple(range(num_robots))
    try:
        ids = tuple(sorted(set(map(int, text.split()))))
    except ValueError:
        raise ParameterError(
            f"{PARAMETERS}/elsewhere: {text!r}; expected ids of robots, separated by blanks, or {EVERYBODY}"
        ) from None
    for robot_id in ids:
        if robot_id not in range(num_robots):
            raise ParameterError(f"{PARAMETERS}/elsewhere: {robot_id}; expected 0 to {num_robots - 1}")
    return ids


def _check(settings: Settings) -> None:
    """Raise ParameterError if the settings do not fit together."""
    if settings.controllers not in HOSTED:
        raise ParameterError(f"{PARAMETERS}/controllers: {settings.controllers}; expected {', '.join(HOSTED)}")
    if settings.controllers != "none" and not parameter(f"{PARAMETERS}/allow_code", False):
        foreign_code.check_scenario(settings.scenario, "allow_code:=true")
    if not settings.prefix and (settings.num_robots > 1 or settings.mission or settings.controllers != "none"):
        raise ParameterError(f"{PARAMETERS}/prefix: false; expected true unless world.launch runs a single robot")
    if settings.lockstep and not settings.mission:
        raise ParameterError(f"{PARAMETERS}/lockstep: true; expected false without a mission")
    if settings.lockstep and settings.elsewhere:
        raise ParameterError(f"{PARAMETERS}/lockstep: true; expected false with robots in another world")
    if settings.by_tf:
        _check_tf(settings)
    if settings.teleop not in range(NOT_SET, settings.num_robots):
        raise ParameterError(f"{PARAMETERS}/teleop: {settings.teleop}; expected 0 to {settings.num_robots - 1}")


def _check_tf(settings: Settings) -> None:
    """Raise ParameterError if the settings do not fit to poses from tf, as of real robots."""
    if settings.lockstep:
        raise ParameterError(f"{PARAMETERS}/lockstep: true; expected false with control.localisation=tf")
    if settings.controllers == "inside":
        raise ParameterError(f"{PARAMETERS}/controllers: inside; expected nodes or team with control.localisation=tf")
    scenario = settings.scenario
    walking = [f"victim {victim.name} who walks" for victim in scenario.mission.victims if victim.walks]
    timed = ["schedule", *walking] if scenario.schedule else walking
    # Their times begin at 0.
    if timed and not rospy.get_param("/use_sim_time", False):
        raise ParameterError(f"/use_sim_time: false; expected true, because the scenario has a {timed[0]}")
