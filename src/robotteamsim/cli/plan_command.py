"""`robotteamsim plan`: import floor plans from images and worlds of Stage and Gazebo, export them, draw them."""

import argparse
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli import gazebo_commands, mujoco_commands, stage_commands
from robotteamsim.cli.converting import add_plan_option, plan_file
from robotteamsim.cli.parser import PLAN_HELP, path_of
from robotteamsim.cli.pictures import add_png_option, save
from robotteamsim.recording.files import atomically
from robotteamsim.wording import counted

_IMPORT_TEXT = """\
Convert an occupancy image, as written by map_server or slam_gmapping, into a floor plan of
walls and blocks. A scenario can also use the image's yaml directly as its plan."""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("plan", help="import, export or draw floor plans", description=__doc__)
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)

    import_parser = actions.add_parser(
        "import", help="convert a map_server image to a floor plan", description=_IMPORT_TEXT
    )
    import_parser.add_argument("map", type=path_of, metavar="MAP.yaml", help="yaml of the image")
    add_plan_option(import_parser)
    import_parser.set_defaults(command=import_plan)

    stage_commands.add_to(actions)
    gazebo_commands.add_to(actions)
    mujoco_commands.add_to(actions)

    render_parser = actions.add_parser("render", help="draw a floor plan")
    render_parser.add_argument("plan", metavar="PLAN", help=PLAN_HELP)
    add_png_option(render_parser)
    render_parser.set_defaults(command=render_plan)


def import_plan(options: argparse.Namespace) -> None:
    """Import an image."""
    # Imported late, because OpenCV takes longer to load than most commands take to run.
    from robotteamsim.scenario.plan_import import import_map

    out = plan_file(options.out, options.map, "map")
    plan = import_map(options.map)
    with atomically(out) as part:
        scenario.write_floor_plan(plan, part)
    print(f"{out}: {counted(len(plan.walls), 'wall')}, {counted(len(plan.blocks), 'block')}")


def render_plan(options: argparse.Namespace) -> None:
    """Draw a floor plan."""
    from robotteamsim.analysis.plan_picture import draw_plan

    save(draw_plan(scenario.load_floor_plan(options.plan)), options.png)
