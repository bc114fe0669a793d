"""mission.json: the result of a trial, every event, and everything needed to repeat it."""

import json
import platform
from importlib import metadata
from pathlib import Path
from typing import Any

import msgspec

import robotteamsim
from robotteamsim.errors import RecordingError
from robotteamsim.mission.events import Event
from robotteamsim.recording.files import prepare_folder, remove_empty, write_atomically
from robotteamsim.recording.measures import Measures
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, StepRecord
from robotteamsim.user_files import open_regular

FILE_NAME = "mission.json"

_LIBRARIES = ("numpy", "scipy", "shapely", "pydantic", "rosbags")


_MOST_BYTES = 64 * 2**20


class _Hash(msgspec.Struct, frozen=True):
    trajectory_hash: str


class _Document(msgspec.Struct, frozen=True):
    """The keys of mission.json that repeat a trial."""

    scenario: dict[str, Any]
    result: _Hash


def read_mission(folder: Path) -> tuple[dict[str, Any], str]:
    """Return the scenario, as plain values, and the trajectory hash of the mission.json in a folder.

    Raises: RecordingError: there is none, or it is not one of `ResultWriter`.
    """
    path = folder / FILE_NAME
    reason = f"is larger than {_MOST_BYTES // 2**20} MiB"
    try:
        with open_regular(path) as file:
            text = file.read(_MOST_BYTES + 1)
        if len(text) <= _MOST_BYTES:
            document = msgspec.json.decode(text, type=_Document)
            return document.scenario, document.result.trajectory_hash
    except OSError as error:
        raise RecordingError(
            f"{path}: cannot be read: {error.strerror or error}; expected a folder of `run --out`"
        ) from None
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        reason = str(error)
    raise RecordingError(f"{path}: is not a mission.json of `run --out`: {reason}")


class EventList(Observer):
    """Collects the events of a run."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def begin(self, setup: Setup) -> None:
        """Discard the events of an earlier run."""
        self.events = []

    def step(self, record: StepRecord) -> None:
        """Keep the events of one step."""
        self.events.extend(record.events)


class ResultWriter(EventList):
    """Writes `folder`/mission.json when the mission has ended, completely or not at all."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder
        self._created: list[Path] = []
        self._measures = Measures()

    def begin(self, setup: Setup) -> None:
        """Raises: RecordingError: the folder cannot be written."""
        super().begin(setup)
        self._scenario = setup.scenario
        self._measures.begin(setup)
        self._created = prepare_folder(self._folder)

    def step(self, record: StepRecord) -> None:
        """Keep the events of one step, and measure it."""
        super().step(record)
        self._measures.step(record)

    def end(self, result: Result) -> None:
        """Write the file. Raises: RecordingError."""
        self._measures.end(result)
        document = mission_document(self._scenario, result, self.events) | self._measures.values()
        write_atomically(self._folder / FILE_NAME, json.dumps(document, indent=1, ensure_ascii=False) + "\n")

    def abandon(self) -> None:
        """Remove the folder if it is new and empty."""
        remove_empty(self._created)


def result_summary(result: Result) -> dict[str, Any]:
    """Return a result as plain values for JSON."""
    return {
        **msgspec.structs.asdict(result),
        "robots": [msgspec.structs.asdict(robot) for robot in result.robots],
        "egress": None if result.egress is None else result.egress.values(),
    }


def mission_document(scenario: Scenario, result: Result, events: list[Event]) -> dict[str, Any]:
    """Return the contents of mission.json: result, events in order, versions, and the scenario with every default."""
    return {
        "result": result_summary(result),
        "events": [event.row() for event in events],
        "versions": versions(),
        "scenario": scenario.model_dump(mode="json", by_alias=True),
    }


def versions() -> dict[str, str]:
    """Return the versions of this package, of Python and of the libraries that results depend on."""
    found = {"robotteamsim": robotteamsim.__version__, "python": platform.python_version()}
    for library in _LIBRARIES:
        try:
            found[library] = metadata.version(library)
        except metadata.PackageNotFoundError:
            continue  # Not every library is required: only bags need rosbags.
    return found
