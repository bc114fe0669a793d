"""`robotteamsim plan import-stage` and `plan export-stage`: convert worlds of the Stage simulator."""

import argparse
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.converting import add_export_options, warn
from robotteamsim.cli.parser import UsageError, path_of, positive_number
from robotteamsim.recording.files import atomically, prepare_folder
from robotteamsim.scenario.plan_export import RESOLUTION_M
from robotteamsim.scenario.yaml_text import write
from robotteamsim.wording import counted

_IMPORT_TEXT = """\
Convert a Stage world to a scenario and its floor plan: models with a bitmap, blocks or a
boundary become walls and blocks, position models with a ranger become robots. A warning is
printed for each setting that is converted differently; docs/stage.md lists what is supported."""

_IMPORT_EXAMPLES = """\
examples:
  robotteamsim plan import-stage office.world                office/office.yaml, office/plan.yaml
  robotteamsim plan import-stage office.world --out DIR && robotteamsim run DIR/office.yaml"""

_EXPORT_TEXT = """\
Write a scenario as a Stage world with a bitmap of its walls and closed doors, for stage_ros:
the same controllers then drive the same robots in Stage."""

_EXPORT_EXAMPLES = """\
examples:
  robotteamsim plan export-stage garage_sar --out DIR        DIR/garage_sar.world, DIR/garage_sar.png
  rosrun stage_ros stageros DIR/garage_sar.world"""


def add_to(actions: Any) -> None:
    """Add the commands to the parser of `plan`."""
    import_parser = actions.add_parser(
        "import-stage",
        help="convert a Stage world to a scenario",
        description=_IMPORT_TEXT,
        epilog=_IMPORT_EXAMPLES,
    )
    import_parser.add_argument("world", type=path_of, metavar="FILE.world", help="the world file")
    import_parser.add_argument(
        "--out", type=path_of, metavar="DIR", help="where to write; default a new folder named after the world"
    )
    import_parser.set_defaults(command=import_stage)

    export_parser = actions.add_parser(
        "export-stage", help="write a scenario as a Stage world", description=_EXPORT_TEXT, epilog=_EXPORT_EXAMPLES
    )
    add_export_options(export_parser, "the world and its bitmap")
    export_parser.add_argument(
        "--resolution",
        type=positive_number,
        default=RESOLUTION_M,
        metavar="M",
        help="size of a pixel [m]; default %(default)s",
    )
    export_parser.set_defaults(command=export_stage)


def import_stage(options: argparse.Namespace) -> None:
    """Import a Stage world."""
    # Imported late, because OpenCV takes longer to load than most commands take to run.
    from robotteamsim.stage import import_world

    name = options.world.stem
    folder = options.out or Path(name)
    if options.out is None and folder.exists():
        raise UsageError(f"{folder} already exists; choose a folder with --out")
    found = import_world(options.world)
    warn(found.notes)
    plan_file, scenario_file = folder / "plan.yaml", folder / f"{name}.yaml"
    if scenario_file == plan_file:
        scenario_file = folder / "scenario.yaml"
    keys = {"name": found.keys["name"], "plan": plan_file.name, **found.keys}
    prepare_folder(folder)
    with atomically(plan_file) as plan_part, atomically(scenario_file) as scenario_part:
        scenario.write_floor_plan(found.plan, plan_part)
        scenario_part.write_text(write(keys), encoding="utf-8")
    robots, walls, blocks = found.scenario.num_robots, len(found.plan.walls), len(found.plan.blocks)
    print(
        f"{scenario_file}: {counted(robots, 'robot')}; "
        f"{plan_file}: {counted(walls, 'wall')}, {counted(blocks, 'block')}"
    )


def export_stage(options: argparse.Namespace) -> None:
    """Export a scenario to Stage."""
    from robotteamsim.stage import export_world

    model = scenario.load(options.scenario, options.overrides)
    # The scenario's own name may not be a valid file name.
    name = Path(options.scenario).stem
    export = export_world(model, f"{name}.png", options.resolution)
    warn(export.notes)
    prepare_folder(options.out)
    world, bitmap = options.out / f"{name}.world", options.out / f"{name}.png"
    with atomically(bitmap) as bitmap_part, atomically(world) as world_part:
        bitmap_part.write_bytes(export.bitmap)
        world_part.write_text(export.world, encoding="utf-8")
    print(f"{world}: {counted(model.num_robots, 'robot')}; {bitmap}: walls and closed doors")
