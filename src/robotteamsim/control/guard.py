"""One robot's faulty controller stops that robot, not the mission."""

from __future__ import annotations

import logging
import math
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

from robotteamsim.control.controller import Controller, Decision, Task
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Twist
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.sensing.readings import Observation

_logger = logging.getLogger(__name__)


class Guard:
    """Runs a controller until it raises, or decides what no robot can do; from then on the robot stands still.

    Why is told in each further decision, `Decision.fault`. A mistake of the user (`errors.py`) passes: it concerns all.
    """

    def __init__(self, robot_id: int, num_robots: int, make: Callable[[], Controller]) -> None:
        """Make the controller by `make`. Raises: RobotTeamSimError, as `make` does."""
        self._robot_id = robot_id
        self._num_robots = num_robots
        self._fault = ""
        self.controller: Controller | None = None
        """None where it could not be made."""
        try:
            self.controller = make()
        except RobotTeamSimError:
            raise
        except Exception as error:
            self._note(error)

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Let the controller take in what the robot perceives."""
        if self._fault or self.controller is None:
            return
        try:
            self.controller.observe(observation, inbox, task)
        except Exception as error:
            self._note(error)

    def decide(self) -> Decision:
        """Return the controller's decision; standing still, with the reason, once it has failed."""
        if not self._fault and self.controller is not None:
            try:
                decision = self.controller.decide()
                wrong = problem_of(decision, self._robot_id, self._num_robots)
                if not wrong:
                    return decision
                self._fault = wrong
            except Exception as error:
                self._note(error)
        return Decision(fault=self._fault)

    def _note(self, error: Exception) -> None:
        *_, last = traceback.extract_tb(error.__traceback__)
        text = " ".join(str(error).split())
        self._fault = f"{type(error).__name__}: {text} ({Path(last.filename).name}:{last.lineno})"
        _logger.debug("controller of robot %d failed", self._robot_id, exc_info=error)


def problem_of(decision: Decision, robot_id: int, num_robots: int) -> str:
    """Return what is wrong with a decision, in a few words; "": nothing."""
    if not isinstance(decision, Decision):
        return f"decide returned {decision!r:.60}; wanted a Decision"
    twist, goal_m = decision.twist, decision.goal_m
    if not isinstance(twist, Twist) or not _are_finite(twist):
        return f"decide returned {twist!r:.120}; wanted a Twist of finite numbers"
    if goal_m is not None and not (isinstance(goal_m, tuple) and len(goal_m) == 2 and _are_finite(goal_m)):
        return f"decide returned the goal {goal_m!r:.60}; wanted finite (x, y), or None"
    for message in decision.outbox:
        if not isinstance(message, Message) or not isinstance(message.payload, str):
            return f"decide returned {message!r:.60} to send; wanted a Message with text"
        if message.sender != robot_id:
            return f"decide returned a message from sender {message.sender!r}; wanted {robot_id}, the robot itself"
        if message.receiver != EVERYBODY and message.receiver not in range(num_robots):
            return (
                f"decide returned a message to receiver {message.receiver!r}; wanted 0 to {num_robots - 1}, or "
                f"{EVERYBODY} for everybody"
            )
    return ""


def _are_finite(values: tuple[float, ...]) -> bool:
    try:
        return all(map(math.isfinite, values))
    except TypeError:
        return False
