"""Options of importers and exporters on the command line."""

import argparse
from collections.abc import Mapping
from typing import Any

Options = Mapping[str, Mapping[str, Any]]
"""Options of a command by name, such as `--layer`: the settings of `argparse`'s `add_argument`, without a default."""

_TAKEN = ("--command", "--file", "--force", "--out", "--overrides", "--png", "--scenario", "--set")


def check_options(options: Options) -> None:
    """Raises: ValueError, TypeError: one line on an option that no command can have."""
    parser = argparse.ArgumentParser()
    try:
        for name in _TAKEN:
            parser.add_argument(name)
        for name, settings in options.items():
            parser.add_argument(name, **settings)
    except argparse.ArgumentError as error:
        raise ValueError(str(error)) from None
