"""Options of importers and exporters on the command line."""

import argparse
from collections.abc import Iterable, Mapping
from typing import Any

Options = Mapping[str, Mapping[str, Any]]
"""Options of a command by name, such as `--layer`: the settings of `argparse`'s `add_argument`, without a default."""

LEVEL: Options = {
    "--level": {
        "metavar": "NAME",
        "help": "one level of a building, default: all",
    }
}

_TAKEN = ("--command", "--file", "--force", "--out", "--overrides", "--png", "--scenario", "--set")
_OURS = ("default", "dest", "required")
"""Settings that an option must not have."""


def add_options(parser: argparse.ArgumentParser, options: Options) -> None:
    """Add options; only those that are given are among the parsed ones. Raises: ArgumentError: two of one name."""
    for name, settings in options.items():
        parser.add_argument(name, dest=_keyword(name), **{"default": argparse.SUPPRESS, **settings})


def given(options: argparse.Namespace, names: Iterable[str]) -> dict[str, Any]:
    """Return the options of these names that were given, by their keywords."""
    return {_keyword(name): getattr(options, _keyword(name)) for name in names if hasattr(options, _keyword(name))}


def _keyword(option: str) -> str:
    return option.lstrip("-").replace("-", "_")


def check_options(options: Options) -> None:
    """Raises: ValueError, TypeError: one line on an option that no command can have."""
    parser = argparse.ArgumentParser()
    for name in _TAKEN:
        parser.add_argument(name)
    for name, settings in options.items():
        if not name.startswith("--"):
            raise ValueError(f"option '{name}'; expected a name that begins with --")
        if wrong := sorted(set(settings) & set(_OURS)):
            raise ValueError(f"option {name} has {wrong[0]}; expected none")
    try:
        add_options(parser, options)
        parser.format_help()
    except argparse.ArgumentError as error:
        raise ValueError(str(error)) from None
