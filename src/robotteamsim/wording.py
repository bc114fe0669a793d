"""The wording of messages: plurals, and text of others that is safe to print."""

import re

_LONG = re.compile(r"[^\s/]{120,}")
_SHOWN_OF_LONG = 80


def counted(number: int, noun: str) -> str:
    """Return such as "1 robot", "3 robots" or "0 robots"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def printable(text: str) -> str:
    r"""Return a text for one line of a terminal: control characters as \x1b, words of 120 characters shortened."""
    escaped = "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)
    return _LONG.sub(lambda word: f"{word[0][:_SHOWN_OF_LONG]}...", escaped)
