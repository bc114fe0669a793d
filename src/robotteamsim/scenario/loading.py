"""Reading scenarios and floor plans from YAML, with overrides, and writing them; a mistake is reported in one line."""

import copy
import logging
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.scenario.base import Model
from robotteamsim.scenario.controllers import is_policy_file
from robotteamsim.scenario.door_places import misplaced_doors
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.origin import Key, Origin
from robotteamsim.scenario.overrides import Override, drop_foreign_keys
from robotteamsim.scenario.patrol import read_patrol_graph
from robotteamsim.scenario.problems import problems, validated
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.shipped import (
    is_bare_name,
    map_names,
    scenario_names,
    shipped_map_name,
    shipped_plan,
    shipped_scenario,
)
from robotteamsim.scenario.yaml_text import check_depth, is_file, read_mapping, shown, write
from robotteamsim.wording import counted

_logger = logging.getLogger(__name__)

MOST_LINES = 10
"""Of a file's mistakes, so that one that many elements share does not hide where it begins."""

_ALGORITHM = "control.algorithm"

M = TypeVar("M", bound=Model)


def load(path_or_name: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Scenario:
    """Return the scenario of a file or of a shipped name.

    `setup.resolve`, which every simulation calls, checks that robots, objects, areas and victims have room in the plan.

    Args:   path_or_name: a file, or a name without folder and suffix, such as "garage_sar".
            overrides: "key=value" each, with a dotted key, list items by index (`mission.victims.0.position=[1, 2]`),
                and the value as in YAML. A file in an override is relative to the current folder. An override of
                `control.algorithm` drops the file's keys of `control` that the new algorithm lacks, with a warning.
    Raises: ScenarioError: one line with file (or --set), key, value and what was expected; the exception's notes
                contain further mistakes in the same file. PlacementError: a door is not in a gap.
    """
    try:
        place = os.fspath(path_or_name)
    except TypeError:
        place = None
    if not isinstance(place, str):  # of bytes, too
        raise ScenarioError(f"load: {path_or_name!r:.60}; expected a file, or the name of a shipped scenario")
    if not place:
        raise ScenarioError("the name of the scenario is empty")
    path = Path(place)
    if is_bare_name(place) and not is_file(path):
        path = shipped_scenario(place)
        place = path.name
    return _of_file(read_mapping(path, place, "a scenario"), path, place, overrides)


def _of_file(data: dict[str, Any], path: Path, place: str, overrides: Sequence[str]) -> Scenario:
    """Return the scenario of the data in a file. Args: place: what messages call the file."""
    if "plan" not in data and _is_plan(data):
        raise ScenarioError(f"{place}: this is a floor plan, not a scenario; a scenario names it in its key 'plan'")
    changes = Override.all_of(overrides)
    origin = Origin(place, tuple(change.key for change in changes))
    folder = path.parent
    file_control = dict(data["control"]) if isinstance(data.get("control"), dict) else None
    for change in changes:
        if change.key[0] == "plan" and len(change.key) > 1 and isinstance(data.get("plan"), str):
            plan, _ = _read_plan(*_plan_file(data["plan"], folder, place))
            data["plan"] = plan.model_dump(by_alias=True, mode="json")
        elif change.key == ("plan",):
            folder = Path()
        change.apply(data)
    dropped = drop_foreign_keys(data.get("control"), file_control, origin.set_keys)
    if dropped:
        keys = ", ".join(f"control.{key}" for key in dropped)
        _logger.warning("%s: %s: dropped, not keys of '%s' (--set)", place, keys, data["control"]["algorithm"])

    plan_path: Path | None = None
    files: tuple[Path, ...] = (path,)
    if isinstance(data.get("plan"), str):
        plan_path, plan_place = _plan_file(data["plan"], folder, "--set" if ("plan",) in origin.set_keys else place)
        data["plan"], plan_files = _read_plan(plan_path, plan_place)
        files += plan_files
    files += _read_patrol_graph(data, path.parent, origin) + _find_policy(data, path.parent, origin)
    scenario = _validated(Scenario, data, origin)
    if plan_path is None:
        _check_doors(scenario.plan, "plan.", origin)
    return scenario.read_from(replace(origin, files=files), None if plan_path is None else str(plan_path.resolve()))


def from_mapping(data: dict[str, Any], place: str, overrides: Sequence[str] = ()) -> Scenario:
    """Return the scenario of plain values with the plan among them, such as in mission.json.

    Args: place: where they come from, for errors.  overrides: as for `load`; keys are dropped without a warning.
    Raises: ScenarioError, PlacementError: as `load`, or the values are nested too deeply.
    """
    check_depth(data, place)
    changes = Override.all_of(overrides)
    origin = Origin(place, tuple(change.key for change in changes))
    old_control = data.get("control")
    data = copy.deepcopy(data)
    for change in changes:
        change.apply(data)
    drop_foreign_keys(data.get("control"), old_control, origin.set_keys)
    if ("plan",) in origin.set_keys and isinstance(data["plan"], str):
        data["plan"], _ = _read_plan(*_plan_file(data["plan"], Path(), "--set"))
    if origin.is_set(_ALGORITHM):
        _find_policy(data, Path(), origin)
    scenario = _validated(Scenario, data, origin)
    _check_doors(scenario.plan, "plan.", origin)
    return scenario.read_from(origin, None)


def load_floor_plan(path_or_name: str | os.PathLike[str]) -> FloorPlan:
    """Return the floor plan of a plan file, a map_server yaml, or a shipped map's name.

    Raises: ScenarioError: one line with file, key, value and what was expected.
    """
    return floor_plan_and_files(path_or_name)[0]


def floor_plan_and_files(path_or_name: str | os.PathLike[str]) -> tuple[FloorPlan, tuple[Path, ...]]:
    """Return a floor plan as `load_floor_plan`, and the files that were read for it. Raises: ScenarioError."""
    name = os.fspath(path_or_name)
    if is_bare_name(name) and not is_file(Path(name)):
        return _read_plan(shipped_plan(name), f"{name}/plan.yaml")
    return _read_plan(Path(name), name)


def is_floor_plan(path_or_name: str) -> bool:
    """Whether a name is that of a floor plan or of the yaml of a map. Raises: ScenarioError: it cannot be read."""
    if is_bare_name(path_or_name) and not is_file(Path(path_or_name)):
        return path_or_name in map_names() and path_or_name not in scenario_names()
    return _is_plan(read_mapping(Path(path_or_name), path_or_name, "a scenario"))


def dump(scenario: Scenario) -> str:
    """Return a scenario as YAML with every key; `load` reads an equal scenario from it.

    A shipped map is written as its name, another plan file as its absolute path.
    """
    data = scenario.model_dump(by_alias=True, mode="json")
    if scenario.plan_file:
        data["plan"] = shipped_map_name(Path(scenario.plan_file)) or scenario.plan_file
    return write(data)


def write_floor_plan(plan: FloorPlan, path: str | os.PathLike[str]) -> None:
    """Write a floor plan as a plan.yaml without keys that have their default. Raises: OSError."""
    data = plan.model_dump(by_alias=True, mode="json", exclude_defaults=True)
    Path(path).write_text(write(data), encoding="utf-8")


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


def _read_plan(path: Path, place: str) -> tuple[FloorPlan, tuple[Path, ...]]:
    """Return the plan of a file, and the files that were read: it, and the image that it names."""
    data = read_mapping(path, place, "a floor plan")
    if "plan" in data and not _is_plan(data):
        raise ScenarioError(f"{place}: this is a scenario, not a floor plan; its key 'plan' names its floor plan")
    if "image" in data:
        from robotteamsim.scenario.map_image import import_map  # late: few plans are images, and it imports much

        return import_map(path), (path, path.parent / str(data["image"]))
    plan = _validated(FloorPlan, data, Origin(place))
    _check_doors(plan, "", Origin(place))
    return plan, (path,)


def _is_plan(data: dict[str, Any]) -> bool:
    """Whether the keys of a file are those of a floor plan or of the yaml of a map."""
    return "bounds" in data or {"image", "resolution"} <= data.keys()


def _read_patrol_graph(data: Any, folder: Path, origin: Origin) -> tuple[Path, ...]:
    """Replace the name of a graph file by the graph, and return the file; the name is relative to the folder."""
    key = ("mission", "patrol", "graph")
    section = data
    for part in key[:-1]:
        section = section.get(part) if isinstance(section, dict) else None
    if not isinstance(section, dict) or not isinstance(section.get("graph"), str):
        return ()
    name, dotted = section["graph"], ".".join(key)
    path = (Path() if key in origin.set_keys else folder) / name
    if not is_file(path):
        raise ScenarioError(origin.line(f"{dotted}: there is no file {shown(name)}", dotted))
    section["graph"] = read_patrol_graph(path, name)
    return (path,)


def _find_policy(data: dict[str, Any], folder: Path, origin: Origin) -> tuple[Path, ...]:
    """Replace the name of a policy's file by its absolute path, and return it; the name is relative to the folder."""
    section = data.get("control")
    name = section.get("algorithm") if isinstance(section, dict) else None
    if not isinstance(section, dict) or not isinstance(name, str) or not is_policy_file(name):
        return ()
    path = (Path() if origin.is_set(_ALGORITHM) else folder) / name
    if not is_file(path):
        raise ScenarioError(origin.line(f"{_ALGORITHM}: there is no file {shown(name)}", _ALGORITHM))
    section["algorithm"] = str(path.resolve())
    return (path,)


def _check_doors(plan: FloorPlan, prefix: str, origin: Origin) -> None:
    for index, text in misplaced_doors(plan):
        key = f"{prefix}doors.{index}"
        raise PlacementError(origin.line(f"{key}: {text} (in '{plan.doors[index].name}')", key), key)


def _validated(model: type[M], data: Any, origin: Origin) -> M:
    try:
        return validated(model, data)
    except ValidationError as error:
        found = problems(error, model, data)
    lines = []
    for problem in found:
        to_blame = Origin(origin.place, (*origin.set_keys, *_blamed(problem.key, data, origin.set_keys)))
        lines.append(to_blame.line(str(problem), problem.key))
    raised = ScenarioError(lines[0])
    for line in lines[1:MOST_LINES]:
        raised.add_note(line)
    if len(lines) > MOST_LINES:
        raised.add_note(f"{origin.place}: {counted(len(lines) - MOST_LINES, 'more mistake')}")
    raise raised


def _blamed(key: str, data: Any, set_keys: Sequence[Key]) -> list[Key]:
    """Return the key if the file does not have it, but --set changed another one in its section.

    Then the default of the key conflicts with the --set, and the message should not blame the file.
    """
    *section, name = key.split(".")
    for part in section:
        data = data.get(part) if isinstance(data, dict) else None
    if isinstance(data, dict) and name not in data and any([*map(str, k)][:-1] == section for k in set_keys):
        return [tuple(key.split("."))]
    return []
