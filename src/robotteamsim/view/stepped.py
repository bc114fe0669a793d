"""A mission that a program steps while viewers watch it."""

from __future__ import annotations

from robotteamsim.view.live import AnyCommand, Pause, Play, SetLayers, SetSpeed, Step
from robotteamsim.view.shown import ShownMission


class SteppedMission(ShownMission):
    """Its pages make the program wait, make one step, and set the speed; a subclass waits accordingly."""

    def __init__(self, *, speed: float) -> None:
        """Args: speed: simulated over wall time. Raises: ValueError: it is out of range."""
        super().__init__(speed=speed, playing=True)
        self._is_one_step = False

    def execute(self, command: AnyCommand) -> None:
        """Let the program wait or go on. Raises: ValueError: only the program changes anything else."""
        with self._changed:
            match command:
                case Play() | Pause():
                    self._playing = isinstance(command, Play)
                case Step():
                    self._playing, self._is_one_step = False, True
                case SetSpeed(speed):
                    self._speed = speed
                case SetLayers(number, layers):
                    self._set_layers(number, layers)
                case _:
                    raise ValueError("not possible: a program steps this mission, and only it changes anything else")
            if self._missions:
                self._version += 1  # no new frame, because the program may be within a step
            self._changed.notify_all()
