"""`robotteamsim plan export-gazebo` and `plan import-gazebo`: convert worlds of the Gazebo simulator."""

import argparse
import os
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.converting import add_export_options, add_plan_option, plan_file, warn
from robotteamsim.cli.parser import UsageError, path_of
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
    add_plan_option(import_parser)
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
    add_export_options(export_parser, "the world")
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

    out = plan_file(options.out, options.world, "world")
    for folder in options.models:
        if not folder.is_dir():
            raise UsageError(f"--models {folder}: there is no such folder")
    searched = [Path(folder) for folder in os.environ.get(_MODEL_PATH, "").split(os.pathsep) if folder]
    found = import_world(options.world, [*options.models, *searched], strict=options.strict)
    warn(found.notes)
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
    warn(export.notes)
    prepare_folder(options.out)
    for name, text in export.absent.items():
        write_atomically(options.out / f"{name}.sdf", text)
    # The scenario's own name may not be a valid file name.
    world = options.out / f"{Path(options.scenario).stem}.world"
    write_atomically(world, export.world)
    present = model.num_robots - len(export.absent)
    print(f"{world}: {counted(present, 'robot')}, {counted(len(model.plan.doors), 'door')}")
