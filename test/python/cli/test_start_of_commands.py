"""A command imports its modules when it is used; each is described and completed all the same."""

from __future__ import annotations

import argparse
import subprocess
import sys

import pytest

from robotteamsim.cli.command_line import make_parser

HEAVY = {"matplotlib", "msgspec", "numpy", "pydantic", "rich", "rosbags", "ruamel", "scipy", "shapely", "yaml"}


def imported(*words: str) -> set[str]:
    """Return the modules that a command has imported when its process ends."""
    code = f"import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr)); sys.argv[1:] = {words}"
    program = [sys.executable, "-c", f"{code}; import robotteamsim.cli; robotteamsim.cli.run_and_exit()"]
    done = subprocess.run(program, capture_output=True, text=True, check=False)
    return set(done.stderr.splitlines()[-1].split())


def commands_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    return parser.commands.choices  # type: ignore[attr-defined,no-any-return]


@pytest.mark.parametrize("words", [("--help",), ("--version",), ("help",), ()])
def test_help_and_version_import_no_library(words: tuple[str, ...]) -> None:
    names = imported(*words)
    assert "argparse" in names
    assert not HEAVY & names
    assert not any(name.startswith("robotteamsim.scenario") for name in names)


def test_a_mission_without_files_imports_nothing_for_bags_pages_images_and_campaigns() -> None:
    names = imported("run", "garage_sar", "--set", "mission.time_limit_s=0.2", "--quiet")
    assert "robotteamsim.simulation.simulation" in names
    late = ("rosbags", "filelock", "robotteamsim.campaign", "robotteamsim.view.html", "robotteamsim.scenario.map_image")
    assert not names.intersection(late)


def test_argument_that_is_named_like_a_command_imports_no_command() -> None:
    names = imported("run", "campaign")
    assert "robotteamsim.cli.run_command" in names
    assert "robotteamsim.cli.campaign_command" not in names


def test_parser_of_all_commands_imports_nothing_that_takes_seconds() -> None:
    late = "{'dask', 'distributed', 'scipy.stats', 'matplotlib'}"
    code = f"import sys, robotteamsim.cli.command_line as c; c.make_parser(); assert not {late} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_used_command_has_the_options_that_it_has_in_the_parser_of_all_commands() -> None:
    for name, command in commands_of(make_parser()).items():
        alone = commands_of(make_parser([name]))
        assert alone[name].format_help() == command.format_help()
        assert name == "help" or len(command.format_usage()) > len("usage: robotteamsim completion [-h]\n")
        assert all(alone[other].format_usage() == f"usage: robotteamsim {other} [-h]\n" for other in {*alone} - {name})
