"""Rewriting scenarios that have former keys; `renamed_keys` lists them."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from robotteamsim.scenario.controllers import ALGORITHMS, DEFAULT, control_kind
from robotteamsim.scenario.renamed_keys import CONTROLLERS, PATROL, SENSORS


def upgraded(text: str) -> tuple[str, list[str]]:
    """Return the text of a scenario with today's keys, and a line for each change.

    Comments stay, but for those of keys that move to another section.

    Args:   text: YAML whose top level is a mapping.
    Raises: YAMLError: the text is not YAML 1.2.
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
        data.insert(place, "objects", data.pop("things"))
        yield "things: now objects"


def _control(data: CommentedMap) -> Iterator[str]:
    control = data.get("control")
    if not isinstance(control, CommentedMap):
        return
    algorithm = control.get("algorithm", DEFAULT)
    for key, section, name in (("relays", "relays", "count"), ("dispatch", "firefighters", "dispatch")):
        if key in control:
            _section(data, section)[name] = control.pop(key)
            yield f"control.{key}: now {section}.{name}"
    for section, owner in (CONTROLLERS | {"patrol": "sebs"}).items():
        if not isinstance(control.get(section), CommentedMap):
            continue
        for key, value in control.pop(section).items():
            if section == "patrol" and key in PATROL:
                _section(_section(data, "mission"), "patrol")[key] = value
                yield f"control.patrol.{key}: now mission.patrol.{key}"
            elif owner == algorithm:
                control[key] = value
                yield f"control.{section}.{key}: now control.{key}"
            else:
                yield f"control.{section}.{key}: dropped; it is a key of '{owner}', not of '{algorithm}'"
    own = control_kind(algorithm).model_fields
    known = {key for kind in ALGORITHMS.values() for key in kind.model_fields}
    for key in [key for key in control if key in known and key not in own]:
        del control[key]
        yield f"control.{key}: dropped; it is not a key of '{algorithm}'"


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
        former = robots.pop(key)
        if isinstance(former, CommentedMap):
            former = CommentedSeq([former])
        added = former if isinstance(former, CommentedSeq) else CommentedSeq()
        for sensor in added:
            if isinstance(sensor, CommentedMap):
                sensor.insert(0, "kind", kind)
        if isinstance(robots.get("sensors"), CommentedSeq):
            robots["sensors"].extend(added)
        else:
            robots["sensors"] = added
        yield f"{place}.{key}: now {place}.sensors, of kind {kind}"


def _section(data: CommentedMap, name: str) -> Any:
    """Return a section, which is added if there is none."""
    if not isinstance(data.get(name), CommentedMap):
        data[name] = CommentedMap()
    return data[name]
