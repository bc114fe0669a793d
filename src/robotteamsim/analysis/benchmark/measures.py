"""What is measured in a benchmark's missions: arrays by cell, from stored outcomes."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.benchmark.bound import search_bound
from robotteamsim.campaign import Design, Outcome
from robotteamsim.errors import CampaignError
from robotteamsim.recording.idleness import Idleness
from robotteamsim.recording.network_log import NetworkTotals
from robotteamsim.setup import resolve
from robotteamsim.wording import counted


@dataclass(frozen=True, slots=True)
class Place:
    """What all controllers of a comparison share: the building, the noise and the number of robots."""

    building: str
    noise_db: float
    robots: int

    @property
    def name(self) -> str:
        """A short text."""
        return f"{self.building}, {self.noise_db:g} dB, {counted(self.robots, 'robot')}"


@dataclass(frozen=True, slots=True, eq=False)
class SearchSample:
    """The missions of one controller in one place; arrays have shape (missions,).

    numbers:    of the trials; those of equal number have the same victims.
    saved:      number of victims saved.    areas: number of areas explored.
    last_s:     when the last victim was saved; infinity if not all were.
    end_s:      when the mission ended.     bound_s: before which no team can save all victims.
    coverage:   shares of the floor covered, and
    networks:   of the missions.
    """

    place: Place
    controller: str
    numbers: np.ndarray
    saved: np.ndarray
    areas: np.ndarray
    last_s: np.ndarray
    end_s: np.ndarray
    bound_s: np.ndarray
    coverage: np.ndarray
    networks: tuple[NetworkTotals, ...]
    num_victims: int
    num_areas: int
    limit_s: float
    step_s: float

    @property
    def where(self) -> str:
        """The place in a short text."""
        return self.place.name

    @property
    def restricted_s(self) -> np.ndarray:
        """Times until all victims are saved; a mission that does not save all counts as the limit."""
        return np.asarray(np.minimum(self.last_s, self.limit_s))


Mission = tuple[str, int, int]
"""Building, number of robots and seed of a mission: its bound does not depend on the controller or on the noise."""


def lower_bounds(
    design: Design, outcomes: Sequence[Outcome], shown: Callable[[Collection[Mission]], Iterable[Mission]] = iter
) -> dict[Mission, float]:
    """Return the bound of each mission of a search [s]. Args: shown: yields the missions, and shows the progress."""
    scenarios = {}
    for outcome in outcomes:
        cell = design.cells[outcome.cell]
        building, _, robots, _ = cell.values
        if not outcome.failed:
            scenarios[building, robots, outcome.seed] = cell.scenario
    found = {}
    for mission in shown(scenarios):
        scenario = scenarios[mission]
        seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": mission[2]})})
        found[mission] = search_bound(resolve(seeded))
    return found


def search_samples(
    design: Design, outcomes: Sequence[Outcome], bounds: Mapping[Mission, float]
) -> tuple[SearchSample, ...]:
    """Return the sample of each cell that has a finished mission, in the design's order. Args: design: a search."""
    samples = []
    for index, cell in enumerate(design.cells):
        own = [outcome for outcome in outcomes if outcome.cell == index and not outcome.failed]
        if not own:
            continue
        building, noise_db, robots, controller = cell.values
        place, scenario = Place(building, noise_db, robots), cell.scenario
        samples.append(
            SearchSample(
                place=place,
                controller=controller,
                numbers=np.array([outcome.number for outcome in own]),
                saved=np.array([outcome.victims_saved for outcome in own]),
                areas=np.array([outcome.areas_explored for outcome in own]),
                last_s=np.array([last_saved_s(outcome) for outcome in own]),
                end_s=np.array([outcome.time_s for outcome in own]),
                bound_s=np.array([bounds[building, robots, outcome.seed] for outcome in own]),
                coverage=np.array([share for one in own if (share := one.known_details.coverage) is not None]),
                networks=_networks(own),
                num_victims=scenario.num_victims,
                num_areas=len(scenario.mission.areas),
                limit_s=scenario.mission.time_limit_s,
                step_s=scenario.run.step_s,
            )
        )
    return tuple(samples)


def _networks(outcomes: Sequence[Outcome]) -> tuple[NetworkTotals, ...]:
    return tuple(network for outcome in outcomes if (network := outcome.network) is not None)


def last_saved_s(outcome: Outcome) -> float:
    """Return when the last victim was saved or safe [s]; infinity if not all were."""
    saved_s = outcome.saved_s or ()
    return saved_s[-1] if saved_s and len(saved_s) == outcome.num_victims else math.inf


@dataclass(frozen=True, slots=True, eq=False)
class PatrolSample:
    """The patrols of one controller with one number of robots.

    mean_s, max_s: idleness of the graph, shape (missions,).
    vertices_s:    mean idleness of each vertex, shape (missions, vertices).
    vertex_max_s, visits: of each vertex, same shape.
    networks:      of the missions.
    """

    robots: int
    controller: str
    numbers: np.ndarray
    mean_s: np.ndarray
    max_s: np.ndarray
    vertices_s: np.ndarray
    vertex_max_s: np.ndarray
    visits: np.ndarray
    networks: tuple[NetworkTotals, ...]

    @property
    def where(self) -> str:
        """The team in a short text."""
        return counted(self.robots, "robot")


def patrol_samples(design: Design, outcomes: Sequence[Outcome]) -> tuple[PatrolSample, ...]:
    """Return the sample of each cell that has a finished mission, in the design's order. Args: design: a patrol."""
    samples = []
    for index, cell in enumerate(design.cells):
        own = [outcome for outcome in outcomes if outcome.cell == index and not outcome.failed]
        if not own:
            continue
        found = [idleness for outcome in own if (idleness := outcome.known_details.idleness) is not None]
        if len(found) < len(own) or len({len(one.vertices) for one in found}) > 1:
            raise CampaignError(f"cell {index}: missions without the idleness of the same graph")

        def table(key: str, found: list[Idleness] = found) -> np.ndarray:
            return np.array([[getattr(vertex, key) for vertex in one.vertices] for one in found], dtype=float)

        samples.append(
            PatrolSample(
                robots=cell.values[0],
                controller=cell.values[1],
                numbers=np.array([outcome.number for outcome in own]),
                mean_s=np.array([one.mean_s for one in found]),
                max_s=np.array([one.max_s for one in found]),
                vertices_s=table("mean_s"),
                vertex_max_s=table("max_s"),
                visits=table("visits"),
                networks=_networks(own),
            )
        )
    return tuple(samples)


@dataclass(frozen=True, slots=True, eq=False)
class ExplorationSample:
    """The explorations of one controller under equal conditions; arrays have shape (missions,).

    where:      the conditions in a short text.
    t90_s, t99_s: when 90 % and 99 % of the floor were known; infinity: never.
    known:      share of the floor that is known at the end.
    right, aligned: shares of the found walls that are right, as in `recording.exploration.Exploration`.
    bytes_per_s: sent by a robot.
    limit_s:    time limit of the mission.
    """

    where: str
    controller: str
    numbers: np.ndarray
    t90_s: np.ndarray
    t99_s: np.ndarray
    known: np.ndarray
    right: np.ndarray
    aligned: np.ndarray
    bytes_per_s: np.ndarray
    limit_s: float


def exploration_samples(design: Design, outcomes: Sequence[Outcome]) -> tuple[ExplorationSample, ...]:
    """Return the sample of each cell that has a finished mission, in the design's order. Args: design: explorations.

    Raises: CampaignError: a mission has no measures of the exploration.
    """
    samples = []
    for index, cell in enumerate(design.cells):
        own = [outcome for outcome in outcomes if outcome.cell == index and not outcome.failed]
        if not own:
            continue
        found = [one for outcome in own if (one := outcome.known_details.exploration) is not None]
        if len(found) < len(own):
            raise CampaignError(f"cell {index}: missions without measures of the exploration")
        building, start, pose, robots, controller = cell.values
        samples.append(
            ExplorationSample(
                where=f"{building}, {start}, {pose} poses, {counted(robots, 'robot')}",
                controller=controller,
                numbers=np.array([outcome.number for outcome in own]),
                t90_s=np.array([math.inf if one.t90_s is None else one.t90_s for one in found]),
                t99_s=np.array([math.inf if one.t99_s is None else one.t99_s for one in found]),
                known=np.array([one.known for one in found]),
                right=np.array([one.right for one in found]),
                aligned=np.array([one.aligned for one in found]),
                bytes_per_s=np.array([one.bytes_per_s for one in found]),
                limit_s=cell.scenario.mission.time_limit_s,
            )
        )
    return tuple(samples)
