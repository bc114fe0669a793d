"""Maps of the dissertation's Figures 16 to 18: the ranges of voices and radios."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure
from scipy.spatial import cKDTree

from robotteamsim.analysis.fields.maps import VoiceRange, radio_panel, radio_style, voice_panel, voice_style
from robotteamsim.analysis.fields.picture import draw_fields
from robotteamsim.analysis.report.pictures import Picture, picture
from robotteamsim.analysis.report.samples import Campaign
from robotteamsim.analysis.report.wording import listed, percents
from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.plan import OCCUPIED
from robotteamsim.setup import resolve

_CELLS = 300
"""Along the longer side of the plan."""


def map_pictures(campaign: Campaign) -> Iterator[Picture]:
    """Yield the voice and radio maps of this scenario, which need no mission."""
    scenario, noises_db = campaign.scenario, _noises_db(campaign)
    if scenario.mission.victims and noises_db:
        ranges: tuple[VoiceRange, ...] = ("lowest", "highest")
        for voice_range in ranges:
            shares = heard_shares(scenario, noises_db, voice_range)
            heard = listed(
                [f"{share} of the floor at {db:g} dB" for share, db in zip(percents(*shares), noises_db, strict=True)]
            )
            caption = (
                f"A victim is heard in {heard} if all voices have the {voice_range} range of the voice model "
                f"({_voice_text(scenario, voice_range)})."
            )
            drawn = draw_voices(scenario, noises_db, voice_range)
            yield picture(f"voice_{voice_range}", f"{voice_range.capitalize()} voice detection range", caption, drawn)
    places_m = widest_moment_m(campaign)
    when = "at the time in all missions when a robot was farthest from its nearest neighbour"
    if places_m is None:
        places_m = np.array([robot.start_pose[:2] for robot in resolve(scenario).robots])
        when = "with the robots at their start"
    caption = f"Strongest signal at each place, {when}. Lines are thresholds of the signal for a link."
    yield picture("network", "Range of the team's network", caption, draw_network(scenario, places_m))


def _noises_db(campaign: Campaign) -> list[float]:
    """Return the background noise levels of all cells, ascending [dB]."""
    return sorted({cell.scenario.voice.noise_db for cell in campaign.cells if cell.scenario is not None})


def draw_voices(scenario: Scenario, levels_db: Sequence[float], voice_range: VoiceRange) -> Figure:
    """Draw where victims are heard, with contours at the noise levels, with all voices quiet or all loud.

    A voice that is heard at one level is heard at all lower ones, so one map shows them all.
    """
    quietest = scenario.model_copy(update={"voice": scenario.voice.model_copy(update={"noise_db": levels_db[0]})})
    panel = voice_panel(quietest, (), _resolution_m(scenario), voice_range)
    return draw_fields([panel], voice_style([quietest]), "Voices")


def _voice_text(scenario: Scenario, voice_range: VoiceRange) -> str:
    """Return the parameters of all voices at one end of their range."""
    end = 1 if voice_range == "lowest" else 0
    constant = f"{scenario.voice.constant_db[end]:g}".replace("-", "\N{MINUS SIGN}")
    return f"constant {constant} dB, exponent {scenario.voice.exponent[end]:g}"


def heard_shares(scenario: Scenario, levels_db: Sequence[float], voice_range: VoiceRange) -> list[float]:
    """Return the share of the free floor where a victim is heard, at each noise level."""
    end = 1 if voice_range == "lowest" else 0
    voice = scenario.voice.model_copy(update={"map_resolution_m": _resolution_m(scenario)})
    constant_db, exponent = voice.constant_db[end], voice.exponent[end]
    calling = [victim for victim in scenario.mission.victims if victim.calling]
    sources = [VoiceSource(victim.position, constant_db, exponent) for victim in calling]
    free = building_of(scenario.plan).grid_without_doors(voice.map_resolution_m).cells != OCCUPIED
    shares = []
    for noise_db in levels_db:
        field = VoiceField(scenario.plan, voice.model_copy(update={"noise_db": noise_db}))
        shares.append(float(np.mean(field.map_db(sources).values[free] > 0.0)))
    return shares


def draw_network(scenario: Scenario, positions_m: np.ndarray) -> Figure:
    """Draw the range of a team's radios, with connection thresholds as contour lines."""
    places = [(float(x), float(y)) for x, y in positions_m]
    panel = radio_panel(scenario, places, _resolution_m(scenario), False)
    return draw_fields([panel], radio_style([scenario], False), "Signal")


def widest_moment_m(campaign: Campaign) -> np.ndarray | None:
    """Return the positions at the time when a robot was farthest from its nearest neighbour [m], shape (n, 2)."""
    found: tuple[float, np.ndarray] | None = None
    for cell in campaign.cells:
        for paths_m in cell.paths_m:
            if paths_m.shape[1] < 2:
                continue
            widest_m = nearest_other_m(paths_m).max(axis=1)
            at = int(np.argmax(widest_m))
            if found is None or widest_m[at] > found[0]:
                found = float(widest_m[at]), paths_m[at]
    return found[1] if found else None


def nearest_other_m(paths_m: np.ndarray) -> np.ndarray:
    """Return the distance of each of several robots to the nearest other one [m], shape (samples, robots)."""
    # The first neighbour in the tree is the robot itself.
    return np.array([cKDTree(positions_m).query(positions_m, k=2)[0][:, 1] for positions_m in paths_m])


def _resolution_m(scenario: Scenario) -> float:
    (min_x, min_y), (max_x, max_y) = scenario.plan.bounds.min, scenario.plan.bounds.max
    return min(max(round(max(max_x - min_x, max_y - min_y) / _CELLS, 2), 0.05), 2.0)
