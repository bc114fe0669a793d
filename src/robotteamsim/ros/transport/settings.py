"""Common settings of all nodes of a launch, from the parameter server."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from robotteamsim.control import foreign_code
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.ros.transport.node import ParameterError, node_name, parameter, wait_for_shutdown
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.sections import Run, Team
from robotteamsim.world.random_victims import with_random_victims

PARAMETERS = "/robotteamsim"
"""Namespace of the parameters that all nodes read."""

SEED = f"{PARAMETERS}/seed"
"""The parameter of the seed for all nodes; a string, because XML-RPC has only 32-bit integers."""

USE_SIM_TIME = "/use_sim_time"

REPORT_DELAYS_S = {"/world": 0.0, "/gazebo": 2.0, "/environment": 5.0}
OTHERS_REPORT_S = 10.0
"""Delay before a node reports a mistake in the settings [s, wall]."""
NOT_SET = -1
"""Default for the numbers of robots and people, and for the id of the one driven by hand: not given."""

PER_ROBOT, NO_CONTROLLERS = "per_robot", "false"
HOSTED = (PER_ROBOT, "team", NO_CONTROLLERS)
"""Where controllers run: a process for each robot, one for all, or none at all."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Common settings of all nodes; docs/ros_api.md describes the parameters."""

    scenario: Scenario
    lockstep: bool
    controllers: bool
    teleop: int
    silence_limit_s: float
    mission: bool = True
    """Whether there are an environment and a mission to wait for."""
    team_state: bool = False
    """Whether the world publishes /world/team_state, so that environment and mission need no topic of each robot."""
    prefix: bool = True
    """Whether topics and frames begin with robot_<id>/; without it, there is a single robot, as in stage_ros."""

    @property
    def controlled(self) -> range:
        """Ids of the robots that have a controller."""
        return range(self.num_robots if self.controllers else 0)

    def with_seed(self, seed: int | str) -> Settings:
        """Return the same settings with another seed. Raises: ParameterError."""
        run = checked(Run, self.scenario.run.model_dump() | {"seed": seed}, ParameterError)
        return replace(self, scenario=self.scenario.model_copy(update={"run": run}))

    @property
    def placed(self) -> Scenario:
        """The scenario with the victims of `mission.random_victims` at their places."""
        return with_random_victims(self.scenario)

    def drives(self, robot_id: int) -> bool:
        """Whether the robot is driven by its own controller and not by hand."""
        return robot_id in self.controlled and robot_id != self.teleop

    @property
    def step_ns(self) -> int:
        """Length of a step [ns]."""
        return self.scenario.run.step_ns

    @property
    def num_robots(self) -> int:
        """Number of robots, firefighters and command centres, each with topics of its own."""
        return self.scenario.team_size


def read_settings() -> Settings:
    """Return the settings from the parameter server.

    Raises: ParameterError, ScenarioError. All nodes of a launch find the same mistake: the world reports it at once,
    which ends the launch. Where our own world does not run, Gazebo reports it, or the environment, and then the others.
    """
    try:
        return _read_settings()
    except RobotTeamSimError:
        if delay_s := REPORT_DELAYS_S.get(node_name(), OTHERS_REPORT_S):
            wait_for_shutdown(delay_s)
        raise


def read_seed(settings: Settings) -> Settings:
    """Return the settings with the seed of the last reset, for a node that starts again. Raises: ParameterError."""
    text = parameter(SEED, "")
    try:
        return settings.with_seed(int(text) if re.fullmatch("-?[0-9]{1,20}", text) else text) if text else settings
    except ParameterError as error:
        raise ParameterError(f"{PARAMETERS}/{error}") from None


def _read_settings() -> Settings:
    name = parameter(f"{PARAMETERS}/scenario", "")
    if not name:
        raise ParameterError(f"{PARAMETERS}/scenario: is not set; expected the name or file of a scenario")
    overrides = parameter(f"{PARAMETERS}/set", "").split()
    scenario = load(name, overrides)
    num_robots = parameter(f"{PARAMETERS}/robots", NOT_SET)
    if num_robots != NOT_SET and isinstance(scenario.robots, Team) and scenario.robots.count != num_robots:
        scenario = load(name, [*overrides, f"robots.count={num_robots}"])
    hosted = parameter(f"{PARAMETERS}/controllers", PER_ROBOT)
    if hosted.lower() not in HOSTED:
        raise ParameterError(f"{PARAMETERS}/controllers: {hosted}; expected {', '.join(HOSTED)}")
    settings = Settings(
        scenario,
        lockstep=parameter(f"{PARAMETERS}/lockstep", False),
        controllers=hosted.lower() != NO_CONTROLLERS,
        teleop=parameter(f"{PARAMETERS}/teleop", NOT_SET),
        silence_limit_s=float(parameter(f"{PARAMETERS}/silence_limit_s", 5.0)),
        mission=parameter(f"{PARAMETERS}/mission", True),
        team_state=parameter(f"{PARAMETERS}/team_state", False) and scenario.control.localisation != "tf",
        prefix=parameter(f"{PARAMETERS}/prefix", True),
    )
    if settings.controllers and not parameter(f"{PARAMETERS}/allow_code", False):
        foreign_code.check_scenario(scenario, "allow_code:=true")
    if not settings.prefix and (settings.num_robots > 1 or settings.mission or settings.controllers):
        raise ParameterError(f"{PARAMETERS}/prefix: false; expected true unless world.launch runs a single robot")
    if settings.lockstep and not settings.mission:
        raise ParameterError(f"{PARAMETERS}/lockstep: true; expected false without a mission")
    if scenario.control.localisation == "tf":
        _check_tf(settings)
    if num_robots not in (NOT_SET, scenario.num_robots):
        raise ParameterError(
            f"{PARAMETERS}/robots: {num_robots}; expected {scenario.num_robots}, the length of the robots' list in"
            f" {name}"
        )
    if hosted.lower() == PER_ROBOT:
        _check_people(scenario, name)
    if settings.teleop not in range(NOT_SET, settings.num_robots):
        raise ParameterError(f"{PARAMETERS}/teleop: {settings.teleop}; expected 0 to {settings.num_robots - 1}")
    return read_seed(settings)


def _check_people(scenario: Scenario, name: str) -> None:
    """Raise ParameterError if a launch starts controllers for another number of firefighters and command centres."""
    people, expected = parameter(f"{PARAMETERS}/people", NOT_SET), scenario.team_size - scenario.num_robots
    if people not in (NOT_SET, expected):
        raise ParameterError(
            f"{PARAMETERS}/people: {people}; expected {expected}, the firefighters and the centre of {name}"
        )


def _check_tf(settings: Settings) -> None:
    """Raise ParameterError if the settings do not fit to poses from tf, as of real robots."""
    if settings.lockstep:
        raise ParameterError(f"{PARAMETERS}/lockstep: true; expected false with control.localisation=tf")
    scenario = settings.scenario
    walking = [f"victim {victim.name} who walks" for victim in scenario.mission.victims if victim.walks]
    timed = ["schedule", *walking] if scenario.schedule else walking
    # Their times begin at 0.
    if timed and not parameter(USE_SIM_TIME, False):
        raise ParameterError(f"{USE_SIM_TIME}: false; expected true, because the scenario has a {timed[0]}")
