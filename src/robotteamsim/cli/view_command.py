"""`robotteamsim view`: watch a mission in the browser, live or recorded, or write it as one HTML file."""

from __future__ import annotations

import argparse
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING

from robotteamsim import scenario
from robotteamsim.arguments import positive_number, whole_number
from robotteamsim.cli.output import check_outputs
from robotteamsim.cli.parser import Parser, UsageError, path_of
from robotteamsim.cli.run_command import SCENARIO_HELP, TRAJECTORIES, add_scenario_options, check_code, load_scenario
from robotteamsim.recording.bag_paths import files_of, is_bag
from robotteamsim.recording.files import write_atomically
from robotteamsim.recording.results import FILE_NAME, read_mission

if TYPE_CHECKING:
    from robotteamsim.view.recorder import Recording
    from robotteamsim.view.server import ViewServer

DESCRIPTION = """\
Show a mission in the browser. A scenario runs live: pause it, open doors, move victims, change the
noise. A bag, also a folder of `ros2 bag record`, or the folder of `run --out`, is played back. With
--html, the mission is written to one file that any browser opens without a network, on phones as well."""

EPILOG = """\
Only browsers on this machine can connect or, with --host, all that know the printed address. A folder
is simulated again from its mission.json, which takes a second; the result must be the same, bit for bit.

examples:
  robotteamsim view garage_sar
  robotteamsim view garage_sar --html mission.html
  robotteamsim view results --html mission.html
  robotteamsim view mission.bag --scenario garage_sar
  robotteamsim view one.bag --compare two.bag --html both.html"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument("target", metavar="TARGET", help=f"a bag, a folder of `run --out`, or {SCENARIO_HELP}")
    add_scenario_options(parser)
    parser.add_argument("--html", type=path_of, metavar="FILE", help="write one self-contained page instead")
    parser.add_argument("--compare", metavar="TARGET", help="show a second mission next to the first")
    parser.add_argument("--scenario", metavar="SCENARIO", help="for bags: draw its building instead of the bag's /map")
    parser.add_argument(
        "--odometry", action="append", default=[], metavar="TOPIC", help="for bags: as in `robotteamsim analyse`"
    )
    parser.add_argument(
        "--speed", type=positive_number, default=10.0, metavar="X", help="simulated over wall time; default 10"
    )
    parser.add_argument(
        "--host", metavar="ADDRESS",
        help="listen at this address of the machine; browsers need the printed one, which contains a secret; default "
        "127.0.0.1",
    )  # fmt: skip
    parser.add_argument("--port", type=whole_number, default=0, metavar="N", help="of the address; default: a free one")
    parser.add_argument("--no-browser", action="store_true", help="print the address, and open no browser")
    parser.set_defaults(command=view)


def view(options: argparse.Namespace) -> None:
    """Show the mission until Ctrl-C, or write the page."""
    targets = [options.target, *([options.compare] if options.compare else [])]
    _check(options, targets)
    if options.html:
        loaded = _loaded(options, targets)
        check_outputs({"--html": options.html}, _inputs(options, targets, loaded))
        write_atomically(options.html, _page(options, targets, loaded))
        print(options.html)
    elif options.compare or _is_recorded(options.target):
        from robotteamsim.view.server import ViewServer

        _serve(options, ViewServer(options.port, _page(options, targets, _loaded(options, targets)), host=options.host))
    else:
        _show_live(options)


def _check(options: argparse.Namespace, targets: list[str]) -> None:
    """Raises: UsageError: an option is out of range, or would have no effect."""
    from robotteamsim.view.shown import LEAST_SPEED, MOST_SPEED

    if not 0 <= options.port <= 65535:
        raise UsageError(f"--port {options.port} is outside 0 to 65535")
    if not LEAST_SPEED <= options.speed <= MOST_SPEED:
        raise UsageError(f"--speed {options.speed:g} is outside {LEAST_SPEED:g} to {MOST_SPEED:g}")
    if options.host == "" or (options.host and options.html):
        raise UsageError(f"--host {options.host or repr('')}: expected an address, and no --html, which serves nothing")
    for option, value in (("--scenario", options.scenario), ("--odometry", ", ".join(options.odometry))):
        if value and not any(map(is_bag, targets)):
            raise UsageError(f"{option} {value}: only allowed for bags; got {', '.join(targets)}")
    given = {"--seed": options.seed, "--noise": options.noise, "--robots": options.robots}
    changed = [option for option, value in given.items() if value is not None]
    changed += ["--set"] if options.overrides else []
    if changed and all(map(_is_recorded, targets)):
        raise UsageError(f"{changed[0]}: has no effect on recordings: {', '.join(targets)}")


def _loaded(options: argparse.Namespace, targets: list[str]) -> dict[str, scenario.Scenario]:
    """Return the scenarios among the targets, by name. Raises: ScenarioError."""
    return {target: load_scenario(options, target) for target in targets if not _is_recorded(target)}


def _inputs(options: argparse.Namespace, targets: list[str], loaded: dict[str, scenario.Scenario]) -> list[str | Path]:
    """Return the files of bags, folders and scenarios. Raises: ScenarioError."""
    files: list[str | Path] = []
    for target in map(Path, targets):
        # All files of a recorded mission belong together, although only one is read.
        is_mission = target.is_dir() and not is_bag(target)
        files += [target / FILE_NAME, *(target / TRAJECTORIES).glob("*")] if is_mission else files_of(target)
    scenarios = [*loaded.values(), *([scenario.load(options.scenario)] if options.scenario else [])]
    return [*files, *(file for one in scenarios for file in one.origin.files)]


def _show_live(options: argparse.Namespace) -> None:
    # Imported late, because other commands need neither server nor page.
    from robotteamsim.view.html import live_page
    from robotteamsim.view.live import LiveMission
    from robotteamsim.view.server import ViewServer

    def load(seed: int | None) -> scenario.Scenario:
        if seed is not None:
            options.seed = seed
        loaded = load_scenario(options, options.target)
        check_code(options, loaded)
        return loaded

    mission = LiveMission(load, speed=options.speed, playing=True)
    mission.start()
    try:
        _serve(options, ViewServer(options.port, live_page(options.target), mission, options.host))
    finally:
        mission.close()


def _serve(options: argparse.Namespace, server: ViewServer) -> None:
    """Serve until Ctrl-C. Raises: RobotTeamSimError: see `ViewServer`. KeyboardInterrupt: the end."""
    with server:
        print(f"{server.url}  (Ctrl-C ends it)", flush=True)
        if not options.no_browser and not webbrowser.open(server.url):
            print("No browser was found: open this address yourself.", flush=True)
        server.serve_forever(poll_interval=0.1)


def _page(options: argparse.Namespace, targets: list[str], loaded: dict[str, scenario.Scenario]) -> str:
    from robotteamsim.view.html import mission_page

    recordings = [_recording(options, target, loaded.get(target)) for target in targets]
    title = recordings[0].title if len(recordings) == 1 else " and ".join(one.title for one in recordings)
    return mission_page(recordings, title, compare=len(recordings) > 1)


def _is_recorded(target: str) -> bool:
    return Path(target).is_dir() or is_bag(target)


def _recording(options: argparse.Namespace, target: str, loaded: scenario.Scenario | None) -> Recording:
    """Simulate a scenario, read a bag, or simulate the mission of a folder again."""
    from robotteamsim.view.recorder import record_mission

    if loaded is not None:
        check_code(options, loaded)
        return record_mission(loaded)[0]
    if is_bag(target):
        from robotteamsim.recording.replay.reading import read_run
        from robotteamsim.view.from_bag import recording_of

        building = scenario.load(options.scenario) if options.scenario else None
        return recording_of(read_run([Path(target)], options.odometry), building)
    return _repeated(options, Path(target))


def _repeated(options: argparse.Namespace, folder: Path) -> Recording:
    """Simulate the mission of a folder again. Raises: RecordingError: the result is another one."""
    from robotteamsim.view.recorder import repeat_mission

    path = folder / FILE_NAME
    data, expected = read_mission(folder)
    loaded = scenario.from_mapping(data, str(path))
    check_code(options, loaded)
    return repeat_mission(loaded, expected, str(path))
