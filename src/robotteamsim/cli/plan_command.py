"""`robotteamsim plan`: import files of other programs, export to simulators, draw floor plans."""

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.output import (
    add_png_option,
    check_outputs,
    expect_new,
    mistakes_of,
    report_mistakes,
    save,
    warn,
)
from robotteamsim.cli.parser import Parser, UsageError, path_of
from robotteamsim.cli.run_command import SCENARIO_HELP, add_set_option
from robotteamsim.errors import ScenarioError, UnfinishedImportError
from robotteamsim.formats import (
    Exporter,
    Imported,
    Importer,
    PlanExporter,
    exporters,
    importer_of,
    importers,
    read_with,
)
from robotteamsim.formats.options import add_options, given
from robotteamsim.recording.files import atomically, prepare_folder, write_atomically
from robotteamsim.scenario.loading import floor_plan_and_files, is_floor_plan
from robotteamsim.scenario.map_image import left_out
from robotteamsim.scenario.plan import plan_of_level
from robotteamsim.scenario.problems import suggestion
from robotteamsim.scenario.yaml_text import write
from robotteamsim.setup import resolve
from robotteamsim.wording import counted

_IMPORT_TEXT = """\
Convert a drawing (an image, DXF or DWG), or an occupancy image as written by map_server or
slam_gmapping, or a building of Open-RMF or in IFC, into a floor plan of walls and blocks; or a
Stage world into a scenario and its plan. A scenario can also use the yaml of an image directly
as its plan.
Warnings name what is converted differently, and the parts of the floor to which no door leads;
of many, the ten largest."""

_PLAN_HELP = f"a floor plan, a map_server yaml, or a shipped map: {', '.join(scenario.map_names())}"


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    known = importers()
    examples = "\n".join(["examples:", *(importer.examples for importer in known.values() if importer.examples)])
    found = actions.add_parser(
        "import", help="convert a file of another program", description=_IMPORT_TEXT, epilog=examples
    )
    nouns = ", ".join(importer.noun for importer in known.values())
    found.add_argument("file", type=path_of, metavar="FILE", help=nouns)
    add_options(found, {name: settings for importer in known.values() for name, settings in importer.options.items()})
    add_png_option(found, "draw what was taken for what", required=False)
    found.add_argument(
        "--out",
        type=path_of,
        metavar="FILE",
        help="the floor plan to write, default plan.yaml; of a world, the folder, default one named after the world",
    )
    found.set_defaults(command=partial(import_file, known))
    with_force = [found, *(_add_exporter(actions, name, exporter) for name, exporter in exporters().items())]
    for one in with_force:
        one.add_argument("--force", action="store_true", help="replace files that exist")

    render = actions.add_parser("render", help="draw a floor plan")
    render.add_argument("plan", metavar="PLAN", help=_PLAN_HELP)
    render.add_argument("--level", metavar="NAME", help="draw only this level; default all, side by side")
    add_png_option(render)
    render.set_defaults(command=render_plan)


def _add_exporter(actions: Any, name: str, exporter: Exporter) -> Parser:
    """Add the command of an exporter; return its parser."""
    epilog = f"examples:\n{exporter.examples}" if exporter.examples else None
    parser: Parser = actions.add_parser(
        f"export-{name}", help=exporter.help, description=exporter.description or exporter.help, epilog=epilog
    )
    more = "; or a floor plan" if isinstance(exporter, PlanExporter) else ""
    parser.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP + more)
    add_set_option(parser)
    add_options(parser, exporter.options)
    parser.add_argument("--out", type=path_of, required=True, metavar="DIR", help="where to write")
    parser.set_defaults(command=partial(export_scenario, exporter))
    return parser


def import_file(known: Mapping[str, Importer], options: argparse.Namespace) -> None:
    """Import a file."""
    importer = importer_of(options.file, known.values())
    for name in (name for other in known.values() for name in other.options):
        if name not in importer.options and given(options, [name]):
            raise UsageError(f"{options.file} is {importer.noun}, for which there is no {name}")
    try:
        found = read_with(importer, options.file, **given(options, importer.options))
    except ScenarioError as error:
        if isinstance(error, UnfinishedImportError):
            _write_tables_of(error, options)
        report_mistakes(mistakes_of(error))
        raise
    said = _write_scenario(found, options) if importer.makes_scenarios else _write_plan(found, options)
    warn(found.notes)
    print(said)
    if options.png:
        from robotteamsim.analysis.import_picture import draw_import

        shown = (found.image[0], left_out(*found.image)) if found.image else ()
        save(draw_import(found.plan, found.parts, *shown), options.png)


def _write_plan(found: Imported, options: argparse.Namespace) -> str:
    """Write a floor plan and the tables of its import; return a line on each."""
    out, tables = _plan_file(options), _by_file(found.tables, options)
    outputs = {"--out": out, "--png": options.png, **{f"the table {table}": table for table in tables}}
    check_outputs(outputs, [options.file, *found.files])
    expect_new([out, *tables], options.force)
    with atomically(out) as part:
        scenario.write_floor_plan(found.plan, part)
    return "\n".join([f"{out}: {found}", *_write_tables(tables)])


def _plan_file(options: argparse.Namespace) -> Path:
    return options.out or Path("plan.yaml")


def _by_file(tables: Mapping[str, str], options: argparse.Namespace) -> dict[Path, str]:
    """Return tables, see `Imported.tables`, by their files, which are next to the plan."""
    return {_plan_file(options).with_suffix(f".{name}.yaml"): text for name, text in tables.items()}


def _write_tables(tables: Mapping[Path, str]) -> list[str]:
    """Write tables; return a line on each."""
    for file, text in tables.items():
        write_atomically(file, text)
    return [f"{file}: what was guessed; correct it for another import" for file in tables]


def _write_tables_of(error: UnfinishedImportError, options: argparse.Namespace) -> None:
    """Write the tables of a file that cannot be imported, unless they exist."""
    for file, text in _by_file(error.tables, options).items():
        if file.exists() and not options.force:
            warn([f"{file} already exists and is not replaced; --force replaces it"])
        else:
            check_outputs({"--out": file}, [options.file])
            print(*_write_tables({file: text}))


def _write_scenario(found: Imported, options: argparse.Namespace) -> str:
    """Write a scenario, if there is one, and its floor plan into a folder; return a line on them."""
    name = options.file.stem
    folder = options.out or Path(name)
    plan_file, scenario_file = folder / "plan.yaml", folder / f"{name}.yaml"
    if scenario_file == plan_file:
        scenario_file = folder / "scenario.yaml"
    expect_new((plan_file, scenario_file) if options.out else (folder,), options.force)
    inputs = [options.file, *found.files]
    check_outputs({"--png": options.png}, inputs, folders={"--out": [plan_file, scenario_file]})
    prepare_folder(folder)
    with atomically(plan_file) as part:
        scenario.write_floor_plan(found.plan, part)
    if found.scenario is None:
        return f"{plan_file}: {found}"
    keys = {"name": found.keys["name"], "plan": plan_file.name, **found.keys}
    write_atomically(scenario_file, write(keys))
    return f"{scenario_file}: {counted(found.scenario.num_robots, 'robot')}; {plan_file}: {found}"


def export_scenario(exporter: Exporter, options: argparse.Namespace) -> None:
    """Export a scenario or a floor plan."""
    name, keywords = options.scenario, given(options, exporter.options)
    if isinstance(exporter, PlanExporter) and is_floor_plan(name) and not options.overrides:
        plan, inputs = floor_plan_and_files(name)
        export = exporter.export_plan(plan, **keywords)
    else:
        loaded = scenario.load(name, options.overrides)
        inputs, export = loaded.origin.files, exporter.export(resolve(loaded), **keywords)
    # The scenario's own name may not be a valid file name.
    path = options.out / f"{Path(name).stem}.{export.suffix or exporter.suffix}"
    for other in export.others:
        if Path(other).name != other:
            raise ScenarioError(f"{type(exporter).__qualname__}: file '{other}'; expected a name without a folder")
    texts: dict[Path, str | bytes] = {path: export.text}
    texts |= {options.out / other: text for other, text in export.others.items()}
    expect_new(texts, options.force)
    check_outputs({}, inputs, folders={"--out": [*texts]})
    warn(export.notes)
    prepare_folder(options.out)
    for file, text in texts.items():
        write_atomically(file, text)
    print(f"{path}: {export.summary}")


def render_plan(options: argparse.Namespace) -> None:
    """Draw a floor plan."""
    from robotteamsim.analysis.plan_picture import draw_plan

    plan, files = floor_plan_and_files(options.plan)
    check_outputs({"--png": options.png}, files)
    if options.level is not None:
        level = next((level for level in plan.levels if level.name == options.level), None)
        if level is None:
            names = [level.name for level in plan.levels]
            known = f"known: {', '.join(names) or 'none'}{suggestion(options.level, names)}"
            raise UsageError(f"--level: {options.plan} has no level {options.level!r}; {known}")
        plan = plan_of_level(plan, level)
    save(draw_plan(plan), options.png)
