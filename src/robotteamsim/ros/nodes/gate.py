"""When the world may take its next step: pause, single steps, reset, pace. Knows threads, but no ROS."""

import math
import threading
import time
from collections.abc import Callable

REANCHOR_S = 0.25
"""A world that is late by more than this [s, wall] does not hurry to catch up."""


class Gate:
    """Lets one thread through, step by step, as others allow. Everything but `wait` and `sleep` is for the others."""

    def __init__(self) -> None:
        self._paused = False
        self._steps = 0
        self.reset_wanted = False
        """Whether a reset was asked for."""
        self._waiting = False
        self._closed = False
        # Its lock may be taken twice by one thread: a signal handler may close the gate in the midst of `wait`.
        self._changed = threading.Condition()

    def wait(self) -> bool:
        """Wait until the next step, or a reset, may happen; False when closed."""
        with self._changed:
            self._waiting = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._closed or not self._paused or self._steps > 0 or self.reset_wanted)
            self._waiting = False
            return not self._closed

    def sleep(self, duration_s: float) -> bool:
        """Wait for a time [s, wall]; False when closed, at once."""
        with self._changed:
            return not self._changed.wait_for(lambda: self._closed, timeout=duration_s)

    def passed(self) -> None:
        """Note that a step has been taken."""
        with self._changed:
            self._steps = max(0, self._steps - 1)
            self._changed.notify_all()

    def reset_done(self) -> None:
        """Note that the reset has happened."""
        with self._changed:
            self.reset_wanted = False
            self._changed.notify_all()

    def pause(self, timeout_s: float) -> bool:
        """Let no more steps through; return whether the one under way ended in time [s, wall]."""
        with self._changed:
            self._paused = True
            self._steps = 0
            return self._changed.wait_for(lambda: self._closed or self._waiting, timeout=timeout_s)

    def resume(self) -> None:
        """Let steps through again."""
        with self._changed:
            self._paused = False
            self._changed.notify_all()

    def step(self, steps: int) -> bool:
        """Let some steps through while paused and wait until they are taken; False when not paused, or not done."""
        with self._changed:
            if not self._paused:
                return False
            self._steps += steps
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._closed or not self._paused or (self._steps == 0 and self._waiting))
            return self._paused and not self._closed

    def reset(self, timeout_s: float) -> bool:
        """Ask for a reset; return whether it happened in time [s, wall]."""
        with self._changed:
            self.reset_wanted = True
            self._changed.notify_all()
            return self._changed.wait_for(lambda: self._closed or not self.reset_wanted, timeout=timeout_s)

    def close(self) -> None:
        """Let nobody through any more, and nobody wait."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class Pacer:
    """Computes how long to wait so that simulated time passes `speed` times as fast as wall time; 0: flat out."""

    def __init__(self, speed: float, wall_s: Callable[[], float] = time.monotonic) -> None:
        """Raises: ValueError: as `set_speed`."""
        self._wall_s = wall_s
        self._lock = threading.Lock()
        self.set_speed(speed)

    def set_speed(self, speed: float) -> None:
        """Let time pass at another speed from now on; from any thread.

        Raises: ValueError: the speed is negative or not finite.
        """
        if not (math.isfinite(speed) and speed >= 0.0):
            raise ValueError(f"speed must be finite and >= 0, got {speed:g}")
        with self._lock:
            self._speed = speed
            self._anchor: tuple[float, int] | None = None

    @property
    def is_flat_out(self) -> bool:
        """Whether time passes as fast as it goes."""
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
