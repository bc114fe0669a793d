"""How a robot's own way carries on in its next step: the memory term of eq. (25)."""

from collections import deque

from robotteamsim.swarm import Vector, memory_term


class Momentum:
    """The velocities that a robot really had in the last iterations, and what they add to the next one."""

    def __init__(self, coefficients: tuple[float, ...]) -> None:
        """Args: coefficients: the weights of v[t], v[t-1], ..."""
        self.coefficients = coefficients
        self._velocities: deque[Vector] = deque(maxlen=len(coefficients))
        """Newest first [m per iteration]."""
        self._position: Vector | None = None

    def note(self, position: Vector) -> None:
        """Take note of where the robot is, in `map` [m], once per iteration.

        It remembers where it went, not where it wanted to: a blocked robot had no velocity.
        """
        if self._position is not None:
            self._velocities.appendleft((position[0] - self._position[0], position[1] - self._position[1]))
        self._position = position

    def forget(self) -> None:
        """Begin anew, from rest."""
        self._position = None
        self._velocities.clear()

    def term(self) -> Vector:
        """Return the weighted sum of the past velocities [m per iteration]."""
        return memory_term(self.coefficients, self._velocities)
