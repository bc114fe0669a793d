"""Former keys of scenarios, and their replacements."""

from collections.abc import Sequence

RENAMED_KEYS = {"things": "objects"}
"""Old dotted key, with * for list indices, and the dotted key that replaces it."""


def renaming(path: Sequence[str | int]) -> str | None:
    """Return the message about a renamed key; None if the key was not renamed."""
    new = RENAMED_KEYS.get(".".join("*" if isinstance(part, int) else part for part in path))
    return None if new is None else f"renamed; use '{new}'"
