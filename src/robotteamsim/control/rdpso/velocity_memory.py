"""The memory term of eq. (25), from the past velocities of a robot."""

from collections import deque
from typing import Literal

from robotteamsim.swarm import Vector, memory_term


class Momentum:
    """The velocities of a robot in the last iterations, and their weighted sum."""

    def __init__(self, coefficients: tuple[float, ...], of: Literal["motion", "commands"] = "motion") -> None:
        """Args: coefficients: the weights of v[t], v[t-1], ...

        of: `motion` remembers the velocities that the robot really had: a blocked robot had none. `commands` remembers
        the velocities that it chose, as in the printed equations.
        """
        self.coefficients = coefficients
        self._of = of
        self._velocities: deque[Vector] = deque(maxlen=len(coefficients))
        """Newest first [m per iteration]."""
        self._position: Vector | None = None

    def note(self, position: Vector) -> None:
        """Note the robot's position, in `map` [m], once per iteration."""
        if self._of == "motion" and self._position is not None:
            self._velocities.appendleft((position[0] - self._position[0], position[1] - self._position[1]))
        self._position = position

    def note_command(self, velocity: Vector) -> None:
        """Note the velocity that the robot chose [m per iteration]."""
        if self._of == "commands":
            self._velocities.appendleft(velocity)

    def forget(self) -> None:
        """Restart from rest."""
        self._position = None
        self._velocities.clear()

    def term(self) -> Vector:
        """Return the weighted sum of the past velocities [m per iteration]."""
        return memory_term(self.coefficients, self._velocities)
