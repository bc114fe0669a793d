"""`robotteamsim plan`: import images and Stage worlds, export to Stage, Gazebo and MuJoCo, draw floor plans."""

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from robotteamsim import scenario
from robotteamsim.cli import stage_commands
from robotteamsim.cli.output import add_png_option, check_outputs, expect_new, save, warn, write_world
from robotteamsim.cli.parser import Parser, UsageError, number, path_of, positive_number
from robotteamsim.cli.run_command import SCENARIO_HELP, add_set_option
from robotteamsim.map_import.paper import MOST_TURN_DEG
from robotteamsim.recording.files import atomically, write_atomically
from robotteamsim.scenario.door_places import without_misplaced_doors
from robotteamsim.scenario.dxf import DxfImport, DxfRules, import_dxf
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.loading import floor_plan_and_files
from robotteamsim.scenario.map_image import (
    DrawingRules,
    MapImage,
    import_image,
    left_out,
    open_places,
    read_drawing,
    read_map,
    with_openings,
)
from robotteamsim.setup import resolve
from robotteamsim.wording import counted
from robotteamsim.world.floor_parts import floor_parts, part_texts

_IMPORT_TEXT = """\
Convert a drawing (an image, or DXF), or an occupancy image as written by map_server or
slam_gmapping, into a floor plan of walls and blocks. A scenario can also use the yaml of an image directly as its plan.
Warnings name the parts of the floor to which no door leads; of many, the ten largest."""

_IMPORT_EXAMPLES = """\
examples:
  robotteamsim plan import house.yaml                        image, resolution, origin
  robotteamsim plan import house.png --metres-per-pixel 0.02
  robotteamsim plan import house.png --measured 120,80,820,80,14
                                     the line between these pixels is 14 m long; y counts from the top
  robotteamsim plan import house.png --metres-per-pixel 0.02 --thinnest-wall 0.08 --smallest-wall 0.5 \\
    --doors --png import.png         without text and thin lines, gaps as doors, and what became what
  robotteamsim plan import house.dxf --layer WALLS --layer PILLARS --wall-thickness 0.12"""

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


_PLAN_HELP = f"a floor plan, a map_server yaml, or a shipped map: {', '.join(scenario.map_names())}"
_DOOR_WIDTHS_M = (0.6, 1.6)
_DOOR_WIDTHS_TEXT = ",".join(f"{width_m:g}" for width_m in _DOOR_WIDTHS_M)
_MOST_PLACES = 10
_MOST_GREY = 0.1
"""Of the pixels, the largest share that is usual in photos and scans of drawings."""
_UPRIGHT = 0.02
"""Of a wall along an axis, the largest slope."""
_ONLY_DXF = ("layer", "metres_per_unit", "wall_thickness")
_ONLY_IMAGES = ("metres_per_pixel", "measured", "thinnest_wall", "smallest_wall")
_ROBOT_M = 0.2
"""Radius of the robot for which parts of the floor count as connected."""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)

    image = actions.add_parser(
        "import", help="convert a drawing or map to a floor plan", description=_IMPORT_TEXT, epilog=_IMPORT_EXAMPLES
    )
    image.add_argument("map", type=path_of, metavar="FILE", help="an image, the yaml of one, or a DXF file")
    _add_drawing_options(image)
    image.add_argument("--out", type=path_of, metavar="FILE", help="the floor plan to write; default plan.yaml")
    image.add_argument("--force", action="store_true", help="replace the file if it exists")
    image.set_defaults(command=import_plan)

    stage_commands.add_to(actions)

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
    render.add_argument("plan", metavar="PLAN", help=_PLAN_HELP)
    add_png_option(render)
    render.set_defaults(command=render_plan)


def _add_drawing_options(parser: argparse.ArgumentParser) -> None:
    """Add the scale of an image, what of it is a wall, a door or a window, and the options of DXF files."""
    scale = parser.add_mutually_exclusive_group()
    scale.add_argument("--metres-per-pixel", type=positive_number, metavar="M", help="scale of an image without a yaml")
    scale.add_argument(
        "--measured",
        type=_measured,
        metavar="X1,Y1,X2,Y2,M",
        help="the same, from two pixels and their distance",
    )
    parser.add_argument(
        "--thinnest-wall",
        type=positive_number,
        default=0.0,
        metavar="M",
        help="thinner strokes are no walls: text, dimension lines, arcs of doors; default: all are",
    )
    parser.add_argument(
        "--smallest-wall",
        type=positive_number,
        default=0.0,
        metavar="M",
        help="separate strokes smaller than this in width and height are no walls: letters; default: all are",
    )
    parser.add_argument(
        "--doors",
        type=_widths,
        nargs="?",
        const=_DOOR_WIDTHS_M,
        metavar="LOW,HIGH",
        help=f"gaps of these widths [m] in walls along the axes become open doors; default {_DOOR_WIDTHS_TEXT}",
    )
    parser.add_argument(
        "--windows",
        type=_widths,
        metavar="LOW,HIGH",
        help="gaps of these widths [m] in outer walls, empty or with thin lines, become walls of material glass",
    )
    add_png_option(parser, "draw what was taken for what", required=False)
    _add_dxf_options(parser)


def _add_dxf_options(parser: argparse.ArgumentParser) -> None:
    """Add what lines of a DXF file mean."""
    parser.add_argument(
        "--layer",
        action="append",
        default=[],
        metavar="NAME",
        help="a layer of a DXF file whose lines are walls; repeatable; without it, the layers are listed",
    )
    parser.add_argument(
        "--metres-per-unit", type=positive_number, metavar="M", help="scale of a DXF file; default: the unit it names"
    )
    parser.add_argument(
        "--wall-thickness",
        type=positive_number,
        metavar="M",
        help="of lines of a DXF file that are no faces and have no width; default 0.1",
    )


def _numbers(text: str, count: int, form: str) -> list[float]:
    """Return comma-separated numbers. Raises: ArgumentTypeError."""
    parts = text.split(",")
    if len(parts) != count:
        raise argparse.ArgumentTypeError(f"'{text}' is not {form}")
    return [number(part) for part in parts]


def _measured(text: str) -> float:
    """Return the metres per pixel of a measured line. Raises: ArgumentTypeError."""
    x1, y1, x2, y2, metres = _numbers(text, 5, "X1,Y1,X2,Y2,M")
    pixels = math.hypot(x2 - x1, y2 - y1)
    if pixels < 1.0 or metres <= 0.0:
        raise argparse.ArgumentTypeError(f"'{text}': expected two pixels apart from each other, and metres above 0")
    return metres / pixels


def _widths(text: str) -> tuple[float, float]:
    """Return the least and greatest width of a door. Raises: ArgumentTypeError."""
    low, high = _numbers(text, 2, "LOW,HIGH")
    if not 0.0 < low <= high:
        raise argparse.ArgumentTypeError(f"'{text}': expected widths above 0, the smaller one first")
    return low, high


def _read_image(options: argparse.Namespace) -> tuple[MapImage, DrawingRules]:
    """Return an image, and what of it is a wall.

    Raises: UsageError: no scale, or two. ScenarioError: it cannot be read.
    """
    scale, is_yaml = options.metres_per_pixel or options.measured, options.map.suffix.lower() in (".yaml", ".yml")
    if is_yaml and scale is not None:
        raise UsageError(f"{options.map} has the resolution; --metres-per-pixel and --measured are for images")
    if not is_yaml and scale is None:
        raise UsageError(f"{options.map}: give its scale with --metres-per-pixel or --measured, or import its yaml")
    rules = DrawingRules(options.thinnest_wall, options.smallest_wall, options.doors, options.windows)
    return read_map(options.map) if is_yaml else read_drawing(options.map, scale), rules


def _check_kind(options: argparse.Namespace, *, is_dxf: bool) -> None:
    """Raises: UsageError: an option is for another kind of file."""
    kind, others = ("images", _ONLY_IMAGES) if is_dxf else ("DXF files", _ONLY_DXF)
    for option in others:
        if getattr(options, option):
            raise UsageError(f"--{option.replace('_', '-')}: only for {kind}, not for {options.map}")


def _import_dxf(options: argparse.Namespace) -> DxfImport:
    """Return the import of a DXF file. Raises: ScenarioError: it cannot be read."""
    thickness_m = options.wall_thickness or DxfRules(()).wall_thickness_m
    found = import_dxf(options.map, DxfRules(options.layer, options.metres_per_unit, thickness_m))
    rules = DrawingRules(doors_m=options.doors, windows_m=options.windows)
    return found._replace(plan=with_openings(found.plan, rules))


def import_plan(options: argparse.Namespace) -> None:
    """Import an image or a DXF file."""
    out = options.out or Path("plan.yaml")
    notes: tuple[str, ...] = ()
    is_dxf = options.map.suffix.lower() == ".dxf"
    _check_kind(options, is_dxf=is_dxf)
    if is_dxf and not options.layer:  # a question, whose answer is the list of layers
        _import_dxf(options)
    image, rules = (None, DrawingRules()) if is_dxf else _read_image(options)
    inputs = [options.map, *([options.map.parent / image.settings.image] if image else [])]
    check_outputs({"--out": out, "--png": options.png}, inputs)
    expect_new([out], options.force)
    if image is None:
        found, notes = _import_dxf(options)
    else:
        found = import_image(image, options.map, rules)
    plan = without_misplaced_doors(found)
    parts = floor_parts(plan, _ROBOT_M)
    if image is not None:  # what the image does not know is no floor
        parts = tuple(part for part in parts if image.is_free_at(part.place))
    with atomically(out) as part:
        scenario.write_floor_plan(plan, part)
    print(f"{out}: {_summary(plan, image, options)}")
    if options.png:
        from robotteamsim.analysis.import_picture import draw_import

        no_wall = None if image is None else left_out(image, rules)
        save(draw_import(plan, parts, image, no_wall), options.png)
    warn([*notes, *_doubts(plan, image, options)])
    if num_left_out := len(found.doors) - len(plan.doors):
        warn([f"{counted(num_left_out, 'gap')} found next to which a leaf cannot turn: left open, without a door"])
    warn(f"no door leads from the largest part of the floor to {part}" for part in part_texts(parts[1:]))
    if image is None or image.settings.image == options.map.name:  # a map knows no outside
        _warn_of_open_places(plan, options)


def _summary(plan: FloorPlan, image: MapImage | None, options: argparse.Namespace) -> str:
    """Return size and number of elements of an imported plan, and what was measured or changed in its source."""
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    num_windows = sum(wall.material == "glass" for wall in plan.walls)
    parts = [f"{x1 - x0:g} x {y1 - y0:g} m", counted(len(plan.walls) - num_windows, "wall")]
    parts += [counted(len(plan.blocks), "block")]
    parts += [counted(len(plan.doors), "door")] if options.doors else []
    parts += [counted(num_windows, "window")] if options.windows else []
    notes = [", ".join(parts)]
    if plan.drawing_offset_m is not None:
        notes.append("[0, 0] is [{:.10g}, {:.10g}] m in the drawing".format(*plan.drawing_offset_m))
    if image is not None and image.settings.image == options.map.name:
        notes.append(f"{100.0 * image.grey_share:.1f} % of the pixels were neither black nor white")
        notes += [f"turned by {-image.turn_deg:.1f} degrees"] if image.turn_deg else []
    return "; ".join(notes)


def _doubts(plan: FloorPlan, image: MapImage | None, options: argparse.Namespace) -> Iterator[str]:
    """Yield why what was imported may not be what was drawn."""
    if image is not None and abs(image.turn_deg) > MOST_TURN_DEG - 0.05:
        yield f"the paper is turned by {MOST_TURN_DEG:g} degrees or more, and only so much is undone; turn the picture"
    if image is not None and image.grey_share > _MOST_GREY:
        yield f"{100.0 * image.grey_share:.0f} % of the pixels are neither black nor white: walls may be wrong"
    spans_m = [np.abs(np.subtract(wall.end, wall.start)) for wall in plan.walls]
    slanted = [float(np.hypot(*span)) for span in spans_m if span.min() > _UPRIGHT * span.max()]
    if options.doors and not plan.doors and sum(slanted) > 0.5 * sum(float(np.hypot(*span)) for span in spans_m):
        yield "no doors: their gaps are only looked for in walls along the axes, and most walls are turned from these"


def _warn_of_open_places(plan: FloorPlan, options: argparse.Namespace) -> None:
    places = [f"[{x:g}, {y:g}]" for x, y in open_places(plan)]
    if places:
        more = [counted(len(places) - _MOST_PLACES, "other place")] if len(places) > _MOST_PLACES else []
        hint = "" if options.windows else "; --windows LOW,HIGH makes glass of gaps, --doors makes doors"
        warn([f"the outer wall is open at {', '.join([*places[:_MOST_PLACES], *more])}{hint}"])


def export_gazebo(options: argparse.Namespace) -> None:
    """Export a scenario to Gazebo."""
    from robotteamsim.gazebo import export_world

    loaded = scenario.load(options.scenario, options.overrides)
    export = export_world(resolve(loaded), options.drive)
    robots = counted(loaded.num_robots - len(export.absent), "robot")
    said = f"{robots}, {counted(len(loaded.plan.doors), 'door')}"
    write_world(options, "world", loaded.origin.files, export.world, said, export.notes)
    for name, text in export.absent.items():
        write_atomically(options.out / f"{name}.sdf", text)


def export_mujoco(options: argparse.Namespace) -> None:
    """Export a scenario to MuJoCo."""
    from robotteamsim.world.mujoco.model import mjcf  # MuJoCo is an extra

    loaded = scenario.load(options.scenario, options.overrides)
    setup = resolve(loaded)
    robots = counted(sum(robot.present for robot in setup.robots), "robot")
    said = f"{robots}, {counted(len(loaded.objects), 'object')}"
    write_world(options, "xml", loaded.origin.files, mjcf(setup.scenario, setup.robots), said)


def render_plan(options: argparse.Namespace) -> None:
    """Draw a floor plan."""
    from robotteamsim.analysis.plan_picture import draw_plan

    plan, files = floor_plan_and_files(options.plan)
    check_outputs({"--png": options.png}, files)
    save(draw_plan(plan), options.png)
