"""Numbers of the command line: types of `argparse` whose errors are one line."""

import argparse
import math


def point(text: str) -> tuple[float, float]:
    """Return [x, y] of an argument X,Y. Raises: ArgumentTypeError."""
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' does not have the form X,Y, such as 4.0,5.0 [m]") from None
    if not (math.isfinite(x) and math.isfinite(y)):
        raise argparse.ArgumentTypeError(f"'{text}' is not finite")
    return x, y


def number(text: str) -> float:
    """Return a finite number. Raises: ArgumentTypeError."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number")
    return value


def positive_number(text: str) -> float:
    """Return a finite number above 0. Raises: ArgumentTypeError."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{value:g} is not above 0")
    return value


def whole_number(text: str) -> int:
    """Return a whole number. Raises: ArgumentTypeError."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number") from None


def positive_whole_number(text: str) -> int:
    """Return a whole number above 0. Raises: ArgumentTypeError."""
    value = whole_number(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{value} is not above 0")
    return value
