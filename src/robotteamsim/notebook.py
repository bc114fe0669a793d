"""Missions and campaigns in notebooks: tables with pictures, inline players, data frames.

Example::

    from robotteamsim.notebook import read_bag, read_campaign, simulate

    mission = simulate("garage_sar", seed=1)
    mission  # shows a table and a picture
    mission.show()  # shows the player
"""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from robotteamsim.analysis.runs.totals import RunTotals, run_totals
from robotteamsim.campaign import read_store
from robotteamsim.control import foreign_code
from robotteamsim.extras import missing_extra
from robotteamsim.mission.status import END_TEXTS
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import Scenario, from_mapping, load
from robotteamsim.simulation import Result
from robotteamsim.view.document import packed
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.html import HEIGHT_PX, player_frame
from robotteamsim.view.plan_svg import plan_svg
from robotteamsim.view.recorder import Recording, record_mission

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Mission", "Player", "read_bag", "read_campaign", "simulate"]

_NOT_IN_TABLE = ("cell", "details", "paths", "traceback")


@dataclass(frozen=True)
class Player:
    """A player of one mission; a notebook shows it if it is the last value of a cell."""

    recording: Recording = field(repr=False)
    height_px: int = HEIGHT_PX

    def _repr_html_(self) -> str:
        return player_frame(packed([self.recording]), self.recording.title, self.height_px)


@dataclass(frozen=True)
class Mission:
    """A simulated or recorded mission; a notebook shows its table and picture.

    values:    its outcome, by name.
    recording: what the player shows.
    result:    of the simulation; None for a bag.
    """

    values: Mapping[str, Any]
    recording: Recording = field(repr=False)
    result: Result | None = field(default=None, repr=False)

    def show(self, height_px: int = HEIGHT_PX) -> Player:
        """Return a player, with time slider and layers. Args: height_px: of the player in the page."""
        return Player(self.recording, height_px)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>"
            for name, value in self.values.items()
        )
        style = "display:flex;flex-wrap:wrap;gap:1.5em;align-items:flex-start"
        picture = f"<div style='flex:1 1 320px'>{plan_svg(self.recording)}</div>"
        return f"<div style='{style}'><table><tbody>{rows}</tbody></table>{picture}</div>"


def simulate(
    scenario: str | os.PathLike[str] | Scenario,
    *,
    seed: int | None = None,
    noise_db: float | None = None,
    robots: int | None = None,
    settings: Mapping[str, Any] | None = None,
    allow_code: bool = False,
) -> Mission:
    """Simulate a mission from start to end.

    Args:   scenario: a shipped name, a file, or a `Scenario`.
            seed, noise_db, robots: replace `run.seed`, `voice.noise_db` and `robots.count`.
            settings: further values by key, such as {"control.alpha": 0.5}.
            allow_code: whether a controller that a file names as module:Class may run.
    Raises: ScenarioError: one line with place, key and value.
    """
    named = {"run.seed": seed, "voice.noise_db": noise_db, "robots.count": robots}
    chosen = dict(settings or {}) | {key: value for key, value in named.items() if value is not None}
    overrides = [f"{key}={json.dumps(value, default=_plain)}" for key, value in chosen.items()]
    if isinstance(scenario, Scenario) and not overrides:
        loaded = scenario
    elif isinstance(scenario, Scenario):
        loaded = from_mapping(scenario.model_dump(mode="json", by_alias=True), scenario.name, overrides)
    else:
        loaded = load(scenario, overrides)
        if not allow_code:
            foreign_code.check_scenario(loaded, "allow_code=True")
    recording, result = record_mission(loaded)
    return Mission(_values_of_result(result), recording, result)


def read_bag(
    path: str | os.PathLike[str], scenario: str | os.PathLike[str] | None = None, odometry: Sequence[str] = ()
) -> Mission:
    """Read a mission from a bag: a file, or a folder of `ros2 bag record`.

    Args:   scenario: its building is drawn instead of the bag's /map.
            odometry: the topics of the robots' poses; (): found by name and type.
    Raises: RecordingError, ScenarioError.
    """
    run = read_run([Path(path)], odometry)
    recording = recording_of(run, None if scenario is None else load(scenario))
    return Mission(_values_of_run(run_totals(run)), recording)


def read_campaign(folder: str | os.PathLike[str]) -> pd.DataFrame:
    """Return the trials of a campaign, one row each: its settings, number and results.

    Args:   folder: of `robotteamsim campaign --out`.
    Raises: CampaignError: there is no campaign. ImportError: pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError as error:
        raise ImportError(missing_extra(error) or str(error), name=error.name) from None
    stored = read_store(Path(folder))
    keys, cells = stored.settings["keys"], stored.settings["cells"]
    rows = []
    for outcome in stored.outcomes:
        names = (name for name in outcome.__dataclass_fields__ if name not in _NOT_IN_TABLE)
        values = {"trial" if name == "number" else name: getattr(outcome, name) for name in names}
        rows.append(dict(zip(keys, cells[outcome.cell], strict=True)) | values)
    return pd.DataFrame(rows)


def _plain(value: Any) -> Any:
    """Return a number of NumPy as one of Python. Raises: TypeError: it is something else."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{value!r} cannot be a setting; expected a number, text, list or dict")


def _values_of_result(result: Result) -> dict[str, Any]:
    values = msgspec.structs.asdict(result)
    return {
        "scenario": result.scenario,
        "seed": result.seed,
        **_outcome(values),
        "driven": f"{sum(robot.distance_m for robot in result.robots):.1f} m",
        "trajectory hash": f"{result.trajectory_hash[:16]}..",
    }


def _values_of_run(totals: RunTotals) -> dict[str, Any]:
    mission = totals.mission
    values: dict[str, Any] = {"recording": totals.bag}
    if mission is not None:
        names = mission.__dataclass_fields__
        values |= {"scenario": mission.scenario} | _outcome({name: getattr(mission, name) for name in names})
    driven = None if totals.distance_m is None else f"{totals.distance_m:.1f} m"
    return values | {"duration": f"{totals.duration_s:.1f} s"} | ({"driven": driven} if driven else {})


def _outcome(values: Mapping[str, Any]) -> dict[str, str]:
    return {
        "noise": f"{values['noise_db']:g} dB",
        "end": f"{END_TEXTS.get(values['end'], 'not recorded')}, after {values['time_s']:.1f} s",
        "areas explored": f"{values['areas_explored']} of {values['num_areas']}",
        "victims saved": f"{values['victims_saved']} of {values['num_victims']}",
        "links endangered": str(values["endangered_links"]),
    }
