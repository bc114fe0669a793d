"""`robotteamsim field`: draw radio and voice maps, and write them as files."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from robotteamsim import scenario
from robotteamsim.arguments import number, point
from robotteamsim.cli.output import add_png_option, check_outputs, save
from robotteamsim.cli.parser import Parser, UsageError, path_of
from robotteamsim.cli.run_command import SCENARIO_HELP, add_set_option
from robotteamsim.errors import ScenarioError
from robotteamsim.recording.files import atomically
from robotteamsim.setup import resolve

if TYPE_CHECKING:
    from robotteamsim.analysis.fields.maps import VoiceRange
    from robotteamsim.analysis.fields.picture import FieldStyle, Panel

MAX_PANELS = 9
SHOWN_KEYS = ("voice.noise_db", "radio.tx_power_dbm")
"""Keys that the titles of the maps show anyway."""

MAX_CELLS = 50_000_000

_RADIO_TEXT = """\
Map the received signal strength of a radio; walls and closed doors attenuate it. Contour
lines are at -60 and -70 dBm, where a link is endangered (-80) and where it is lost (-94).
With several transmitters, each cell shows the strongest signal."""

_RADIO_EPILOG = """\
examples:
  robotteamsim field radio garage_sar --png radio.png
  robotteamsim field radio garage_sar --at 4,5 --at 30,36 --at 50,18 --png team.png
  robotteamsim field radio garage_sar --loss --compare at=4,5 --compare at=40,30 --png two.png
  robotteamsim field radio garage_sar --compare radio.pillars=true --compare radio.pillars=false --png pillars.png
  robotteamsim field radio garage_sar --out radio.npz"""

_VOICE_TEXT = """\
Map the level at which victims are heard. Contour lines are at 10, 20 and 30 dB: inside a
line, a victim can be heard over that much noise. l_c and gamma are drawn per victim from the
scenario's seed; --range uses the quiet or the loud ends of their ranges for all victims."""

_VOICE_EPILOG = """\
examples:
  robotteamsim field voice garage_sar --png voice.png
  robotteamsim field voice garage_sar --range lowest --png lowest.png
  robotteamsim field voice garage_sar --compare range=lowest --compare range=highest --png ranges.png
  robotteamsim field voice garage_sar --range highest --compare voice.noise_db=10 --compare voice.noise_db=30 \\
      --png noise.png
  robotteamsim field voice garage_sar --compare voice.wall_model=count --compare voice.wall_model=thickness \\
      --png models.png
  robotteamsim field voice garage_sar --at 29,4.5 --set voice.wall_loss_db=6 --png one.png --out one.npz"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    kinds = parser.add_subparsers(title="maps", metavar="radio|voice", required=True)

    radio = kinds.add_parser(
        "radio", help="map the received signal strength", description=_RADIO_TEXT, epilog=_RADIO_EPILOG
    )
    radio.add_argument("--loss", action="store_true", help="draw the path loss [dB] instead of the signal strength")
    radio.set_defaults(command=draw_radio, range="drawn")

    voice = kinds.add_parser(
        "voice", help="map the level of the victims' voices", description=_VOICE_TEXT, epilog=_VOICE_EPILOG
    )
    voice.add_argument(
        "--range",
        choices=("drawn", "lowest", "highest"),
        default="drawn",
        help="values of l_c and gamma; default drawn",
    )
    voice.set_defaults(command=draw_voice)

    positions = {
        radio: "position of a transmitter [m]; repeatable; default the start of robot 0",
        voice: "position of a victim [m] instead of the scenario's; repeatable",
    }
    for kind, position in positions.items():
        kind.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
        add_set_option(kind)
        kind.add_argument("--at", type=point, action="append", default=[], metavar="X,Y", help=position)
        kind.add_argument(
            "--resolution", type=number, metavar="M", help="cell size [m]; default 600 cells along the longer side"
        )
        kind.add_argument(
            "--compare",
            action="append",
            default=[],
            metavar="'K=V ...'",
            help="settings of one of several maps drawn side by side: as in --set, or at=X,Y, or range=...; repeatable",
        )
        add_png_option(kind, required=False)
        kind.add_argument("--out", type=path_of, metavar="FILE.npz", help="write the values for NumPy")


@dataclass(frozen=True, slots=True)
class _Variant:
    """One map to draw, with the settings of the command line and those of one --compare."""

    name: str
    overrides: list[str]
    at_m: list[tuple[float, float]]
    voice_range: VoiceRange
    own_keys: tuple[str, ...] = ()

    def load(self, options: argparse.Namespace) -> scenario.Scenario:
        """Load the scenario of this map. Raises: ScenarioError, UsageError: the message names the option."""
        try:
            loaded = scenario.load(options.scenario, self.overrides)
            resolve(loaded)
        except ScenarioError as error:
            error.args = (self._with_own_option(str(error)),)
            raise
        for x, y in self.at_m:
            if not loaded.plan.bounds.contains((x, y)):
                option = "--compare: at=" if "at" in self.own_keys else "--at "
                raise UsageError(f"{option}{x:g},{y:g} lies outside the plan, {loaded.plan.bounds}")
        return loaded

    def _with_own_option(self, message: str) -> str:
        """Return a message about --set, with --compare instead of --set if the key was given by --compare."""
        option, colon, rest = message.partition(": ")
        named = re.split("[:=]", rest.lstrip("'"))[0] + "."
        is_own = any(named.startswith(f"{key}.") or f"{key}.".startswith(named) for key in self.own_keys)
        return f"--compare{colon}{rest}" if option == "--set" and is_own else message


def draw_radio(options: argparse.Namespace) -> None:
    """Draw or write the radio maps."""
    # Imported late, because Matplotlib takes longer to load than a short mission takes to run.
    from robotteamsim.analysis.fields.maps import radio_panel, radio_style

    def panel(loaded: scenario.Scenario, variant: _Variant, resolution_m: float) -> Panel:
        return radio_panel(loaded, variant.at_m, resolution_m, options.loss)

    _draw(options, panel, lambda scenarios: radio_style(scenarios, options.loss))


def draw_voice(options: argparse.Namespace) -> None:
    """Draw or write the voice maps."""
    from robotteamsim.analysis.fields.maps import voice_panel, voice_style

    def panel(loaded: scenario.Scenario, variant: _Variant, resolution_m: float) -> Panel:
        return voice_panel(loaded, variant.at_m, resolution_m, variant.voice_range)

    _draw(options, panel, voice_style)


def _draw(
    options: argparse.Namespace,
    panel: Callable[[scenario.Scenario, _Variant, float], Panel],
    style: Callable[[Sequence[scenario.Scenario]], FieldStyle],
) -> None:
    """Draw and write the requested files, or none if the maps do not fit into one file."""
    from robotteamsim.analysis.fields.maps import map_arrays
    from robotteamsim.analysis.fields.picture import draw_fields

    variants = _variants(options)
    scenarios = [variant.load(options) for variant in variants]
    check_outputs(
        {"--png": options.png, "--out": options.out}, [file for one in scenarios for file in one.origin.files]
    )
    panels = []
    for variant, loaded in zip(variants, scenarios, strict=True):
        drawn = panel(loaded, variant, _resolution_m(options, loaded))
        panels.append(replace(drawn, title=f"{variant.name}: {drawn.title}") if variant.name else drawn)
    common = style(scenarios)
    arrays = map_arrays(panels, common) if options.out else {}
    if options.png:
        save(draw_fields(panels, common, f"{panels[0].plan.name}: {common.quantity}"), options.png)
    if options.out:
        with atomically(options.out) as part, part.open("wb") as file:
            np.savez_compressed(file, **arrays)  # type: ignore[arg-type]  # NumPy's stub does not allow other keywords
        print(options.out)


def _variants(options: argparse.Namespace) -> list[_Variant]:
    """Return the requested maps. Raises: UsageError."""
    if not (options.png or options.out):
        raise UsageError("no output given; use --png FILE for a picture, --out FILE.npz for the values, or both")
    if options.out and options.out.suffix != ".npz":
        raise UsageError(f"--out {options.out}: expected a name that ends in .npz")
    if len(options.compare) == 1 or len(options.compare) > MAX_PANELS:
        count = "once" if len(options.compare) == 1 else f"{len(options.compare)} times"
        raise UsageError(f"--compare is given {count}; expected 2 to {MAX_PANELS}, one for each map")
    common = _Variant("", options.overrides, options.at, options.range)
    return [_variant(common, text) for text in options.compare] or [common]


def _variant(common: _Variant, text: str) -> _Variant:
    overrides, at_m, voice_range = list(common.overrides), [], common.voice_range
    names, keys = [], []
    for part in text.split():
        key, equals, value = part.partition("=")
        if not equals:
            raise UsageError(
                f"--compare: '{part}' does not have the form KEY=VALUE, such as voice.noise_db=20 or at=4,5"
            )
        keys.append(key)
        if key == "at":
            try:
                at_m.append(point(value))
            except argparse.ArgumentTypeError as error:
                raise UsageError(f"--compare: at: {error}") from None
        elif key == "range":
            if value not in ("drawn", "lowest", "highest"):
                raise UsageError(f"--compare: range: '{value}' is not valid; expected one of drawn, lowest, highest")
            voice_range = cast("VoiceRange", value)
        else:
            overrides.append(part)
            names += [] if key in SHOWN_KEYS else [part]
    return replace(
        common,
        name=", ".join(names),
        overrides=overrides,
        at_m=at_m or common.at_m,
        voice_range=voice_range,
        own_keys=tuple(keys),
    )


def _resolution_m(options: argparse.Namespace, loaded: scenario.Scenario) -> float:
    from robotteamsim.analysis.fields.maps import default_resolution_m

    if options.resolution is None:
        return default_resolution_m(loaded.plan)
    if not 0.01 <= options.resolution <= 10.0:
        raise UsageError(f"--resolution {options.resolution:g} is outside 0.01 to 10 m")
    (min_x, min_y), (max_x, max_y) = loaded.plan.bounds.min, loaded.plan.bounds.max
    cells = (max_x - min_x) * (max_y - min_y) / options.resolution**2
    if cells > MAX_CELLS:
        raise UsageError(f"--resolution {options.resolution:g} gives {cells:.0f} cells; expected at most {MAX_CELLS}")
    return float(options.resolution)
