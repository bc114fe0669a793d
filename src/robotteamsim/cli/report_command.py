"""`robotteamsim report`: make one page with figures, tables and verdicts from the store of a campaign."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import Any

from robotteamsim.campaign import read_store
from robotteamsim.cli.parser import path_of

_DESCRIPTION = """\
Make the report of a campaign: report.html, which needs no other file, the figures as PNG,
and the tables as CSV and LaTeX. The same store always gives the same bytes. Campaigns of
the garage with 10, 20 or 30 dB of noise are compared with the dissertation."""

_EPILOG = """\
examples:
  robotteamsim report DIR
  robotteamsim report DIR --out docs/report"""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("report", help="make a campaign's report", description=_DESCRIPTION, epilog=_EPILOG)
    parser.add_argument("folder", type=path_of, metavar="DIR", help="folder of the campaign (--out of `campaign`)")
    parser.add_argument(
        "--out", type=path_of, metavar="DIR", help="folder for the report; default the folder of the campaign"
    )
    parser.add_argument("--json", action="store_true", help="print notes and claims as one JSON object")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> None:
    """Make the report and print its verdicts."""
    stored = read_store(options.folder)
    # Imported late, because Matplotlib and statsmodels take longer to load than a short mission takes to run.
    from robotteamsim.analysis.report import make_report

    report = make_report(stored, str(options.folder))
    path = report.write(options.out or options.folder)
    if options.json:
        claims = [asdict(claim) for claim in report.claims]
        print(json.dumps({"report": str(path), "notes": list(report.notes), "claims": claims}, ensure_ascii=False))
        return
    for note in report.notes:
        print(note)
    width = max((len(claim.verdict) for claim in report.claims), default=0)
    for claim in report.claims:
        print(f"{claim.verdict:<{width}}  {claim.text}")
    print(f"{chr(10) if report.claims or report.notes else ''}written {path}")
