"""Combines the stamped messages of several channels to steps. Independent of ROS and threads."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

REPORT_TIMEOUT_S = 10.0
"""A longer wait is reported once [s, wall]."""
MAX_WAITING = 1000
"""Without lockstep, so many messages of a channel wait for other channels; older ones are dropped. Otherwise a node
whose inputs lack one topic would fill the memory."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One stream of stamped messages into a node.

    needed:         without lockstep, a step waits for a new message of this channel.
    of_last_step:   in lockstep, the step at t uses the message of the step before t.
    may_be_silent:  in lockstep, steps do not wait for this channel while it has been silent for too long.
    due:            in lockstep, a function of a step's stamp: whether there is a message then; None for every step. A
                    channel with it has no message in the first step.
    robot_id:       the channel's robot; the channel is silent while that robot is absent. None if it has no robot.
    has_presence:   `present` of its messages states which robots are present in the step of their stamp.
    """

    name: str
    needed: bool = False
    of_last_step: bool = False
    may_be_silent: bool = False
    due: Callable[[int], bool] | None = None
    robot_id: int | None = None
    has_presence: bool = False


@dataclass(frozen=True, slots=True)
class Step:
    """The inputs of a node for one step.

    stamp_ns:  of the step.
    restarted: time has jumped backwards since the last step, so the node must restart.
    messages:  per channel the messages since the last step, oldest first.
    """

    stamp_ns: int
    restarted: bool
    messages: Mapping[str, Sequence[Any]]

    def latest(self, channel: str) -> Any:
        """Return the newest message of a channel; None: nothing came, or the node has no such channel."""
        messages = self.messages.get(channel)
        return messages[-1] if messages else None

    def after(self, skipped: Step | None) -> Step:
        """Return this step with the messages of a skipped one before its own; None: no step was skipped."""
        if skipped is None or self.restarted:
            return self
        old, new = skipped.messages, self.messages
        both = {name: (*old.get(name, ()), *new.get(name, ()))[-MAX_WAITING:] for name in {**old, **new}}
        return replace(self, messages=both)


@dataclass(slots=True)
class _Queue:
    """Messages of one channel; `life` counts the backward jumps of its stamps."""

    channel: Channel
    life: int = 0
    last_ns: int = -1
    late_ns: int | None = None
    """Stamp of a message that was dropped because it was older than the last one; None: there was none since."""
    silent: bool = False
    skipped: bool = False
    waiting: list[tuple[int, Any]] = field(default_factory=list)

    def has(self, stamp_ns: int) -> bool:
        """Whether the message with a stamp has arrived; discards older ones."""
        while self.waiting and self.waiting[0][0] < stamp_ns:
            del self.waiting[0]
        return bool(self.waiting) and self.waiting[0][0] == stamp_ns

    def skip(self, stamp_ns: int, life: int) -> None:
        """Count a step without this robot as if its message had arrived, so that later stamps show jumps of time."""
        self.last_ns = max(self.last_ns, stamp_ns) if self.life == life else stamp_ns
        self.life, self.skipped = life, True


class StepSynchronizer(ABC):
    """Collects messages and returns them step by step."""

    def __init__(self, channels: Iterable[Channel]) -> None:
        """Start without messages."""
        self._queues = {channel.name: _Queue(channel) for channel in channels}
        self._order = tuple(self._queues.values())
        self._num_ready = 0
        """The first queues, which were ready when they were last checked."""
        self._life = 0
        self._restarted = False
        self._present: dict[int, Sequence[int]] = {}
        """The robots present, by stamp of the step; all are if the stamp is missing."""
        self._wait_reported = False

    def add(self, channel: str, stamp_ns: int, message: Any) -> None:
        """Add a message."""
        queue = self._queues[channel]
        self._accept(queue, stamp_ns, message)
        if queue.channel.has_presence:
            self.note_presence(stamp_ns, message.present)

    def note_presence(self, stamp_ns: int, present: Sequence[int]) -> None:
        """Set which robots are present in a step; for the node that decides this."""
        if self._present and stamp_ns < next(reversed(self._present)):
            self._present.clear()
        self._present[stamp_ns] = present

    def take_step(self) -> Step | None:
        """Return the next step, or None as long as messages are missing."""
        if not self._has_step():
            return None
        step, self._restarted = self._hand_out(), False
        self._wait_reported = False
        return step

    def check_wait(self, waited_s: float) -> list[str]:
        """Return lines to report about a wait of this length [s, wall]; to be called about once a second."""
        missing = [queue.channel.name for queue in self._missing()]
        if not missing or self._wait_reported or waited_s < REPORT_TIMEOUT_S:
            return []
        self._wait_reported = True
        return [f"waiting for {', '.join(missing)}"]

    def _missing(self) -> list[_Queue]:
        return [queue for queue in self._queues.values() if not self._ready(queue)]

    def _has_step(self) -> bool:
        # Messages of thousands of channels arrive one by one, so a check must not begin with the first channel again.
        while self._num_ready < len(self._order):
            if not self._ready(self._order[self._num_ready]):
                return False
            self._num_ready += 1
        self._num_ready = 0
        # Time may have jumped back since the first ones were checked.
        return all(map(self._ready, self._order))

    @staticmethod
    def _is_absent(queue: _Queue, present: Sequence[int] | None) -> bool:
        robot_id = queue.channel.robot_id
        return robot_id is not None and present is not None and not present[robot_id]

    @abstractmethod
    def _accept(self, queue: _Queue, stamp_ns: int, message: Any) -> None: ...

    @abstractmethod
    def _ready(self, queue: _Queue) -> bool: ...

    @abstractmethod
    def _hand_out(self) -> Step: ...


class LatestSynchronizer(StepSynchronizer):
    """A step is complete when every needed channel has a new message; it contains all messages since the last step.

    When the stamps of a needed channel jump back, time has been reset: messages with later stamps are from before the
    reset and are dropped. A slow channel may still deliver such messages; the step that contains them is followed by
    another restart when that channel jumps back, too.

    A single message that is slightly older than the last one is late and not a sign of a reset: it is dropped. A reset
    is recognised by the next message, which is newer than that one and still older than the last one before.
    """

    def __init__(self, channels: Iterable[Channel], *, stale_ns: int = 0, period_ns: int = 0) -> None:
        """Start without messages.

        Args:
            stale_ns:  a single message that is older by less than this is late.
            period_ns: steps are this far apart on average, even if messages come more often; 0: as often as they come.
        """
        super().__init__(channels)
        self._stale_ns = stale_ns
        self._period_ns = period_ns
        self._due_ns = 0
        """Stamp of the next step; half a period less is enough, so that jitter of the messages skips no step."""

    def _accept(self, queue: _Queue, stamp_ns: int, message: Any) -> None:
        if queue.channel.needed and stamp_ns < queue.last_ns:
            is_second = queue.late_ns is not None and stamp_ns > queue.late_ns
            if queue.last_ns - stamp_ns < self._stale_ns and not is_second:
                queue.late_ns = stamp_ns
                return
            self._restarted = True
            queue.waiting.clear()
            for other in self._queues.values():
                other.waiting = [waiting for waiting in other.waiting if waiting[0] <= stamp_ns]
            # Otherwise a step would lack both a robot's messages and the message that it is absent.
            self._present = {noted_ns: present for noted_ns, present in self._present.items() if noted_ns <= stamp_ns}
        queue.last_ns, queue.late_ns = stamp_ns, None
        queue.waiting.append((stamp_ns, message))
        del queue.waiting[:-MAX_WAITING]

    def _ready(self, queue: _Queue) -> bool:
        return not queue.channel.needed or bool(queue.waiting) or self._is_absent(queue, self._newest_presence())

    def _has_step(self) -> bool:
        # With no robot present all channels may be ready without a new message.
        return super()._has_step() and any(queue.waiting for queue in self._pacing()) and self._is_due()

    def _is_due(self) -> bool:
        return not self._period_ns or self._restarted or self._newest_ns() >= self._due_ns - self._period_ns // 2

    def _newest_ns(self) -> int:
        return max(queue.last_ns for queue in self._pacing())

    def _pacing(self) -> list[_Queue]:
        """Return the queues that determine a step: those needed or, with no robot present, those with presence."""
        present, queues = self._newest_presence(), self._queues.values()
        needed = [queue for queue in queues if queue.channel.needed and not self._is_absent(queue, present)]
        return needed or [queue for queue in queues if queue.channel.has_presence]

    def _newest_presence(self) -> Sequence[int] | None:
        return next(reversed(self._present.values())) if self._present else None

    def _hand_out(self) -> Step:
        present = self._newest_presence()
        for queue in self._queues.values():
            if self._is_absent(queue, present):
                queue.waiting.clear()
        stamp_ns = self._newest_ns()
        is_late = self._restarted or stamp_ns >= self._due_ns + self._period_ns
        self._due_ns = (stamp_ns if is_late else self._due_ns) + self._period_ns
        self._present = {} if present is None else {stamp_ns: present}
        messages = {name: tuple(message for _, message in queue.waiting) for name, queue in self._queues.items()}
        for queue in self._queues.values():
            queue.waiting.clear()
        return Step(stamp_ns, self._restarted, messages)


class LockstepSynchronizer(StepSynchronizer):
    """A step is complete when every channel has the message with the expected stamp, and contains exactly those.

    Every node therefore has the same inputs in every run. The first step is at `step_ns`, each next one `step_ns`
    later. Silent channels, and channels of the last step in the first step, have no message. Messages with stamp 0,
    which announce that a node has started, are not part of steps.
    """

    def __init__(self, channels: Iterable[Channel], *, step_ns: int, silence_limit_s: float) -> None:
        """Start without messages.

        Args:
            step_ns: length of a step [ns].
            silence_limit_s: if a wait is longer than this [s, wall] and only for channels that may be silent, steps do
                not wait for them until they have a message again; the first message of a channel has no time limit.
        """
        super().__init__(channels)
        self._step_ns = step_ns
        self._next_ns = step_ns
        self._silence_limit_s = silence_limit_s
        self._only_silent = False
        """Whether at the last check of this wait only channels that may be silent were missing."""

    def restart(self) -> None:
        """Restart with the first stamp, in messages yet to come; for the node that resets time itself."""
        self._life += 1
        self._next_ns = self._step_ns
        self._present.clear()

    def check_wait(self, waited_s: float) -> list[str]:
        """As for every synchronizer; stops waiting for channels that have been silent for too long."""
        missing, lines = self._missing(), []
        only_silent = all(queue.channel.may_be_silent and queue.last_ns > 0 for queue in missing)
        # Only if seen twice in a row, because another channel may have caused the wait until just now.
        if only_silent and self._only_silent and waited_s >= self._silence_limit_s:
            for queue in missing:
                queue.silent = True
                lines.append(f"{queue.channel.name} has been silent for {waited_s:.0f} s; continuing without it")
        self._only_silent = only_silent
        return lines or super().check_wait(waited_s)

    def _accept(self, queue: _Queue, stamp_ns: int, message: Any) -> None:
        if stamp_ns == queue.last_ns and queue.life == self._life:
            return  # a late subscriber may receive a latched message twice
        if stamp_ns == 0 and queue.skipped:
            return  # late message of an absent robot; no step has waited for it
        if queue.life == self._life and self._step_ns < stamp_ns < queue.last_ns:
            return  # late: after a reset, stamps begin with the first step
        queue.skipped = False
        if queue.channel.due is not None:
            # It may have had no message before time jumped back, so its stamps do not show that it did. Those of the
            # others have shown it: the world does not go on to such a step before all have made the first one.
            if queue.life != self._life:
                queue.waiting.clear()
            queue.life = self._life
        elif stamp_ns <= queue.last_ns:
            queue.life += 1
            queue.waiting.clear()
            if queue.life > self._life:
                self._life, self._restarted = queue.life, True
                self._next_ns = self._step_ns
        queue.last_ns = stamp_ns
        queue.silent = False
        queue.waiting.append((stamp_ns, message))

    def _ready(self, queue: _Queue) -> bool:
        stamp_ns, due = self._wanted_ns(queue), queue.channel.due
        if (due is not None and not due(stamp_ns)) or self._is_absent(queue, self._present.get(stamp_ns)):
            return True
        return queue.silent or stamp_ns == 0 or (queue.life == self._life and queue.has(stamp_ns))

    def _hand_out(self) -> Step:
        messages = {}
        for name, queue in self._queues.items():
            stamp_ns = self._wanted_ns(queue)
            if self._is_absent(queue, self._present.get(stamp_ns)):
                queue.skip(stamp_ns, self._life)
            has_message = stamp_ns > 0 and queue.life == self._life and queue.has(stamp_ns)
            messages[name] = (queue.waiting.pop(0)[1],) if has_message else ()
        stamp_ns, self._next_ns = self._next_ns, self._next_ns + self._step_ns
        for old_ns in [noted_ns for noted_ns in self._present if noted_ns < stamp_ns]:
            del self._present[old_ns]
        self._only_silent = False
        return Step(stamp_ns, self._restarted, messages)

    def _wanted_ns(self, queue: _Queue) -> int:
        return self._next_ns - self._step_ns if queue.channel.of_last_step else self._next_ns
