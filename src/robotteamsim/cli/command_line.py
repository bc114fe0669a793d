"""Entry point of the command line: runs a command and prints each error as one line."""

from __future__ import annotations

import argparse
import contextlib
import errno
import gc
import importlib
import logging
import os
import re
import sys
import traceback
from collections.abc import Iterator, Sequence

import robotteamsim
from robotteamsim.cli.interrupt import HungUp, Terminated, signals_raised
from robotteamsim.cli.parser import Parser, UsageError
from robotteamsim.cli.streams import close_stdout, open_streams
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.extras import missing_extra
from robotteamsim.wording import described, printable

EXIT_ERROR = 1
EXIT_MISTAKE = 2
EXIT_HUNG_UP = 129
EXIT_INTERRUPTED = 130
EXIT_BROKEN_PIPE = 141
EXIT_TERMINATED = 143

_DEBUG = "--debug"

_COMMANDS = {
    "run": "run one mission",
    "view": "watch a mission in the browser, or write it as one HTML file",
    "campaign": "run many missions",
    "report": "make a campaign's report",
    "benchmark": "compare controllers under one protocol",
    "analyse": "summarise bags as tables and pictures",
    "judge": "judge a bag by the mission of a scenario",
    "scenario": "check, show or list scenarios",
    "plan": "import, export or draw floor plans",
    "field": "draw a radio or voice map",
    "new": "write a scenario, controller, package or exercises to start from",
    "completion": "print a script for completion in a shell",
}
"""What each command does, which its module <name>_command describes; imported on use, because that takes a while."""

_EXAMPLES = """\
examples:
  robotteamsim run garage_sar                        one mission, with a table of its events
  robotteamsim view garage_sar                       the same, live in the browser
  robotteamsim run garage_sar --seed 7 --noise 20 --out results --bag mission.bag
  robotteamsim run my.yaml --set control.alpha=0.5 --json
  robotteamsim campaign garage_sar --noise 10 --noise 20 --trials 30 --out DIR
  robotteamsim report DIR                            figures, tests and verdicts of a campaign on one page
  robotteamsim benchmark search --out DIR            controllers compared in searches for random victims
  robotteamsim analyse mission.bag                   summary of any bag: headless, ROS or real robots
  robotteamsim scenario show garage_sar              every key and its value
  robotteamsim field voice garage_sar --png voice.png
  robotteamsim new scenario my_house                 files to start from
  robotteamsim plan import map.yaml --out plan.yaml  a map_server image as walls
  robotteamsim plan import office.world              a Stage world as a scenario

`robotteamsim help COMMAND` describes a command in detail."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    With --debug anywhere among the arguments, an error also prints its traceback, and warnings of libraries are shown.

    Returns: 0; 1 for failed trials, missions in which a controller failed, or an error that is not the user's; 2 for a
        user's mistake; 129 if the terminal was closed; 130 if interrupted; 141 for a broken pipe; 143 if terminated.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    open_streams()
    # Only figures are drawn, and never on a screen. A shell inside Jupyter names a backend that is not installed here.
    os.environ["MPLBACKEND"] = "Agg"
    raised: list[KeyboardInterrupt] = []
    try:
        with signals_raised() as raised, _without_warnings(_DEBUG not in words):
            return _run([word for word in words if word != _DEBUG])
    except (Exception, KeyboardInterrupt) as error:
        if _DEBUG in words:
            traceback.print_exc()
        if isinstance(error, RobotTeamSimError) and not raised:
            from robotteamsim.cli.foreign_files import foreign_file

            foreign = foreign_file(words)
            error = UsageError(foreign) if foreign else error
        return _reported(raised[-1] if raised else error)


@contextlib.contextmanager
def _without_warnings(hidden: bool) -> Iterator[None]:
    """Keep Python's warnings, such as those of libraries about odd input, off the terminal: errors are one line."""
    logging.captureWarnings(hidden)
    matplotlib = logging.getLogger("matplotlib")  # it warns that its folder of caches cannot be written
    level = matplotlib.level
    if hidden:
        matplotlib.setLevel(logging.ERROR)
    try:
        yield
    finally:
        matplotlib.setLevel(level)
        logging.captureWarnings(False)


def _run(words: list[str]) -> int:
    if words[:1] == ["help"] or not words:
        words = [*words[1:], "--help"]
    try:
        os.getcwd()
    except FileNotFoundError:
        raise UsageError("the current folder does not exist any more") from None
    for word in words:
        if "\0" in word:
            raise UsageError(f"{word}: contains a NUL, which no name and no value does")
        if not word.isascii() and re.search("[\ud800-\udfff]", word):  # what Python makes of other bytes
            raise UsageError(f"{word}: is not UTF-8; rename the file, or write the value in UTF-8")
    try:
        options = make_parser(words[:1]).parse_args(words)
    except SystemExit:
        sys.stdout.flush()  # of a help text, whose reader may be gone
        raise
    if not gc.isenabled():
        gc.freeze()  # what imports have made stays
        gc.enable()
    status = options.command(options)
    sys.stdout.flush()
    return status or 0


def _reported(error: BaseException) -> int:
    """Print an error as one line and return the exit status for it."""
    match error:
        case BrokenPipeError():  # the reader has closed the pipe
            close_stdout()
            return EXIT_BROKEN_PIPE
        case HungUp():
            line, status = "terminated, because the terminal was closed", EXIT_HUNG_UP
        case Terminated():
            line, status = "terminated", EXIT_TERMINATED
        case KeyboardInterrupt():
            line, status = "interrupted", EXIT_INTERRUPTED
        case RobotTeamSimError():
            line, status = str(error), EXIT_MISTAKE
        case OSError(errno=errno.EMFILE | errno.ENFILE):
            line, status = "too many open files; raise `ulimit -n`", EXIT_ERROR
        case OSError(errno=errno.EAGAIN) | RuntimeError(args=("can't start new thread",)):
            line, status = "no more threads or processes can be started; raise `ulimit -u`", EXIT_ERROR
        case OSError(filename=None):
            close_stdout()
            line, status = f"standard output: {error.strerror or error}", EXIT_ERROR
        case OSError():
            line, status = f"{error.filename}: {error.strerror or error}", EXIT_MISTAKE
        case ModuleNotFoundError() if missing_extra(error) is not None:
            line, status = str(missing_extra(error)), EXIT_ERROR
        case MemoryError():
            line, status = "out of memory", EXIT_ERROR
        case _:
            *_, last = traceback.extract_tb(error.__traceback__)
            where = f"{os.path.basename(last.filename)}:{last.lineno}"
            line = f"internal error: {described(error)} ({where}); {_DEBUG} shows more"
            status = EXIT_ERROR
    print(f"robotteamsim: {printable(line)}", file=sys.stderr)
    return status


def make_parser(words: Sequence[str] = tuple(_COMMANDS)) -> argparse.ArgumentParser:
    """Return the parser of all commands; only those among the words have their texts and options."""
    parser = Parser(
        prog="robotteamsim",
        description="Simulate teams of mobile robots in search and rescue missions, and analyse the results.",
        epilog=_EXAMPLES,
    )
    parser.add_argument("-V", "--version", action="version", version=f"robotteamsim {robotteamsim.__version__}")
    parser.add_argument(_DEBUG, action="store_true", help="print the traceback of an error")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, text in _COMMANDS.items():
        command = commands.add_parser(name, help=text)
        if name in words:
            module = importlib.import_module(f"robotteamsim.cli.{name}_command")
            command.description = getattr(module, "DESCRIPTION", module.__doc__)
            command.epilog = getattr(module, "EPILOG", None)
            module.add_to(command)
    commands.add_parser("help", help="describe a command, such as `robotteamsim help run`")
    return parser
