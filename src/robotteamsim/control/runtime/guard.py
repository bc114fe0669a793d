"""A faulty controller stops its own robot, not the mission."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Sequence
from math import dist, hypot, isfinite
from operator import attrgetter, is_
from pathlib import Path
from typing import Any, get_args

import msgspec
import numpy as np

from robotteamsim.control.driving.driver import Course, DrivesOn
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import (
    EVERYBODY,
    OUTSIDE,
    Controller,
    Decision,
    Localisation,
    Message,
    Observation,
    SwarmContext,
    Task,
)
from robotteamsim.interface.localisation import LocalisationState
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.wording import described, place_of

_REGISTRY = "robotteamsim.control.runtime.registry"
"""Calls the classes of controllers."""

_LARGEST = 2**31 - 1
"""ROS messages and bags hold numbers of swarms and search counters in 32 bits."""

_ORIGIN = (0.0, 0.0)
_STATES = get_args(LocalisationState)
_WHOLE = (int, np.integer)
_TRUTHS = (bool, np.bool_)
_NUMBERS = (float, int, np.number)

_ADDRESS = re.compile(" at 0x[0-9a-f]+")

_of_numbers = attrgetter("excluded", "goal_m", "local_best", "local_best_m", "search_counter", "area", "swarm")
"""The fields of a decision that may have NumPy's numbers."""

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
        """The last decision, if it was returned as it is: what the next one has of it needs no other check."""
        try:
            self.controller = make()
        except (RobotTeamSimError, KeyboardInterrupt):
            raise
        except BaseException as error:
            self._stop(error)

    @property
    def course(self) -> Course | None:
        """How the robot drives on without its controller."""
        return self.controller.course if isinstance(self.controller, DrivesOn) and not self.fault else None

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision; once it has failed, that is to stand still, with the reason."""
        if self.fault or self.controller is None:
            return Decision(fault=self.fault)
        try:
            decision = self.controller.step(observation, inbox, task)
            if problem := problem_of(decision, self._robot_id, self._num_robots, self._before):
                self.fault = f"{problem}{_place_of_step(self.controller)}"
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # also SystemExit, and what asyncio raises
            self._stop(error)
        if self.fault:
            return Decision(fault=self.fault)
        self._before = plain = _plain(decision, self._before)
        return plain

    def _stop(self, error: BaseException) -> None:
        self.fault = f"{described(error)}{_place(error)}".encode(errors="backslashreplace").decode()
        _logger.debug("controller of robot %d failed", self._robot_id, exc_info=error)


def _place(error: BaseException) -> str:
    """Return where an error occurred, as " (my_controller.py:27)"; "" if a class could not be called at all."""
    module, place = place_of(error)
    return "" if module == _REGISTRY else f" ({place})"


def _place_of_step(controller: Any) -> str:
    """Return where a controller's own `step` or `decide` begins, as " (my_controller.py:27)"; "" if it has none.

    A method is its own if it is not of this package, which wraps controllers and has base classes for them.
    """
    while _is_of_package(controller) and hasattr(controller, "controller"):
        controller = controller.controller
    methods = (getattr(controller, name, None) for name in ("step", "decide"))
    own = (method for method in methods if method is not None and not _is_of_package(method))
    code = getattr(next(own, None), "__code__", None)
    return f" ({Path(code.co_filename).name}:{code.co_firstlineno})" if code else ""


def _is_of_package(part: object) -> bool:
    """Whether a method, or the class of an object, is defined in this package."""
    return str(getattr(part, "__module__", "")).startswith("robotteamsim.")


def _plain(decision: Decision, before: Decision | None) -> Decision:
    """Return a valid decision with Python's numbers instead of NumPy's, which files and C++ do not take.

    Args: before: one with Python's numbers.
    """
    if before is not None and all(map(is_, _of_numbers(decision), _of_numbers(before))):
        return decision
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


def problem_of(decision: Any, robot_id: int, num_robots: int, before: Decision | None = None) -> str:
    """Return what is wrong with what a controller decided, in a few words; "" where nothing is.

    Args: before: a valid decision: what this one has of it is not looked at again.
    """
    if not isinstance(decision, Decision):
        return f"step returned {_shown(decision)}; expected a Decision"
    for name, is_valid, found in _FIELDS:
        value = getattr(decision, name)
        if (before is None or value is not getattr(before, name)) and not is_valid(value):
            return f"step returned {found(value)}"
    # Values of these two may have changed.
    if decision.belief is not None and not _is_field(decision.belief):
        return f"step returned the belief {_shown(decision.belief)}; expected a finite FieldMap, or None"
    if decision.found is not None and not _is_grid(decision.found):
        return f"step returned found = {_shown(decision.found)}; expected an OccupancyGrid of int8, or None"
    if decision.particles is not None and not _are_poses(decision.particles):
        return f"step returned particles = {_shown(decision.particles)}; expected a tuple of finite Poses, or None"
    if not isinstance(decision.outbox, (tuple, list)):
        return f"step returned the outbox {_shown(decision.outbox)}; expected a tuple of Messages"
    for message in decision.outbox:
        if problem := _problem_of_message(message, robot_id, num_robots):
            return problem
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


def _is_grid(value: Any) -> bool:
    try:
        cells, numbers = value.cells, (*value.origin_m, value.resolution_m)
        is_finite = isinstance(value, OccupancyGrid) and isfinite(hypot(*numbers)) and value.resolution_m > 0.0
        return bool(is_finite and cells.dtype == np.int8 and cells.ndim == 2 and cells.size > 0)
    except (TypeError, ValueError, AttributeError):
        return False


def _is_localisation(value: Any) -> bool:
    try:
        estimates = [(one.pose.x_m, one.pose.y_m, one.pose.yaw_rad, *one.covariance) for one in value.estimates]
        are_finite = all(len(numbers) == 9 and isfinite(hypot(*numbers)) for numbers in estimates)
        return isinstance(value, Localisation) and value.state in _STATES and bool(estimates) and are_finite
    except (TypeError, ValueError, AttributeError):
        return False


def _are_poses(value: Any) -> bool:
    try:
        numbers = [hypot(one.x_m, one.y_m, one.yaw_rad) for one in value if isinstance(one, Pose)]
        return isinstance(value, tuple) and len(numbers) == len(value) and all(map(isfinite, numbers))
    except TypeError:
        return False


def _is_point(value: Any) -> bool:
    try:
        return isinstance(value, (tuple, list, np.ndarray)) and isfinite(dist(value, _ORIGIN))
    except (TypeError, ValueError):
        return False


def _is_index(value: Any, least: int) -> bool:
    return bool(isinstance(value, _WHOLE) and least <= value <= _LARGEST)


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
    text = _ADDRESS.sub("", repr(value))
    return text if len(text) <= 60 else f"{text[:57]}..."


def _has_utf8(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and (not value or _has_utf8(value))


def _or_none(is_valid: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: value is None or is_valid(value)


def _wrong_thing(name: str, expected: str) -> Callable[[object], str]:
    return lambda value: f"the {name} {_shown(value)}; expected {expected}"


def _wrong_value(name: str, expected: str) -> Callable[[object], str]:
    return lambda value: f"{name} = {value!r:.60}; expected {expected}"


def _wrong_text(name: str) -> Callable[[object], str]:
    def found(value: object) -> str:
        wrong = ", which cannot be encoded as UTF-8" if isinstance(value, str) else "; expected text"
        return f"{name} = {value!r:.60}{wrong}"

    return found


_FIELDS: tuple[tuple[str, Callable[[Any], bool], Callable[[Any], str]], ...] = (
    ("twist", _is_twist, lambda twist: f"{twist!r:.120}; expected a Twist of finite numbers"),
    ("goal_m", _or_none(_is_point), _wrong_thing("goal", "finite (x, y), or None")),
    (
        "local_best_m",
        _or_none(_is_point),
        _wrong_thing("local best", "finite (x, y), or None"),
    ),
    (
        "context",
        _or_none(_is_context),
        _wrong_thing("context", "a finite SwarmContext, or None"),
    ),
    (
        "localisation",
        _or_none(_is_localisation),
        _wrong_thing("localisation", "a Localisation with finite estimates, or None"),
    ),
    ("excluded", lambda value: isinstance(value, _TRUTHS), _wrong_value("excluded", "True or False")),
    (
        "swarm",
        lambda value: _is_index(value, OUTSIDE),
        _wrong_value("swarm", f"a number from 0 on, or {OUTSIDE} for none"),
    ),
    ("search_counter", lambda value: _is_index(value, 0), _wrong_value("search_counter", "a number from 0 on")),
    ("area", lambda value: _is_index(value, -1), _wrong_value("area", "the index of an area, or -1 for none")),
    ("local_best", _is_number, _wrong_value("local_best", "a number")),
    ("fault", _is_text, _wrong_text("fault")),
    ("done", _is_text, _wrong_text("done")),
)
"""Fields of decisions that need no others: whether a value is valid, and what is said of one that is not."""
