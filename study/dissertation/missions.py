"""The missions of a campaign next to those of the dissertation with the same settings."""

from __future__ import annotations

import numpy as np

from robotteamsim.analysis.report.samples import Campaign, Cell, Panel, Sample, Series
from robotteamsim.campaign.design import NOISE_KEY
from robotteamsim.palette import OURS, THEIRS
from study.dissertation.reference import dissertation_missions

LIMIT_S = 600.0
_NUM_AREAS, _NUM_VICTIMS = 5, 4

Pair = tuple[Cell, Sample]
"""A cell of a campaign, and the dissertation's missions of its settings."""


def compared(campaign: Campaign) -> tuple[Pair, ...]:
    """Return the cells whose settings the dissertation also has: the garage, where only the noise varies."""
    if campaign.scenario.name != "garage_sar" or not set(campaign.keys) <= {NOISE_KEY}:
        return ()
    known = _dissertation_samples()
    cells = [(cell, cell.scenario.voice.noise_db) for cell in campaign.cells if cell.scenario is not None]
    return tuple((cell, known[noise_db]) for cell, noise_db in cells if noise_db in known)


def panels(campaign: Campaign) -> tuple[Panel, ...]:
    """Return a panel for each cell, with the dissertation's missions if it has some of these settings."""
    theirs = {cell.name: sample for cell, sample in compared(campaign)}
    found = []
    for cell in campaign.cells:
        ours = Series("ours" if cell.name in theirs else "", cell.missions, OURS)
        other = [Series("dissertation", theirs[cell.name], THEIRS)] if cell.name in theirs else []
        found.append(Panel(cell.name, (ours, *other)))
    return tuple(found)


def _dissertation_samples() -> dict[float, Sample]:
    """Return the missions by background noise [dB] [dissertation, Tables 6 and 7]."""
    samples = {}
    for noise_db, missions in dissertation_missions().items():
        time_s = np.array([mission.time_s for mission in missions])
        samples[noise_db] = Sample(
            time_s=time_s,
            finished=time_s < LIMIT_S,
            victims_saved=np.array([mission.victims_saved for mission in missions]),
            areas_explored=np.array([mission.areas_explored for mission in missions]),
            endangered=np.array([mission.endangered_links for mission in missions]),
            distance_m=np.full(len(missions), np.nan),
            numbers=np.arange(1, len(missions) + 1),
            num_victims=_NUM_VICTIMS,
            num_areas=_NUM_AREAS,
            limit_s=LIMIT_S,
        )
    return samples
