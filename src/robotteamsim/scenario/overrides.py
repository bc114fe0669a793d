"""Overrides of a scenario's keys: `--set KEY=VALUE`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.controllers import DEFAULT, control_kind
from robotteamsim.scenario.origin import Key
from robotteamsim.scenario.yaml_text import parse, shown
from robotteamsim.wording import counted

_MOST_DIGITS = 9
"""Of the index of a list."""


@dataclass(frozen=True, slots=True)
class Override:
    """One `--set`: `key` as a path into the YAML data."""

    key: Key
    value: Any

    @classmethod
    def of(cls, text: str) -> Override:
        """Return the override of "key=value". Raises: ScenarioError: not of that form."""
        key, equals, value = text.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not equals or not all(parts):
            raise ScenarioError(f"--set: '{text}' is not of the form KEY=VALUE, such as voice.noise_db=20")
        path = tuple(int(part) if part.isdecimal() and len(part) <= _MOST_DIGITS else part for part in parts)
        return cls(path, parse(value, f"--set: {key}"))

    @classmethod
    def all_of(cls, texts: Sequence[str]) -> list[Override]:
        """Return the overrides of a list of "key=value". Raises: ScenarioError: one is wrong, or it is not a list."""
        is_list = isinstance(texts, Sequence) and not isinstance(texts, str)
        if not is_list or not all(isinstance(text, str) for text in texts):
            raise ScenarioError(f"overrides: {texts!r:.60}; expected a list of KEY=VALUE, such as ['run.seed=1']")
        return [cls.of(text) for text in texts]

    def apply(self, data: Any) -> None:
        """Put the value into the YAML data; missing sections are created. Raises: ScenarioError."""
        for position, part in enumerate(self.key):
            here = ".".join(map(str, self.key[:position]))
            key = ".".join(map(str, self.key[: position + 1]))
            last = position + 1 == len(self.key)
            if isinstance(data, list):
                items = counted(len(data), "item")
                if not isinstance(part, int):
                    raise ScenarioError(f"--set: {key}: '{part}' is not an index (list has {items})")
                if part >= len(data):
                    raise ScenarioError(f"--set: {key}: index {part} out of range (list has {items})")
            elif isinstance(data, dict):
                if isinstance(part, int) and part not in data:
                    raise ScenarioError(f"--set: {key}: the file has no list {here}; set the whole list")
                if not last and data.get(part) is None:
                    data[part] = {}
            else:
                raise ScenarioError(f"--set: {key}: {here} is {shown(data)}, not a section")
            if last:
                data[part] = self.value
            else:
                data = data[part]


def drop_foreign_keys(control: Any, file_control: Any, set_keys: Sequence[Key]) -> list[str]:
    """Remove the keys of the file's algorithm that the algorithm of an override lacks, and return them.

    Keys that are overridden themselves stay, so that they are refused.

    Args: control: the section with its overrides, which is changed. file_control: the section as in the file.
    """
    if not isinstance(control, dict) or not isinstance(file_control, dict) or ("control",) in set_keys:
        return []
    old, new = (control_kind(section.get("algorithm", DEFAULT)).model_fields for section in (file_control, control))
    foreign = [key for key in file_control if key in old and key not in new]
    dropped = [key for key in foreign if not any(set_key[:2] == ("control", key) for set_key in set_keys)]
    for key in dropped:
        del control[key]
    return dropped
