"""`robotteamsim plan import-stage` and `plan export-stage`: convert worlds of the Stage simulator."""

import argparse
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.output import check_outputs, expect_new, mistakes_of, report_mistakes, warn, write_world
from robotteamsim.cli.parser import path_of
from robotteamsim.cli.run_command import add_set_option
from robotteamsim.errors import ScenarioError
from robotteamsim.recording.files import atomically, prepare_folder, write_atomically
from robotteamsim.scenario.loading import floor_plan_and_files, is_floor_plan
from robotteamsim.scenario.yaml_text import write
from robotteamsim.setup import resolve
from robotteamsim.wording import counted

_IMPORT_TEXT = """\
Convert a Stage world to a scenario and its floor plan: models with a bitmap, blocks or a
boundary become walls and blocks, position models become robots. A warning is printed for
each setting that is converted differently; docs/stage.md lists what is supported."""

_IMPORT_EXAMPLES = """\
examples:
  robotteamsim plan import-stage office.world                office/office.yaml, office/plan.yaml
  robotteamsim plan import-stage office.world --out DIR && robotteamsim run DIR/office.yaml"""

_EXPORT_TEXT = """\
Write a scenario, or a floor plan, as a Stage world, for stage_ros: the same controllers then
drive the same robots in Stage. `plan import-stage` converts it back to an equal scenario."""

_EXPORT_EXAMPLES = """\
examples:
  robotteamsim plan export-stage garage_sar --out DIR        DIR/garage_sar.world
  robotteamsim plan export-stage DIR/plan.yaml --out DIR     the walls, blocks and doors alone"""


def add_to(actions: Any) -> None:
    """Add the commands to the parser of `plan`."""
    to_scenario = actions.add_parser(
        "import-stage",
        help="convert a Stage world to a scenario",
        description=_IMPORT_TEXT,
        epilog=_IMPORT_EXAMPLES,
    )
    to_scenario.add_argument("world", type=path_of, metavar="FILE.world", help="the world file")
    to_scenario.add_argument(
        "--out", type=path_of, metavar="DIR", help="where to write; default a new folder named after the world"
    )
    to_scenario.add_argument(
        "--grey",
        choices=("as-import", "as-stage"),
        default="as-import",
        help="what is solid in bitmaps: as in `plan import`, or as in Stage, where the first channel is below 128; "
        "default %(default)s",
    )
    to_scenario.set_defaults(command=import_stage)
    to_world = actions.add_parser(
        "export-stage", help="write a scenario as a Stage world", description=_EXPORT_TEXT, epilog=_EXPORT_EXAMPLES
    )
    to_world.add_argument("scenario", metavar="SCENARIO", help="a file, or a shipped scenario; or a floor plan")
    add_set_option(to_world)
    to_world.add_argument("--out", type=path_of, required=True, metavar="DIR", help="where to write the world")
    to_world.set_defaults(command=export_stage)
    for parser in (to_scenario, to_world):
        parser.add_argument("--force", action="store_true", help="replace files that exist")


def import_stage(options: argparse.Namespace) -> None:
    """Import a Stage world."""
    from robotteamsim.stage import import_world  # late, because of OpenCV

    name = options.world.stem
    folder = options.out or Path(name)
    plan_file, scenario_file = folder / "plan.yaml", folder / f"{name}.yaml"
    if scenario_file == plan_file:
        scenario_file = folder / "scenario.yaml"
    expect_new((plan_file, scenario_file) if options.out else (folder,), options.force)
    check_outputs({}, [options.world], folders={"--out": [plan_file, scenario_file]})
    try:
        found = import_world(options.world, grey_as_stage=options.grey == "as-stage")
    except ScenarioError as error:
        report_mistakes(mistakes_of(error))
        raise
    warn(found.notes)
    prepare_folder(folder)
    walls, blocks = counted(len(found.plan.walls), "wall"), counted(len(found.plan.blocks), "block")
    with atomically(plan_file) as part:
        scenario.write_floor_plan(found.plan, part)
    if found.scenario is not None:
        keys = {"name": found.keys["name"], "plan": plan_file.name, **found.keys}
        write_atomically(scenario_file, write(keys))
        print(f"{scenario_file}: {counted(found.scenario.num_robots, 'robot')}; {plan_file}: {walls}, {blocks}")
    else:
        print(f"{plan_file}: {walls}, {blocks}")


def export_stage(options: argparse.Namespace) -> None:
    """Export a scenario or a floor plan to Stage."""
    from robotteamsim.stage import export_world  # late, as above

    name = options.scenario
    if is_floor_plan(name) and not options.overrides:
        plan, files = floor_plan_and_files(name)
        export, said = export_world(plan), "no robot"
    else:
        setup = resolve(scenario.load(name, options.overrides))
        files = setup.scenario.origin.files
        robots = setup.robots[: setup.scenario.num_robots]
        export = export_world(setup.plan, setup.scenario, robots)
        said = counted(sum(robot.present for robot in robots), "robot")
    write_world(options, "world", files, export.world, said, export.notes, force=options.force)
