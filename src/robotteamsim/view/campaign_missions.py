"""Three missions of a campaign, the best, the median and the worst, simulated again for its report."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from robotteamsim.analysis.report import ShownMissions
from robotteamsim.analysis.report.samples import cell_scenario
from robotteamsim.campaign import Outcome, StoredCampaign
from robotteamsim.campaign.design import cell_name
from robotteamsim.control import foreign_code
from robotteamsim.errors import RecordingError, RobotTeamSimError
from robotteamsim.view.html import player_frame
from robotteamsim.view.recorder import Recording, repeat_mission

RULE = (
    "Missions are ordered by victims saved, then by areas explored, then by duration (shorter is better). Shown are "
    "the first, the middle and the last of all."
)


@dataclasses.dataclass(frozen=True, slots=True)
class _Mission:
    """A mission of a campaign. label: its place in the order: best, median or worst."""

    label: str
    campaign: StoredCampaign
    outcome: Outcome


def shown_missions(stored: Sequence[StoredCampaign], places: Sequence[str], *, allow_code: bool) -> ShownMissions:
    """Return the player of three missions of all campaigns, or the reason why there is none.

    Args: places: the stores' folders, for messages. allow_code: whether a controller that a store names as
          module:Class may run.
    """
    recordings: list[Recording] = []
    for mission in _chosen(stored):
        place = places[next(index for index, one in enumerate(stored) if one is mission.campaign)]
        try:
            recordings.append(_recording(mission, place, allow_code=allow_code))
        except RobotTeamSimError as error:
            return ShownMissions(RULE, "", f"No mission can be played: {error}.")
    frame = player_frame(recordings, "Best, median and worst mission") if recordings else ""
    return ShownMissions(RULE, frame, "")


def _chosen(stored: Sequence[StoredCampaign]) -> list[_Mission]:
    """Return the best, the median and the worst mission; fewer if fewer have ended."""
    ended = [(campaign, outcome) for campaign in stored for outcome in campaign.outcomes if not outcome.failed]
    ended.sort(key=lambda pair: _order(pair[1]))
    last = len(ended) - 1
    labels = {last // 2: "median"} | {0: "best", last: "worst"} if last > 0 else {0: "only mission"}
    return [_Mission(label, *ended[index]) for index, label in sorted(labels.items())] if ended else []


def _order(outcome: Outcome) -> tuple[int, int, float, int, int]:
    """Return a key by which better missions come first; ties keep the order of the campaign."""
    assert outcome.victims_saved is not None
    assert outcome.areas_explored is not None
    assert outcome.time_s is not None
    return -outcome.victims_saved, -outcome.areas_explored, outcome.time_s, outcome.cell, outcome.number


def _recording(mission: _Mission, place: str, *, allow_code: bool) -> Recording:
    """Simulate a mission again. Raises: RecordingError, ScenarioError."""
    outcome, settings = mission.outcome, mission.campaign.settings
    values = dict(zip(settings["keys"], settings["cells"][outcome.cell], strict=True))
    scenario = cell_scenario(settings["scenario"], values, place)
    if outcome.trajectory_hash is None:
        raise RecordingError(f"{place}: a mission has no trajectory hash")
    if not allow_code:
        foreign_code.check_foreign(scenario.control.algorithm, place, "--allow-code")
    seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": outcome.seed})})
    recording = repeat_mission(seeded, outcome.trajectory_hash, place)
    name = cell_name(values, scenario.name)
    return dataclasses.replace(recording, title=f"{mission.label}: {name}, seed {outcome.seed}, {_summary(outcome)}")


def _summary(outcome: Outcome) -> str:
    counts = (
        f"{outcome.victims_saved}/{outcome.num_victims} victims, {outcome.areas_explored}/{outcome.num_areas} areas"
    )
    return f"{counts}, {outcome.time_s:.1f} s"
