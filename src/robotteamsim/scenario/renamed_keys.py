"""Keys that scenarios used to have, and what replaces them."""

from collections.abc import Sequence

RENAMED_KEYS = {"things": "objects"}
"""Old dotted key, list indices as *, and the dotted key that replaces it."""


def renaming(path: Sequence[str | int]) -> str | None:
    """Return what to tell the user about a key that was renamed; None: the key was not renamed."""
    new = RENAMED_KEYS.get(".".join("*" if isinstance(part, int) else part for part in path))
    return None if new is None else f"renamed; use '{new}'"
