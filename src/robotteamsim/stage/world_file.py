"""The language of Stage's world files: entities with properties, included files, and `define`d kinds."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.yaml_text import is_file, read_text, shown

MAX_DEPTH = 50
MAX_ENTITIES = 100_000
"""Kinds that contain several of another kind can multiply; no real world needs as many."""

MAX_TOKENS = 1_000_000
MAX_INCLUDES = 200
"""A file may be included repeatedly; no real world needs as many."""

_PATTERN = re.compile(
    r"""(?P<blank>[ \t\r\f\v]+|\#[^\n]*)
    |(?P<line>\n)
    |(?P<word>[A-Za-z][A-Za-z0-9._\-\[\]]*)   # brackets too: point[0] is one word
    |(?P<number>[-+.0-9]+)
    |"(?P<text>[^"\n]*)"
    |(?P<mark>[()\[\]])""",
    re.VERBOSE,
)

Value = float | str


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A line of a file; `file` is what messages call it."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"

    def error(self, text: str) -> ScenarioError:
        """Return the error that names this place."""
        return ScenarioError(f"{self}: {text}")


@dataclass(frozen=True, slots=True)
class Token:
    """One piece of a world file; `value` is without the quotes."""

    kind: Literal["word", "number", "text", "mark"]
    value: str
    place: Place


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


def read_world_file(path: Path, file: str) -> Entity:
    """Return the root of a world file: its properties are the world's, its children the models.

    Args:   file: what error messages call it.
    Raises: ScenarioError: one line with file, line and what was expected.
    """
    return _Parser(read_tokens(path, file), Place(file, 1)).world()


# The grammar has four rules. With lark, limits, included files and messages with their line would still be ours.
class _Parser:
    """Recursive descent: items are `define`, properties and entities.

    A definition is read again where it is used, so that it may contain what is defined later; of two with one name the
    first counts (Stage 4.3, worldfile.cc: AddMacro, ParseTokenEntity).
    """

    def __init__(self, tokens: list[Token], start: Place) -> None:
        self._tokens = tokens
        self._next = 0
        self._start = start
        self._defined: dict[str, int] = {}
        """By name, where the kind of a definition is among the tokens."""
        self._num_entities = self._num_taken = 0

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
        self._defined.setdefault(name.value, self._next - 1)
        depth = 1
        self._take()
        while depth:
            if self._next == len(self._tokens):
                raise kind.place.error(f"{kind.value}: '(' is never closed")
            token = self._take()
            depth += {"(": 1, ")": -1}.get(token.value, 0) if token.kind == "mark" else 0

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
        self._count(name, depth)
        if name.value in self._defined:
            here, self._next = self._next, self._defined[name.value] + 1
            entity = self._entity(self._tokens[self._next - 1], depth + 1)
            self._next, entity.called, entity.place = here, name.value, name.place
        else:
            entity = Entity(name.value, name.value, name.place)
        self._take()
        while not self._peek("mark", ")"):
            if self._next == len(self._tokens):
                raise name.place.error(f"{name.value}: '(' is never closed")
            self._item(entity, depth + 1)
        self._take()
        return entity

    def _count(self, name: Token, depth: int) -> None:
        self._num_entities += 1
        if depth > MAX_DEPTH:
            raise name.place.error(f"{name.value}: nested more than {MAX_DEPTH} levels deep")
        if self._num_entities > MAX_ENTITIES:
            raise name.place.error(f"{name.value}: more than {MAX_ENTITIES} models and parts of models")
        if self._num_taken > 2 * MAX_TOKENS:
            raise name.place.error(f"{name.value}: definitions repeat more than {2 * MAX_TOKENS} words and numbers")

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
        if token.kind not in ("text", "number"):
            raise token.place.error(f"{name.value}: '{token.value}' is neither a number nor a text in quotes")
        with contextlib.suppress(ValueError):  # what is no number is a text, of which Stage reads the first digits
            return float(token.value) if token.kind == "number" else token.value
        return token.value

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
        self._num_taken += 1
        return self._tokens[self._next - 1]


def read_tokens(path: Path, file: str) -> list[Token]:
    """Return the tokens of a world file, with those of included files in place of the `include`.

    As in Stage, paths are relative to the world file, even in an included file.

    Args:   file: what error messages call the world file.
    Raises: ScenarioError: a file is missing or includes itself, or a character is not part of a token.
    """
    tokens: list[Token] = []
    for token in _with_includes(path, file, path.parent, Path(file).parent, (), itertools.count(1)):
        tokens.append(token)
        if len(tokens) > MAX_TOKENS:
            raise token.place.error(f"more than {MAX_TOKENS} words and numbers")
    return tokens


def _with_includes(
    path: Path, file: str, folder: Path, called: Path, chain: tuple[Path, ...], includes: Iterator[int]
) -> Iterator[Token]:
    """Yield the tokens of a file.

    Args: folder, called: what paths are relative to, and what messages call it. chain: the files that led here.
          includes: counts the included files.
    """
    # Comments may have any encoding; all other text is ASCII.
    tokens = _of_text(read_text(path, file, errors="replace"), file)
    for token in tokens:
        if token.kind != "word" or token.value != "include":
            yield token
            continue
        name = next(tokens, None)
        if name is None or name.kind != "text":
            raise token.place.error('include: expected a file name in quotes, such as include "robots.inc"')
        included = folder / name.value
        if not is_file(included):
            raise name.place.error(f"include: there is no file {shown(name.value)}")
        if included.resolve() in (*chain, path.resolve()):
            raise name.place.error(f"include: '{name.value}' includes itself")
        if next(includes) > MAX_INCLUDES:
            raise name.place.error(f"include: more than {MAX_INCLUDES} included files")
        place = os.path.normpath(called / name.value)
        yield from _with_includes(included, place, folder, called, (*chain, path.resolve()), includes)


def _of_text(text: str, file: str) -> Iterator[Token]:
    line, position = 1, 0
    while position < len(text):
        place = Place(file, line)
        match = _PATTERN.match(text, position)
        if match is None:
            character = text[position]
            if character == '"':
                raise place.error("a text has no closing quote")
            quoted = f"'{character}'" if character.isprintable() else f"character {ord(character)}"
            raise place.error(f"unexpected {quoted}")
        position = match.end()
        if match.lastgroup == "line":
            line += 1
        elif match.lastgroup == "number":
            following = text[position : position + 1]
            if following.isalpha():
                raise place.error(
                    f"'{match[0]}{following}' is not a number in Stage: expected digits, a point and a sign"
                )
            yield Token("number", match[0], place)
        elif match.lastgroup in ("word", "text", "mark"):
            yield Token(match.lastgroup, match[match.lastgroup], place)  # type: ignore[arg-type]
