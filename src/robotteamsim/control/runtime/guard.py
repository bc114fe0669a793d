"""One robot's faulty controller stops that robot, not the mission."""

from __future__ import annotations

import logging
import math
import re
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Twist
from robotteamsim.interface import OUTSIDE, Controller, Decision, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message

_LARGEST = 2**31 - 1
"""Numbers of swarms, and what they count, are of 32 bits in messages."""

# Of bool | np.bool_, written where it is asked, Python would make a new object each time.
_TRUTHS = (bool, np.bool_)
_NUMBERS = (float, int, np.number)

_ADDRESS = re.compile(" at 0x[0-9a-f]+")

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
        except (Exception, SystemExit) as error:
            self._note(error)

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Let the controller take in what the robot perceives."""
        if self._fault or self.controller is None:
            return
        try:
            self.controller.observe(observation, inbox, task)
        except (Exception, SystemExit) as error:
            self._note(error)

    def decide(self) -> Decision:
        """Return the controller's decision; standing still, with the reason, once it has failed."""
        if not self._fault and self.controller is not None:
            try:
                decision = self.controller.decide()
                self._fault = problem_of(decision, self._robot_id, self._num_robots)
                if not self._fault:
                    return decision
            except (Exception, SystemExit) as error:
                self._note(error)
        return Decision(fault=self._fault)

    def _note(self, error: BaseException) -> None:
        *_, last = traceback.extract_tb(error.__traceback__)
        text = ": ".join(filter(None, (type(error).__name__, " ".join(str(error).split()))))
        self._fault = f"{text} ({Path(last.filename).name}:{last.lineno})"
        _logger.debug("controller of robot %d failed", self._robot_id, exc_info=error)


def problem_of(decision: Decision, robot_id: int, num_robots: int) -> str:
    """Return what is wrong with a decision, in a few words; "": nothing."""
    if not isinstance(decision, Decision):
        return f"decide returned {_shown(decision)}; wanted a Decision"
    twist, goal_m = decision.twist, decision.goal_m
    if not isinstance(twist, Twist) or not _are_finite(twist):
        return f"decide returned {twist!r:.120}; wanted a Twist of finite numbers"
    if goal_m is not None and not (isinstance(goal_m, tuple) and len(goal_m) == 2 and _are_finite(goal_m)):
        return f"decide returned the goal {_shown(goal_m)}; wanted finite (x, y), or None"
    if not isinstance(decision.outbox, (tuple, list)):
        return f"decide returned the outbox {_shown(decision.outbox)}; wanted a tuple of Messages"
    for message in decision.outbox:
        wrong = _problem_of_message(message, robot_id, num_robots)
        if wrong:
            return wrong
    return _problem_of_what_is_told(decision)


def _problem_of_message(message: object, robot_id: int, num_robots: int) -> str:
    if not isinstance(message, Message) or not isinstance(message.payload, str):
        return f"decide returned {_shown(message)} to send; wanted a Message with text"
    if not message.payload.isascii() and not _has_utf8(message.payload):
        return f"decide returned the text {message.payload!r:.60} to send, which UTF-8 does not have"
    if not _is_whole(message.sender) or message.sender != robot_id:
        return f"decide returned a message from sender {message.sender!r}; wanted {robot_id}, the robot itself"
    if not _is_whole(message.receiver) or not EVERYBODY <= message.receiver < num_robots:
        return (
            f"decide returned a message to receiver {message.receiver!r}; wanted 0 to {num_robots - 1}, or "
            f"{EVERYBODY} for everybody"
        )
    return ""


def _problem_of_what_is_told(decision: Decision) -> str:
    """Return what is wrong with what others are told of a decision: messages of ROS and bags hold it as it is."""
    if not isinstance(decision.excluded, _TRUTHS):
        return f"decide returned excluded = {decision.excluded!r:.60}; wanted True or False"
    if not _is_whole(decision.swarm) or not OUTSIDE <= decision.swarm <= _LARGEST:
        return f"decide returned swarm = {decision.swarm!r:.60}; wanted a number from 0 on, or {OUTSIDE} for none"
    if not _is_whole(decision.search_counter) or not 0 <= decision.search_counter <= _LARGEST:
        return f"decide returned search_counter = {decision.search_counter!r:.60}; wanted a number from 0 on"
    if not isinstance(decision.local_best, _NUMBERS):
        return f"decide returned local_best = {decision.local_best!r:.60}; wanted a number"
    if not isinstance(decision.fault, str):
        return f"decide returned fault = {decision.fault!r:.60}; wanted text"
    return ""


def _shown(value: object) -> str:
    """Return the beginning of a value's text, without the place in memory that differs between equal runs."""
    return _ADDRESS.sub("", repr(value))[:60]


def _is_whole(value: object) -> bool:
    return type(value) is int or isinstance(value, np.integer)


def _has_utf8(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _are_finite(values: tuple[float, ...]) -> bool:
    try:
        return all(map(math.isfinite, values))
    except TypeError:
        return False
