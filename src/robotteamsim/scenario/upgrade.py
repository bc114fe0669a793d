"""Rewriting scenarios that have former keys; `renamed_keys` lists them."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from types import NoneType
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.controllers import ALGORITHMS, DEFAULT, control_kind
from robotteamsim.scenario.renamed_keys import CONTROLLERS, PATROL, SENSORS


def upgraded(text: str) -> tuple[str, list[str]]:
    """Return the text of a scenario with today's keys, and a line for each change.

    Comments stay, but for those of keys that move to another section.

    Args:   text: YAML whose top level is a mapping.
    Raises: YAMLError: the text is not YAML 1.2. ScenarioError: a former key cannot move, for it would replace another.
    """
    yaml = YAML()
    yaml.preserve_quotes, yaml.width = True, 10_000
    yaml.indent(mapping=2, sequence=4, offset=2)
    data = yaml.load(text)
    changes = [*_objects(data), *_control(data), *_sensors(data)]
    if not changes:
        return text, []
    output = StringIO()
    yaml.dump(data, output)
    return output.getvalue(), changes


def _objects(data: CommentedMap) -> Iterator[str]:
    if "things" in data:
        place = list(data).index("things")
        _check_absent(data, "objects", "objects", "things")
        data.insert(place, "objects", _taken(data, "things", "things"))
        yield "things: now objects"


def _control(data: CommentedMap) -> Iterator[str]:
    control = data.get("control")
    if not isinstance(control, CommentedMap):
        return
    algorithm = control.get("algorithm", DEFAULT)
    for key, section, name in (("relays", "relays", "count"), ("dispatch", "firefighters", "dispatch")):
        if key in control:
            yield _moved(data, _taken(control, key, f"control.{key}"), f"control.{key}", (section, name))
    for section, owner in (CONTROLLERS | {"patrol": "sebs"}).items():
        if not isinstance(control.get(section), CommentedMap):
            continue
        for key, value in _taken(control, section, f"control.{section}").items():
            former = f"control.{section}.{key}"
            if section == "patrol" and key in PATROL:
                yield _moved(data, value, former, ("mission", "patrol", key))
            elif owner == algorithm:
                yield _moved(data, value, former, ("control", key))
            else:
                yield f"{former}: dropped; it is a key of '{owner}', not of '{algorithm}'"
    own = control_kind(algorithm).model_fields
    known = {key for kind in ALGORITHMS.values() for key in kind.model_fields}
    for key in [key for key in control if key in known and key not in own]:
        _taken(control, key, f"control.{key}")
        yield f"control.{key}: dropped; it is not a key of '{algorithm}'"


def _moved(data: CommentedMap, value: Any, former: str, key: tuple[str, ...]) -> str:
    """Put the value of a former key at its new key; return the line about it. Raises: ScenarioError: it exists."""
    section = data
    for depth, name in enumerate(key[:-1], start=1):
        if section.get(name) is None:
            section[name] = CommentedMap()
        section = section[name]
        if not isinstance(section, CommentedMap):
            raise ScenarioError(f"{former}: belongs into {'.'.join(key[:depth])}, which is not a section")
    _check_absent(section, key[-1], ".".join(key), former)
    section[key[-1]] = value
    return f"{former}: now {'.'.join(key)}"


def _taken(section: CommentedMap, key: str, place: str) -> Any:
    """Remove a key and return its value. Raises: ScenarioError: the section has a merge key, which may have the key."""
    if list(section.merge):
        raise ScenarioError(f"{place}: cannot be moved out of a section with a merge key, <<; write out its keys")
    return section.pop(key)


def _check_absent(section: CommentedMap, key: str, place: str, former: str) -> None:
    """Raises: ScenarioError: the key exists, so that a former key would replace it."""
    if key in section:
        raise ScenarioError(f"{former}: is now {place}, which the file has, too; remove one of both")


def _sensors(data: CommentedMap) -> Iterator[str]:
    for name in ("robots", "firefighters"):
        section = data.get(name)
        teams = section if isinstance(section, CommentedSeq) else [section]
        for index, robots in enumerate(teams):
            if isinstance(robots, CommentedMap):
                place = f"{name}.{index}" if isinstance(section, CommentedSeq) else name
                yield from _sensors_of(robots, place)


def _sensors_of(robots: CommentedMap, place: str) -> Iterator[str]:
    for key, kind in SENSORS.items():
        if key not in robots:
            continue
        if not isinstance(robots[key], (CommentedMap, CommentedSeq, NoneType)):
            continue  # the check of the scenario rejects it
        former = _taken(robots, key, f"{place}.{key}")
        added = CommentedSeq([former]) if isinstance(former, CommentedMap) else former or CommentedSeq()
        for sensor in added:
            if isinstance(sensor, CommentedMap):
                sensor.insert(0, "kind", kind)
        if robots.get("sensors") is None:
            robots["sensors"] = added
        elif isinstance(robots["sensors"], CommentedSeq):
            robots["sensors"].extend(added)
        else:
            raise ScenarioError(f"{place}.{key}: belongs into {place}.sensors, which is not a list")
        yield f"{place}.{key}: now {place}.sensors, of kind {kind}"
