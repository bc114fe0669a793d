"""Calls of `robotteamsim._core` as trees whose leaves can be replaced."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose


class Output(NamedTuple):
    """An array that the call fills in."""

    shape: tuple[int, ...]
    kind: type = np.float32
    before: float = 0.0


@dataclass(frozen=True)
class Call:
    """A function or class of `_core`, and then methods or properties of the object that it returned."""

    name: str
    args: tuple[Any, ...] = ()
    named: tuple[tuple[str, Any], ...] = ()
    then: tuple[tuple[Any, ...], ...] = ()

    def of(self, *methods: tuple[Any, ...]) -> Call:
        return replace(self, then=methods)


def new(name: str, *args: Any, **named: Any) -> Call:
    return Call(name, args, tuple(named.items()))


def evaluate(node: Any, filled: list[Any]) -> Any:
    """Make the calls of a tree and return the result of its root; `filled` collects everything that they returned."""
    if isinstance(node, (float, int, str)):  # most nodes
        return node
    match node:
        case Call():
            target: Any = _core
            for part in node.name.split("."):
                target = getattr(target, part)
            made = target(*(evaluate(arg, filled) for arg in node.args), **dict(evaluate(node.named, filled)))
            filled.append(made)
            for method, *args in node.then:
                attribute = getattr(made, method)
                filled.append(attribute(*(evaluate(arg, filled) for arg in args)) if callable(attribute) else attribute)
            return made
        case Output(shape, kind, before):
            filled.append(np.full(shape, before, kind))
            return filled[-1]
        case Pose():
            return node
        case tuple() | list():
            return type(node)([evaluate(item, filled) for item in node])
        case dict():
            return {key: evaluate(item, filled) for key, item in node.items()}
    return node


def leaves(node: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Return the paths of all numbers of a tree; of an array, those of its first and its last element."""
    match node:
        case Call():
            for part in ("args", "named", "then"):
                yield from leaves(getattr(node, part), (*path, part))
        case Pose():
            for part in ("x_m", "y_m", "yaw_rad"):
                yield (*path, part)
        case Output() | str() | bool():
            return
        case tuple() | list():
            for index, item in enumerate(node):
                yield from leaves(item, (*path, index))
        case dict():
            for key, item in node.items():
                yield from leaves(item, (*path, key))
        case np.ndarray():
            if node.size and node.dtype.kind == "f":
                yield from ((*path, place) for place in {0, node.size - 1})
        case int() | float():
            yield path


def replaced(node: Any, path: tuple[Any, ...], value: Any) -> Any:
    """Return the tree with another value at a path."""
    if not path:
        return value
    first, *rest = path
    match node:
        case Call():
            return replace(node, **{first: replaced(getattr(node, first), tuple(rest), value)})
        case Pose():
            return Pose(**{name: value if name == first else getattr(node, name) for name in ("x_m", "y_m", "yaw_rad")})
        case np.ndarray():
            changed = node.copy()
            with np.errstate(over="ignore"):
                changed.flat[first] = math.nan if value is None else value
            return changed
        case dict():
            return {**node, first: replaced(node[first], tuple(rest), value)}
    items = [replaced(item, tuple(rest), value) if index == first else item for index, item in enumerate(node)]
    return type(node)(items)
