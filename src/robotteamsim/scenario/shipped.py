"""Finds the shipped scenarios and maps: in the source tree, a catkin space or a wheel."""

import os
from pathlib import Path

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.problems import suggestion


def share_roots() -> tuple[Path, ...]:
    """Return the folders that contain `scenarios/` and `maps/` of this package, the nearest to the code first.

    In a wheel they are in robotteamsim/share, in the source tree (and a catkin devel space) next to src, in a catkin
    install space in share/robotteamsim; packages of that name on ROS_PACKAGE_PATH come last.
    """
    package = Path(__file__).resolve().parents[1]
    candidates = [package / "share", package.parents[1]]
    candidates += [parent / "share" / "robotteamsim" for parent in package.parents[:5]]
    for entry in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        candidates += [Path(entry) / "robotteamsim", Path(entry)]
    return tuple(dict.fromkeys(root for root in candidates if _is_share_root(root)))


def scenario_names() -> list[str]:
    """Return the names of the shipped scenarios, sorted."""
    return sorted({file.stem for root in share_roots() for file in (root / "scenarios").glob("*.yaml")})


def map_names() -> list[str]:
    """Return the names of the shipped maps, sorted."""
    return sorted({file.parent.name for root in share_roots() for file in (root / "maps").glob("*/plan.yaml")})


def is_bare_name(name: str) -> bool:
    """Whether a text is a shipped name and not a file: it has no folder and no suffix."""
    return bool(name) and os.path.basename(name) == name and not os.path.splitext(name)[1]


def shipped_scenario(name: str) -> Path:
    """Return the file of a shipped scenario. Raises: ScenarioError: no such scenario."""
    if name not in scenario_names() and name in map_names():
        raise ScenarioError(f"{name}: this is a floor plan, not a scenario; scenarios: {', '.join(scenario_names())}")
    return _find(name, f"scenarios/{name}.yaml", "scenario", scenario_names())


def shipped_plan(name: str) -> Path:
    """Return the floor plan of a shipped map. Raises: ScenarioError: no such map."""
    return _find(name, f"maps/{name}/plan.yaml", "map", map_names())


def shipped_map_name(plan_file: Path) -> str | None:
    """Return the name for which `shipped_plan` returns this file; None if it is not a shipped map."""
    name = plan_file.parent.name
    files = [root / "maps" / name / "plan.yaml" for root in share_roots()]
    first = next((file for file in files if file.is_file()), None)
    return name if first is not None and first.resolve() == plan_file.resolve() else None


def _find(name: str, relative: str, what: str, known: list[str]) -> Path:
    for root in share_roots():
        if (root / relative).is_file():
            return root / relative
    file = f"{name}.yaml"
    here = f"; did you mean the file {file}?" if Path(file).is_file() else ""
    near = here or suggestion(name, known) or f"; known: {', '.join(known) or 'none'}"
    raise ScenarioError(f"{name}: no shipped {what} of this name{near}")


def _is_share_root(root: Path) -> bool:
    return (root / "scenarios" / "garage_sar.yaml").is_file() and (root / "maps" / "garage" / "plan.yaml").is_file()
