"""Common settings of all nodes of a launch."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from functools import cached_property

from robotteamsim.control import foreign_code
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.launched import NOT_SET, read_scenario
from robotteamsim.nodes.node import Node, ParameterError
from robotteamsim.recording.topics import Topic, When
from robotteamsim.recording.topics.decisions import COMMAND
from robotteamsim.recording.topics.robots import TF
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.sections import Run
from robotteamsim.setup import Setup, resolve

SEED = "seed"
"""The setting of the seed; a string, because XML-RPC has only 32-bit integers."""

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

    def is_latched(self, topic: Topic) -> bool:
        """Whether later subscribers of a topic get its last message."""
        # In lockstep a late subscriber must still get the step that all nodes wait for.
        is_waited_for = self.lockstep and topic.when is When.STEP and topic.name not in (TF.name, COMMAND.name)
        return topic.latched or is_waited_for

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
        return bool(self.elsewhere) and len(self.elsewhere) == self.num_robots

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


def read_settings(node: Node, report_s: float = OTHERS_REPORT_S) -> Settings:
    """Return the settings of a launch.

    All nodes of a launch find the same mistake: the simulation reports it at once, which ends the launch.

    Args:   report_s: delay before a mistake is reported [s, wall].
    Raises: ParameterError, ScenarioError.
    """
    try:
        return _read_settings(node)
    except RobotTeamSimError:
        node.wait_for_shutdown(report_s)
        raise


def read_seed(node: Node, settings: Settings) -> Settings:
    """Return the settings with the seed of the last reset, for a node that starts again. Raises: ParameterError."""
    text = node.setting(SEED, "")
    try:
        return settings.with_seed(int(text) if re.fullmatch("-?[0-9]{1,20}", text) else text) if text else settings
    except ParameterError as error:
        raise ParameterError(node.setting_name(str(error))) from None


def _read_settings(node: Node) -> Settings:
    scenario = read_scenario(node.setting, node.setting_name)
    hosted = node.setting("controllers", "nodes").lower()
    settings = Settings(
        scenario,
        lockstep=node.setting("lockstep", False),
        controllers=OLD_NAMES.get(hosted, hosted),
        teleop=node.setting("teleop", NOT_SET),
        silence_limit_s=float(node.setting("silence_limit_s", 5.0)),
        elsewhere=_elsewhere(node, scenario.team_size),
        mission=node.setting("mission", True),
        prefix=node.setting("prefix", True),
    )
    _check(node, settings)
    return read_seed(node, settings)


def _wrong(node: Node, key: str, what: str) -> ParameterError:
    return ParameterError(f"{node.setting_name(key)}: {what}")


def _elsewhere(node: Node, num_robots: int) -> tuple[int, ...]:
    text = node.setting("elsewhere", "")
    if text == EVERYBODY:
        return tuple(range(num_robots))
    try:
        ids = tuple(sorted(set(map(int, text.split()))))
    except ValueError:
        raise _wrong(
            node, "elsewhere", f"{text!r}; expected ids of robots, separated by blanks, or {EVERYBODY}"
        ) from None
    for robot_id in ids:
        if robot_id not in range(num_robots):
            raise _wrong(node, "elsewhere", f"{robot_id}; expected 0 to {num_robots - 1}")
    return ids


def _check(node: Node, settings: Settings) -> None:
    """Raise ParameterError if the settings do not fit together."""
    if settings.controllers not in HOSTED:
        raise _wrong(node, "controllers", f"{settings.controllers}; expected {', '.join(HOSTED)}")
    allows_code = node.setting("allow_code", False)  # in any case, so that it counts as known
    if settings.controllers != "none" and not allows_code:
        foreign_code.check_scenario(settings.scenario, "allow_code:=true")
    if not settings.prefix and (settings.num_robots > 1 or settings.mission or settings.controllers != "none"):
        raise _wrong(node, "prefix", "false; expected true unless world.launch runs a single robot")
    if settings.lockstep and not settings.mission:
        raise _wrong(node, "lockstep", "true; expected false without a mission")
    if settings.lockstep and settings.elsewhere:
        raise _wrong(node, "lockstep", "true; expected false with robots in another world")
    if not 0.0 <= settings.silence_limit_s < math.inf:
        raise _wrong(node, "silence_limit_s", f"{settings.silence_limit_s:g}; expected a finite number of at least 0")
    if settings.by_tf:
        _check_tf(node, settings)
    if settings.teleop not in range(NOT_SET, settings.num_robots):
        raise _wrong(node, "teleop", f"{settings.teleop}; expected 0 to {settings.num_robots - 1}")


def _check_tf(node: Node, settings: Settings) -> None:
    """Raise ParameterError if the settings do not fit to poses from tf, as of real robots."""
    if settings.lockstep:
        raise _wrong(node, "lockstep", "true; expected false with control.localisation=tf")
    if settings.controllers == "inside":
        raise _wrong(node, "controllers", "inside; expected nodes or team with control.localisation=tf")
    scenario = settings.scenario
    walking = [f"victim {victim.name} who walks" for victim in scenario.mission.victims if victim.walks]
    timed = ["schedule", *walking] if scenario.schedule else walking
    # Their times begin at 0, as this world's do.
    if timed and settings.is_another_world and not node.parameter("/use_sim_time", False):
        raise ParameterError(f"/use_sim_time: false; expected true, because the scenario has a {timed[0]}")
