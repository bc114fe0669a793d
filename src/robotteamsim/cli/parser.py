"""The argument parser of all commands, and argument types shared by several commands."""

import argparse
import difflib
import re
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from robotteamsim.errors import RobotTeamSimError

COMPLETE_FILES = {"bash": "_shtab_compgen_files", "zsh": "_files", "tcsh": "f"}
COMPLETE_SCENARIOS = {"bash": "_robotteamsim_scenarios", "zsh": "_files", "tcsh": "f"}
COMPLETE_KEYS = {"bash": "_robotteamsim_keys"}
"""What shells complete, as shtab names it."""
PICTURES = (".png", ".pdf", ".svg")
"""Kinds of pictures that commands write."""


class UsageError(RobotTeamSimError):
    """The command line is invalid."""


class Parser(argparse.ArgumentParser):
    """Rejects abbreviations, keeps line breaks in help texts, and raises mistakes as a UsageError of one line."""

    def __init__(self, **settings: object) -> None:
        super().__init__(allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter, **settings)  # type: ignore[arg-type]
        self.commands: Any = None

    def add_argument(self, *names: Any, **settings: Any) -> argparse.Action:
        """Add an argument; shells complete paths and scenarios."""
        if choices := settings.get("choices"):
            settings["type"] = partial(self._one_of, choices, names[0])
        action = super().add_argument(*names, **settings)
        if settings.get("metavar") == "SCENARIO":
            action.complete = COMPLETE_SCENARIOS  # type: ignore[attr-defined]  # read by shtab
        elif settings.get("type") in (path_of, picture_of, folder_of):
            action.complete = COMPLETE_FILES  # type: ignore[attr-defined]
        elif "--set" in names:
            action.complete = COMPLETE_KEYS  # type: ignore[attr-defined]
        return action

    def _one_of(self, choices: Sequence[str], name: str, text: str) -> str:
        """Return one of the choices of an argument. Raises: UsageError."""
        if text not in choices:
            self.error(f"{name}: '{text}' is not valid; expected one of {', '.join(choices)}")
        return text

    def add_subparsers(self, **settings: Any) -> Any:
        """Add commands."""
        self.commands = super().add_subparsers(**settings)
        return self.commands

    def parse_known_args(  # type: ignore[override]  # argparse's overloads differ in the type of the namespace alone
        self, args: Any = None, namespace: Any = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse the arguments; none may be left over. Raises: UsageError."""
        words = _with_negative_values(sys.argv[1:] if args is None else args)
        command = next((word for word in words if not word.startswith("-")), None)
        if self.commands and command is not None and command not in self.commands.choices:
            near = difflib.get_close_matches(command, self.commands.choices, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"expected one of {', '.join(self.commands.choices)}"
            self.error(f"no such command '{command}'; {hint}")
        parsed, rest = super().parse_known_args(words, namespace)
        if rest:
            self.error(self._left_over(rest))
        return parsed, rest

    def _left_over(self, rest: Sequence[str]) -> str:
        option = rest[0].partition("=")[0]
        if not option.startswith("-"):
            return f"'{option}' is one argument too many"
        near = difflib.get_close_matches(option, re.findall(r"--[a-z-]+", self.format_usage()), n=1)
        return f"no such option '{option}'" + (f"; did you mean '{near[0]}'?" if near else "")

    def error(self, message: str) -> NoReturn:
        """Raise the mistake. Raises: UsageError."""
        raise UsageError(f"{message} (see `{self.prog} --help`)")


def _with_negative_values(words: Sequence[str]) -> list[str]:
    """Return words with --at=-1,5 for --at -1,5, because argparse takes -1,5 for an option."""
    # No option here starts with a digit.
    joined: list[str] = []
    for word in words:
        if re.match(r"-[\d.]", word) and joined and re.fullmatch(r"--[a-z-]+", joined[-1]):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def path_of(text: str) -> Path:
    """Return a path. Raises: ArgumentTypeError: it is empty, which would be the current folder."""
    if not text:
        raise argparse.ArgumentTypeError("the name is empty")
    return Path(text)


def folder_of(text: str) -> Path:
    """Return the path of a folder, which may not exist yet. Raises: ArgumentTypeError: it is something else."""
    path = path_of(text)
    if path.exists() and not path.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}' is not a folder")
    return path


def picture_of(text: str) -> Path:
    """Return the path of a picture. Raises: ArgumentTypeError: its suffix is not one of PICTURES."""
    path = path_of(text)
    if path.suffix.lower() not in PICTURES:
        raise argparse.ArgumentTypeError(f"'{text}' does not end in {', '.join(PICTURES[:-1])} or {PICTURES[-1]}")
    return path


def address(text: str) -> str:
    """Return the address of a scheduler. Raises: ArgumentTypeError: it is empty."""
    if not text:
        raise argparse.ArgumentTypeError("the address is empty; expected one such as tcp://10.0.0.1:8786")
    return text
