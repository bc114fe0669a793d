"""Sections that exist in several kinds, which their key `kind` selects, such as drives and sensors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pydantic import BeforeValidator, Discriminator

from robotteamsim.scenario.base import wrong
from robotteamsim.scenario.problems import suggestion
from robotteamsim.scenario.yaml_text import shown


def one_of_kinds(kinds: Sequence[str], default: str | None = None) -> tuple[Discriminator, BeforeValidator]:
    """Return what annotates a union of sections with tags "<kind>". Args: default: the kind of one without the key."""
    listed = ", ".join(kinds)

    def kind_of(value: Any) -> Any:
        return value.get("kind", default) if isinstance(value, dict) else getattr(value, "kind", default)

    def checked(value: Any) -> Any:
        kind = kind_of(value)
        if kind is None:
            raise wrong("kind", f"missing; expected one of {listed}")
        if kind not in kinds:
            raise wrong("kind", f"{shown(kind)} is not one of {listed}{suggestion(str(kind), kinds)}")
        return value

    return Discriminator(_tagged(kind_of)), BeforeValidator(checked)


def _tagged(kind_of: Callable[[Any], Any]) -> Callable[[Any], str]:
    return lambda value: f"<{kind_of(value)}>"
