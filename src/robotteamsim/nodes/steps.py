"""Messages of several topics, collected by the step that they belong to."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

REPORT_TIMEOUT_S = 10.0
"""A longer wait is reported once [s, wall]."""
CHECK_PERIOD_S = 1.0
"""Interval of checks for missing messages during a wait [s, wall]."""
MAX_STEPS = 1000
"""So many incomplete steps are kept; otherwise a node whose inputs lack one topic would fill the memory."""

Missing = Callable[[int, Mapping[str, Any]], list[str]]
"""Returns the topics that a step with a stamp [ns] still needs, apart from those whose values it has."""


@dataclass(frozen=True, slots=True)
class Step:
    """The newest complete step.

    restarted: time has jumped back since the last step.
    values:    by topic; of a topic without a message in this step, that of a step left out before it.
    each:      the values of each step, in the order of time: of those left out, because this one was complete, too, and
               its own.
    """

    stamp_ns: int
    restarted: bool
    values: Mapping[str, Any]
    each: tuple[Mapping[str, Any], ...]


class Steps:
    """Collects values from several threads until a step is complete."""

    def __init__(self, pace: str, missing: Missing, warn: Callable[[str], object]) -> None:
        """Args: pace: the topic with a message in each step, whose stamps show that time has jumped back."""
        self._pace = pace
        self._missing = missing
        self._warn = warn
        self._changed = threading.Condition()
        self._closed = False
        self._steps: dict[int, dict[str, Any]] = {}
        self._last_ns: dict[str, int] = {}
        self._complete_ns: int | None = None
        self._restarted = False

    def add(self, topic: str, stamp_ns: int, value: Any) -> None:
        """Add the value of a message; stamp 0 belongs to no step."""
        with self._changed:
            if stamp_ns < self._last_ns.get(topic, 0):
                self._jump_back(topic, stamp_ns)
            self._last_ns[topic] = stamp_ns
            if stamp_ns == 0:
                return
            values = self._steps.setdefault(stamp_ns, {})
            values[topic] = value
            if not self._missing(stamp_ns, values):
                self._complete_ns = stamp_ns
                self._changed.notify()
            elif len(self._steps) > MAX_STEPS:
                del self._steps[min(self._steps)]

    def take(self) -> Step | None:
        """Wait for a complete step and return it; None if closed. A wait of more than 10 s is reported once."""
        begin_s, reported = time.monotonic(), False
        with self._changed:
            while not self._is_complete() and not self._closed:
                self._changed.wait(CHECK_PERIOD_S)
                if not reported and time.monotonic() - begin_s > REPORT_TIMEOUT_S:
                    reported = True
                    newest_ns = max(self._steps, default=0)
                    names = self._missing(newest_ns, self._steps.get(newest_ns, {}))
                    self._warn(f"waiting for {', '.join(names)}")
            return None if self._closed or self._complete_ns is None else self._pop(self._complete_ns)

    def _is_complete(self) -> bool:
        """Whether the newest complete step is still that: messages since then may have taken values of it away."""
        ns = self._complete_ns
        return ns is not None and not self._missing(ns, self._steps.get(ns, {}))

    def close(self) -> None:
        """End all waits; also from a signal handler, because the lock is reentrant."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def _pop(self, stamp_ns: int) -> Step:
        stamps = sorted(ns for ns in self._steps if ns <= stamp_ns)
        each = tuple(self._steps.pop(ns) for ns in stamps)
        values = {topic: value for step in each for topic, value in step.items()}
        step = Step(stamp_ns, self._restarted, values, each)
        self._complete_ns, self._restarted = None, False
        return step

    def _jump_back(self, topic: str, stamp_ns: int) -> None:
        """Forget what the topic had for later steps, which were those before a reset."""
        for ns in [ns for ns in self._steps if ns > stamp_ns]:
            self._steps[ns].pop(topic, None)
        if topic == self._pace:
            self._restarted = True
            self._complete_ns = None
