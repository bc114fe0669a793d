"""The data of a report: the missions of each cell as arrays."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robotteamsim.campaign import Outcome, StoredCampaign, decode_paths
from robotteamsim.campaign.design import cell_name, settings_difference
from robotteamsim.campaign.summary import num_different
from robotteamsim.errors import CampaignError, ScenarioError
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.status import COMPLETED
from robotteamsim.palette import OURS
from robotteamsim.recording.network_log import NetworkTotals
from robotteamsim.scenario import Scenario, from_mapping
from robotteamsim.scenario.controllers import control_kind

_LIMIT_KEY = "mission.time_limit_s"


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Missions of one setting; arrays have shape (missions,).

    time_s:     time at which the mission ended.
    finished:   whether it ended because all areas were explored; otherwise it was cut short.
    endangered: how often a link fell below the network's threshold.
    distance_m: driven by all robots; NaN where unknown.
    numbers:    of the trials: trials of equal number form a pair in a paired campaign.
    limit_s:    time limit of the mission.
    networks, egress: of the missions that have them.
    saved_s:    of each mission, the times at which victims were saved, ascending; () if they are unknown.
    """

    time_s: np.ndarray
    finished: np.ndarray
    victims_saved: np.ndarray
    areas_explored: np.ndarray
    endangered: np.ndarray
    distance_m: np.ndarray
    numbers: np.ndarray
    num_victims: int
    num_areas: int
    limit_s: float
    networks: tuple[NetworkTotals, ...] = ()
    saved_s: tuple[tuple[float, ...], ...] = ()
    egress: tuple[Egress, ...] = ()

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def restricted_s(self) -> np.ndarray:
        """Time to the end; a mission that was cut short counts as the limit."""
        return np.where(self.finished, self.time_s, self.limit_s)

    def time_given_s(self, victims_saved: int) -> np.ndarray:
        """Return `restricted_s` of the missions that saved so many victims."""
        times_s: np.ndarray = self.restricted_s[self.victims_saved == victims_saved]
        return times_s


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """One setting of the campaign.

    name:     its settings in short, such as "20 dB".
    scenario: the scenario with these settings; None if it cannot be read, such as a plan that is missing.
    missions: all that have ended.    different: number of different trajectories among them.
    seeds:    of the missions.
    paths_m:  positions of each mission once a second, shape (samples, robots, 2), in `map`.
    """

    name: str
    settings: dict[str, Any]
    scenario: Scenario | None
    trials: int
    failed: int
    missions: Sample
    different: int
    seeds: tuple[int, ...]
    paths_m: tuple[np.ndarray, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Campaign:
    """The data of a campaign.

    seeds:   several for several campaigns of one design.
    planned: trials of each cell.    cells: cells with at least one finished mission, in the order of the design.
    paired:  whether trials of equal number have the same seed in all cells.
    empty:   names of the other cells.    unreadable: of cells without a scenario, with the reason.
    started: dates of the starts of its campaigns, as far as known.    commands: that run them, as far as known.
    """

    scenario: Scenario
    seeds: tuple[int, ...]
    planned: int
    paired: bool
    keys: tuple[str, ...]
    cells: tuple[Cell, ...]
    empty: tuple[str, ...]
    unreadable: tuple[str, ...]
    done: int
    failed: int
    settings: dict[str, Any]
    versions: dict[str, str]
    started: tuple[str, ...]
    commands: tuple[str, ...]

    @property
    def total(self) -> int:
        """Number of planned trials of all cells."""
        return self.planned * (len(self.cells) + len(self.empty))


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Missions that are drawn in one colour. label: whose they are, if a panel has several series; else ""."""

    label: str
    missions: Sample
    colour: str


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One setting in figures and tables: the campaign's missions, and any others to compare them with."""

    name: str
    series: tuple[Series, ...]

    def named(self) -> list[tuple[str, Series]]:
        """Return each series with the name of its row."""
        return [(f"{self.name}, {each.label}" if each.label else self.name, each) for each in self.series]


def panels_of(campaign: Campaign) -> tuple[Panel, ...]:
    """Return a panel for each cell, with only the campaign's missions."""
    return tuple(Panel(cell.name, (Series("", cell.missions, OURS),)) for cell in campaign.cells)


def read_campaign(stored: StoredCampaign, place: str) -> Campaign:
    """Return a stored campaign as samples. Raises: CampaignError: no finished mission, or an unreadable scenario."""
    settings = stored.settings
    keys, cell_values = tuple(settings["keys"]), settings["cells"]
    try:
        base = cell_scenario(settings["scenario"], {}, place)
    except ScenarioError as error:
        raise CampaignError(f"{error}; this version cannot read the scenario") from None
    cells, empty, unreadable = [], [], []
    for index, values in enumerate(cell_values):
        own = [outcome for outcome in stored.outcomes if outcome.cell == index]
        cell_settings = dict(zip(keys, values, strict=True))
        name = cell_name(cell_settings, base.name)
        if all(outcome.failed for outcome in own):
            empty.append(name)
            continue
        scenario = None
        try:
            scenario = cell_scenario(settings["scenario"], cell_settings, place)
        except ScenarioError as error:
            unreadable.append(f"{name} ({str(error).removeprefix(f'{place}: ')})")
        limit_s = cell_settings.get(_LIMIT_KEY)
        limit_s = limit_s if isinstance(limit_s, (int, float)) else base.mission.time_limit_s
        cells.append(_cell(name, cell_settings, scenario, own, limit_s))
    if not cells:
        raise CampaignError(f"{place}: no mission of this campaign has ended yet; nothing to report")
    return Campaign(
        scenario=base,
        seeds=(settings["seed"],),
        planned=settings["trials"],
        paired=settings["paired"],
        keys=keys,
        cells=tuple(cells),
        empty=tuple(empty),
        unreadable=tuple(unreadable),
        done=len(stored.outcomes),
        failed=sum(outcome.failed for outcome in stored.outcomes),
        settings=settings,
        versions=stored.versions,
        started=(stored.started,) if stored.started else (),
        commands=(stored.command,) if stored.command else (),
    )


def _cell(
    name: str, settings: dict[str, Any], scenario: Scenario | None, outcomes: Sequence[Outcome], limit_s: float
) -> Cell:
    """Return a cell with at least one finished mission. Args: limit_s: that of missions without a scenario."""
    good = [outcome for outcome in outcomes if not outcome.failed]
    return Cell(
        name=name,
        settings=settings,
        scenario=scenario,
        trials=len(good),
        failed=len(outcomes) - len(good),
        missions=_sample(good, limit_s if scenario is None else scenario.mission.time_limit_s),
        different=num_different(good),
        seeds=tuple(outcome.seed for outcome in good),
        paths_m=tuple(decode_paths(outcome.paths) for outcome in good if outcome.paths is not None),
    )


def pooled(stored: Sequence[StoredCampaign], places: Sequence[str]) -> Campaign:
    """Return several campaigns of one design as one campaign; each has its own seed.

    Raises: CampaignError: as `read_campaign`; or two have different settings, or the same seed.
    """
    first, offset, outcomes = stored[0], 0, []
    known: dict[int, str] = {}
    for one, place in zip(stored, places, strict=True):
        seed = one.settings["seed"]
        if seed in known:
            raise CampaignError(f"{place}: has the seed {seed} of {known[seed]}; expected campaigns of different seeds")
        known[seed] = place
        if difference := settings_difference({**one.settings, "seed": 0}, {**first.settings, "seed": 0}):
            raise CampaignError(f"{place}: has {difference} as in {places[0]}; expected campaigns of one design")
        if one.versions != first.versions:
            raise CampaignError(f"{place}: was run by other versions than {places[0]}; expected the same")
        outcomes += [dataclasses.replace(outcome, number=offset + outcome.number) for outcome in one.outcomes]
        offset += one.settings["trials"]
    outcomes.sort(key=lambda outcome: (outcome.cell, outcome.number))
    settings = first.settings | {"trials": offset}
    campaign = read_campaign(dataclasses.replace(first, settings=settings, outcomes=tuple(outcomes)), places[0])
    return dataclasses.replace(
        campaign,
        seeds=tuple(known),
        started=tuple(one.started for one in stored if one.started),
        commands=tuple(one.command for one in stored if one.command),
    )


def cell_scenario(stored: dict[str, Any], settings: Mapping[str, Any], place: str) -> Scenario:
    """Return the scenario of a campaign with the settings of a cell; its seed is 0.

    Args:   stored: the scenario as plain values, without seed. place: the store, for errors.
    Raises: ScenarioError: the plan that a cell names is missing, or this version refuses a value.
    """
    control = stored.get("control")
    own = control.get("algorithm") if isinstance(control, dict) else None
    algorithm = settings.get("control.algorithm", own)
    known = control_kind(algorithm).model_fields
    overrides = ["run.seed=0"]
    for key, value in settings.items():
        section, _, name = key.partition(".")
        # A design has no value of a key that the algorithm of a cell lacks.
        if value is not None or section != "control" or name.partition(".")[0] in known:
            overrides.append(f"{key}={json.dumps(value)}")
    try:
        return from_mapping(stored, place, overrides)
    except ScenarioError as error:
        raise ScenarioError(f"{place}: {str(error).removeprefix('--set: ').removeprefix(f'{place}: ')}") from None


def _sample(outcomes: Sequence[Outcome], limit_s: float) -> Sample:
    def column(name: str) -> np.ndarray:
        return np.array([getattr(outcome, name) for outcome in outcomes])

    saved_s = [outcome.saved_s for outcome in outcomes]
    return Sample(
        time_s=column("time_s").astype(float),
        finished=np.isin(column("end"), list(COMPLETED)),
        victims_saved=column("victims_saved"),
        areas_explored=column("areas_explored"),
        endangered=column("endangered_links"),
        distance_m=column("distance_m").astype(float),
        numbers=column("number"),
        num_victims=int(column("num_victims")[0]),
        num_areas=int(column("num_areas")[0]),
        limit_s=limit_s,
        networks=tuple(network for outcome in outcomes if (network := outcome.network) is not None),
        saved_s=() if None in saved_s else tuple(times_s for times_s in saved_s if times_s is not None),
        egress=tuple(egress for outcome in outcomes if (egress := outcome.egress) is not None),
    )
