"""Where a node's messages wait until a step's worth of them is there. Knows threads, but no ROS."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

PATIENCE_S = 10.0
"""A node says what it is waiting for after this long [s, wall]."""

RING_S = 1.0
"""During a wait a node looks this often at who keeps it waiting [s, wall]."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One stream of stamped messages into a node.

    needed:         out of lockstep, a step waits until this channel has brought something new.
    of_last_step:   in lockstep, the step at t takes the message of the step before t.
    may_be_silent:  in lockstep, this channel is not waited for while it has been silent for too long.
    due:            in lockstep, tells by a step's stamp whether it has a message then; none: in every step. One that
                    has says nothing in the first step.
    robot_id:       whose it is: it says nothing in the steps in which that robot is not there; none: of no robot.
    tells_who:      its messages' `present` tells which robots are there in the step of their stamp.
    """

    name: str
    needed: bool = False
    of_last_step: bool = False
    may_be_silent: bool = False
    due: Callable[[int], bool] | None = None
    robot_id: int | None = None
    tells_who: bool = False


@dataclass(frozen=True, slots=True)
class Step:
    """What a node makes one step from.

    stamp_ns:  of the step.
    restarted: time has jumped backwards since the last step, so the node has to begin anew.
    messages:  per channel what came since the last step, oldest first.
    """

    stamp_ns: int
    restarted: bool
    messages: Mapping[str, Sequence[Any]]

    def latest(self, channel: str) -> Any:
        """Return the newest message of a channel, or None."""
        messages = self.messages[channel]
        return messages[-1] if messages else None


@dataclass(slots=True)
class _Queue:
    """Messages of one channel; `life` counts how often its stamps have jumped backwards."""

    channel: Channel
    life: int = 0
    last_ns: int = -1
    silent: bool = False
    skipped: bool = False
    waiting: list[tuple[int, Any]] = field(default_factory=list)

    def has(self, stamp_ns: int) -> bool:
        """Whether the message of a stamp is there; forgets older ones."""
        while self.waiting and self.waiting[0][0] < stamp_ns:
            del self.waiting[0]
        return bool(self.waiting) and self.waiting[0][0] == stamp_ns

    def skip(self, stamp_ns: int, life: int) -> None:
        """Count a step of a robot that is not there as if it had spoken: later stamps then tell whether time jumps."""
        self.last_ns = max(self.last_ns, stamp_ns) if self.life == life else stamp_ns
        self.life, self.skipped = life, True


class _Watch:
    """How long one wait has been; rings once a second."""

    def __init__(self, now_s: float) -> None:
        self.alone = False
        self.told = False
        self._started_s = now_s
        self._next_s = now_s + RING_S

    def waited_s(self) -> float:
        """Return the length of the wait [s, wall]."""
        return time.monotonic() - self._started_s

    def due_s(self) -> float:
        """Return the time to the next ring [s, wall]; at or below 0 it rings, and is set for the next one."""
        due_s = self._next_s - time.monotonic()
        if due_s <= 0.0:
            self._next_s += RING_S
        return due_s


class Inbox(ABC):
    """Collects messages from many threads and hands them to one thread, a step's worth at a time."""

    def __init__(self, channels: Sequence[Channel], report: Callable[[str], None]) -> None:
        """Make an empty inbox; `report` is told in one line what a long wait is for, from within `take`."""
        self._queues = {channel.name: _Queue(channel) for channel in channels}
        self._report = report
        self._life = 0
        self._restarted = False
        self._closed = False
        self._present: dict[int, Sequence[int]] = {}
        """Which robots are there, by the stamps of steps; of stamps that are not told all are."""
        # Its lock may be taken twice by one thread: a signal handler may close the inbox in the midst of `take`.
        self._changed = threading.Condition()

    def put(self, channel: str, stamp_ns: int, message: Any) -> None:
        """Take a message in, from any thread."""
        with self._changed:
            queue = self._queues[channel]
            self._accept(queue, stamp_ns, message)
            if queue.channel.tells_who:
                self._note_who(stamp_ns, message.present)
            if self._has_step():
                self._changed.notify_all()

    def note_who(self, stamp_ns: int, present: Sequence[int]) -> None:
        """Take note of who is there in a step; for the node that decides it."""
        with self._changed:
            self._note_who(stamp_ns, present)

    def close(self) -> None:
        """Make `take` return None from now on."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def take(self) -> Step | None:
        """Wait for the messages of the next step and return them; None when the inbox is closed."""
        with self._changed:
            watch = _Watch(time.monotonic())
            while not self._closed:
                missing = [queue for queue in self._queues.values() if not self._ready(queue)]
                if not missing and self._has_step():
                    step, self._restarted = self._hand_out(), False
                    return step
                if (alarm_s := watch.due_s()) > 0.0:
                    self._changed.wait(alarm_s)
                elif missing:
                    self._ring(missing, watch)
            return None

    def _has_step(self) -> bool:
        return all(map(self._ready, self._queues.values()))

    def _note_who(self, stamp_ns: int, present: Sequence[int]) -> None:
        if self._present and stamp_ns < next(reversed(self._present)):
            self._present.clear()
        self._present[stamp_ns] = present

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

    def _ring(self, missing: Sequence[_Queue], watch: _Watch) -> None:
        """Called once a second during a wait."""
        if not watch.told and watch.waited_s() >= PATIENCE_S:
            watch.told = True
            self._report(f"waiting for {', '.join(queue.channel.name for queue in missing)}")


class LatestInbox(Inbox):
    """A step is there when every needed channel has brought something new; it gets all that came meanwhile.

    When the stamps of a needed channel jump back, time has been reset: what waits with later stamps is of the time
    before and is dropped. A channel that lags behind may still bring something of that time; the step that it gets into
    is followed by another restart as soon as that channel, too, jumps back.
    """

    def _accept(self, queue: _Queue, stamp_ns: int, message: Any) -> None:
        if queue.channel.needed and stamp_ns < queue.last_ns:
            self._restarted = True
            queue.waiting.clear()
            for other in self._queues.values():
                other.waiting = [waiting for waiting in other.waiting if waiting[0] <= stamp_ns]
        queue.last_ns = stamp_ns
        queue.waiting.append((stamp_ns, message))

    def _ready(self, queue: _Queue) -> bool:
        return not queue.channel.needed or bool(queue.waiting) or self._is_absent(queue, self._who())

    def _has_step(self) -> bool:
        # With nobody there all may be ready, but nothing new has come.
        return super()._has_step() and any(queue.waiting for queue in self._pacing())

    def _pacing(self) -> list[_Queue]:
        """Return the queues that a step is made from: those needed; with nobody there, the one that tells so."""
        present, queues = self._who(), self._queues.values()
        needed = [queue for queue in queues if queue.channel.needed and not self._is_absent(queue, present)]
        return needed or [queue for queue in queues if queue.channel.tells_who]

    def _who(self) -> Sequence[int] | None:
        return next(reversed(self._present.values())) if self._present else None

    def _hand_out(self) -> Step:
        present = self._who()
        for queue in self._queues.values():
            if self._is_absent(queue, present):
                queue.waiting.clear()
        stamp_ns = max(queue.last_ns for queue in self._pacing())
        self._present = {} if present is None else {stamp_ns: present}
        messages = {name: tuple(message for _, message in queue.waiting) for name, queue in self._queues.items()}
        for queue in self._queues.values():
            queue.waiting.clear()
        return Step(stamp_ns, self._restarted, messages)


class LockstepInbox(Inbox):
    """A step is there when every channel has brought the message of the wanted stamp, and gets exactly that one.

    Every node thus computes on the same inputs in every run. The first step is at `step_ns`, each next one `step_ns`
    later. A silent channel, and in the first step a channel of the last step, gives nothing. Messages with stamp 0, by
    which a node may say that it is there, are never handed out.
    """

    def __init__(
        self, channels: Sequence[Channel], report: Callable[[str], None], *, step_ns: int, silence_limit_s: float
    ) -> None:
        """Make an empty inbox.

        Args:
            step_ns: length of a step [ns].
            silence_limit_s: when a wait is longer than this [s, wall] and only for channels that may be silent, they
                are given up until they speak again; channels that have not spoken yet are waited for without limit.
        """
        super().__init__(channels, report)
        self._step_ns = step_ns
        self._next_ns = step_ns
        self._silence_limit_s = silence_limit_s

    def restart(self) -> None:
        """Wait for the first stamp again, in messages yet to come. For the node that turns time back itself."""
        with self._changed:
            self._life += 1
            self._next_ns = self._step_ns
            self._present.clear()

    def _accept(self, queue: _Queue, stamp_ns: int, message: Any) -> None:
        if stamp_ns == queue.last_ns and queue.life == self._life:
            return  # a latched message can arrive twice at a late subscriber
        if stamp_ns == 0 and queue.skipped:
            return  # the node of a robot that is not there is late; nobody has waited for it
        queue.skipped = False
        if queue.channel.due is not None:
            # It may have had no turn before time jumped back, so its stamps do not tell that it did. Those of the
            # others have told: the world does not go on to such a step before all have made the first one.
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
            there = stamp_ns > 0 and queue.life == self._life and queue.has(stamp_ns)
            messages[name] = (queue.waiting.pop(0)[1],) if there else ()
        stamp_ns, self._next_ns = self._next_ns, self._next_ns + self._step_ns
        for old in [told_ns for told_ns in self._present if told_ns < stamp_ns]:
            del self._present[old]
        return Step(stamp_ns, self._restarted, messages)

    def _wanted_ns(self, queue: _Queue) -> int:
        return self._next_ns - self._step_ns if queue.channel.of_last_step else self._next_ns

    def _ring(self, missing: Sequence[_Queue], watch: _Watch) -> None:
        alone = all(queue.channel.may_be_silent and queue.last_ns > 0 for queue in missing)
        # Seen alone twice: it may be others that have only just let it go on.
        if alone and watch.alone and watch.waited_s() >= self._silence_limit_s:
            for queue in missing:
                queue.silent = True
                self._report(f"{queue.channel.name} has been silent for {watch.waited_s():.0f} s; going on without it")
        watch.alone = alone
        super()._ring(missing, watch)
