"""The structure of a Stage world file: entities with properties, with `define`d kinds expanded."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from robotteamsim.errors import ScenarioError
from robotteamsim.stage.tokens import Place, Token, read_tokens

MAX_DEPTH = 50
MAX_ENTITIES = 100_000
"""Kinds that contain several of another kind can multiply; no real world needs as many."""

Value = float | str


@dataclass(frozen=True, slots=True, eq=False)
class Property:
    """One key with its value, or its values in brackets; no two are equal."""

    name: str
    values: tuple[Value, ...]
    place: Place


@dataclass(slots=True)
class Entity:
    """One `kind( ... )` of a world file.

    kind:   in Stage: position, model, ranger, ...
    called: the word in the file: `kind` itself or a defined name.
    """

    kind: str
    called: str
    place: Place
    properties: dict[str, Property] = field(default_factory=dict)
    children: list[Entity] = field(default_factory=list)

    def get(self, name: str) -> Property | None:
        """Return a property; None: the entity does not have it."""
        return self.properties.get(name)

    def place_of(self, name: str) -> Place:
        """Return the place of a property, or else that of the entity."""
        found = self.properties.get(name)
        return found.place if found else self.place

    def error(self, name: str, text: str) -> ScenarioError:
        """Return the error that names a property and its place."""
        return self.place_of(name).error(f"{name}: {text}")

    def of_kind(self, *kinds: str) -> list[Entity]:
        """Return the children of these kinds, in the file's order."""
        return [child for child in self.children if child.kind in kinds]

    def walk(self) -> Iterator[Entity]:
        """Yield this entity and all within it."""
        yield self
        for child in self.children:
            yield from child.walk()


def read_world_file(path: Path, file: str) -> Entity:
    """Return the root of a world file: its properties are the world's, its children the models.

    Args:   file: what error messages call it.
    Raises: ScenarioError: one line with file, line and what was expected.
    """
    return _Parser(read_tokens(path, file), Place(file, 1)).world()


# The grammar has four rules. With lark, limits, included files and messages with their line would still be ours.
class _Parser:
    """Recursive descent: items are `define`, properties and entities."""

    def __init__(self, tokens: list[Token], start: Place) -> None:
        self._tokens = tokens
        self._next = 0
        self._start = start
        self._defined: dict[str, Entity] = {}
        self._num_entities = 0

    def world(self) -> Entity:
        root = Entity("world", "world", self._start)
        while self._next < len(self._tokens):
            if self._peek("word", "define"):
                self._define(self._take())
            else:
                self._item(root, 1)
        return root

    def _define(self, start: Token) -> None:
        name, kind = self._word(start, "define"), self._word(start, "define")
        if not self._peek("mark", "("):
            raise kind.place.error(f"define: expected '(' after '{name.value} {kind.value}'")
        entity = self._entity(kind, 1)
        entity.called = name.value
        self._defined[name.value] = entity

    def _item(self, parent: Entity, depth: int) -> None:
        name = self._take()
        if name.kind != "word":
            closing = "no '(' is open here" if name.value == ")" else "expected a key or the name of a model"
            raise name.place.error(f"'{name.value}': {closing}")
        if self._peek("mark", "("):
            parent.children.append(self._entity(name, depth))
        else:
            parent.properties[name.value] = Property(name.value, self._values(name), name.place)

    def _entity(self, name: Token, depth: int) -> Entity:
        pattern = self._defined.get(name.value)
        entity = self._copy(pattern, name, depth) if pattern else Entity(name.value, name.value, name.place)
        entity.called, entity.place = name.value, name.place
        self._count(name, depth)
        self._take()
        while not self._peek("mark", ")"):
            if self._next == len(self._tokens):
                raise name.place.error(f"{name.value}: '(' is never closed")
            self._item(entity, depth + 1)
        self._take()
        return entity

    def _copy(self, pattern: Entity, name: Token, depth: int) -> Entity:
        """Return a copy of a defined kind; its properties are the same ones."""
        self._count(name, depth)
        copies = [self._copy(child, name, depth + 1) for child in pattern.children]
        return Entity(pattern.kind, pattern.called, pattern.place, dict(pattern.properties), copies)

    def _count(self, name: Token, depth: int) -> None:
        self._num_entities += 1
        if depth > MAX_DEPTH:
            raise name.place.error(f"{name.value}: nested more than {MAX_DEPTH} levels deep")
        if self._num_entities > MAX_ENTITIES:
            raise name.place.error(f"{name.value}: more than {MAX_ENTITIES} models and parts of models")

    def _values(self, name: Token) -> tuple[Value, ...]:
        if not self._peek("mark", "["):
            return (self._value(name),)
        self._take()
        values: list[Value] = []
        while not self._peek("mark", "]"):
            values.append(self._value(name))
        self._take()
        return tuple(values)

    def _value(self, name: Token) -> Value:
        if self._next == len(self._tokens):
            raise name.place.error(f"{name.value}: the file ends where a value was expected")
        token = self._take()
        if token.kind == "text":
            return token.value
        try:
            number = float(token.value) if token.kind == "number" else math.nan
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise token.place.error(f"{name.value}: '{token.value}' is neither a number nor a text in quotes")
        return number

    def _word(self, start: Token, what: str) -> Token:
        token = self._take() if self._next < len(self._tokens) else start
        if token is start or token.kind != "word":
            raise start.place.error(f"{what}: expected a name and a kind, such as define pioneer position ( ... )")
        return token

    def _peek(self, kind: str, value: str) -> bool:
        token = self._tokens[self._next] if self._next < len(self._tokens) else None
        return token is not None and token.kind == kind and token.value == value

    def _take(self) -> Token:
        self._next += 1
        return self._tokens[self._next - 1]
