"""`robotteamsim plan export-gazebo`: write worlds of the Gazebo simulator."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.parser import SCENARIO_HELP, path_of
from robotteamsim.cli.run_command import add_set_option
from robotteamsim.recording.files import prepare_folder, write_atomically
from robotteamsim.wording import counted

_EXPORT_TEXT = """\
Write a scenario as a world of Gazebo 11 (SDF): floor, walls, doors with joints, objects, and
robots with their laser and the plugin that drives them. docs/gazebo.md describes the models."""

_EXPORT_EXAMPLES = """\
examples:
  robotteamsim plan export-gazebo garage_sar --out DIR       DIR/garage_sar.world
  gazebo --verbose DIR/garage_sar.world"""


def add_to(actions: Any) -> None:
    """Add the commands to the parser of `plan`."""
    export_parser = actions.add_parser(
        "export-gazebo", help="write a scenario as a Gazebo world", description=_EXPORT_TEXT, epilog=_EXPORT_EXAMPLES
    )
    export_parser.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    add_set_option(export_parser)
    export_parser.add_argument("--out", type=path_of, required=True, metavar="DIR", help="where to write the world")
    export_parser.add_argument(
        "--drive",
        choices=("velocity", "wheels"),
        default="velocity",
        help="how robots with a differential drive move; default %(default)s",
    )
    export_parser.set_defaults(command=export_gazebo)


def export_gazebo(options: argparse.Namespace) -> None:
    """Export a scenario to Gazebo."""
    from robotteamsim.gazebo import export_world

    model = scenario.load(options.scenario, options.overrides)
    export = export_world(model, options.drive)
    _warn(export.notes)
    prepare_folder(options.out)
    for name, text in export.absent.items():
        write_atomically(options.out / f"{name}.sdf", text)
    # The scenario's own name may not be a valid file name.
    world = options.out / f"{Path(options.scenario).stem}.world"
    write_atomically(world, export.world)
    present = model.num_robots - len(export.absent)
    print(f"{world}: {counted(present, 'robot')}, {counted(len(model.plan.doors), 'door')}")


def _warn(notes: Sequence[str]) -> None:
    for note in notes:
        print(f"robotteamsim: warning: {note}", file=sys.stderr)
