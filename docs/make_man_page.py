"""Write the man page of the command line; the same command always gives the same bytes.

Usage: python docs/make_man_page.py FILE [SOURCES CORE]: with the package in SOURCES and its module _core in CORE.
"""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

from argparse_manpage.manpage import Manpage

DATA = {
    "project_name": "robotteamsim",
    "description": "simulate teams of mobile robots in search and rescue",
    "prog": "robotteamsim",
    "date": "2026",
    "manual_section": 1,
    "manual_title": "robotteamsim",
}

_USAGE = re.compile(r"^usage: ((?:.+\n)+)", re.MULTILINE)
"""A usage of several lines, which would be joined to one."""


def man_page() -> str:
    """Return the page in roff; a width is set, so that it does not depend on the terminal."""
    from robotteamsim.cli.command_line import make_parser

    os.environ["COLUMNS"] = "72"
    lines = [line.rstrip() for line in str(Manpage(make_parser(), _data=DATA)).splitlines()]
    return _USAGE.sub(_as_it_is, "\n".join(lines) + "\n")


def _as_it_is(usage: re.Match[str]) -> str:
    """Return a usage in roff without filling, its lines below the command."""
    unfilled = usage[1].replace("\n" + " " * len("usage: "), "\n")
    return f".nf\n{unfilled}.fi\n"


def main(file: str, sources: str = "", core: str = "") -> None:
    """Write the page."""
    if sources:
        sys.path.insert(0, sources)
        import robotteamsim

        robotteamsim.__path__.append(core)
    Path(file).write_text(man_page(), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
