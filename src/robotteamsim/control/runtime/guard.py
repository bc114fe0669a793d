"""A faulty controller stops its own robot, not the mission."""

from __future__ import annotations

import logging
import re
import traceback
from collections.abc import Callable, Sequence
from math import dist, hypot, isfinite
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from robotteamsim.control.driving.driver import Course
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Twist
from robotteamsim.interface import EVERYBODY, OUTSIDE, Controller, Decision, Message, Observation, SwarmContext, Task
from robotteamsim.propagation import FieldMap
from robotteamsim.wording import described

_PACKAGE = "robotteamsim."
_REGISTRY = "robotteamsim.control.runtime.registry"
"""Calls the classes of controllers."""

_LARGEST = 2**31 - 1
"""ROS messages and bags hold numbers of swarms and search counters in 32 bits."""

_ORIGIN = (0.0, 0.0)
_WHOLE = (int, np.integer)
_TRUTHS = (bool, np.bool_)
_NUMBERS = (float, int, np.number)

_ADDRESS = re.compile(" at 0x[0-9a-f]+")

_logger = logging.getLogger(__name__)


class Guard:
    """Runs a controller until it raises or returns an invalid decision; from then on the robot stands still.

    All later decisions carry the reason in `Decision.fault`. A mistake of the user (`errors.py`) is not caught: it
    concerns all robots.
    """

    def __init__(self, robot_id: int, num_robots: int, make: Callable[[], Controller]) -> None:
        """Make the controller by `make`. Raises: RobotTeamSimError, as `make` does."""
        self._robot_id = robot_id
        self._num_robots = num_robots
        self.fault = ""
        """Why the controller was stopped, in one line; "" while it works."""
        self.controller: Controller | None = None
        """None where it could not be made."""
        self._before: Decision | None = None
        """The last decision, if it was returned as it is: one that differs only in its twist needs no other check."""
        try:
            self.controller = make()
        except (RobotTeamSimError, KeyboardInterrupt):
            raise
        except BaseException as error:
            self._stop(error)

    @property
    def course(self) -> Course | None:
        """How the robot drives on without its controller."""
        return None if self.fault else getattr(self.controller, "course", None)

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision; once it has failed, that is to stand still, with the reason."""
        if self.fault or self.controller is None:
            return Decision(fault=self.fault)
        try:
            decision = self.controller.step(observation, inbox, task)
            if self._before is not None and _differ_in_twist(decision, self._before) and _is_twist(decision.twist):
                return decision
            if problem := problem_of(decision, self._robot_id, self._num_robots):
                self.fault = f"{problem}{_place_of_step(self.controller)}"
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # also SystemExit, and what asyncio raises
            self._stop(error)
        if self.fault:
            return Decision(fault=self.fault)
        plain = _plain(decision)
        self._before = decision if plain is decision else None
        return plain

    def _stop(self, error: BaseException) -> None:
        self.fault = f"{described(error)}{_place(error)}".encode(errors="backslashreplace").decode()
        _logger.debug("controller of robot %d failed", self._robot_id, exc_info=error)


def _place(error: BaseException) -> str:
    """Return where an error occurred, as " (my_controller.py:27)"; "" if a class could not be called at all.

    That is the last line in the first file outside this package, which is the user's if the controller is; an error in
    a library is thus that of the user's line that called it. Without such a file, it is the last line of all.
    """
    frames = [
        (frame.f_globals.get("__name__", ""), frame.f_code.co_filename, line)
        for frame, line in traceback.walk_tb(error.__traceback__)
    ]
    users = next((file for module, file, _ in frames if not module.startswith(_PACKAGE)), None)
    module, file, line = [frame for frame in frames if users in (None, frame[1])][-1]
    return "" if module == _REGISTRY else f" ({Path(file).name}:{line})"


def _place_of_step(controller: Controller) -> str:
    """Return where the method `step` begins, as " (my_controller.py:27)"; "" if it is not Python's."""
    code = getattr(controller.step, "__code__", None)
    return f" ({Path(code.co_filename).name}:{code.co_firstlineno})" if code else ""


def _differ_in_twist(decision: object, before: Decision) -> bool:
    """Whether two decisions share all that can be wrong with them but the twist, and nothing is sent."""
    return (
        type(decision) is Decision
        and decision.outbox == ()
        and decision.belief is None  # whose values may have changed
        and decision.goal_m is before.goal_m
        and decision.local_best_m is before.local_best_m
        and decision.local_best is before.local_best
        and decision.context is before.context
        and decision.excluded is before.excluded
        and decision.swarm is before.swarm
        and decision.search_counter is before.search_counter
        and decision.area is before.area
        and decision.fault is before.fault
        and decision.done is before.done
    )


def _plain(decision: Decision) -> Decision:
    """Return a valid decision with Python's numbers instead of NumPy's, which files and C++ do not take."""
    goal_m, best_m = decision.goal_m, decision.local_best_m
    kinds = type(decision.excluded), type(decision.local_best), type(decision.search_counter), type(decision.swarm)
    are_pythons = kinds == (bool, float, int, int) and type(decision.area) is int
    if are_pythons and _is_plain_point(goal_m) and _is_plain_point(best_m):
        return decision
    return msgspec.structs.replace(
        decision,
        excluded=bool(decision.excluded),
        goal_m=None if goal_m is None else tuple(map(float, goal_m)),
        local_best=float(decision.local_best),
        local_best_m=None if best_m is None else tuple(map(float, best_m)),
        search_counter=int(decision.search_counter),
        area=int(decision.area),
        swarm=int(decision.swarm),
    )


def _is_plain_point(point_m: Any) -> bool:
    return point_m is None or (type(point_m) is tuple and all(type(number) is float for number in point_m))


def problem_of(decision: Any, robot_id: int, num_robots: int) -> str:
    """Return what is wrong with what a controller decided, in a few words; "" where nothing is."""
    if not isinstance(decision, Decision):
        return f"step returned {_shown(decision)}; expected a Decision"
    twist = decision.twist
    if not _is_twist(twist):
        return f"step returned {twist!r:.120}; expected a Twist of finite numbers"
    if decision.goal_m is not None and not _is_point(decision.goal_m):
        return f"step returned the goal {_shown(decision.goal_m)}; expected finite (x, y), or None"
    if decision.local_best_m is not None and not _is_point(decision.local_best_m):
        return f"step returned the local best {_shown(decision.local_best_m)}; expected finite (x, y), or None"
    if decision.context is not None and not _is_context(decision.context):
        return f"step returned the context {_shown(decision.context)}; expected a finite SwarmContext, or None"
    if decision.belief is not None and not _is_field(decision.belief):
        return f"step returned the belief {_shown(decision.belief)}; expected a finite FieldMap, or None"
    if not isinstance(decision.outbox, (tuple, list)):
        return f"step returned the outbox {_shown(decision.outbox)}; expected a tuple of Messages"
    for message in decision.outbox:
        problem = _problem_of_message(message, robot_id, num_robots)
        if problem:
            return problem
    return _problem_of_status(decision)


def _problem_of_status(decision: Decision) -> str:
    """Return what is wrong with the status in a decision, which ROS messages and bags hold as it is."""
    if not isinstance(decision.excluded, _TRUTHS):
        return f"step returned excluded = {decision.excluded!r:.60}; expected True or False"
    if not isinstance(decision.swarm, _WHOLE) or not OUTSIDE <= decision.swarm <= _LARGEST:
        return f"step returned swarm = {decision.swarm!r:.60}; expected a number from 0 on, or {OUTSIDE} for none"
    if not isinstance(decision.search_counter, _WHOLE) or not 0 <= decision.search_counter <= _LARGEST:
        return f"step returned search_counter = {decision.search_counter!r:.60}; expected a number from 0 on"
    if not isinstance(decision.area, _WHOLE) or not -1 <= decision.area <= _LARGEST:
        return f"step returned area = {decision.area!r:.60}; expected the index of an area, or -1 for none"
    if not _is_number(decision.local_best):
        return f"step returned local_best = {decision.local_best!r:.60}; expected a number"
    for name, text in (("fault", decision.fault), ("done", decision.done)):
        if not isinstance(text, str):
            return f"step returned {name} = {text!r:.60}; expected text"
        if text and not _has_utf8(text):
            return f"step returned {name} = {text!r:.60}, which cannot be encoded as UTF-8"
    return ""


def _is_number(value: Any) -> bool:
    try:
        return isinstance(value, _NUMBERS) and isinstance(float(value), float)
    except (OverflowError, TypeError):
        return False


def _is_twist(value: Any) -> bool:
    try:
        return isinstance(value, Twist) and isfinite(
            hypot(value.linear_x_mps, value.linear_y_mps, value.angular_z_radps)
        )
    except TypeError:
        return False


def _is_context(value: Any) -> bool:
    try:
        return isinstance(value, SwarmContext) and isfinite(sum(msgspec.structs.astuple(value)))
    except TypeError:
        return False


def _is_field(value: Any) -> bool:
    try:
        numbers = (*value.origin_m, value.resolution_m, float(np.sum(value.values)))
        return isinstance(value, FieldMap) and value.values.ndim == 2 and isfinite(hypot(*numbers))
    except (TypeError, ValueError, AttributeError):
        return False


def _is_point(value: Any) -> bool:
    try:
        return isinstance(value, (tuple, list, np.ndarray)) and isfinite(dist(value, _ORIGIN))
    except (TypeError, ValueError):
        return False


def _problem_of_message(message: object, robot_id: int, num_robots: int) -> str:
    if not isinstance(message, Message) or not isinstance(message.payload, str):
        return f"step returned {_shown(message)} to send; expected a Message with text"
    if not message.payload.isascii() and not _has_utf8(message.payload):
        return f"step returned the text {message.payload!r:.60} to send, which cannot be encoded as UTF-8"
    if not isinstance(message.sender, _WHOLE) or message.sender != robot_id:
        return f"step returned a message from sender {message.sender!r}; expected {robot_id}, the robot itself"
    if not isinstance(message.receiver, _WHOLE) or not EVERYBODY <= message.receiver < num_robots:
        return (
            f"step returned a message to receiver {message.receiver!r}; expected 0 to {num_robots - 1}, or "
            f"{EVERYBODY} for everybody"
        )
    return ""


def _shown(value: object) -> str:
    """Return the beginning of a value's text, without memory addresses, which differ between equal runs."""
    return _ADDRESS.sub("", repr(value))[:60]


def _has_utf8(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
