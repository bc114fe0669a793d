"""Controls when the world takes its next step: pause, single steps, reset, pace."""

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager

REANCHOR_S = 0.25
"""A world that is late by more than this [s, wall] does not catch up."""


class Gate:
    """Lets one thread take steps as others allow. The others use all methods except `wait` and `sleep`."""

    def __init__(self) -> None:
        self._paused = False
        self._steps = self._pauses = 0
        self._resets_wanted = self._resets_done = 0
        self._waiting = False
        self._closed = False
        # The lock is reentrant, because a signal handler may close the gate during `wait`.
        self._changed = threading.Condition()

    @property
    def is_paused(self) -> bool:
        """Whether only single steps are allowed."""
        return self._paused

    def wait(self) -> bool:
        """Wait until the next step, or a reset, is allowed; return False if closed."""
        with self._changed:
            self._waiting = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._closed or not self._paused or self._steps > 0 or self.reset_wanted)
            self._waiting = False
            return not self._closed

    def sleep(self, duration_s: float) -> bool:
        """Wait for some time [s, wall]; return False at once if closed."""
        with self._changed:
            return not self._changed.wait_for(lambda: self._closed, timeout=duration_s)

    def passed(self) -> None:
        """Record that a step has been taken."""
        with self._changed:
            self._steps = max(0, self._steps - 1)
            self._changed.notify_all()

    @property
    def reset_wanted(self) -> bool:
        """Whether a reset was requested, and is not done."""
        return self._resets_done < self._resets_wanted

    def do_reset(self, reset: Callable[[], None]) -> None:
        """Do a reset, for all that were requested before it began."""
        wanted = self._resets_wanted
        reset()
        with self._changed:
            self._resets_done = wanted
            self._changed.notify_all()

    def want_reset(self) -> int:
        """Request a reset; return its number."""
        with self._changed:
            self._resets_wanted += 1
            self._changed.notify_all()
            return self._resets_wanted

    def pause(self, timeout_s: float) -> bool:
        """Allow no more steps; return whether the current one ended in time [s, wall]."""
        with self._changed:
            self._paused = True
            self._steps = 0
            self._pauses += 1
            return self._changed.wait_for(lambda: self._closed or self._waiting, timeout=timeout_s)

    def resume(self) -> None:
        """Allow steps again."""
        with self._changed:
            self._paused = False
            self._changed.notify_all()

    def step(self, steps: int) -> bool:
        """Allow some steps while paused and wait until they are taken; return False if not paused or not done."""
        with self._changed:
            if not self._paused:
                return False
            self._steps += steps
            pauses = self._pauses  # another one takes the steps away
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._closed or not self._paused or (self._steps == 0 and self._waiting))
            return self._paused and pauses == self._pauses and not self._closed

    def reset(self, timeout_s: float) -> bool:
        """Request a reset; return whether it was done in time [s, wall]."""
        with self._changed:
            number = self.want_reset()
            return self._changed.wait_for(lambda: self._closed or self._resets_done >= number, timeout=timeout_s)

    def close(self) -> None:
        """Allow no more steps, and end all waits."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class FairLock:
    """A lock that threads get in the order in which they have asked for it.

    With an ordinary one, a thread that takes one step after the other would hardly let others in.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._queue: deque[object] = deque()
        """The thread that has the lock, and those that wait for it."""

    def __enter__(self) -> None:
        self._acquire(None)

    def __exit__(self, *_: object) -> None:
        with self._changed:
            self._queue.popleft()
            self._changed.notify_all()

    @contextmanager
    def within(self, timeout_s: float) -> Iterator[None]:
        """Hold the lock; wait for it no longer than a timeout [s, wall]. Raises: ValueError: it took longer."""
        if not self._acquire(timeout_s):
            raise ValueError(f"the current step has not ended within {timeout_s:g} s")
        try:
            yield
        finally:
            self.__exit__()

    def _acquire(self, timeout_s: float | None) -> bool:
        turn = object()
        with self._changed:
            self._queue.append(turn)
            has_come = self._changed.wait_for(lambda: self._queue[0] is turn, timeout_s)
            if not has_come:
                self._queue.remove(turn)
            return has_come


class Pacer:
    """Computes waits so that simulated time passes `speed` times as fast as wall time; 0: as fast as possible."""

    def __init__(self, speed: float, wall_s: Callable[[], float] = time.monotonic) -> None:
        """Raises: ValueError: as `set_speed`."""
        self._wall_s = wall_s
        self._lock = threading.Lock()
        self.set_speed(speed)

    def set_speed(self, speed: float) -> None:
        """Set another speed from now on; may be called from any thread.

        Raises: ValueError: the speed is negative or not finite.
        """
        if not (math.isfinite(speed) and speed >= 0.0):
            raise ValueError(f"speed must be finite and >= 0, got {speed:g}")
        with self._lock:
            self._speed = speed
            self._anchor: tuple[float, int] | None = None

    @property
    def is_flat_out(self) -> bool:
        """Whether time passes as fast as possible."""
        return self._speed == 0.0

    def delay_s(self, sim_time_ns: int) -> float:
        """Return how long to wait [s, wall] until a simulated time is due."""
        with self._lock:
            if self._speed == 0.0:
                return 0.0
            now_s = self._wall_s()
            if self._anchor is None:
                self._anchor = (now_s, sim_time_ns)
            wall_s, anchor_ns = self._anchor
            delay_s = wall_s + (sim_time_ns - anchor_ns) / 1e9 / self._speed - now_s
            if delay_s < -REANCHOR_S:
                self._anchor = (now_s, sim_time_ns)
            return max(0.0, delay_s)
