"""Entry point of the command line: runs a command and prints a user's mistake as one line."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

import robotteamsim
from robotteamsim.cli import (
    analyse_command,
    campaign_command,
    field_command,
    plan_command,
    report_command,
    run_command,
    scenario_command,
)
from robotteamsim.cli.parser import Parser
from robotteamsim.errors import RobotTeamSimError

EXIT_MISTAKE = 2
EXIT_INTERRUPTED = 130
EXIT_BROKEN_PIPE = 141

_EXAMPLES = """\
examples:
  robotteamsim run garage_sar                        one mission, with a table of its events
  robotteamsim run garage_sar --seed 7 --noise 20 --out results --bag mission.bag
  robotteamsim run my.yaml --set control.alpha=0.5 --json
  robotteamsim campaign garage_sar --noise 10 --noise 20 --trials 30 --out DIR
  robotteamsim report DIR                            figures, tests and verdicts of a campaign on one page
  robotteamsim analyse mission.bag                   summary of any bag: headless, ROS or real robots
  robotteamsim scenario show garage_sar              every key and its value
  robotteamsim field voice garage_sar --png voice.png
  robotteamsim plan import map.yaml --out plan.yaml  a map_server image as walls
  robotteamsim plan import-stage office.world        a Stage world as a scenario

`robotteamsim COMMAND --help` describes a command in detail."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    Returns: 0; 1 for a campaign with failed trials; 2 for a user's mistake; 130 if interrupted; 141 for a broken pipe.
    """
    try:
        options = make_parser().parse_args(arguments)
        status = options.command(options)
        sys.stdout.flush()
    except RobotTeamSimError as error:
        print(f"robotteamsim: {error}", file=sys.stderr)
        return EXIT_MISTAKE
    except KeyboardInterrupt:
        print("robotteamsim: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader has closed the pipe. Otherwise Python would print an error when it flushes stdout at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_BROKEN_PIPE
    return status or 0


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = Parser(
        prog="robotteamsim",
        description="Simulate teams of mobile robots in search and rescue missions, and analyse the results.",
        epilog=_EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"robotteamsim {robotteamsim.__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (
        run_command,
        campaign_command,
        report_command,
        analyse_command,
        scenario_command,
        plan_command,
        field_command,
    ):
        command.add_to(commands)
    return parser
