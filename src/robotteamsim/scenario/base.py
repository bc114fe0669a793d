"""The base of all scenario models and the types they share."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


Point = Annotated[tuple[float, float], BeforeValidator(_as_tuple)]
"""[x, y] in the map frame [m]."""

PlanarPose = Annotated[tuple[float, float, float], BeforeValidator(_as_tuple)]
"""[x, y, yaw] in the map frame [m, m, rad]."""

Interval = Annotated[tuple[float, float], BeforeValidator(_as_tuple)]
"""[low, high]."""


def tuple_of(item: Any) -> Any:
    """Return the type of an immutable sequence that YAML writes as a list."""
    return Annotated[tuple[item, ...], BeforeValidator(_as_tuple)]


class Model(BaseModel):
    """A frozen section of a scenario: unknown keys, wrong types, NaN and infinity are errors."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        populate_by_name=True,
        use_attribute_docstrings=True,
    )
