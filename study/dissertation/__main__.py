"""Command line of the study: `python -m study.dissertation --help`."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from robotteamsim.campaign import read_store
from robotteamsim.cli import main as robotteamsim
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.view.campaign_missions import shown_missions
from study.dissertation.report import make_study
from study.dissertation.tables import dissertation_tables, missions_by_noise

SEEDS = (314159265, 271828182, 141421356, 173205080, 223606797)
"""The first nine digits of pi, e, and the square roots of 2, 3 and 5. None was used to choose a parameter."""
NOISES_DB = (10, 20, 30)
TRIALS = 100


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command. Returns: an exit status."""
    parser = argparse.ArgumentParser(prog="study.dissertation", description="The study of the dissertation.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    run = commands.add_parser("run", help="run the five campaigns and write the report: `make report`")
    run.add_argument("--folder", type=Path, default=Path("build/report"), help="of the campaigns; %(default)s")
    run.add_argument("--out", type=Path, default=Path("study/dissertation/report"), help="of the report; %(default)s")
    run.add_argument("--resume", action="store_true", help="keep finished missions: only if no code has changed")
    run.set_defaults(command=_run)
    report = commands.add_parser("report", help="judge each claim by campaigns of the garage, and write the report")
    report.add_argument("folders", type=Path, nargs="+", metavar="DIR", help="of campaigns with different seeds")
    report.add_argument("--out", type=Path, required=True, metavar="DIR", help="of the report")
    report.add_argument("--no-players", action="store_true", help="leave out the three missions, about 2 MB")
    report.set_defaults(command=lambda options: _report(options.folders, options.out, not options.no_players))
    tables = commands.add_parser("tables", help="print Tables 6 to 9, our values next to the dissertation's")
    tables.add_argument("folder", type=Path, metavar="DIR", help="of a campaign of the garage")
    tables.set_defaults(command=_tables)
    options = parser.parse_args(arguments)
    try:
        status: int = options.command(options)
    except RobotTeamSimError as error:
        print(f"study.dissertation: {error}", file=sys.stderr)
        return 1
    return status


def _run(options: argparse.Namespace) -> int:
    if not options.resume:
        shutil.rmtree(options.folder, ignore_errors=True)
    folders = [options.folder / f"seed_{seed}" for seed in SEEDS]
    noise = [word for noise_db in NOISES_DB for word in ("--noise", str(noise_db))]
    for seed, folder in zip(SEEDS, folders, strict=True):
        command = ["campaign", "garage_sar", *noise, "--trials", str(TRIALS), "--seed", str(seed), "--quiet"]
        print(f"-- {TRIALS} trials per level, seed {seed}", flush=True)
        if status := robotteamsim([*command, "--out", str(folder)]):
            return status
    return _report(folders, options.out, True)


def _report(folders: Sequence[Path], out: Path, players: bool) -> int:
    stored, places = [read_store(folder) for folder in folders], [str(folder) for folder in folders]
    missions = shown_missions(stored, places, allow_code=False) if players else None
    study = make_study(stored, places, missions)
    path = study.report.write(out)
    print("\n".join((*study.report.opening, *study.report.notes)))
    width = max(len(claim.verdict) for claim in study.claims)
    for title, fitted in (("Not fitted: the test", False), ("Fitted: calibration", True)):
        print(f"\n{title}")
        for claim in study.claims:
            if claim.fitted is fitted:
                print(f"{claim.verdict:<{width}}  {claim.passed_text:10}  {claim.text}")
    print(f"\nwritten {path}")
    return 0


def _tables(options: argparse.Namespace) -> int:
    missions = missions_by_noise(read_store(options.folder), str(options.folder))
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
    print(dissertation_tables(missions) if width is None else dissertation_tables(missions, width))
    return 0


if __name__ == "__main__":
    sys.exit(main())
