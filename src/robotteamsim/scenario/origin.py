"""The source of a scenario, so that errors found later still name the file or the --set."""

from dataclasses import dataclass, field
from pathlib import Path

Key = tuple[str | int, ...]
"""A dotted key as a path into the YAML data: ("mission", "victims", 0, "position")."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The file of a scenario and the keys that overrides set.

    All origins compare equal, so that equal scenarios from different files are equal.

    place:    the name of the file in messages; empty for a scenario made in Python.
    set_keys: the keys that were set with `--set`.
    files:    the files that were read: the scenario, its plan with the image that the plan names, its patrol graph.
    """

    place: str = field(default="", compare=False)
    set_keys: tuple[Key, ...] = field(default=(), compare=False)
    files: tuple[Path, ...] = field(default=(), compare=False)

    def is_set(self, key: str) -> bool:
        """Whether an override set a dotted key, or a section that contains it."""
        return any(f"{key}.".startswith(f"{'.'.join(map(str, set_key))}.") for set_key in self.set_keys)

    def line(self, text: str, key: str) -> str:
        """Return a message about a dotted key, preceded by the file or option that set the key."""
        place = "--set" if self.is_set(key) else self.place
        return f"{place}: {text}" if place else text
