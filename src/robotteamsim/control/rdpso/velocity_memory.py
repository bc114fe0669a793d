"""The memory term of eq. (25), from a robot's own motion."""

from collections import deque

from robotteamsim.swarm import Vector, memory_term


class Momentum:
    """The velocities that a robot really had in the last iterations, and their weighted sum."""

    def __init__(self, coefficients: tuple[float, ...]) -> None:
        """Args: coefficients: the weights of v[t], v[t-1], ..."""
        self.coefficients = coefficients
        self._velocities: deque[Vector] = deque(maxlen=len(coefficients))
        """Newest first [m per iteration]."""
        self._position: Vector | None = None

    def note(self, position: Vector) -> None:
        """Note the robot's position, in `map` [m], once per iteration.

        The memory contains the real motion and not the command: a blocked robot had no velocity.
        """
        if self._position is not None:
            self._velocities.appendleft((position[0] - self._position[0], position[1] - self._position[1]))
        self._position = position

    def forget(self) -> None:
        """Restart from rest."""
        self._position = None
        self._velocities.clear()

    def term(self) -> Vector:
        """Return the weighted sum of the past velocities [m per iteration]."""
        return memory_term(self.coefficients, self._velocities)
