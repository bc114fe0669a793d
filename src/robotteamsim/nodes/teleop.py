"""Drives one robot with the keyboard: the node `teleop`."""

import contextlib
import os
import select
import sys
import time
from collections.abc import Iterator

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.geometry import Twist
from robotteamsim.nodes.node import Node
from robotteamsim.recording.topics.base import twist
from robotteamsim.recording.topics.decisions import COMMAND

PERIOD_S = 0.1
FIRST_HOLD_S = 0.6
"""How long a key counts as held after its first character [s, wall]. Terminals do not report releases, and keyboards
wait this long before they repeat a key."""
REPEAT_HOLD_S = 0.2
"""How long a key counts as held after each repetition [s, wall]."""

HELP = """\
Hold a key to drive:        q z  both speeds up, down by 10 %
  u  i  o                   w x  driving speed
  j  k  l    k  stop        e c  turning speed
  m  ,  .                   Ctrl-C ends
"""

_DIRECTIONS = {
    "u": (1.0, 1.0),
    "i": (1.0, 0.0),
    "o": (1.0, -1.0),
    "j": (0.0, 1.0),
    "l": (0.0, -1.0),
    "m": (-1.0, -1.0),
    ",": (-1.0, 0.0),
    ".": (-1.0, 1.0),
}
_SCALES = {"q": (1.1, 1.1), "z": (0.9, 0.9), "w": (1.1, 1.0), "x": (0.9, 1.0), "e": (1.0, 1.1), "c": (1.0, 0.9)}


class Keys:
    """The speeds and the command according to the pressed keys."""

    def __init__(self, speed_mps: float, turn_radps: float) -> None:
        """Args: the initial driving and turning speeds."""
        self.speed_mps = speed_mps
        self.turn_radps = turn_radps
        self._held = ""
        self._until_s = 0.0

    def press(self, key: str, now_s: float) -> None:
        """Process a character received at a time [s]."""
        if key in _SCALES:
            speed, turn = _SCALES[key]
            self.speed_mps *= speed
            self.turn_radps *= turn
            return
        repeated = key == self._held and now_s <= self._until_s
        self._held = key
        self._until_s = max(self._until_s if repeated else 0.0, now_s + (REPEAT_HOLD_S if repeated else FIRST_HOLD_S))

    def speeds(self, now_s: float) -> tuple[float, float]:
        """Return the commanded driving and turning speeds at a time [s]; zero if no key is held."""
        forward, left = _DIRECTIONS.get(self._held, (0.0, 0.0)) if now_s <= self._until_s else (0.0, 0.0)
        return forward * self.speed_mps, left * self.turn_radps


def serve(node: Node) -> None:
    """Publish ten commands per second while a key is held, and a stop when it is released.

    Raises: ParameterError. RobotTeamSimError: there is no terminal.
    """
    if not sys.stdin.isatty():
        raise RobotTeamSimError("there is no terminal to read keys from")
    keys = Keys(node.parameter("~speed_mps", 0.5), node.parameter("~turn_radps", 1.0))
    output = node.output(COMMAND.name, COMMAND.type_name)
    sys.stdout.write(f"{HELP}\n")
    sys.stdout.flush()
    is_moving = False
    with unbuffered(sys.stdin.fileno()) as terminal:
        while node.is_running():
            for key in read_keys(terminal, PERIOD_S):
                keys.press(key, time.monotonic())
            speed_mps, turn_radps = speeds = keys.speeds(time.monotonic())
            if is_moving or any(speeds):
                output.publish(twist(Twist(speed_mps, 0.0, turn_radps)))
            is_moving = any(speeds)


@contextlib.contextmanager
def unbuffered(terminal: int) -> Iterator[int]:
    """Let a terminal return each character at once without echo; its settings are restored afterwards."""
    import termios  # only POSIX has it
    import tty

    before = termios.tcgetattr(terminal)
    tty.setcbreak(terminal)
    try:
        yield terminal
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def read_keys(terminal: int, duration_s: float) -> Iterator[str]:
    """Yield the characters received within a time [s, wall]."""
    until_s = time.monotonic() + duration_s
    while (left_s := until_s - time.monotonic()) > 0.0:
        if select.select([terminal], [], [], left_s)[0]:
            characters = os.read(terminal, 64)
            if not characters:
                raise RobotTeamSimError("the terminal was closed")
            yield from characters.decode(errors="ignore")
