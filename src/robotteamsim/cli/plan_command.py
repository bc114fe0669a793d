"""`robotteamsim plan`: import images and worlds of Stage, export scenarios to Gazebo and MuJoCo, draw floor plans."""

import argparse
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.output import add_png_option, save
from robotteamsim.cli.parser import PLAN_HELP, SCENARIO_HELP, UsageError, path_of
from robotteamsim.cli.run_command import add_set_option
from robotteamsim.recording.files import atomically, prepare_folder, write_atomically
from robotteamsim.scenario.map_image import import_map
from robotteamsim.scenario.yaml_text import write
from robotteamsim.setup import resolve
from robotteamsim.wording import counted

_IMPORT_TEXT = """\
Convert an occupancy image, as written by map_server or slam_gmapping, into a floor plan of
walls and blocks. A scenario can also use the image's yaml directly as its plan."""

_STAGE_TEXT = """\
Convert a Stage world to a scenario and its floor plan: models with a bitmap, blocks or a
boundary become walls and blocks, position models with a ranger become robots. A warning is
printed for each setting that is converted differently; docs/stage.md lists what is supported."""

_STAGE_EXAMPLES = """\
examples:
  robotteamsim plan import-stage office.world                office/office.yaml, office/plan.yaml
  robotteamsim plan import-stage office.world --out DIR && robotteamsim run DIR/office.yaml"""

_GAZEBO_TEXT = """\
Write a scenario as a world of Gazebo 11 (SDF): floor, walls, doors with joints, objects, and
robots with their laser and the plugin that drives them. docs/gazebo.md describes the models."""

_GAZEBO_EXAMPLES = """\
examples:
  robotteamsim plan export-gazebo garage_sar --out DIR       DIR/garage_sar.world
  gazebo --verbose DIR/garage_sar.world"""

_MUJOCO_TEXT = """\
Write a scenario at its start in MJCF, with the same bodies as in `run.world: mujoco`, for
MuJoCo's viewer and other programs."""

_MUJOCO_EXAMPLES = """\
examples:
  robotteamsim plan export-mujoco garage_sar --out DIR       DIR/garage_sar.xml
  python -m mujoco.viewer --mjcf=DIR/garage_sar.xml"""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("plan", help="import, export or draw floor plans", description=__doc__)
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)

    image = actions.add_parser("import", help="convert a map_server image to a floor plan", description=_IMPORT_TEXT)
    image.add_argument("map", type=path_of, metavar="MAP.yaml", help="yaml of the image")
    image.add_argument(
        "--out", type=path_of, metavar="FILE", help="the floor plan to write; default plan.yaml, if that does not exist"
    )
    image.set_defaults(command=import_image)

    stage = actions.add_parser(
        "import-stage", help="convert a Stage world to a scenario", description=_STAGE_TEXT, epilog=_STAGE_EXAMPLES
    )
    stage.add_argument("world", type=path_of, metavar="FILE.world", help="the world file")
    stage.add_argument(
        "--out", type=path_of, metavar="DIR", help="where to write; default a new folder named after the world"
    )
    stage.set_defaults(command=import_stage)

    gazebo = actions.add_parser(
        "export-gazebo", help="write a scenario as a Gazebo world", description=_GAZEBO_TEXT, epilog=_GAZEBO_EXAMPLES
    )
    gazebo.add_argument(
        "--drive",
        choices=("velocity", "wheels"),
        default="velocity",
        help="how robots with a differential drive move; default %(default)s",
    )
    gazebo.set_defaults(command=export_gazebo)

    mujoco = actions.add_parser(
        "export-mujoco", help="write a scenario for MuJoCo's viewer", description=_MUJOCO_TEXT, epilog=_MUJOCO_EXAMPLES
    )
    mujoco.set_defaults(command=export_mujoco)

    for export, written in ((gazebo, "the world"), (mujoco, "the model")):
        export.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
        add_set_option(export)
        export.add_argument("--out", type=path_of, required=True, metavar="DIR", help=f"where to write {written}")

    render = actions.add_parser("render", help="draw a floor plan")
    render.add_argument("plan", metavar="PLAN", help=PLAN_HELP)
    add_png_option(render)
    render.set_defaults(command=render_plan)


def import_image(options: argparse.Namespace) -> None:
    """Import an image."""
    out = options.out or Path("plan.yaml")
    if options.out is None and out.exists():
        raise UsageError(f"{out} already exists; choose a file with --out")
    if os.path.realpath(out) == os.path.realpath(options.map):
        raise UsageError(f"--out {out}: would overwrite the map")
    plan = import_map(options.map)
    with atomically(out) as part:
        scenario.write_floor_plan(plan, part)
    print(f"{out}: {counted(len(plan.walls), 'wall')}, {counted(len(plan.blocks), 'block')}")


def import_stage(options: argparse.Namespace) -> None:
    """Import a Stage world."""
    from robotteamsim.stage import import_world  # late, because of OpenCV

    name = options.world.stem
    folder = options.out or Path(name)
    if options.out is None and folder.exists():
        raise UsageError(f"{folder} already exists; choose a folder with --out")
    found = import_world(options.world)
    _warn(found.notes)
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


def export_gazebo(options: argparse.Namespace) -> None:
    """Export a scenario to Gazebo."""
    from robotteamsim.gazebo import export_world

    loaded = scenario.load(options.scenario, options.overrides)
    export = export_world(resolve(loaded), options.drive)
    _warn(export.notes)
    prepare_folder(options.out)
    for name, text in export.absent.items():
        write_atomically(options.out / f"{name}.sdf", text)
    # The scenario's own name may not be a valid file name.
    path = options.out / f"{Path(options.scenario).stem}.world"
    write_atomically(path, export.world)
    robots = loaded.num_robots - len(export.absent)
    print(f"{path}: {counted(robots, 'robot')}, {counted(len(loaded.plan.doors), 'door')}")


def export_mujoco(options: argparse.Namespace) -> None:
    """Export a scenario to MuJoCo."""
    from robotteamsim.world.mujoco.model import mjcf  # MuJoCo is an extra

    loaded = scenario.load(options.scenario, options.overrides)
    setup = resolve(loaded)
    text = mjcf(setup.scenario, setup.robots)
    prepare_folder(options.out)
    path = options.out / f"{Path(options.scenario).stem}.xml"
    write_atomically(path, text)
    robots = sum(robot.present for robot in setup.robots)
    print(f"{path}: {counted(robots, 'robot')}, {counted(len(loaded.objects), 'object')}")


def render_plan(options: argparse.Namespace) -> None:
    """Draw a floor plan."""
    from robotteamsim.analysis.plan_picture import draw_plan

    save(draw_plan(scenario.load_floor_plan(options.plan)), options.png)


def _warn(notes: Iterable[str]) -> None:
    """Print the notes of a conversion."""
    for note in notes:
        print(f"robotteamsim: warning: {note}", file=sys.stderr)
