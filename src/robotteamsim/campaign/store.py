"""The store of a campaign: one SQLite file, written by one process, row by row as trials end."""

import contextlib
import csv
import dataclasses
import datetime
import io
import json
import os
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, get_args

import msgspec
from filelock import FileLock, Timeout

import robotteamsim
from robotteamsim.campaign.design import Design, Trial, settings_difference
from robotteamsim.campaign.factors import MAX_TRIALS
from robotteamsim.campaign.trial import Count, Outcome
from robotteamsim.errors import CampaignError, ScenarioError
from robotteamsim.mission.status import MissionEnd
from robotteamsim.recording.files import PART, atomically, prepare_folder, write_atomically
from robotteamsim.recording.network_log import NetworkTotals
from robotteamsim.recording.results import versions
from robotteamsim.scenario.yaml_text import check_depth, shown
from robotteamsim.wording import counted, safe_cell

STORE_NAME = "campaign.sqlite"
CSV_NAME = "trials.csv"
_LOCK_NAME = ".lock"
_OUR_FILES = {STORE_NAME, f"{STORE_NAME}-wal", f"{STORE_NAME}-shm", CSV_NAME, _LOCK_NAME}

_FORMAT = 4
_APPLICATION_ID = 0x52545343  # "RTSC" identifies our databases.
_COLUMNS = tuple(field.name for field in dataclasses.fields(Outcome))
_OF_ENDED = (
    *("end", "time_s", "areas_explored", "num_areas", "victims_saved", "num_victims", "endangered_links"),
    *("distance_m", "contact_s", "steps", "trajectory_hash", "details"),
)
"""What each trial that has not failed has."""
_LARGEST_VALUE = 256 * 2**20
"""Of a text or of paths [bytes]."""
_SCHEMA = f"""
PRAGMA application_id = {_APPLICATION_ID};
CREATE TABLE campaign (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE trial (
  cell INTEGER, number INTEGER, seed INTEGER, "end" TEXT, time_s REAL, areas_explored INTEGER, num_areas INTEGER,
  victims_saved INTEGER, num_victims INTEGER, endangered_links INTEGER, discoveries_delivered INTEGER,
  mean_delivery_delay_s REAL, max_delivery_delay_s REAL, distance_m REAL, contact_s REAL, steps INTEGER,
  trajectory_hash TEXT, details TEXT, paths BLOB, controller_failed TEXT NOT NULL, error TEXT NOT NULL,
  traceback TEXT NOT NULL, wall_s REAL NOT NULL,
  PRIMARY KEY (cell, number)
);
"""

_SELECT = "SELECT * FROM trial ORDER BY cell, number"
_INSERT = f"INSERT INTO trial VALUES ({', '.join('?' * len(_COLUMNS))})"

# trials.csv does not contain values that differ between equal trials, and documents.
_CSV_COLUMNS = tuple(name for name in _COLUMNS if name not in ("cell", "details", "paths", "traceback", "wall_s"))

_NETWORK_COLUMNS = NetworkTotals.__struct_fields__


@dataclass(frozen=True, slots=True)
class StoredCampaign:
    """The contents of a store.

    settings: `Design.settings`.     versions: of the program and libraries that started the campaign.
    outcomes: of the trials that are done, by cell, then number.
    started:  date of its start, as YYYY-MM-DD.
    command:  command line that runs it; "" if it was not run by the command line.
    """

    settings: dict[str, Any]
    versions: dict[str, str]
    outcomes: tuple[Outcome, ...]
    started: str
    command: str = ""


class _Settings(msgspec.Struct, frozen=True):
    """`Design.settings`."""

    seed: Count
    trials: Annotated[int, msgspec.Meta(ge=1, le=MAX_TRIALS)]
    keys: list[str]
    cells: list[list[Any]]
    scenario: dict[str, Any]
    fingerprint: str
    paired: bool


class _Properties(msgspec.Struct, frozen=True):
    """The table `campaign`."""

    format: str
    settings: str
    versions: str
    started: str
    command: str = ""


class Store:
    """The store of a folder, open for writing; use `open_store`."""

    def __init__(self, folder: Path, design: Design, database: sqlite3.Connection) -> None:
        self._folder, self._design, self._database = folder, design, database

    def outcomes(self) -> tuple[Outcome, ...]:
        """Return the stored outcomes, by cell, then number. Raises: CampaignError."""
        with _as_campaign_errors(self._folder / STORE_NAME):
            return _outcomes(self._database)

    def missing(self) -> list[Trial]:
        """Return the missing trials, in order. Raises: CampaignError."""
        done = {(outcome.cell, outcome.number) for outcome in self.outcomes()}
        return [trial for trial in self._design.all_trials() if (trial.cell, trial.number) not in done]

    def keep(self, outcome: Outcome) -> None:
        """Store an outcome durably. Raises: CampaignError: a full disk, for example."""
        with _as_campaign_errors(self._folder / STORE_NAME), self._database:
            self._database.execute(_INSERT, dataclasses.astuple(outcome))

    def export(self) -> Path:
        """Write trials.csv and return its path; equal results give equal bytes. Raises: RecordingError."""
        path = self._folder / CSV_NAME
        write_atomically(path, trials_csv(self._design, self.outcomes()))
        return path


def check_folder(folder: Path, design: Design) -> None:
    """Check, without changing anything, that `open_store` can succeed. Raises: CampaignError."""
    if (folder / STORE_NAME).exists():
        _check_same(folder, read_store(folder), design)
    elif folder.exists():
        _check_ours(folder)
    else:
        parent = next(parent for parent in folder.absolute().parents if parent.exists())
        if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
            reason = "is not a folder" if not parent.is_dir() else "cannot be written"
            raise CampaignError(f"{folder}: cannot be created: {parent} {reason}")


@contextlib.contextmanager
def open_store(folder: Path, design: Design, command: str = "") -> Iterator[Store]:
    """Open the store of a folder for a design, or create it; the design may have more trials per cell than before.

    Args:   command: command line that runs this campaign, for its report.
    Raises: CampaignError: the folder contains something else, another campaign, or one that is running now;
            the message names the difference. RecordingError: the folder cannot be written.
    """
    check_folder(folder, design)
    prepare_folder(folder)
    path = folder / STORE_NAME
    with _locked(folder):
        with _as_campaign_errors(path):
            if not path.exists():
                _make(path, design)
            _check_same(folder, read_store(folder), design)
            database = sqlite3.connect(path)
        with contextlib.closing(database):
            with _as_campaign_errors(path):
                # The design may have more trials than before.
                with database:
                    changed = {"settings": json.dumps(design.settings())} | ({"command": command} if command else {})
                    database.executemany("INSERT OR REPLACE INTO campaign VALUES (?, ?)", changed.items())
                database.execute("PRAGMA journal_mode = WAL")
                # A stored row survives a power failure.
                database.execute("PRAGMA synchronous = FULL")
            yield Store(folder, design, database)


def read_store(folder: Path) -> StoredCampaign:
    """Return the contents of a folder's store, also while it grows. Raises: CampaignError: there is no store."""
    path = folder / STORE_NAME
    if not path.is_file():
        raise CampaignError(f"{folder}: contains no campaign: there is no {STORE_NAME}")
    with _as_campaign_errors(path), contextlib.closing(sqlite3.connect(path)) as database:
        if database.execute("PRAGMA application_id").fetchone()[0] != _APPLICATION_ID:
            raise CampaignError(f"{path}: is not the store of a campaign")
        _check_tables(database, path)
        rows = dict(database.execute("SELECT name, value FROM campaign").fetchall())
        with _named("campaign"):
            properties = msgspec.convert(rows, _Properties)
        if (number := properties.format) != str(_FORMAT):
            raise CampaignError(f"{path}: has format {number:.40}; expected {_FORMAT}: choose another folder")
        with _named("settings"):
            settings = msgspec.json.decode(properties.settings, type=_Settings)
            check_depth(settings.scenario, "scenario")
            check_depth(settings.cells, "cells")
        with _named("versions"):
            of_versions = msgspec.json.decode(properties.versions, type=dict[str, str])
        if "robotteamsim" not in of_versions:
            raise CampaignError(f"{path}: versions: robotteamsim is missing")
        for index, values in enumerate(settings.cells):
            if len(values) != len(settings.keys):
                counts = f"{counted(len(values), 'value')} for {counted(len(settings.keys), 'key')}"
                raise CampaignError(f"{path}: settings: cell {index} has {counts}")
        outcomes = _outcomes(database)
        for outcome in outcomes:
            if outcome.cell >= len(settings.cells):
                raise CampaignError(f"{path}: trial: there is no cell {outcome.cell}")
            if not 1 <= outcome.number <= settings.trials:
                place = f"trial {outcome.number} of cell {outcome.cell}"
                raise CampaignError(f"{path}: {place}: expected 1 to {settings.trials}")
        return StoredCampaign(
            msgspec.to_builtins(settings), of_versions, outcomes, properties.started, properties.command
        )


def trials_csv(design: Design, outcomes: tuple[Outcome, ...]) -> str:
    """Return a table with one line per trial: the cell's settings, the trial's number and results."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ("trial" if name == "number" else name for name in _CSV_COLUMNS)
    writer.writerow([*design.keys, *names, *_NETWORK_COLUMNS])
    for outcome in outcomes:
        settings = design.cells[outcome.cell].values
        values = [value if isinstance(value, str) else json.dumps(value) for value in settings]
        totals, network = [getattr(outcome, name) for name in _CSV_COLUMNS], outcome.network
        networks = [getattr(network, name, None) for name in _NETWORK_COLUMNS]
        writer.writerow(map(safe_cell, (*values, *totals, *networks)))
    return text.getvalue()


def _make(path: Path, design: Design) -> None:
    """Create a store with all its settings, or none at all."""
    with atomically(path) as part, contextlib.closing(sqlite3.connect(part)) as database:
        database.executescript(_SCHEMA)
        rows = {
            "format": _FORMAT,
            "settings": json.dumps(design.settings()),
            "versions": json.dumps(versions()),
            "started": datetime.date.today().isoformat(),
        }
        with database:
            database.executemany("INSERT INTO campaign VALUES (?, ?)", rows.items())


def _check_ours(folder: Path) -> None:
    if not folder.is_dir():
        raise CampaignError(f"{folder}: is not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise CampaignError(f"{folder}: cannot be written")
    others = sorted(name for name in os.listdir(folder) if name not in _OUR_FILES and not name.startswith(PART))
    if others:
        raise CampaignError(f"{folder}: contains '{others[0]}' and no campaign; expected a new or an empty folder")


def _check_same(folder: Path, stored: StoredCampaign, design: Design) -> None:
    old, new = stored.versions["robotteamsim"], robotteamsim.__version__
    if old != new:
        raise CampaignError(f"{folder}: contains a campaign of version {old}, not {new}; choose another folder")
    # Compare as JSON, where tuples are lists.
    wanted = json.loads(json.dumps(design.settings()))
    known = stored.settings
    if known["trials"] <= design.trials:
        known = known | {"trials": design.trials}
    difference = settings_difference(known, wanted)
    if difference:
        raise CampaignError(f"{folder}: contains a campaign with {difference}; choose another folder")


def _check_tables(database: sqlite3.Connection, path: Path) -> None:
    """Raise CampaignError unless the store has its two tables. They are no views, which may compute without an end."""
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LARGEST_VALUE)
    for name in ("campaign", "trial"):
        found = database.execute("SELECT type, rootpage FROM sqlite_master WHERE name = ?", (name,)).fetchall()
        if [(kind, page > 0) for kind, page in found] != [("table", True)]:  # a virtual table has no page
            raise CampaignError(f"{path}: has no table {name}")


def _outcomes(database: sqlite3.Connection) -> tuple[Outcome, ...]:
    """Return the stored outcomes. Raises: ValueError: a value is missing, or has a wrong type or range."""
    rows = database.execute(_SELECT)
    if len(rows.description) != len(_COLUMNS):
        raise ValueError(f"trial: {len(rows.description)} columns; expected {len(_COLUMNS)}")
    return tuple(_outcome(row) for row in rows)


def _outcome(row: tuple[Any, ...]) -> Outcome:
    with _named(f"trial {shown(row[1])} of cell {shown(row[0])}"):
        values = dict(zip(_COLUMNS, row, strict=True))
        outcome = msgspec.convert(values, Outcome)
        if not outcome.failed:
            missing = [name for name in _OF_ENDED if values[name] is None]
            if missing:
                raise ValueError(f"{missing[0]} is missing")
            _check_values(outcome)
            _ = outcome.known_details
        return outcome


def _check_values(outcome: Outcome) -> None:
    """Raises: ValueError: values of a trial that no mission has."""
    if outcome.end not in get_args(MissionEnd):
        raise ValueError(f"end: {shown(outcome.end)} is not valid; expected one of {', '.join(get_args(MissionEnd))}")
    for part, whole in (("areas_explored", "num_areas"), ("victims_saved", "num_victims")):
        if getattr(outcome, part) > getattr(outcome, whole):
            raise ValueError(f"{part}: {getattr(outcome, part)} is above {whole}, {getattr(outcome, whole)}")


@contextlib.contextmanager
def _named(part: str) -> Iterator[None]:
    """Name the damaged part of a store. Raises: ValueError."""
    try:
        yield
    except (ScenarioError, msgspec.MsgspecError, ValueError, RecursionError) as error:
        raise ValueError(f"{part}: {error}") from error


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Lock the folder against other campaigns. The system releases the lock when the process ends."""
    try:
        with FileLock(folder / _LOCK_NAME, blocking=False):
            yield
    except Timeout:
        raise CampaignError(f"{folder}: another process is running this campaign") from None


@contextlib.contextmanager
def _as_campaign_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except (sqlite3.Error, ValueError) as error:
        raise CampaignError(f"{path}: {error}") from error
