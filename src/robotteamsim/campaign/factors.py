"""The factors of a campaign, from the command line or a YAML file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import Field

from robotteamsim.errors import CampaignError
from robotteamsim.scenario.base import Many, Model
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.yaml_text import parse, read_mapping

MAX_TRIALS = 1_000_000


@dataclass(frozen=True, slots=True)
class Factor:
    """A dotted key of the scenario and its values, as YAML reads them; `place` names the option or file."""

    key: str
    values: tuple[Any, ...]
    place: str


class DesignFile(Model):
    """A design file."""

    trials: int | None = Field(default=None, ge=1, le=MAX_TRIALS, description="of each cell")
    seed: int | None = Field(default=None, ge=0, le=2**53, description="the seeds of all trials are derived from it")
    paired: bool | None = Field(default=None, description="trials of equal number have the same seed in all cells")
    overrides: dict[str, Any] = Field(default={}, alias="set", description="key: value for all cells")
    sweep: dict[str, Many[Any]] = Field(default={}, description="key: list of values; all combinations are run")
    cells: Many[dict[str, Any]] = Field(
        default=(), description="selected combinations, each a mapping of key: value; combined with the swept keys"
    )


def read_design_file(path: Path) -> DesignFile:
    """Return the design of a YAML file. Raises: ScenarioError, CampaignError: one line with file, key and value."""
    data = read_mapping(path, str(path), "a design")
    return checked(DesignFile, data, CampaignError, f"{path}: ")


def parse_sweep(text: str) -> Factor:
    """Return the factor of KEY=A,B,C. Raises: CampaignError, ScenarioError: not of that form."""
    key, equals, values = (part.strip() for part in text.partition("="))
    if not (key and equals and values):
        raise CampaignError(f"--sweep: '{text}' is not of the form KEY=A,B,C, such as control.alpha=0.3,0.5,0.7")
    # Read as a YAML list, so that commas within brackets and quotes do not separate values.
    return Factor(key, tuple(parse(f"[{values}]", f"--sweep: {key}")), "--sweep")


def parse_override(text: str) -> Factor:
    """Return KEY=VALUE as a factor of one value. Raises: CampaignError, ScenarioError: not of that form."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not (key and equals):
        raise CampaignError(f"--set: '{text}' is not of the form KEY=VALUE, such as voice.noise_db=20")
    return Factor(key, (parse(value, f"--set: {key}"),), "--set")
