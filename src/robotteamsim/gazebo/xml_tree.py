"""XML files of users as a tree in which each element knows its line.

Size, depth and number of elements are limited. A document type is an error, so that no entity can be declared: nested
entities could expand to gigabytes, and external ones would read other files.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.text_file import read_text
from robotteamsim.scenario.yaml_text import shown
from robotteamsim.wording import printable

MAX_DEPTH = 50
"""Elements within each other."""

MAX_ELEMENTS = 200_000
"""Elements of a file; the world of a large building has some thousands."""

MAX_NUMBER = 1e6
"""Limit of all lengths and angles."""


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """One element; place: file and line, for messages."""

    tag: str
    place: str
    attributes: Mapping[str, str] = field(default_factory=dict)
    children: list[Node] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """Its text, without spaces around it."""
        return "".join(self.texts).strip()

    @property
    def name(self) -> str:
        """Its attribute `name`."""
        return self.attributes.get("name", "")

    def all(self, *tags: str) -> Iterator[Node]:
        """Yield its children with these tags, in the file's order."""
        return (child for child in self.children if child.tag in tags)

    def child(self, tag: str) -> Node | None:
        """Return its first child with this tag."""
        return next(self.all(tag), None)

    def required(self, tag: str) -> Node:
        """Return its first child with this tag. Raises: ScenarioError: there is none."""
        found = self.child(tag)
        if found is None:
            raise self.error(f"<{tag}> is missing")
        return found

    def numbers(self, count: int) -> tuple[float, ...]:
        """Return its text as numbers. Raises: ScenarioError: it is something else."""
        try:
            values = tuple(map(float, self.text.split()))
        except ValueError:
            values = ()
        if len(values) != count:
            raise self.error(f"{shown(self.text)} is not {f'{count} numbers' if count > 1 else 'a number'}")
        if not all(math.isfinite(value) and abs(value) <= MAX_NUMBER for value in values):
            raise self.error(f"{shown(self.text)} is beyond {MAX_NUMBER:.0f}")
        return values

    def lengths(self, count: int) -> tuple[float, ...]:
        """Return its text as numbers above 0. Raises: ScenarioError."""
        values = self.numbers(count)
        if min(values) <= 0.0:
            raise self.error(f"{shown(self.text)} is not above 0")
        return values

    def flag(self) -> bool:
        """Return its text as true or false. Raises: ScenarioError: it is something else."""
        text = self.text.lower()
        if text not in ("true", "false", "1", "0"):
            raise self.error(f"{shown(self.text)} is not true or false")
        return text in ("true", "1")

    def error(self, text: str) -> ScenarioError:
        """Return the error that names this element and its place."""
        return ScenarioError(f"{self.place}: {self.label}: {text}")

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{printable(self.tag)} {shown(self.name)}" if self.name else printable(self.tag)


def read_tree(path: Path, file: str) -> Node:
    """Return the root of an XML file.

    Args:   file: what error messages call it.
    Raises: ScenarioError: one line with file, line and what is wrong.
    """
    return _Reader(file).read(read_text(path, file))


class _Reader:
    def __init__(self, file: str) -> None:
        self._file = file
        self._open: list[Node] = []
        self._root: Node | None = None
        self._count = 0
        # The text is decoded already, whatever encoding the file declares.
        self._parser = expat.ParserCreate("UTF-8")
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._add_text
        self._parser.StartDoctypeDeclHandler = self._reject_doctype

    def read(self, text: str) -> Node:
        try:
            self._parser.Parse(text.encode("utf-8"), True)
        except expat.ExpatError as error:
            raise ScenarioError(f"{self._file}:{error.lineno}: not XML: {expat.ErrorString(error.code)}") from None
        assert self._root is not None  # expat rejects a file without an element
        return self._root

    @property
    def _place(self) -> str:
        return f"{self._file}:{self._parser.CurrentLineNumber}"

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MAX_ELEMENTS:
            raise ScenarioError(f"{self._place}: more than {MAX_ELEMENTS} elements")
        if len(self._open) >= MAX_DEPTH:
            raise ScenarioError(f"{self._place}: nested more than {MAX_DEPTH} levels deep")
        node = Node(tag, self._place, attributes)
        if self._open:
            self._open[-1].children.append(node)
        else:
            self._root = node
        self._open.append(node)

    def _end(self, _tag: str) -> None:
        self._open.pop()

    def _add_text(self, text: str) -> None:
        self._open[-1].texts.append(text)

    def _reject_doctype(self, *_details: object) -> None:
        raise ScenarioError(f"{self._place}: <!DOCTYPE> is not supported; expected plain SDF")
