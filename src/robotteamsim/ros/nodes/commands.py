"""The last command and the last answer of each robot's controller. Independent of ROS."""

from collections.abc import Iterable, Sequence

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

    def clear(self) -> None:
        """Discard all commands."""
        self._last = [None] * len(self._hold_ns)


class Answers:
    """The last step that each of several nodes has answered."""

    def __init__(self, names: Iterable[str]) -> None:
        self._last_ns = dict.fromkeys(names, -1)
        self._excused: frozenset[str] = frozenset()

    def put(self, name: str, stamp_ns: int) -> None:
        """Record an answer; its stamp is 0 if a node announces that it has started."""
        self._last_ns[name] = stamp_ns

    def excuse(self, names: Iterable[str]) -> None:
        """From now on expect answers from all nodes except these."""
        self._excused = frozenset(names)

    def clear(self) -> None:
        """Restart with the first step; the nodes are already running."""
        self._last_ns = {name: min(last_ns, 0) for name, last_ns in self._last_ns.items()}

    def missing(self, stamp_ns: int) -> list[str]:
        """Return the nodes that have not answered a step yet."""
        return [name for name, last_ns in self._last_ns.items() if last_ns < stamp_ns and name not in self._excused]
