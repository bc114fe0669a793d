"""One trial of a campaign, as a worker runs it."""

import json
import time
import traceback
from dataclasses import dataclass, field
from typing import Annotated, Any, get_args

import msgspec

import robotteamsim
from robotteamsim.campaign.design import Trial
from robotteamsim.campaign.paths import PathLog
from robotteamsim.errors import CampaignError, RobotTeamSimError
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.events import VictimLocated, failure_of
from robotteamsim.mission.status import VictimState
from robotteamsim.recording.exploration import Exploration, ExplorationLog
from robotteamsim.recording.idleness import Idleness
from robotteamsim.recording.measures import Measures
from robotteamsim.recording.network_log import NetworkLog, NetworkTotals
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
from robotteamsim.wording import described, place_of

_OF_RESULT = (
    *("end", "time_s", "areas_explored", "num_areas", "victims_saved", "num_victims", "endangered_links"),
    *("discoveries_delivered", "mean_delivery_delay_s", "max_delivery_delay_s", "steps", "trajectory_hash"),
)
"""Values of a `Result` that are stored as they are."""

_VICTIM_EVENTS = frozenset(f"victim_{state}" for state in get_args(VictimState) if state != "waiting")

_CASUALTIES = ("robot_failed_by_heat", "firefighter_collapsed")


Few = Annotated[int, msgspec.Meta(ge=0, le=100_000)]
Count = Annotated[int, msgspec.Meta(ge=0, le=2**53)]
Amount = Annotated[float, msgspec.Meta(ge=0.0, le=1e12)]


class VictimTimes(msgspec.Struct, frozen=True):
    """When a victim was first heard, saved, and safe [s]; None: never."""

    heard_s: Amount | None = None
    saved_s: Amount | None = None
    safe_s: Amount | None = None


class Details(msgspec.Struct, frozen=True):
    """The parts of `Outcome.details` that reports need; None: unknown."""

    victims: dict[str, VictimTimes] | None = None
    network: NetworkTotals | None = None
    idleness: Idleness | None = None
    coverage: Annotated[float, msgspec.Meta(ge=0.0, le=1.0)] | None = None
    egress: Egress | None = None
    exploration: Exploration | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """The stored results of a trial. A failed one has an error, its traceback, and None for all values.

    discoveries_delivered, mean_delivery_delay_s, max_delivery_delay_s: as in `Result`; None without a base.
    details: JSON with `areas` (name: time explored [s] or null), `victims` (name: {heard_s, saved_s}, null if that
             never happened; with firefighters also located_s, reported_s, reached_s, carried_s, safe_s, dead_s if it
             did, and located_by and position_error_m of the first location) and `robots` (distance_m, contact_s,
             excluded_s, longest_stay_s of each); if there are any, `casualties` (id, kind, time_s of robots that
             failed and firefighters who collapsed); `network`, as `recording.network_log.NetworkTotals`; for a patrol
             also `idleness`, as `recording.idleness.Idleness`; with `mission.coverage` also `coverage`, the share of
             the floor; in a building that nobody knows `exploration`, as `recording.exploration.Exploration`; with fire
             or exits also `egress`, as `mission.egress.Egress`.
    paths:   of the robots, for `decode_paths`.
    controller_failed: the first controller that was stopped, with its reason, such as "3.2 s: robot 1 is stopped:
             ValueError: .. (mine.py:7)"; "" if all worked to the end.
    wall_s:  computing time, the only value that differs between equal trials.
    """

    cell: Count
    number: Count
    seed: Count
    end: str | None = None
    time_s: Amount | None = None
    areas_explored: Few | None = None
    num_areas: Few | None = None
    victims_saved: Few | None = None
    num_victims: Few | None = None
    endangered_links: Count | None = None
    discoveries_delivered: Count | None = None
    mean_delivery_delay_s: Amount | None = None
    max_delivery_delay_s: Amount | None = None
    distance_m: Amount | None = None
    contact_s: Amount | None = None
    steps: Count | None = None
    trajectory_hash: str | None = None
    details: str | None = None
    paths: bytes | None = field(default=None, repr=False)
    controller_failed: str = ""
    error: str = ""
    traceback: str = ""
    wall_s: Amount = 0.0

    @property
    def failed(self) -> bool:
        """Whether an exception ended the trial."""
        return self.error != ""

    @property
    def known_details(self) -> Details:
        """The details of a trial that has not failed. Raises: msgspec.MsgspecError: they are damaged."""
        return msgspec.json.decode(self.details or "{}", type=Details)

    @property
    def saved_s(self) -> tuple[float, ...] | None:
        """Times at which victims were saved or safe, ascending, from the start of the mission [s]; None if unknown."""
        victims = self.known_details.victims
        if victims is None:
            return None
        times_s = (time_s for times in victims.values() for time_s in (times.saved_s, times.safe_s))
        return tuple(sorted(time_s for time_s in times_s if time_s is not None))

    @property
    def network(self) -> NetworkTotals | None:
        """The network of the trial; None if it failed."""
        return self.known_details.network

    @property
    def egress(self) -> Egress | None:
        """How people left; None if the trial failed, or has no fire and no exits."""
        return self.known_details.egress


def run_trial(scenario: Scenario, trial: Trial, version: str) -> Outcome:
    """Run one trial. An exception in it becomes a failed outcome.

    Args:   scenario: of the trial's cell; its own seed is not used.
            version: of robotteamsim that the campaign requires.
    Raises: CampaignError: this process has another version.
    """
    if robotteamsim.__version__ != version:
        raise CampaignError(f"a worker has robotteamsim {robotteamsim.__version__}, expected {version}")
    start_s = time.perf_counter()
    seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": trial.seed})})
    times, paths, network, measures = _EventTimes(), PathLog(), NetworkLog(), Measures()
    try:
        simulation = Simulation(seeded)
        exploration = ExplorationLog(simulation)
        explored: list[Observer] = [exploration] if seeded.control.map == "unknown" else []
        result = simulation.run([times, paths, network, measures, *explored])
    except Exception as error:  # The other trials continue.
        wall_s = time.perf_counter() - start_s
        # Our own errors name the place: that of a sensor its line of code, for example.
        place = "" if isinstance(error, RobotTeamSimError) else f" ({place_of(error)[1]})"
        line = described(error) + place
        trace = traceback.format_exc()
        return Outcome(trial.cell, trial.number, trial.seed, error=line, traceback=trace, wall_s=wall_s)
    values = msgspec.structs.asdict(result)
    return Outcome(
        trial.cell,
        trial.number,
        trial.seed,
        **{name: values[name] for name in _OF_RESULT},
        distance_m=sum(robot.distance_m for robot in result.robots),
        contact_s=sum(robot.contact_s for robot in result.robots),
        details=times.details(result, network.values() | measures.values() | exploration.values()),
        paths=paths.encoded(),
        controller_failed=times.controller_failed,
        wall_s=time.perf_counter() - start_s,
    )


class _EventTimes(Observer):
    """Records when each area was explored, each victim reached each state after waiting, and a controller failed."""

    def begin(self, setup: Setup) -> None:
        self.controller_failed = ""
        self._casualties: list[dict[str, Any]] = []
        self._areas: dict[str, float | None] = {area.name: None for area in setup.scenario.mission.areas}
        self._victims: dict[str, dict[str, float | int | None]] = {
            victim.name: {"heard_s": None, "saved_s": None} for victim in setup.scenario.mission.victims
        }

    def step(self, record: StepRecord) -> None:
        for event in record.events:
            if event.kind == "area_explored":
                self._areas[event.subject] = event.time_s
            elif event.kind == "victim":
                self._victims.setdefault(event.subject, {"heard_s": None, "saved_s": None})
            elif event.kind in _VICTIM_EVENTS:
                times = self._victims[event.subject]
                key = event.kind.removeprefix("victim_") + "_s"
                if times.get(key) is None:
                    times[key] = event.time_s
                    if isinstance(event.what, VictimLocated):
                        error_m = round(event.what.error_m, 2)
                        times |= {"located_by": event.robot_id, "position_error_m": error_m}
            elif event.kind == "controller_failed":
                self.controller_failed = self.controller_failed or failure_of(event)
            elif event.kind in _CASUALTIES:
                self._casualties.append({"id": event.robot_id, "kind": event.kind, "time_s": event.time_s})

    def details(self, result: Result, further: dict[str, Any]) -> str:
        """Return the `details` of an outcome, with further ones."""
        robots = [msgspec.structs.asdict(robot) for robot in result.robots]
        own: dict[str, Any] = {"areas": self._areas, "victims": self._victims, "robots": robots}
        if self._casualties:
            own["casualties"] = self._casualties
        if result.egress is not None:
            own["egress"] = result.egress.values()
        return json.dumps(own | further, ensure_ascii=False)
