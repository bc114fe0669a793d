"""`robotteamsim field`: pictures of radio and voice maps."""

from __future__ import annotations

import argparse
from typing import Any

from robotteamsim import scenario
from robotteamsim.cli.parser import UsageError, number, point
from robotteamsim.cli.pictures import add_png_option, save
from robotteamsim.cli.run_command import add_set_option

RADIO_RESOLUTION_M = 0.1

_EPILOG = """\
examples:
  robotteamsim field radio garage_sar --at 4,5 --png radio.png
  robotteamsim field voice garage_sar --set voice.noise_db=30 --png voice.png"""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("field", help="draw a radio or voice map", description=__doc__, epilog=_EPILOG)
    kinds = parser.add_subparsers(title="maps", metavar="radio|voice", required=True)

    radio = kinds.add_parser("radio", help="what a robot's radio is received with, everywhere")
    radio.add_argument("--at", type=point, metavar="X,Y", help="the transmitter [m]; robot 0 at its start if not given")
    radio.add_argument(
        "--resolution", type=number, default=RADIO_RESOLUTION_M, metavar="M", help="cell [m]; default %(default)s"
    )
    radio.set_defaults(command=draw_radio)

    voice = kinds.add_parser("voice", help="what is heard of the victims, everywhere")
    voice.add_argument("--at", type=point, metavar="X,Y", help="one victim here [m] instead of the scenario's")
    voice.set_defaults(command=draw_voice)

    for kind in (radio, voice):
        kind.add_argument("scenario", metavar="SCENARIO", help="a file or a shipped name")
        add_set_option(kind)
        add_png_option(kind)


def draw_radio(options: argparse.Namespace) -> None:
    """Draw the signal strength of one transmitter."""
    # Imported late: Matplotlib takes longer to start than a short mission.
    from robotteamsim.analysis.field_picture import FieldStyle, Spot, draw_field
    from robotteamsim.propagation import RadioField

    loaded = scenario.load(options.scenario, options.overrides)
    if not 0.01 <= options.resolution <= 10.0:
        raise UsageError(f"--resolution {options.resolution:g} is not within 0.01 .. 10 m")
    at_m = _inside(loaded, options.at) if options.at else loaded.placed_robots()[0].start_pose[:2]
    field = RadioField(loaded.plan, loaded.radio).rssi_map_dbm(at_m, options.resolution)
    network = loaded.network
    style = FieldStyle(
        quantity="signal strength",
        unit="dBm",
        colours="viridis",
        low=network.lost_below_dbm,
        high=loaded.radio.tx_power_dbm - loaded.radio.constant_loss_db,
        silent_below=network.lost_below_dbm,
        silence=f"below {network.lost_below_dbm:g} dBm, no link",
        contours=((network.endangered_below_dbm, f"endangered {network.endangered_below_dbm:g} dBm"),),
    )
    title = f"{loaded.plan.name}: radio of a robot at ({at_m[0]:g}, {at_m[1]:g}), {loaded.radio.tx_power_dbm:g} dBm"
    save(draw_field(field, loaded.plan, style, title, [Spot("transmitter", at_m)]), options.png)


def draw_voice(options: argparse.Namespace) -> None:
    """Draw the voice map."""
    from robotteamsim.analysis.field_picture import FieldStyle, Spot, draw_field
    from robotteamsim.scenario.sections import Victim
    from robotteamsim.sensing.voice import VoiceSensor

    loaded = scenario.load(options.scenario, options.overrides)
    victims = loaded.mission.victims
    if options.at:
        victims = (Victim(name="victim", position=_inside(loaded, options.at)),)
    field = VoiceSensor(loaded.plan, loaded.voice, victims, loaded.run.seed).map()
    noise_db = loaded.voice.noise_db
    style = FieldStyle(
        quantity="voice level",
        unit="dB",
        colours="magma",
        low=noise_db,
        high=-loaded.voice.constant_db[0],
        silent_below=max(noise_db, 1e-9),
        silence="below the noise",
        contours=tuple((level, f"{level:g} dB") for level in (20.0, 30.0, 40.0) if level > noise_db),
    )
    title = f"{loaded.plan.name}: voices above {noise_db:g} dB of noise, seed {loaded.run.seed}"
    spots = [Spot(victim.name, victim.position) for victim in victims]
    save(draw_field(field, loaded.plan, style, title, spots), options.png)


def _inside(loaded: scenario.Scenario, point_m: tuple[float, float]) -> tuple[float, float]:
    if not loaded.plan.bounds.contains(point_m):
        raise UsageError(f"--at {point_m[0]:g},{point_m[1]:g} lies outside the plan, {loaded.plan.bounds}")
    return point_m
