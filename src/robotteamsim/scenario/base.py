"""The base of all scenario models and the types they share."""

import math
import unicodedata
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field
from pydantic_core import PydanticCustomError

from robotteamsim.scenario.yaml_text import shown


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _form(text: str, length: int) -> BeforeValidator:
    """Return the check that a value is a list of that many items; `text` shows the form, such as [x, y]."""

    def check(value: Any) -> Any:
        if not isinstance(value, (list, tuple)) or len(value) != length:
            raise wrong("", f"{shown(value)} is not {text}")
        return tuple(value)

    return BeforeValidator(check)


Point = Annotated[tuple[float, float], _form("[x, y]", 2)]
"""[x, y] in the map frame [m]."""


def _in_radians(value: Any) -> Any:
    if isinstance(value, int | float) and abs(value) > math.tau:
        raise wrong("", f"{shown(value)} is not within -6.28 to 6.28 radians (90 degrees are 1.5708)")
    return value


Yaw = Annotated[float, Field(ge=-math.tau, le=math.tau), BeforeValidator(_in_radians)]

PlanarPose = Annotated[tuple[float, float, Yaw], _form("[x, y, yaw]", 3)]
"""[x, y, yaw] in the map frame [m, m, rad]."""

HeatPoint = Annotated[tuple[float, float], _form("[t_s, kw]", 2)]
"""[t_s, kw] of a heat release rate: a time since the ignition [s] and the rate then [kW]."""

Item = TypeVar("Item")

Interval = Annotated[tuple[Item, Item], _form("[low, high]", 2)]
"""[low, high]: Interval[float]."""

Many = Annotated[tuple[Item, ...], BeforeValidator(_as_tuple)]
"""An immutable sequence that YAML writes as a list: Many[Wall]."""


SMALLEST = 1e-9
"""Smallest value of a key that must be above 0, in any unit: quotients of such numbers stay finite in C++."""

MAX_NAME_CHARACTERS = 100


def _as_name(name: str) -> str:
    if any(unicodedata.category(char) == "Cc" for char in name):
        raise wrong("", f"{shown(name)} has control characters")
    if len(name) > MAX_NAME_CHARACTERS:
        raise wrong("", f"{shown(name)} is longer than {MAX_NAME_CHARACTERS} characters")
    return name


Name = Annotated[str, AfterValidator(_as_name)]
"""A name that tables, messages and pictures show."""


def wrong(key: str, text: str) -> PydanticCustomError:
    """Return the error that a check of our own raises: `text` says what is wrong.

    Args: key: relative to the checked model or value; "" is that itself.
    """
    return PydanticCustomError("wrong", "{key}: {text}" if key else "{text}", {"key": key, "text": text})


def by_kind(default: str | None = None) -> Discriminator:
    """Return what selects the member of a union of sections, which are tagged "<kind>", by their key `kind`.

    Args: default: the kind of a section without the key.
    """

    def tag(value: Any) -> str:
        kind = value.get("kind", default) if isinstance(value, dict) else getattr(value, "kind", default)
        return f"<{kind}>"

    return Discriminator(tag)


def _in_tenths(loss_db: float) -> float:
    if abs(loss_db * 10.0 - round(loss_db * 10.0)) > 1e-6:
        raise wrong("", f"{loss_db:g} is not a multiple of 0.1")
    return loss_db


LossDb = Annotated[
    float,
    # With multipleOf, validators that divide binary numbers reject a third of the tenths, such as 0.3.
    Field(ge=0.0, le=120.0, json_schema_extra={"enum": [tenths / 10.0 for tenths in range(1201)]}),
    AfterValidator(_in_tenths),
]
"""A loss in whole tenths of a dB, so that half of it is exact in the integer sums of the propagation model."""

NoiseDb = Annotated[float, Field(ge=0.0, le=80.0)]
"""A background noise [dB]."""


def check_names(items: Mapping[str, Any], what: str = "") -> None:
    """Raise a model's error for an item with the name of an earlier one. Args: items: by key. what: they are."""
    seen: set[str] = set()
    for key, item in items.items():
        if item.name in seen:
            raise wrong(f"{key}.name", f"'{item.name}' is already the name of another{what and f' {what}'}")
        seen.add(item.name)


def by_index(key: str, items: Sequence[Item]) -> dict[str, Item]:
    """Return the items of a list by their keys."""
    return {f"{key}.{index}": item for index, item in enumerate(items)}


class Model(BaseModel):
    """A frozen section of a scenario: unknown keys, wrong types, NaN and infinity are errors."""

    model_config = ConfigDict(
        defer_build=True,  # by the first use: nodes start a tenth of a second sooner
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        populate_by_name=True,
    )
