"""Three missions of a campaign, the best, the median and the worst, simulated again for its report."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from robotteamsim.analysis.report import ShownMissions
from robotteamsim.analysis.report.samples import cell_scenario
from robotteamsim.cache import cached
from robotteamsim.campaign import Outcome, StoredCampaign
from robotteamsim.campaign.design import cell_name
from robotteamsim.control import foreign_code
from robotteamsim.errors import RecordingError, RobotTeamSimError
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.scenario.sections import Team
from robotteamsim.scenario.worlds import OURS
from robotteamsim.view import document
from robotteamsim.view.html import player_frame
from robotteamsim.view.recorder import Recording, repeat_mission

RULE = (
    "Missions are ordered by victims saved, then by areas explored, then by duration (shorter is better). Shown are "
    "the first, the middle and the last of all."
)


@dataclasses.dataclass(frozen=True, slots=True)
class _Mission:
    """A mission of a campaign. place: folder of the store, for messages."""

    title: str
    scenario: Scenario
    trajectory_hash: str
    place: str


def shown_missions(stored: Sequence[StoredCampaign], places: Sequence[str], *, allow_code: bool) -> ShownMissions:
    """Return the player of three missions of all campaigns, or the reason why there is none.

    They are simulated again, and kept in the user's cache folder for the next report if no code but ours runs in them.

    Args: places: the stores' folders, for messages. allow_code: whether a controller that a store names as
          module:Class may run.
    """
    try:
        missions = _chosen(stored, places, allow_code=allow_code)
        if not missions:
            return ShownMissions(RULE, "", "")
        content = [f"{one.title} {one.trajectory_hash} {one.scenario.model_dump_json()}".encode() for one in missions]

        def packed() -> bytes:
            return document.packed(list(map(_recording, missions))).encode()

        shown = cached(content, packed) if all(_is_ours(mission.scenario) for mission in missions) else packed()
    except RobotTeamSimError as error:
        return ShownMissions(RULE, "", f"No mission can be played: {error}.")
    return ShownMissions(RULE, player_frame(shown.decode(), "Best, median and worst mission"), "")


def _is_ours(scenario: Scenario) -> bool:
    """Return whether a mission depends on no code of users, which may change."""
    robots = (scenario.robots,) if isinstance(scenario.robots, Team) else scenario.robots
    classes = {type(sensor).__module__ for robot in robots for sensor in robot.sensors}
    is_ours = scenario.control.algorithm in ALGORITHMS and scenario.run.world in OURS
    return is_ours and all(name.startswith("robotteamsim.") for name in classes)


def _chosen(stored: Sequence[StoredCampaign], places: Sequence[str], *, allow_code: bool) -> list[_Mission]:
    """Return the best, the median and the worst mission; fewer if fewer have ended. Raises: as `_mission`."""
    ended = [
        (campaign, place, outcome)
        for campaign, place in zip(stored, places, strict=True)
        for outcome in campaign.outcomes
        if not outcome.failed
    ]
    ended.sort(key=lambda mission: _order(mission[2]))
    last = len(ended) - 1
    labels = {last // 2: "median"} | {0: "best", last: "worst"} if last > 0 else {0: "only mission"}
    return [_mission(label, *ended[i], allow_code=allow_code) for i, label in sorted(labels.items())] if ended else []


def _order(outcome: Outcome) -> tuple[int, int, float, int, int]:
    """Return a key by which better missions come first; ties keep the order of the campaign."""
    assert outcome.victims_saved is not None
    assert outcome.areas_explored is not None
    assert outcome.time_s is not None
    return -outcome.victims_saved, -outcome.areas_explored, outcome.time_s, outcome.cell, outcome.number


def _mission(label: str, campaign: StoredCampaign, place: str, outcome: Outcome, *, allow_code: bool) -> _Mission:
    """Return a mission under a label. Raises: RecordingError, ScenarioError: it cannot be simulated again."""
    settings = campaign.settings
    values = dict(zip(settings["keys"], settings["cells"][outcome.cell], strict=True))
    scenario = cell_scenario(settings["scenario"], values, place)
    if outcome.trajectory_hash is None:
        raise RecordingError(f"{place}: a mission has no trajectory hash")
    if not allow_code:
        foreign_code.check_foreign(scenario.control.algorithm, place, "--allow-code")
    seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": outcome.seed})})
    title = f"{label}: {cell_name(values, scenario.name)}, seed {outcome.seed}, {_summary(outcome)}"
    return _Mission(title, seeded, outcome.trajectory_hash, place)


def _recording(mission: _Mission) -> Recording:
    """Simulate a mission again. Raises: RecordingError: as `repeat_mission`."""
    recording = repeat_mission(mission.scenario, mission.trajectory_hash, mission.place)
    return dataclasses.replace(recording, title=mission.title)


def _summary(outcome: Outcome) -> str:
    counts = (
        f"{outcome.victims_saved}/{outcome.num_victims} victims, {outcome.areas_explored}/{outcome.num_areas} areas"
    )
    return f"{counts}, {outcome.time_s:.1f} s"
