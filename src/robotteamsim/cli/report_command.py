"""`robotteamsim report`: make one page with figures, tables and tests from the store of a campaign."""

from __future__ import annotations

import argparse
import json
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Console

from robotteamsim.campaign import StoredCampaign, read_store
from robotteamsim.cli.parser import Parser, path_of
from robotteamsim.cli.progress import working
from robotteamsim.cli.run_command import add_code_option
from robotteamsim.errors import CampaignError
from robotteamsim.recording.files import prepare_folder, remove_empty
from robotteamsim.wording import printable

if TYPE_CHECKING:
    from robotteamsim.analysis.report import Report

DESCRIPTION = """\
Make the report of a campaign: report.html, which needs no other file, the figures as PNG, and the
tables as CSV and LaTeX. The same store always gives the same bytes. The page compares the
settings, and plays the best, the median and the worst mission, which are simulated again and must
have the stored trajectories; the next report shows them at once."""

EPILOG = """\
examples:
  robotteamsim report DIR
  robotteamsim report DIR --out page
  robotteamsim report DIR --width column --out paper
  robotteamsim report garage_1 garage_2 garage_3 --out garage_report"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument(
        "folders",
        type=path_of,
        nargs="+",
        metavar="DIR",
        help="folder of the campaign (--out of `campaign`); several campaigns of one design, with different seeds, "
        "get one report",
    )
    parser.add_argument(
        "--out", type=path_of, metavar="DIR", help="folder for the report; default the folder of the only campaign"
    )
    parser.add_argument(
        "--each-pair",
        action="store_true",
        help="compare each pair of algorithms, not only each with the first; and any number of pairs of settings",
    )
    parser.add_argument(
        "--width",
        choices=("column", "page"),
        help="draw the files of figures for a paper in two columns, 3.5 or 7.16 inches wide with text of 8 pt, also "
        "as PDF, and let wide LaTeX tables span both columns",
    )
    parser.add_argument("--pdf", action="store_true", help="also write the figures as PDF")
    parser.add_argument("--svg", action="store_true", help="also write the figures as SVG")
    parser.add_argument("--no-players", action="store_true", help="leave out the three missions, about 2 MB")
    add_code_option(parser)
    parser.add_argument("--json", action="store_true", help="print opening and notes as one JSON object")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Make the report and print how the settings compare. Returns: 0, or 1 if a controller failed in a mission."""
    if len(options.folders) > 1 and options.out is None:
        raise CampaignError("--out: missing; expected a folder for the report of several campaigns")
    stored = [read_store(folder) for folder in options.folders]
    out = options.out or options.folders[0]
    created = prepare_folder(out)  # first, because the report takes long
    try:
        with working(Console(stderr=True), "report", "missions, figures and tables"):
            report = _report(stored, options)
            path = report.write(out)
    finally:
        remove_empty(created)
    failed = sum(bool(outcome.controller_failed) for one in stored for outcome in one.outcomes)
    if options.json:
        document = {"report": str(path), "opening": report.opening, "notes": report.notes, "controllers_failed": failed}
        print(json.dumps(document, ensure_ascii=False))
    else:
        for paragraph in (*report.opening, *report.notes):
            print(textwrap.fill(printable(paragraph), 100))
        print(f"written {path}")
    return 1 if failed else 0


def _report(stored: Sequence[StoredCampaign], options: argparse.Namespace) -> Report:
    # Imported late, because Matplotlib and statsmodels take longer to load than a short mission takes to run.
    from robotteamsim.analysis.report import PAPERS, make_report

    places = [str(folder) for folder in options.folders]
    missions = None
    if not options.no_players:
        from robotteamsim.view.campaign_missions import shown_missions

        missions = shown_missions(stored, places, allow_code=options.allow_code)
    wanted = {"pdf": options.pdf or options.width, "svg": options.svg}
    return make_report(
        stored,
        places,
        missions,
        each_pair=options.each_pair,
        paper=PAPERS.get(options.width),
        formats=[kind for kind, is_wanted in wanted.items() if is_wanted],
    )
