"""Where a robot is according to tf, and since when that is unknown."""

from __future__ import annotations

from collections.abc import Callable

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.message_parts import MAP_FRAME
from robotteamsim.recording.topics.base import check_place

START_TIMEOUT_S = 10.0
"""At the start, a robot waits at least this long for its first transform; only then it is lost [s]."""

Newest = Callable[[str, str], tuple[tuple[int, float, float, float] | None, str]]
"""Returns stamp [ns], x, y [m] and yaw [rad] of the second frame in the first one; or None and the reason."""


class TfPose:
    """The pose of one robot, `map` -> `robot_<id>/base_link`."""

    def __init__(self, newest_transform: Newest, robot_name: str, timeout_s: float) -> None:
        """Args: timeout_s: without a new transform for this time, the robot is lost [s]."""
        self._newest_transform = newest_transform
        self._frame = f"{robot_name}/base_link"
        self._timeout_s = timeout_s
        self.name = f"{MAP_FRAME} -> {self._frame}"
        """The transform, in messages."""
        self.reason = ""
        """Why there was no transform in the last step; "" if there was one."""
        self.restart()

    def restart(self) -> None:
        """Restart with the first step, because time has jumped back."""
        self.newest: PoseReading | None = None
        """The newest pose, which is the last one while the robot is lost; None before the first one."""
        self._tf_ns = -1
        self._seen_ns: int | None = None

    def follow(self, step_ns: int) -> str:
        """Look the pose up in a step with this stamp; return in one line why the robot is lost, "" if it is not.

        Clocks of robots may differ: a transform from the future counts from the step in which it arrived.
        """
        found, self.reason = self._newest_transform(MAP_FRAME, self._frame)
        if found is not None:
            self._note(step_ns, *found)
        if self._seen_ns is None:
            self._seen_ns = step_ns  # waits from the first step on
        timeout_s = self._timeout_s if self.newest is not None else max(START_TIMEOUT_S, self._timeout_s)
        if step_ns - self._seen_ns < round(timeout_s * 1e9):
            return ""
        key = "" if timeout_s > self._timeout_s else " (control.tf_timeout_s)"
        return f"/tf: no transform {self.name} for {timeout_s:g} s{key}"

    def _note(self, step_ns: int, tf_ns: int, x_m: float, y_m: float, yaw_rad: float) -> None:
        try:
            check_place("position", x_m, y_m)
        except ValueError as error:
            self.reason = str(error)
            return
        if tf_ns == 0:  # static
            self._seen_ns = step_ns
        elif tf_ns != self._tf_ns:
            self._seen_ns = min(tf_ns, step_ns)
        self._tf_ns = tf_ns
        self.newest = PoseReading.from_pose(Pose(x_m, y_m, yaw_rad))
