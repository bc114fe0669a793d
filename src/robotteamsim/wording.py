"""Pluralisation in messages."""


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, such as "1 robot", "3 robots" or "0 robots"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
