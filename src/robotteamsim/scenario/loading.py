"""Reading scenarios and floor plans from YAML, with overrides; every mistake ends in one line."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.scenario.base import Model
from robotteamsim.scenario.door_places import misplaced_doors
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.patrol import read_patrol_graph
from robotteamsim.scenario.placement import check_places
from robotteamsim.scenario.problems import problems
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schedule import check_schedule
from robotteamsim.scenario.shipped import is_bare_name, shipped_plan, shipped_scenario
from robotteamsim.scenario.things import check_things
from robotteamsim.scenario.yaml_text import is_file, parse, read_mapping, shown

M = TypeVar("M", bound=Model)


def load(path_or_name: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Scenario:
    """Return the scenario of a file or of a shipped name, checked against its plan.

    Args:   path_or_name: a file, or a name without folder and suffix, such as "garage_sar".
            overrides: "key=value" each: the key dotted, list items by index (`mission.victims.0.position=[1, 2]`),
                the value as in YAML. A `plan` given so is relative to the current folder.
    Raises: ScenarioError: one line with file (or --set), key, value and what was wanted; further mistakes of the
                same file stand in the exception's notes. PlacementError: a robot, area, victim or door stands badly.
    """
    path, place = _scenario_file(os.fspath(path_or_name))
    data = read_mapping(path, place, "a scenario")
    changes = [_Override.of(text) for text in overrides]
    folder = path.parent
    for change in changes:
        if change.key[0] == "plan" and len(change.key) > 1 and isinstance(data.get("plan"), str):
            data["plan"] = _read_plan(*_plan_file(data["plan"], folder, place)).model_dump(by_alias=True, mode="json")
        elif change.key == ("plan",):
            folder = Path()
        change.apply(data)

    set_keys = [change.key for change in changes]
    plan_path: Path | None = None
    if isinstance(data.get("plan"), str):
        plan_path, plan_place = _plan_file(data["plan"], folder, "--set" if ("plan",) in set_keys else place)
        data["plan"] = _read_plan(plan_path, plan_place)
    _read_patrol_graph(data, path.parent, place, set_keys)
    scenario = _validated(Scenario, data, place, set_keys)
    if plan_path is not None:
        scenario = scenario.with_plan_file(str(plan_path.resolve()))
    else:
        _check_doors(scenario.plan, "plan.", place, set_keys)
    try:
        check_places(scenario.plan, scenario.robots, scenario.mission)
        robots = scenario.placed_robots() if scenario.things or scenario.schedule else ()
        check_things(scenario.plan, scenario.things, robots)
        check_schedule(scenario.plan, scenario.schedule, robots)
    except PlacementError as error:
        raise PlacementError(_line(str(error), str(error).partition(": ")[0], place, set_keys)) from None
    return scenario


def load_floor_plan(path_or_name: str | os.PathLike[str]) -> FloorPlan:
    """Return the floor plan of a plan file, a map_server yaml, or a shipped map's name.

    Raises: ScenarioError: one line with file, key, value and what was wanted.
    """
    name = os.fspath(path_or_name)
    if is_bare_name(name) and not is_file(Path(name)):
        return _read_plan(shipped_plan(name), f"{name}/plan.yaml")
    return _read_plan(Path(name), name)


@dataclass(frozen=True, slots=True)
class _Override:
    """One `--set`: `key` as a path into the YAML data."""

    key: tuple[str | int, ...]
    value: Any

    @classmethod
    def of(cls, text: str) -> _Override:
        key, equals, value = text.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not equals or not all(parts):
            raise ScenarioError(f"--set: '{text}' is not of the form KEY=VALUE, such as voice.noise_db=20")
        return cls(tuple(int(part) if part.isdecimal() else part for part in parts), parse(value, f"--set: {key}"))

    def apply(self, data: Any) -> None:
        """Put the value into the YAML data; sections that the file leaves out are made."""
        for position, part in enumerate(self.key):
            here = ".".join(map(str, self.key[:position]))
            key = ".".join(map(str, self.key[: position + 1]))
            last = position + 1 == len(self.key)
            if isinstance(data, list):
                if not isinstance(part, int) or part >= len(data):
                    raise ScenarioError(f"--set: {key}: '{part}' is no index of a list of {len(data)} items")
            elif isinstance(data, dict):
                if isinstance(part, int) and part not in data:
                    raise ScenarioError(f"--set: {key}: the file has no list {here}; set the whole of it")
                if not last and data.get(part) is None:
                    data[part] = {}
            else:
                raise ScenarioError(f"--set: {key}: {here} is {shown(data)}, not a section")
            if last:
                data[part] = self.value
            else:
                data = data[part]


def _scenario_file(name: str) -> tuple[Path, str]:
    """Return the file and what messages call it."""
    if is_bare_name(name) and not is_file(Path(name)):
        path = shipped_scenario(name)
        return path, path.name
    return Path(name), name


def _plan_file(name: str, folder: Path, place: str) -> tuple[Path, str]:
    if is_bare_name(name) and not is_file(folder / name):
        try:
            return shipped_plan(name), f"{name}/plan.yaml"
        except ScenarioError as error:
            raise ScenarioError(f"{place}: plan: {error}") from None
    path = folder / name
    if not is_file(path):
        raise ScenarioError(f"{place}: plan: there is no file {shown(name)}")
    return path, name


def _read_plan(path: Path, place: str) -> FloorPlan:
    data = read_mapping(path, place, "a floor plan")
    if "image" in data:
        # OpenCV takes longer to import than most scenarios to load.
        from robotteamsim.scenario.plan_import import import_map

        return import_map(path)
    plan = _validated(FloorPlan, data, place)
    _check_doors(plan, "", place)
    return plan


def _read_patrol_graph(data: Any, folder: Path, place: str, set_keys: Sequence[tuple[str | int, ...]]) -> None:
    """Put the graph itself where the data name its file, which is relative to the folder as a plan's is."""
    key = ("control", "patrol", "graph")
    section = data
    for part in key[:-1]:
        section = section.get(part) if isinstance(section, dict) else None
    if not isinstance(section, dict) or not isinstance(section.get("graph"), str):
        return
    name = section["graph"]
    is_set = key in set_keys
    path = (Path() if is_set else folder) / name
    if not is_file(path):
        raise ScenarioError(f"{'--set' if is_set else place}: {'.'.join(key)}: there is no file {shown(name)}")
    section["graph"] = read_patrol_graph(path, name)


def _check_doors(plan: FloorPlan, prefix: str, place: str, set_keys: Sequence[tuple[str | int, ...]] = ()) -> None:
    for index, text in misplaced_doors(plan):
        key = f"{prefix}doors.{index}"
        raise PlacementError(_line(f"{key}: {text} (in '{plan.doors[index].name}')", key, place, set_keys))


def _validated(model: type[M], data: Any, place: str, set_keys: Sequence[tuple[str | int, ...]] = ()) -> M:
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = problems(error, model, data)
        lines = [
            _line(str(problem), problem.key, place, [*set_keys, *_blamed(problem.key, data, set_keys)])
            for problem in found
        ]
    raised = ScenarioError(lines[0])
    for line in lines[1:]:
        raised.add_note(line)
    raise raised


def _blamed(key: str, data: Any, set_keys: Sequence[tuple[str | int, ...]]) -> list[tuple[str | int, ...]]:
    """Return a key that is wrong beside another of its section that was set: the file does not have it, so it is no
    mistake of the file."""
    *section, name = key.split(".")
    for part in section:
        data = data.get(part) if isinstance(data, dict) else None
    if isinstance(data, dict) and name not in data and any([*map(str, k)][:-1] == section for k in set_keys):
        return [tuple(key.split("."))]
    return []


def _line(text: str, key: str, place: str, set_keys: Sequence[tuple[str | int, ...]]) -> str:
    dotted = [".".join(map(str, set_key)) for set_key in set_keys]
    from_set = any(f"{key}.".startswith(f"{set_key}.") for set_key in dotted)
    return f"{'--set' if from_set else place}: {text}"
