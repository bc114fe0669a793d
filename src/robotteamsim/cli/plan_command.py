"""`robotteamsim plan`: floor plans from map_server images, Stage worlds, and pictures of plans."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli import stage_commands
from robotteamsim.cli.parser import UsageError
from robotteamsim.cli.pictures import add_png_option, save
from robotteamsim.recording.files import atomically

_IMPORT_TEXT = """\
Turn an occupancy image, as map_server and slam_gmapping write it, into a floor plan of
walls and blocks. A scenario can also name the image's yaml as its plan directly."""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("plan", help="import, export or draw floor plans", description=__doc__)
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)

    bring = actions.add_parser("import", help="turn a map_server image into a floor plan", description=_IMPORT_TEXT)
    bring.add_argument("map", type=Path, metavar="MAP.yaml", help="yaml of the image")
    bring.add_argument(
        "--out", type=Path, metavar="FILE", help="the plan to write; default plan.yaml, if there is none"
    )
    bring.set_defaults(command=import_plan)

    stage_commands.add_to(actions)

    render = actions.add_parser("render", help="draw a floor plan")
    render.add_argument("plan", metavar="PLAN", help="a plan file, a map_server yaml, or a shipped map: garage")
    add_png_option(render)
    render.set_defaults(command=render_plan)


def import_plan(options: argparse.Namespace) -> None:
    """Import an image."""
    # Imported late: OpenCV takes longer to start than most commands to run.
    from robotteamsim.scenario.plan_import import import_map

    out = options.out or Path("plan.yaml")
    if options.out is None and out.exists():
        raise UsageError(f"{out} exists already; name the file to write with --out")
    plan = import_map(options.map)
    with atomically(out) as part:
        scenario.write_floor_plan(plan, part)
    print(f"{out}: {len(plan.walls)} walls, {len(plan.blocks)} blocks")


def render_plan(options: argparse.Namespace) -> None:
    """Draw a plan."""
    from robotteamsim.analysis.plan_picture import draw_plan

    save(draw_plan(scenario.load_floor_plan(options.plan)), options.png)
