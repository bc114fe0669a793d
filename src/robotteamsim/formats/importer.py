"""Importers: what reads the files of other programs as floor plans and scenarios, chosen by suffix and content."""

import functools
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, ClassVar

from robotteamsim.errors import RobotTeamSimError, ScenarioError
from robotteamsim.extras import missing_extra
from robotteamsim.formats.options import Options, check_options
from robotteamsim.own_parts import check_texts, class_below, load_parts
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.map_image import DrawingRules, MapImage
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.user_files import open_regular
from robotteamsim.wording import counted, described, place_of
from robotteamsim.world.floor_parts import FloorPart

ENTRY_POINTS = "robotteamsim.importers"
"""The group of entry points with which other packages register importers: `gbxml = my_package:GbxmlImporter`."""


@dataclass(frozen=True, slots=True)
class Imported:
    """What an importer makes of a file.

    plan:     the floor plan.
    notes:    one line each: what was guessed, left out or is interpreted differently.
    keys:     the scenario's keys as in YAML, without `plan`; none if the file has only a building.
    scenario: the same, checked.
    summary:  the size of the import; by default, numbers of walls and blocks.
    files:    what was read besides the file itself.
    parts:    of the floor, the largest first, if doors between them may be missing.
    image:    from which the plan was made, and by which rules.
    tables:   texts in YAML that the user corrects for another import, by name: plan.NAME.yaml is next to plan.yaml.
    """

    plan: FloorPlan
    notes: tuple[str, ...] = ()
    keys: Mapping[str, Any] = field(default_factory=dict)
    scenario: Scenario | None = None
    summary: str = ""
    files: tuple[Path, ...] = ()
    parts: tuple[FloorPart, ...] = ()
    image: tuple[MapImage, DrawingRules] | None = None
    tables: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """Return the summary."""
        return self.summary or f"{counted(len(self.plan.walls), 'wall')}, {counted(len(self.plan.blocks), 'block')}"


class Importer(ABC):
    """Reads one format. `plan import` describes it and takes its options.

    noun:     what a file of it is, such as "a world of Stage".
    suffixes: of such files, in lower case.
    sign:     a regular expression (MULTILINE, DOTALL) that is found only in texts of this format; None: not a text.
    makes_scenarios: whether a file may have robots; then a folder with a scenario and its plan is written.
    options:  become keywords of `read`, if they are given.
    examples: lines for the help.
    """

    noun: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]
    sign: ClassVar[str | None] = None
    makes_scenarios: ClassVar[bool] = False
    options: ClassVar[Options] = {}
    examples: ClassVar[str] = ""

    @abstractmethod
    def read(self, path: Path, **options: Any) -> Imported:
        """Return the contents of a file.

        Raises: ScenarioError: one line with file, place and what was expected; its notes are further mistakes.
        """

    def recognises(self, text: str) -> bool:
        """Whether only this format has such a text."""
        return self.sign is not None and re.search(self.sign, text, re.MULTILINE | re.DOTALL) is not None


_OURS = {
    "image": "robotteamsim.formats.image:ImageImporter",
    "cad": "robotteamsim.formats.cad:CadImporter",
    "stage": "robotteamsim.stage.formats:StageImporter",
    "open_rmf": "robotteamsim.formats.open_rmf:OpenRmfImporter",
    "ifc": "robotteamsim.formats.ifc:IfcImporter",
}
"""Our importers, by the places of their classes."""


@functools.cache
def importers() -> Mapping[str, Importer]:
    """Return all importers by name, ours first. One that cannot be used is left out, with a warning."""
    ours: dict[str, Importer] = {name: resolve_name(place)() for name, place in _OURS.items()}
    taken = {option: settings for importer in ours.values() for option, settings in importer.options.items()}

    def checked(name: str, found: Any) -> Importer:
        importer: Importer = class_below(Importer, found, "noun", "suffixes")()
        if isinstance(importer.suffixes, str):
            raise TypeError(f"suffixes {importer.suffixes!r:.40}; expected a tuple")
        check_texts(importer, "noun", "examples")
        importer.recognises("")
        check_options(importer.options)
        for option, settings in importer.options.items():
            if taken.setdefault(option, settings) != settings:
                raise ValueError(f"option {option} is that of another importer, with other settings")
        return importer

    return ours | load_parts(ENTRY_POINTS, ours, checked)


def read_with(importer: Importer, path: Path, **options: Any) -> Imported:
    """Return the contents of a file.

    Raises: ScenarioError: as `Importer.read`; any other error as one line.
            ModuleNotFoundError: an extra is not installed; see `robotteamsim.extras`.
    """
    what = f"{path}: {type(importer).__qualname__}"
    try:
        found = importer.read(path, **options)
    except (RobotTeamSimError, KeyboardInterrupt):
        raise
    except BaseException as error:  # of a user's class
        if isinstance(error, ModuleNotFoundError) and missing_extra(error):
            raise
        raise ScenarioError(f"{what}: {described(error)} ({place_of(error)[1]})") from error
    if not isinstance(found, Imported) or isinstance(found.notes, str):
        raise ScenarioError(f"{what}: returns {found!r:.60}; expected an Imported whose notes are a tuple")
    return found


def importer_of(path: Path, known: Iterable[Importer]) -> Importer:
    """Return the importer of a file by its suffix, and by its content if several have the suffix, or none has.

    Raises: ScenarioError: there is none, or the file cannot be read.
    """
    known = tuple(known)
    of_suffix = [importer for importer in known if path.suffix.lower() in importer.suffixes]
    if len(of_suffix) == 1:
        return of_suffix[0]
    text = _begin(path)
    recognised = [importer for importer in of_suffix or known if importer.recognises(text)]
    if found := [*recognised, *of_suffix]:
        return found[0]
    suffixes = ", ".join(sorted({suffix for importer in known for suffix in importer.suffixes}))
    raise ScenarioError(f"{path}: no importer reads this file; expected one of {suffixes}")


def _begin(path: Path) -> str:
    """Return the begin of a file as text. Raises: ScenarioError: it cannot be read."""
    try:
        with open_regular(path) as file:
            return file.read(_BEGIN_BYTES).decode(errors="replace")
    except FileNotFoundError:
        raise ScenarioError(f"{path}: there is no such file") from None
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror or error}") from None


_BEGIN_BYTES = 2**20
"""Of a file, in which the sign of its format is looked for."""
