"""`robotteamsim scenario`: check, show, draw and list scenarios; print the JSON Schema for editors."""

import argparse
import json
from itertools import takewhile

from robotteamsim import scenario
from robotteamsim.cli.output import add_png_option, check_outputs, mistakes_of, report_mistakes, save
from robotteamsim.cli.parser import Parser, UsageError, path_of
from robotteamsim.cli.run_command import SCENARIO_HELP, add_code_option, add_set_option, check_code
from robotteamsim.control.baselines.patrol_graph import patrol_graph
from robotteamsim.errors import RobotTeamSimError, ScenarioError
from robotteamsim.recording.files import write_atomically
from robotteamsim.recording.idleness import patrols
from robotteamsim.scenario.shipped import shipped_scenario
from robotteamsim.scenario.yaml_text import read_text
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Simulation
from robotteamsim.wording import counted
from robotteamsim.world.floor_parts import part_texts, parts_without, places_without

_SCHEMA_EPILOG = """\
With an editor's YAML extension, this first line enables completion and checks:
  # yaml-language-server: $schema=scenario.schema.json"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)

    check = actions.add_parser("check", help="report all mistakes in scenarios")
    check.add_argument("scenarios", nargs="+", metavar="SCENARIO", help="files or shipped names")
    add_set_option(check)
    add_code_option(check)
    check.set_defaults(command=run_check)

    show = actions.add_parser("show", help="print a scenario with every key and default")
    show.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    add_set_option(show)
    show.set_defaults(command=run_show)

    render = actions.add_parser("render", help="draw floor plan, areas, victims and robots")
    render.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    add_set_option(render)
    add_png_option(render)
    render.set_defaults(command=run_render)

    schema = actions.add_parser("schema", help="print the JSON Schema of a scenario", epilog=_SCHEMA_EPILOG)
    schema.add_argument("file", nargs="?", type=path_of, metavar="FILE", help="write to this file instead")
    schema.set_defaults(command=run_schema)

    shipped = actions.add_parser("list", help="print the shipped scenarios, each with a line about it")
    shipped.set_defaults(command=run_list)


def run_check(options: argparse.Namespace) -> None:
    """Check scenarios and report all mistakes in all of them."""
    mistakes: list[str] = []
    for name in options.scenarios:
        try:
            loaded = scenario.load(name, options.overrides)
            check_code(options, loaded)
            setup = resolve(loaded)
        except ScenarioError as error:
            mistakes += mistakes_of(error)
            continue
        if mistake := _mistake_in_setting_up(setup, name):
            mistakes.append(mistake)
            continue
        mission, bounds = loaded.mission, loaded.plan.bounds
        width_m, height_m = (high - low for low, high in zip(bounds.min, bounds.max, strict=True))
        print(
            f"{name}: valid: {counted(loaded.num_robots, 'robot')}, {counted(len(mission.areas), 'area')}, "
            f"{counted(loaded.num_victims, 'victim')} in {loaded.plan.name} of {width_m:g} x {height_m:g} m"
        )
        for part in _unreachable(setup):
            print(f"{name}: no robot can get to {part}, not even through doors")
    report_mistakes(mistakes)


def _unreachable(setup: Setup) -> list[str]:
    """Return the areas, victims and parts of the floor that no robot can reach from its start."""
    of = setup.scenario
    robots = [robot for robot in setup.robots[: of.num_robots] if robot.present]
    if not robots:
        return []
    within = setup.plan, min(robot.reach_m for robot in robots), [robot.start_pose[:2] for robot in robots]
    places = [(f"area {area.name}", area.center, area.radius_m) for area in of.mission.areas]
    places += [(f"victim {one.name}", one.position, of.mission.save_distance_m) for one in of.mission.victims]
    missed = (places[index] for index in places_without(*within, [place[1:] for place in places]))
    found = [f"{what} at [{x_m:g}, {y_m:g}]" for what, (x_m, y_m), _ in missed]
    return found + part_texts(parts_without(*within))


def _mistake_in_setting_up(setup: Setup, name: str) -> str:
    """Return a mistake that appears only when the mission is set up, such as an unknown controller; "" if none.

    Args: name: of the scenario, for mistakes that do not name its file or option.
    """
    of = setup.scenario
    try:
        if patrols(of):
            patrol_graph(setup)
        faults = Simulation(setup).controllers.faults
    except RobotTeamSimError as error:
        line = str(error).removeprefix(f"{of.name}: ")
        return line if line.startswith((f"{of.origin.place}: ", "--set: ")) else f"{name}: {line}"
    fault = next(filter(None, faults), "")
    return f"{name}: control.algorithm: {of.control.algorithm}: {fault}" if fault else ""


def run_show(options: argparse.Namespace) -> None:
    """Print a scenario as YAML."""
    print(scenario.dump(scenario.load(options.scenario, options.overrides)), end="")


def run_render(options: argparse.Namespace) -> None:
    """Draw a scenario."""
    from robotteamsim.analysis.plan_picture import draw_plan

    loaded = scenario.load(options.scenario, options.overrides)
    check_outputs({"--png": options.png}, loaded.origin.files)
    save(draw_plan(loaded.plan, resolve(loaded)), options.png)


def run_schema(options: argparse.Namespace) -> None:
    """Print or write the JSON Schema."""
    text = json.dumps(scenario.json_schema(), indent=2)
    if options.file:
        if options.file.exists() and options.file.suffix in (".yaml", ".yml"):
            raise UsageError(f"{options.file} already exists; choose a name for JSON, such as scenario.schema.json")
        write_atomically(options.file, text + "\n")
    else:
        print(text)


def run_list(options: argparse.Namespace) -> None:
    """Print the shipped scenarios' names, each with the first sentence of its file's comment."""
    names = scenario.scenario_names()
    width = max(map(len, names), default=0)
    for name in names:
        text = read_text(shipped_scenario(name), name)
        comment = " ".join(line[1:].strip() for line in takewhile(lambda line: line.startswith("#"), text.splitlines()))
        print(f"{name:{width}}  {comment.partition('. ')[0].removesuffix('.')}")
