"""Radio and voice maps of a scenario as panels, the styles to draw them, and their values as arrays."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from robotteamsim import palette
from robotteamsim.analysis.fields.picture import FieldStyle, Level, Panel, Spot
from robotteamsim.errors import RecordingError, ScenarioError
from robotteamsim.propagation import RadioField, VoiceField, VoiceSource
from robotteamsim.scenario import FloorPlan, Scenario
from robotteamsim.scenario.sections import Victim
from robotteamsim.sensing.voice import VoiceSensor
from robotteamsim.setup import resolve

Point = tuple[float, float]
VoiceRange = Literal["drawn", "lowest", "highest"]

RADIO_LEVELS_DBM = (-60.0, -70.0)
"""Contour lines in addition to the two thresholds of the network [dissertation, Fig. 18]."""

VOICE_LEVELS_DB = (10.0, 20.0, 30.0)
"""Contour lines at the noise levels of the dissertation's missions [Fig. 16, 17]."""

_MINUS = "\N{MINUS SIGN}"

_BEYOND_LOST_DB = 16.0
"""Maps of the path loss extend beyond the range of links, so that walls are visible there, too [Fig. 6]."""

_JUST_HEARD_DB = 1e-9
"""Lowest voice level drawn: voice maps contain 0 where nothing is heard."""

_FINEST_M, _COARSEST_M, _CELLS = 0.02, 1.0, 600


def default_resolution_m(plan: FloorPlan) -> float:
    """Return the cell size for about 600 cells along the longer side, in whole centimetres [m]."""
    longer_side_m = float(np.subtract(plan.bounds.max, plan.bounds.min).max())
    return min(max(round(longer_side_m / _CELLS, 2), _FINEST_M), _COARSEST_M)


def radio_panel(scenario: Scenario, at_m: Sequence[Point], resolution_m: float, loss: bool) -> Panel:
    """Return the strongest signal of all transmitters in each cell [dBm], or the smallest path loss [dB].

    Args:   at_m: transmitters in `map` [m]; if empty, robot 0 at its start.
    Raises: ScenarioError: there is neither a transmitter nor a robot.
    """
    if not at_m and not scenario.team_size:
        raise ScenarioError(f"{scenario.name}: has no robots; expected --at x,y, the place of a transmitter")
    places = list(at_m) or [resolve(scenario).start_m(0)]
    model = RadioField(scenario.plan, scenario.radio)
    field = model.best_rssi_map_dbm(places, resolution_m)
    if loss:
        field = replace(field, values=scenario.radio.tx_power_dbm - field.values)
    names = ["transmitter"] if len(places) == 1 else [f"tx {i}" for i in range(len(places))]
    spots = tuple(Spot(name, place, "robot") for name, place in zip(names, places, strict=True))
    power = f"{scenario.radio.tx_power_dbm:g} dBm".replace("-", _MINUS)
    best = "smallest" if loss else "strongest"
    title = "transmitter at ({:g},\N{NO-BREAK SPACE}{:g})".format(*places[0])
    if len(places) > 1:
        title = f"{best} of {len(places)} transmitters"
    if loss:
        return Panel(title, field, scenario.plan, spots)
    return Panel(f"{title}, {power}", field, scenario.plan, spots, silent_below=scenario.network.lost_below_dbm)


def voice_panel(scenario: Scenario, at_m: Sequence[Point], resolution_m: float, voice_range: VoiceRange) -> Panel:
    """Return the loudest voice in each cell [dB]; 0 below the noise and in walls.

    Args: at_m: victims in `map` [m]; if empty, those of the scenario.
          voice_range: l_c and gamma as drawn per victim from the scenario's seed, or the quiet or the loud ends of
              their ranges for all victims.
    """
    named = [Victim(name=f"victim_{i}", position=place) for i, place in enumerate(at_m, 1)]
    victims = named or [victim for victim in scenario.mission.victims if victim.calling]
    voice = scenario.voice.model_copy(update={"map_resolution_m": resolution_m})
    if voice_range == "drawn":
        field = VoiceSensor(scenario.plan, voice, victims, scenario.run.seed).map()
        how = f"as drawn by seed {scenario.run.seed}"
    else:
        end = 1 if voice_range == "lowest" else 0
        constant_db, exponent = voice.constant_db[end], voice.exponent[end]
        sources = [VoiceSource(victim.position, constant_db, exponent) for victim in victims]
        field = VoiceField(scenario.plan, voice).map_db(sources)
        how = f"{voice_range} range (constant {constant_db:g} dB,\N{NO-BREAK SPACE}exponent {exponent:g})"
    spots = tuple(Spot(victim.name, victim.position, "victim") for victim in victims)
    title = f"{voice.noise_db:g} dB of noise, {how.replace('-', _MINUS)}"
    return Panel(title, field, scenario.plan, spots, silent_below=max(voice.noise_db, _JUST_HEARD_DB))


def radio_style(scenarios: Sequence[Scenario], loss: bool) -> FieldStyle:
    """Return the style of radio maps, with one scale for all scenarios."""
    lost = min(scenario.network.lost_below_dbm for scenario in scenarios)
    endangered = min(scenario.network.endangered_below_dbm for scenario in scenarios)
    strongest = max(scenario.radio.tx_power_dbm - scenario.radio.constant_loss_db for scenario in scenarios)
    power = max(scenario.radio.tx_power_dbm for scenario in scenarios)
    meanings = {lost: "lost", endangered: "endangered"}
    values = sorted({*RADIO_LEVELS_DBM, endangered, lost})
    if loss:
        marks = tuple(Level(power - value, meanings.get(value, "")) for value in values)
        return FieldStyle(
            "path loss", "dB", palette.LOSS_MAP, power - strongest, power - lost + _BEYOND_LOST_DB, levels=marks
        )
    marks = tuple(Level(value, meanings.get(value, "")) for value in values)
    return FieldStyle("signal strength", "dBm", palette.SIGNAL_MAP, lost, max(strongest, lost + 1.0), "no link", marks)


def voice_style(scenarios: Sequence[Scenario]) -> FieldStyle:
    """Return the style of voice maps, with one scale for all scenarios."""
    noise_db = min(scenario.voice.noise_db for scenario in scenarios)
    loudest = max(-scenario.voice.constant_db[0] for scenario in scenarios)
    usual = sorted({noise_db, *VOICE_LEVELS_DB} - {0.0})
    marks = tuple(Level(value) for value in usual if value >= noise_db)
    return FieldStyle(
        "voice level", "dB", palette.VOICE_MAP, noise_db, max(loudest, noise_db + 1.0), "not heard", marks
    )


def map_arrays(panels: Sequence[Panel], style: FieldStyle) -> dict[str, np.ndarray]:
    """Return maps as the named arrays of an npz archive.

    values:         float64, shape (rows, cols), row 0 at the lowest y; of several maps (maps, rows, cols).
    origin_m:       lower left corner of cell (0, 0) in `map`; resolution_m: size of a cell.
    quantity, unit: what the values are; titles: titles of the maps.
    sources_m:      x, y of every source of every map, shape (n, 2); source_map: index of the map of each source.
    Raises: RecordingError: the maps have different cells.
    """
    first = panels[0].field
    if len({(panel.field.values.shape, panel.field.origin_m, panel.field.resolution_m) for panel in panels}) > 1:
        raise RecordingError("maps with different cells do not fit into one file; write one map at a time")
    stacked = np.stack([panel.field.values for panel in panels])
    spots = [(index, *spot.position_m) for index, panel in enumerate(panels) for spot in panel.spots]
    sources = np.array(spots, dtype=np.float64).reshape(-1, 3)
    return {
        "values": stacked if len(panels) > 1 else stacked[0],
        "origin_m": np.array(first.origin_m),
        "resolution_m": np.array(first.resolution_m),
        "quantity": np.array(style.quantity),
        "unit": np.array(style.unit),
        "titles": np.array([panel.title for panel in panels]),
        "sources_m": sources[:, 1:],
        "source_map": sources[:, 0].astype(np.int64),
    }
