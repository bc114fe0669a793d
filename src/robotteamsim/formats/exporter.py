"""Exporters: what writes scenarios as files of other programs."""

import functools
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pkgutil import resolve_name
from typing import Any, ClassVar

from robotteamsim.formats.options import Options, check_options
from robotteamsim.own_parts import check_texts, class_below, load_parts
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.setup import Setup

ENTRY_POINTS = "robotteamsim.exporters"
"""The group of entry points with which other packages register exporters: `webots = my_package:WebotsExporter`."""


@dataclass(frozen=True, slots=True)
class Exported:
    """What an exporter makes of a scenario.

    text:    of the file; bytes, if it is none.
    summary: what it has, such as "3 robots".
    notes:   what the format lacks, one line each.
    others:  texts of further files in the same folder, by their names without a folder.
    suffix:  of the file, if it is not that of the exporter.
    """

    text: str | bytes
    summary: str
    notes: tuple[str, ...] = ()
    others: Mapping[str, str] = field(default_factory=dict)
    suffix: str = ""


class Exporter(ABC):
    """Writes one format. Its name gives it a command, such as `plan export-gazebo`.

    help:        what the command does, in one line.
    description: the same in its help, and `examples` below its options.
    suffix:      of the file.
    options:     become keywords of `export` and `export_plan`, if they are given.
    """

    help: ClassVar[str]
    suffix: ClassVar[str]
    description: ClassVar[str] = ""
    examples: ClassVar[str] = ""
    options: ClassVar[Options] = {}

    @abstractmethod
    def export(self, setup: Setup, **options: Any) -> Exported:
        """Return the files of a scenario that is ready to run. Raises: RobotTeamSimError: it cannot be exported."""


class PlanExporter(Exporter):
    """Also writes a floor plan without a scenario."""

    @abstractmethod
    def export_plan(self, plan: FloorPlan, **options: Any) -> Exported:
        """Return the file of a floor plan."""


_OURS = {
    "stage": "robotteamsim.stage.formats:StageExporter",
    "gazebo": "robotteamsim.gazebo.formats:GazeboExporter",
    "mujoco": "robotteamsim.formats.mujoco:MujocoExporter",
    "mesh": "robotteamsim.formats.mesh:MeshExporter",
    "open-rmf": "robotteamsim.formats.open_rmf_export:OpenRmfExporter",
}
"""Our exporters, by the places of their classes."""


@functools.cache
def exporters() -> Mapping[str, Exporter]:
    """Return all exporters by name, ours first. One that cannot be used is left out, with a warning."""
    ours: dict[str, Exporter] = {name: resolve_name(place)() for name, place in _OURS.items()}
    return ours | load_parts(ENTRY_POINTS, ours, _checked)


def _checked(name: str, found: Any) -> Exporter:
    """Raises: TypeError, ValueError: it is not the class of an exporter."""
    exporter: Exporter = class_below(Exporter, found, "help", "suffix")()
    check_texts(exporter, "help", "suffix", "description", "examples")
    check_options(exporter.options)
    return exporter
