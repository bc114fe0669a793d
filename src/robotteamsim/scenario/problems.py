"""Pydantic's validation errors as one line that a user understands: key, value, what was expected."""

import difflib
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, get_args, get_origin

from pydantic import Tag, ValidationError
from pydantic.fields import FieldInfo

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import Model
from robotteamsim.scenario.yaml_text import shown
from robotteamsim.wording import counted

M = TypeVar("M", bound=Model)

_Detail = dict[str, Any]

_LIST = "<list>"
"""The tag of a section's form that is a list."""

_LONGEST_LIST = 240
"""Longest list of known keys in an error [characters], so that the message stays one readable line."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake: the dotted key and the text after it."""

    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.key}: {self.text}" if self.key else self.text


def problems(error: ValidationError, root: type[Model], data: Any = None) -> list[Problem]:
    """Return the mistakes of one validation, unknown keys first: they often explain missing ones.

    Args: data: the validated data, for the names of list items in messages.
    """
    details = sorted(map(dict, error.errors(include_url=False)), key=lambda detail: detail["type"] != "extra_forbidden")
    return [_problem(detail, root, data) for detail in details if not _only_lacks_wrong_items(detail, details)]


def checked(model: type[M], data: Any, kind: type[Exception] = ScenarioError, place: str = "") -> M:
    """Return a model of some data. Raises: an error of that kind: the first mistake in one line, after `place`."""
    try:
        return validated(model, data)
    except ValidationError as error:
        raise kind(f"{place}{problems(error, model, data)[0]}") from None


def validated(model: type[M], data: Any) -> M:
    """Return a model of some data; for whole numbers also 3.0, which is one for JSON. Raises: ValidationError."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        details = [detail for detail in error.errors(include_url=False) if detail["type"] == "int_type"]
        whole = [d for d in details if isinstance(d["input"], float) and d["input"].is_integer()]
        if not whole:
            raise
    for detail in whole:
        data = _replaced(data, [part for part in detail["loc"] if not _is_tag(part)], int(detail["input"]))
    return model.model_validate(data)


def _replaced(data: Any, path: Sequence[str | int], value: int) -> Any:
    """Return a copy of nested dictionaries and lists with another value."""
    if not path:
        return value
    first, *rest = path
    if isinstance(data, dict):
        return data | {first: _replaced(data[first], rest, value)}
    return [*data[:first], _replaced(data[first], rest, value), *data[int(first) + 1 :]]


def _only_lacks_wrong_items(detail: _Detail, details: Sequence[_Detail]) -> bool:
    """Whether a list is too short only because pydantic does not count invalid items, which have their own messages."""
    place = detail["loc"]
    return detail["type"] == "too_short" and any(
        len(other["loc"]) > len(place) and other["loc"][: len(place)] == place for other in details
    )


def suggestion(name: str, known: Sequence[str]) -> str:
    """Return "; did you mean 'x'?" for the known name that is most similar, or "" when none is similar."""
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    return f"; did you mean '{near[0]}'?" if near else ""


_TEXTS: dict[str, Callable[[_Detail, _Detail], str]] = {
    "greater_than": lambda d, ctx: f"{shown(d['input'])} is not above {ctx['gt']:g}",
    "greater_than_equal": lambda d, ctx: f"{shown(d['input'])} is below {ctx['ge']:g}",
    "less_than": lambda d, ctx: f"{shown(d['input'])} is not below {ctx['lt']:g}",
    "less_than_equal": lambda d, ctx: f"{shown(d['input'])} is above {ctx['le']:g}",
    "finite_number": lambda d, ctx: f"{shown(d['input'])} is not a finite number",
    "float_type": lambda d, ctx: f"{shown(d['input'])} is not a number",
    "int_type": lambda d, ctx: f"{shown(d['input'])} is not a whole number",
    "int_from_float": lambda d, ctx: f"{shown(d['input'])} is not a whole number",
    "bool_type": lambda d, ctx: f"{shown(d['input'])} is not true or false",
    "string_type": lambda d, ctx: f"{shown(d['input'])} is not text; put it in quotes if it should be",
    "tuple_type": lambda d, ctx: f"{shown(d['input'])} is not a list",
    "dict_type": lambda d, ctx: f"{shown(d['input'])} is not a section",
    "model_type": lambda d, ctx: f"{shown(d['input'])} is not a section",
    "too_short": lambda d, ctx: f"has {counted(ctx['actual_length'], 'item')}; expected at least {ctx['min_length']}",
    "too_long": lambda d, ctx: f"has {counted(ctx['actual_length'], 'item')}; expected at most {ctx['max_length']}",
    "literal_error": lambda d, ctx: _wrong_choice(d["input"], ctx["expected"]),
    "union_tag_not_found": lambda d, ctx: f"{shown(d['input'])} is neither a section nor a list",
    "recursion_loop": lambda d, ctx: "contains itself",
}


def _problem(detail: _Detail, root: type[Model], data: Any) -> Problem:
    place = detail["loc"]
    path = [part for part in place if not _is_tag(part)]
    kind, context = detail["type"], detail.get("ctx", {})
    if kind == "wrong":
        path += [context["key"]] if context["key"] else []
        text = context["text"]
    elif kind == "extra_forbidden":
        path = [*(part for part in place[:-1] if not _is_tag(part)), place[-1]]  # a key may look like a tag
        text = f"unknown key{_foreign(root, place) or _known_key(path, place, root)}"
    elif kind == "union_tag_invalid":
        path += ["kind"]
        text = _wrong_kind(detail)
    elif kind == "missing":
        text = f"missing{_meaning(_model_at(root, place[:-1]), str(path[-1]))}"
    elif kind in _TEXTS:
        text = _TEXTS[kind](detail, context)
    else:
        text = f"{shown(detail['input'])}: {' '.join(str(detail['msg']).split())}"
    key = ".".join(map(str, path))
    return Problem(key, f"{text}{_item_name(key, data)}")


def _item_name(key: str, data: Any) -> str:
    """Return " (in 'x')" where x is the name of the innermost list item that contains the key, else ""."""
    name = None
    for part in key.split("."):
        try:
            data = data[int(part)] if isinstance(data, (list, tuple)) else data[part]
        except (ValueError, IndexError, KeyError, TypeError):
            break
        if part.isdecimal() and isinstance(data, dict):
            name = data.get("name", name)
    return f" (in {shown(name)})" if isinstance(name, str) and not key.endswith(".name") else ""


def _wrong_choice(value: Any, expected: str) -> str:
    choices = [choice.strip("'") for choice in expected.replace(" or ", ", ").split(", ")]
    return f"{shown(value)} is not one of {', '.join(choices)}{suggestion(str(value), choices)}"


def _wrong_kind(detail: _Detail) -> str:
    kind = detail["input"].get("kind") if isinstance(detail["input"], dict) else None
    kinds = [tag.strip("'<>") for tag in detail["ctx"]["expected_tags"].split(", ")]
    if kind is None:
        return f"missing; expected one of {', '.join(kinds)}"
    return f"{shown(kind)} is not one of {', '.join(kinds)}{suggestion(str(kind), kinds)}"


def _foreign(root: type[Model], place: Sequence[str | int]) -> str:
    """Return a hint: the other kinds of this section that have the key; "" if none has it, or there are no kinds."""
    kinds, own = _kinds_at(root, place[:-1])
    # The form of a team is not a kind of the other form, a list.
    names = [tag[1:-1] for tag, kind in kinds.items() if tag not in (own, _LIST) and _field(kind, str(place[-1]))]
    return f" of {own[1:-1]}; known to {', '.join(names)}" if names else ""


def _known_key(path: Sequence[str | int], place: Sequence[str | int], root: type[Model]) -> str:
    """Return a hint: a key with a similar name here, one with this name elsewhere, or all keys known here."""
    name, model = str(path[-1]), _model_at(root, place[:-1])
    if model is None:
        return ""
    known = [_key(key, field) for key, field in model.model_fields.items()]
    near = suggestion(name, known)
    if near:
        return near
    elsewhere = next((path for path in paths(root) if path.rpartition(".")[2] == name), None)
    if elsewhere:
        return f"; did you mean '{elsewhere}'?"
    listed = textwrap.shorten(", ".join(known), _LONGEST_LIST, placeholder=f" ... ({len(known)} in all)")
    return f"; known: {listed}"


def _meaning(model: type[Model] | None, key: str) -> str:
    field = _field(model, key) if model else None
    return f"; expected {field.description}" if field and field.description else ""


def paths(model: type[Model], prefix: str = "") -> Iterator[str]:
    """Yield the dotted keys of a model's sections, of all kinds of each, some repeatedly; without those in lists."""
    for name, field in model.model_fields.items():
        yield f"{prefix}{_key(name, field)}"
        if get_origin(field.annotation) is not tuple:
            for tag, section in _kinds(field.annotation):
                if tag != _LIST:
                    yield from paths(section, f"{prefix}{_key(name, field)}.")


def _model_at(root: type[Model], place: Sequence[str | int]) -> type[Model] | None:
    """Return the model that contains a location; None: it is in a dictionary or a list of numbers."""
    kinds, tag = _kinds_at(root, place)
    return kinds.get(tag)


def _kinds_at(root: type[Model], place: Sequence[str | int]) -> tuple[dict[str, type[Model]], str]:
    """Return the models that a section may be, by tag, and the tag that it has."""
    kinds, tag = {"": root}, ""
    for part in place:
        if _is_tag(part):
            tag = str(part)
        elif isinstance(part, str):
            field = _field(kinds[tag], part) if tag in kinds else None
            kinds, tag = dict(_kinds(field.annotation)) if field else {}, ""
    return kinds, tag


def _kinds(annotation: Any, tag: str = "") -> Iterator[tuple[str, type[Model]]]:
    """Yield the models in the type of a key, or of a list, each with the tag of its kind; "" if it has no kinds."""
    if isinstance(annotation, type) and issubclass(annotation, Model):
        yield tag, annotation
    tag = next((part.tag for part in getattr(annotation, "__metadata__", ()) if isinstance(part, Tag)), tag)
    for argument in get_args(annotation):
        yield from _kinds(argument, tag)


def _is_tag(part: str | int) -> bool:
    """Whether a part of a location is the tag of a union's member, not a key."""
    return isinstance(part, str) and part.startswith("<")


def _field(model: type[Model], key: str) -> FieldInfo | None:
    return next((field for name, field in model.model_fields.items() if key in (name, _key(name, field))), None)


def _key(name: str, field: FieldInfo) -> str:
    """Return the name of a field in YAML."""
    return field.validation_alias if isinstance(field.validation_alias, str) else name
