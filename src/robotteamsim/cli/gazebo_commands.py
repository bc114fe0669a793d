"""`robotteamsim plan export-gazebo` and `plan import-gazebo`: convert worlds of the Gazebo simulator."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.parser import SCENARIO_HELP, UsageError, path_of
from robotteamsim.cli.run_command import add_set_option
from robotteamsim.recording.files import atomically, prepare_folder, write_atomically
from robotteamsim.wording import counted

_EXPORT_TEXT = """\
Write a scenario as a world of Gazebo 11 (SDF): floor, walls, doors with joints, objects, and
robots with their laser and the plugin that drives them. docs/gazebo.md describes the models."""

_EXPORT_EXAMPLES = """\
examples:
  robotteamsim plan export-gazebo garage_sar --out DIR       DIR/garage_sar.world
  gazebo --verbose DIR/garage_sar.world"""

_IMPORT_TEXT = """\
Convert the static models of a Gazebo world (SDF) to a floor plan: upright boxes become walls,
other boxes, cylinders and polylines become blocks. A warning names each other shape, such as
a mesh, and each model that is not static."""

_IMPORT_EXAMPLES = """\
examples:
  robotteamsim plan import-gazebo house.world --out plan.yaml
  robotteamsim plan import-gazebo house.world --models DIR --strict"""

_MODEL_PATH = "GAZEBO_MODEL_PATH"


def add_to(actions: Any) -> None:
    """Add the commands to the parser of `plan`."""
    import_parser = actions.add_parser(
        "import-gazebo",
        help="convert a Gazebo world to a floor plan",
        description=_IMPORT_TEXT,
        epilog=_IMPORT_EXAMPLES,
    )
    import_parser.add_argument("world", type=path_of, metavar="WORLD.sdf", help="the world file")
    import_parser.add_argument(
        "--out", type=path_of, metavar="FILE", help="the floor plan to write; default plan.yaml, if that does not exist"
    )
    import_parser.add_argument(
        "--models",
        type=path_of,
        action="append",
        default=[],
        metavar="DIR",
        help=f"folder of included models, before those in {_MODEL_PATH}; may be repeated",
    )
    import_parser.add_argument(
        "--strict", action="store_true", help="reject a world with shapes that cannot become walls"
    )
    import_parser.set_defaults(command=import_gazebo)

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


def import_gazebo(options: argparse.Namespace) -> None:
    """Import a Gazebo world."""
    from robotteamsim.gazebo import import_world

    out = options.out or Path("plan.yaml")
    if options.out is None and out.exists():
        raise UsageError(f"{out} already exists; choose a file with --out")
    if os.path.realpath(out) == os.path.realpath(options.world):
        raise UsageError(f"--out {out}: would overwrite the world")
    for folder in options.models:
        if not folder.is_dir():
            raise UsageError(f"--models {folder}: there is no such folder")
    searched = [Path(folder) for folder in os.environ.get(_MODEL_PATH, "").split(os.pathsep) if folder]
    found = import_world(options.world, [*options.models, *searched], strict=options.strict)
    _warn(found.notes)
    with atomically(out) as part:
        scenario.write_floor_plan(found.plan, part)
    plan = found.plan
    counts = (len(plan.walls), "wall"), (len(plan.blocks), "block"), (len(plan.doors), "door")
    print(f"{out}: {', '.join(counted(*count) for count in counts)}")


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
