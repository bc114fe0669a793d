"""`robotteamsim plan export-mujoco`: write a scenario for MuJoCo's viewer."""

import argparse
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.parser import SCENARIO_HELP, path_of
from robotteamsim.cli.run_command import add_set_option
from robotteamsim.recording.files import prepare_folder, write_atomically
from robotteamsim.wording import counted
from robotteamsim.world.placement import placed_robots

_TEXT = """\
Write a scenario at its start in MJCF, with the same bodies as in `run.world: mujoco`, for
MuJoCo's viewer and other programs."""

_EXAMPLES = """\
examples:
  robotteamsim plan export-mujoco garage_sar --out DIR       DIR/garage_sar.xml
  python -m mujoco.viewer --mjcf=DIR/garage_sar.xml"""


def add_to(actions: Any) -> None:
    """Add the command to the parser of `plan`."""
    parser = actions.add_parser(
        "export-mujoco", help="write a scenario for MuJoCo's viewer", description=_TEXT, epilog=_EXAMPLES
    )
    parser.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    add_set_option(parser)
    parser.add_argument("--out", type=path_of, required=True, metavar="DIR", help="where to write the model")
    parser.set_defaults(command=export_mujoco)


def export_mujoco(options: argparse.Namespace) -> None:
    """Export a scenario to MuJoCo."""
    # MuJoCo is an extra.
    from robotteamsim.world.mujoco.mjcf import mjcf

    model = scenario.load(options.scenario, options.overrides)
    text = mjcf(model)
    prepare_folder(options.out)
    # The scenario's own name may not be a valid file name.
    path = options.out / f"{Path(options.scenario).stem}.xml"
    write_atomically(path, text)
    robots = sum(robot.present for robot in placed_robots(model))
    print(f"{path}: {counted(robots, 'robot')}, {counted(len(model.objects), 'object')}")
