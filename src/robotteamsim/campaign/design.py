"""The design of a campaign: cells, which are settings of a scenario, and the trials of each, with their seeds."""

import hashlib
import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robotteamsim import rng, scenario
from robotteamsim.campaign.factors import MAX_TRIALS, Factor
from robotteamsim.control import foreign_code
from robotteamsim.errors import CampaignError, RobotTeamSimError, ScenarioError
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.yaml_text import shown
from robotteamsim.setup import check_headless, resolve
from robotteamsim.simulation.controllers import TeamControllers, check_constructed

NOISE_KEY = "voice.noise_db"

_NUM_SEEDS = 2**53
_SHOWN_VALUE = 24


@dataclass(frozen=True, slots=True)
class Cell:
    """One combination of settings.

    values:   of the design's keys, in their order: plain values as in the checked scenario.
    scenario: with these settings; its own seed is not used.
    """

    values: tuple[Any, ...]
    scenario: Scenario


@dataclass(frozen=True, slots=True)
class Trial:
    """One mission of a campaign: `cell` counts from 0, `number` within the cell from 1."""

    cell: int
    number: int
    seed: int


@dataclass(frozen=True, slots=True)
class Design:
    """All cells, with `trials` trials of each.

    keys:   those whose values differ between cells.
    paired: whether trials of equal number have the same seed in all cells.
    """

    scenario: Scenario
    seed: int
    trials: int
    keys: tuple[str, ...]
    cells: tuple[Cell, ...]
    paired: bool = False

    def all_trials(self) -> Iterator[Trial]:
        """Yield every trial: the first of each cell, then the second of each cell, and so on."""
        for number in range(1, self.trials + 1):
            for index, cell in enumerate(self.cells):
                yield Trial(index, number, self._trial_seed(cell, number))

    def settings(self) -> dict[str, Any]:
        """Return everything that determines the results, as plain values for JSON."""
        contents = json.dumps([_without_seed(cell.scenario) for cell in self.cells], sort_keys=True)
        return {
            "seed": self.seed,
            "trials": self.trials,
            "paired": self.paired,
            "keys": list(self.keys),
            "cells": [list(cell.values) for cell in self.cells],
            "scenario": _without_seed(self.scenario),
            # Of the complete cells: their values do not contain the contents of files that they name.
            "fingerprint": hashlib.sha256(contents.encode()).hexdigest(),
        }

    def _trial_seed(self, cell: Cell, number: int) -> int:
        # A cell is identified by its settings: its seeds do not depend on the other cells.
        values = () if self.paired else zip(self.keys, cell.values, strict=True)
        named = sorted(f"{key}={json.dumps(value)}" for key, value in values)
        return int(rng.stream(self.seed, "campaign", *named, number).integers(_NUM_SEEDS))


def make_design(
    scenario_name: str,
    *,
    trials: int,
    seed: int = 1,
    overrides: Sequence[Factor] = (),
    factors: Sequence[Factor] = (),
    groups: Sequence[Sequence[Factor]] = ((),),
    paired: bool = False,
    allow_code: bool = True,
) -> Design:
    """Return the design of all combinations of the factors' values, each with every group; all cells are checked.

    Args:   scenario_name: a file or a shipped name.
            overrides: with one value each, for all cells; the last one of a key counts.
            groups: selected combinations, each of factors with one value.
            paired: trials of equal number have the same seed in all cells.
            allow_code: whether a controller that a file names as module:Class may run.
    Raises: CampaignError, ScenarioError: one line with place, key and value.
    """
    keys = _checked_keys(overrides, factors, groups)
    if trials < 1:
        raise CampaignError(f"--trials: {trials} is below 1")
    num_trials = trials * len(groups) * math.prod(len(factor.values) for factor in factors)
    if num_trials > MAX_TRIALS:
        raise CampaignError(f"{num_trials} trials in all; expected at most {MAX_TRIALS}")
    if not 0 <= seed < _NUM_SEEDS:
        raise CampaignError(f"--seed: {seed} is not between 0 and 2^53")
    base = _load(scenario_name, overrides)
    checked: set[str] = set()
    cells: dict[str, Cell] = {}
    for group in groups:
        for values in itertools.product(*(factor.values for factor in factors)):
            chosen = [Factor(factor.key, (value,), factor.place) for factor, value in zip(factors, values, strict=True)]
            settings = [*overrides, *group, *chosen]
            loaded = _load(scenario_name, settings)
            data, given = loaded.model_dump(mode="json", by_alias=True), {s.key: s.values[0] for s in settings}
            cell = Cell(tuple(_value_at(data, key, given.get(key)) for key in keys), loaded)
            if cell.scenario.control.algorithm not in checked:
                _check_algorithm(cell.scenario, settings, allow_code)
                checked.add(cell.scenario.control.algorithm)
            name = json.dumps(cell.values)
            if name in cells:
                place = (chosen or group)[-1].place
                said = ", ".join(f"{key}={shown(value)}" for key, value in zip(keys, cell.values, strict=True))
                raise CampaignError(f"{place}: duplicate cell: {said or 'no settings'}")
            cells[name] = cell
    return Design(base, seed, trials, keys, tuple(cells.values()), paired)


def _checked_keys(
    overrides: Sequence[Factor], factors: Sequence[Factor], groups: Sequence[Sequence[Factor]]
) -> tuple[str, ...]:
    """Return all varied keys, in order. Raises: CampaignError: a key is given twice, or is the seed."""
    varied: dict[str, str] = {}
    for group in groups:
        for factor in group:
            varied[factor.key] = factor.place
    for factor in factors:
        if not factor.values:
            raise CampaignError(f"{factor.place}: {factor.key}: no values")
        if factor.key in varied:
            raise CampaignError(f"{factor.place}: {factor.key}: already varied by {varied[factor.key]}")
        varied[factor.key] = factor.place
    for factor in overrides:
        if factor.key in varied:
            raise CampaignError(f"{factor.place}: {factor.key}: already varied by {varied[factor.key]}")
    for key, place in {**{factor.key: factor.place for factor in overrides}, **varied}.items():
        if key in ("run", "run.seed"):
            raise CampaignError(f"{place}: {key}: not allowed: the seed of each trial is derived from --seed")
    return tuple(varied)


def _load(scenario_name: str, settings: Sequence[Factor]) -> Scenario:
    try:
        loaded = scenario.load(scenario_name, [f"{s.key}={json.dumps(s.values[0])}" for s in settings])
        resolve(loaded)
        check_headless(loaded)
        return loaded
    except ScenarioError as error:
        message = str(error).removeprefix("--set: ")
        if message == str(error):
            raise
        key = message.partition(": ")[0]
        # The error may concern a key within the one that was set, or a section that contains it.
        matching = [s for s in settings if f"{key}.".startswith(f"{s.key}.") or s.key.startswith(f"{key}.")]
        place = matching[-1].place if matching else "--set"
        raise CampaignError(f"{place}: {message}") from None


def _check_algorithm(of: Scenario, settings: Sequence[Factor], allow_code: bool) -> None:
    """Raise CampaignError if a controller does not exist or cannot be constructed: every trial would be useless."""
    matching = [s for s in settings if s.key in foreign_code.KEYS]
    if not allow_code:
        place = matching[-1].place if matching else of.origin.place
        foreign_code.check_foreign(of.control.algorithm, place, "--allow-code")
    try:
        check_constructed(TeamControllers(resolve(of)), of)
    except RobotTeamSimError as error:
        message = str(error).removeprefix(f"{of.name}: ").removeprefix(f"{of.origin.place}: ")
        raise CampaignError(f"{matching[-1].place if matching else of.name}: {message}") from None


def _value_at(data: Any, key: str, default: Any) -> Any:
    """Return the value at a dotted key; for `plan` its name instead of its contents."""
    if key == "plan":
        return default
    for part in key.split("."):
        try:
            data = data[int(part)] if isinstance(data, list) else data[part]
        except (KeyError, IndexError, ValueError, TypeError):
            return default
    return data


def _without_seed(of: Scenario) -> dict[str, Any]:
    data = of.model_dump(mode="json", by_alias=True)
    data["run"].pop("seed")
    return data


def cell_name(settings: Mapping[str, Any], scenario_name: str) -> str:
    """Return the settings of a cell in short: the noise with its unit, other keys by their last part.

    Of keys that end alike, such as `radio.exponent` and `voice.exponent`, the whole key. Without settings, the name of
    the scenario.
    """
    ends = [key.rpartition(".")[2] for key in settings]
    words = []
    for (key, value), end in zip(settings.items(), ends, strict=True):
        short = end if ends.count(end) == 1 else key
        is_noise = key == NOISE_KEY and isinstance(value, (int, float))
        words.append(f"{value:g} dB" if is_noise else f"{short} = {setting_text(value)}")
    return ", ".join(words) or scenario_name


def setting_text(value: Any) -> str:
    """Return the value of a setting: a name in full; long lists without their middle, so that their ends differ."""
    if isinstance(value, str):
        return value
    text, end = shown(value), (_SHOWN_VALUE - 3) // 2
    return text if len(text) <= _SHOWN_VALUE else f"{text[:end]}...{text[-end:]}"


def settings_difference(old: Mapping[str, Any], new: Mapping[str, Any]) -> str | None:
    """Return the first difference of two `Design.settings` as "key = old, not new"; None if they are equal."""
    flat_old, flat_new = dict(_flat(old)), dict(_flat(new))
    keys = [key for key in (*flat_new, *flat_old) if flat_old.get(key) != flat_new.get(key)]
    if not keys:
        return None
    key = keys[0]
    texts = [shown(flat[key]) if key in flat else "nothing" for flat in (flat_old, flat_new)]
    return f"{key.removeprefix('scenario.')} = {texts[0]}, not {texts[1]}"


def _flat(data: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield all plain values with their dotted keys; lists of plain values count as one value."""
    if isinstance(data, dict) and data:
        for part, value in data.items():
            yield from _flat(value, f"{key}.{part}" if key else str(part))
    elif isinstance(data, list) and any(isinstance(item, dict) for item in data):
        for index, value in enumerate(data):
            yield from _flat(value, f"{key}.{index}")
    else:
        yield key, data
