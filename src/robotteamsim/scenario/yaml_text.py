"""YAML as scenarios use it: keys are text and unique, `1e6` is a number, dates are plain text, tags are not used.

Depth and number of values are limited; a value counts again for each alias of it, since each alias becomes a copy.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml
from yaml.composer import Composer
from yaml.constructor import SafeConstructor
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.resolver import Resolver
from yaml.scanner import Scanner

from robotteamsim.errors import ScenarioError
from robotteamsim.user_files import open_regular
from robotteamsim.wording import printable

MAX_BYTES = 4 * 2**20
"""Of a text file: ten times the floor plan of a large building. No file can fill the memory."""

MAX_DEPTH = 50
"""Sections and lists within each other."""

MAX_VALUES = 200_000
"""Values, lists, sections and keys of a file; a floor plan of a large building has some thousands."""


MAX_DIGITS = 100
"""Of a whole number."""


class _Values(Composer, SafeConstructor, Resolver):  # type: ignore[misc]  # PyYAML has no types
    """The values of a YAML text, with the differences that the module describes; a loader adds a parser."""

    def __init__(self) -> None:
        for part in (Composer, SafeConstructor, Resolver):
            part.__init__(self)
        self._depth = 0
        self._count = 0
        self._sizes: dict[int, int] = {}

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node:
        event = self.peek_event()
        if getattr(event, "tag", None) is not None:
            raise yaml.MarkedYAMLError(problem="tags such as !!int are not supported", problem_mark=event.start_mark)
        value = getattr(event, "value", "")
        if not value.isascii() and re.search("[\ud800-\udfff]", value):
            problem = "half of a surrogate pair, such as \\ud800, is not a character"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise yaml.MarkedYAMLError(problem="nested too deeply", problem_mark=event.start_mark)
        before = self._count
        node = super().compose_node(parent, index)
        if isinstance(event, yaml.AliasEvent):
            self._count += self._sizes.get(id(node), 1)
        else:
            self._count += 1
            self._sizes[id(node)] = self._count - before
        if self._count > MAX_VALUES:
            problem = f"more than {MAX_VALUES} values, aliases included"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
        self._depth -= 1
        return node

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        if len(node.value) > MAX_DIGITS:
            problem = f"a number of {len(node.value)} characters; expected at most {MAX_DIGITS}"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)
        if ":" in node.value or re.match("[-+]?0[0-9]", node.value):
            problem = f"{node.value}: base 60 or 8 in YAML 1.1; expected a number in base 10, or a text in quotes"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)
        number: int = super().construct_yaml_int(node)
        return number

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem="a key must be plain text", problem_mark=key_node.start_mark)
            if key_node.tag not in ("tag:yaml.org,2002:str", "tag:yaml.org,2002:merge"):
                problem = f"key {key_node.value} is not text; put it in quotes"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=key_node.start_mark)
            if key_node.value in seen:
                problem = f"duplicate key '{key_node.value}'"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=key_node.start_mark)
            seen.add(key_node.value)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping


# The table is public; PyYAML has no function that removes a resolver. ruamel.yaml would need the same class and limits.
_Values.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith((":timestamp", ":float", ":value"))]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Values.add_constructor("tag:yaml.org,2002:int", _Values.construct_yaml_int)
_Values.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    # YAML 1.2: a point or an exponent is enough (PyYAML reads 1e6 as text).
    re.compile(
        r"[-+]?(?:(?:\.[0-9]+|[0-9]+\.[0-9]*)(?:[eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+|\.(?:inf|Inf|INF))$|\.nan$"
    ),
    list("-+0123456789."),
)


class _Loader(Reader, Scanner, Parser, _Values):  # type: ignore[misc]
    """With the parser in Python, whose messages users know."""

    def __init__(self, text: str) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        _Values.__init__(self)


_READ_OTHERWISE = re.compile("[\t?|>\ufeff]")
"""Where libyaml accepts what PyYAML's own parser rejects, such as `fr?om: 1` in braces."""

if yaml.__with_libyaml__:

    class _FastLoader(_Values, yaml.cyaml.CParser):  # type: ignore[misc]
        """With libyaml's parser, four times as fast."""

        def __init__(self, text: str) -> None:
            yaml.cyaml.CParser.__init__(self, text)
            _Values.__init__(self)


def parse(text: str, place: str) -> Any:
    """Return the value of a YAML text.

    Args:   place: name of the text in messages: the file, or the override.
    Raises: ScenarioError: a syntax error, a duplicate key, a tag, too many or too deeply nested values, with its line.
    """
    if yaml.__with_libyaml__ and not _READ_OTHERWISE.search(text):
        try:
            return yaml.load(text, Loader=_FastLoader)
        except (yaml.YAMLError, ValueError):
            pass  # the other parser words the mistake
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        # PyYAML detects a line without a colon only on the next line.
        noticed_late = error.context == "while scanning a simple key"
        mark = error.context_mark if noticed_late else error.problem_mark
        line = f":{mark.line + 1}" if mark and "\n" in text.strip() else ""
        raise ScenarioError(f"{place}{line}: {error.problem or error.context}") from None
    except (yaml.YAMLError, ValueError) as error:
        # An unprintable character, or a malformed number (0b, 1_).
        raise ScenarioError(f"{place}: {str(error).splitlines()[0]}") from None


def check_depth(value: Any, place: str) -> None:
    """Raise ScenarioError for plain values that are nested deeper than `parse` allows."""
    level, depth = [value], 0
    while level:
        depth += 1
        if depth > MAX_DEPTH:
            raise ScenarioError(f"{place}: nested too deeply")
        inner = [item.values() if isinstance(item, dict) else item for item in level if isinstance(item, (dict, list))]
        level = [part for parts in inner for part in parts]


def read_text(path: Path, place: str, errors: str = "strict") -> str:
    """Return the text of a file in UTF-8.

    Args:   place: what error messages call the file. errors: as for `bytes.decode`.
    Raises: ScenarioError: the file is missing, unreadable, too large or not UTF-8.
    """
    try:
        with open_regular(path) as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise ScenarioError(f"{place}: there is no such file") from None
    except ValueError:  # a NUL in the name
        raise ScenarioError(f"{place}: not a file name") from None
    except OSError as error:
        raise ScenarioError(f"{place}: {error.strerror or error}") from None
    if len(data) > MAX_BYTES:
        raise ScenarioError(f"{place}: larger than {MAX_BYTES // 2**20} MiB; expected a text file")
    try:
        return data.decode("utf-8-sig", errors)
    except UnicodeDecodeError:
        raise ScenarioError(f"{place}: not a text file in UTF-8") from None


def is_file(path: Path) -> bool:
    """Whether a file exists; False also for an invalid name, such as one that is too long."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def read_mapping(path: Path, place: str, what: str) -> dict[str, Any]:
    """Return the keys and values of a YAML file.

    Args:   place: name of the file in messages. what: what it should be, such as "a scenario".
    Raises: ScenarioError: the file is missing, unreadable, too large, not YAML or not a mapping.
    """
    return mapping_of(read_text(path, place), place, what)


def mapping_of(text: str, place: str, what: str) -> dict[str, Any]:
    """Return the keys and values of a YAML text, see `read_mapping`. Raises: ScenarioError."""
    data = parse(text, place)
    if data is None:
        raise ScenarioError(f"{place}: file is empty; expected {what}: lines of KEY: VALUE")
    if not isinstance(data, dict):
        raise ScenarioError(f"{place}: {shown(data)} is not {what}: lines of KEY: VALUE")
    return data


class _Dumper(yaml.SafeDumper):  # type: ignore[misc]  # PyYAML has no types
    """PyYAML's safe dumper, with lists of plain values, such as points, on one line."""

    def represent_sequence(self, tag: str, sequence: Any, flow_style: bool | None = None) -> yaml.SequenceNode:
        plain = not any(isinstance(item, dict) for item in sequence)
        return super().represent_sequence(tag, sequence, flow_style=plain)

    def ignore_aliases(self, data: Any) -> bool:
        return True


# Text that the loader would read as a number must be quoted.
_Dumper.yaml_implicit_resolvers = _Values.yaml_implicit_resolvers


def _text(dumper: yaml.SafeDumper, value: str) -> yaml.ScalarNode:
    # Only the double-quoted style preserves every control character.
    style = None if value.isprintable() else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", value, style=style)


_Dumper.add_representer(str, _text)


def write(value: Any) -> str:
    """Return the YAML text of plain values, with keys in their order.

    `parse` returns the same value, and so do loaders of YAML 1.1, such as that of roslaunch, to which 5e-05 is text.
    """
    text: str = yaml.dump(value, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=110)
    return text


def shown(value: Any) -> str:
    """Return a value as YAML, on one short line."""
    if isinstance(value, dict):
        return "a section"
    try:
        text = f"'{value}'" if isinstance(value, str) else write(value).splitlines()[0]
    except RecursionError:
        return "a list that contains itself"
    except yaml.YAMLError:  # of Python alone, such as an array
        text = repr(value)
    # A text may have line breaks of its own.
    text = printable(" ".join(text.split()))
    return text if len(text) <= 60 else f"{text[:57]}..."
