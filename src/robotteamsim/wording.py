"""Texts of messages: plurals, errors, foreign text made safe to print, and tables that fit a terminal."""

import re
import traceback
from collections.abc import Sequence
from pathlib import Path

_LONG = re.compile(r"[^\s/]{120,}|(?<!\S)'[^'/]{120,}'")
_SHOWN_OF_LONG = 80
_PACKAGE = "robotteamsim."
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, such as "1 robot", "3 robots" or "0 robots"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def printable(text: str) -> str:
    r"""Return a text for one line of a terminal: control characters as \x1b, long words and quotes shortened."""
    escaped = "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)
    return _LONG.sub(lambda word: f"{word[0][:_SHOWN_OF_LONG]}...", escaped)


def described(error: BaseException) -> str:
    """Return the class and the text of an error in one line; only the class if it has no text or fails to give it."""
    try:
        text = " ".join(str(error).split())
    except KeyboardInterrupt:
        raise
    except BaseException:  # `__str__` of a user's class runs any code
        text = ""
    return ": ".join(filter(None, (type(error).__name__, text)))


def place_of(error: BaseException) -> tuple[str, str]:
    """Return the module and the place where an error occurred, such as "my_controller.py:27".

    That is the last line in the first file outside this package, which is the user's if a part is; an error in a
    library is thus that of the user's line that called it. Without such a file, it is the last line of all.
    """
    frames = [
        (frame.f_globals.get("__name__", ""), frame.f_code.co_filename, line)
        for frame, line in traceback.walk_tb(error.__traceback__)
    ]
    users = next((file for module, file, _ in frames if not module.startswith(_PACKAGE)), None)
    module, file, line = [frame for frame in frames if users in (None, frame[1])][-1]
    return module, f"{Path(file).name}:{line}"


def safe_cell(value: object) -> object:
    """Return a value for a CSV file; a text that a spreadsheet would run as a formula begins with an apostrophe."""
    return f"'{value}" if isinstance(value, str) and value.startswith(_FORMULA) and not _is_number(value) else value


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def column_groups(widths: Sequence[int], first_width: int, total_width: int) -> list[range]:
    """Return which columns of a wide table to print together, below each other; every group has at least one.

    Args: widths: of each column, with the space before it. first_width: of what every group repeats.
    """
    groups, begin, used = [], 0, first_width
    for index, width in enumerate(widths):
        if index > begin and used + width > total_width:
            groups.append(range(begin, index))
            begin, used = index, first_width
        used += width
    return [*groups, range(begin, len(widths))]
