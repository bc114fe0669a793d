"""The last command for each robot. Independent of ROS."""

from collections.abc import Sequence

from robotteamsim.geometry import Twist

STOP = Twist()


class Commands:
    """The last velocity command of each robot; it holds for some time, then the robot stops."""

    def __init__(self, hold_ns: Sequence[int]) -> None:
        """Args: hold_ns: how long the commands of each robot hold [ns], in id order."""
        self._hold_ns = tuple(hold_ns)
        self._last: list[tuple[int, Twist] | None] = [None] * len(hold_ns)

    def put(self, robot_id: int, sim_time_ns: int, twist: Twist) -> bool:
        """Store a command received at a time. Returns: False if it is not finite and therefore ignored."""
        if twist.is_finite:
            self._last[robot_id] = (sim_time_ns, twist)
        return twist.is_finite

    def at(self, robot_id: int, sim_time_ns: int) -> Twist:
        """Return the command that holds at a time."""
        last = self._last[robot_id]
        return last[1] if last is not None and sim_time_ns - last[0] < self._hold_ns[robot_id] else STOP

    def stop(self, robot_id: int) -> None:
        """Discard a robot's command."""
        self._last[robot_id] = None
