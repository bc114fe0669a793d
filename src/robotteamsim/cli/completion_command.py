"""`robotteamsim completion`: print a script that completes commands, options and names in a shell."""

from __future__ import annotations

import argparse
from typing import Any

from robotteamsim.cli.parser import COMPLETE_KEYS, COMPLETE_SCENARIOS, Parser, UsageError
from robotteamsim.scenario.problems import paths
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.shipped import scenario_names

SHELLS = ("bash", "zsh", "fish", "tcsh")

EPILOG = """\
examples:
  robotteamsim completion bash > ~/.local/share/bash-completion/completions/robotteamsim
  robotteamsim completion fish > ~/.config/fish/completions/robotteamsim.fish
  robotteamsim completion zsh > DIR/_robotteamsim      with DIR in $fpath"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument("shell", choices=SHELLS, help="the shell")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> None:
    """Print the script."""
    from robotteamsim.cli.command_line import make_parser  # which imports this module

    try:
        import shtab
    except ModuleNotFoundError:
        raise UsageError("completion needs the package shtab: pip install shtab") from None
    names = " ".join(scenario_names())
    keys = " ".join(f"{key}=" for key in sorted({*paths(Scenario)}))
    scenarios = f'{COMPLETE_SCENARIOS["bash"]}() {{ compgen -W "{names}" -- "$1"; _shtab_compgen_files "$1"; }}\n'
    settings = f'{COMPLETE_KEYS["bash"]}() {{ compgen -W "{keys}" -- "$1"; }}\n'
    preamble: Any = {"bash": scenarios + settings}
    print(shtab.complete(make_parser(), options.shell, preamble=preamble))
