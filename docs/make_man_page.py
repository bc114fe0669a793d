"""Write the man page of the command line: python docs/make_man_page.py FILE; the same command always the same bytes."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from argparse_manpage.manpage import Manpage

from robotteamsim.cli.main import make_parser

DATA = {
    "project_name": "robotteamsim",
    "prog": "robotteamsim",
    "date": "2026",
    "manual_section": 1,
    "manual_title": "robotteamsim",
}


def man_page() -> str:
    """Return the page in roff; a width is set, so that it does not depend on the terminal."""
    os.environ["COLUMNS"] = "100"
    text = str(Manpage(make_parser(), _data=DATA))
    return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(man_page(), encoding="utf-8")
