"""The words, numbers, texts and brackets of a Stage world file, with the files that it includes."""

import itertools
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.text_file import read_text
from robotteamsim.scenario.yaml_text import is_file, shown

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
    tokens = _of_text(_read(path, file), file)
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


def _read(path: Path, file: str) -> str:
    # Comments may have any encoding; all other text is ASCII.
    return read_text(path, file, errors="replace")


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
