"""Small scenarios, made-up outcomes and workers that tests of several floors share."""

from __future__ import annotations

import gc
import json
import math
import os
import shutil
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import hypothesis
import numpy as np
import pytest
import shapely

from robotteamsim.campaign import Design, Outcome, StoredCampaign, Trial
from robotteamsim.campaign.paths import encode_paths
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot, Run, Victim

# MuJoCo reads it when it is imported, which a test may do before this package does.
os.environ.setdefault("MUJOCO_GL", "egl")

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# A busy machine takes longer for an example than Hypothesis allows by default.
hypothesis.settings.register_profile("without deadline", deadline=None)
hypothesis.settings.load_profile("without deadline")

_CHROMIUM_FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def pytest_collection_finish() -> None:
    """Exempt modules and tests, which live until the end, from garbage collection: statsmodels calls it often."""
    gc.collect()
    gc.freeze()


def _hall() -> FloorPlan:
    """An empty hall of 20 x 10 m within walls of 0.2 m."""
    return FloorPlan(
        name="hall",
        bounds=Bounds(max=(20.0, 10.0)),
        walls=(
            Wall(name="south", start=(0.0, 0.1), end=(20.0, 0.1)),
            Wall(name="north", start=(0.0, 9.9), end=(20.0, 9.9)),
            Wall(name="west", start=(0.1, 0.2), end=(0.1, 9.8)),
            Wall(name="east", start=(19.9, 0.2), end=(19.9, 9.8)),
        ),
    )


@pytest.fixture
def closet() -> FloorPlan:
    """A room of 0.36 m, in which a robot of 0.15 m radius has room but too little clearance for a path."""
    return FloorPlan(
        name="closet",
        bounds=Bounds(max=(0.56, 0.56)),
        walls=(
            Wall(name="south", start=(0.0, 0.05), end=(0.56, 0.05), thickness_m=0.1),
            Wall(name="north", start=(0.0, 0.51), end=(0.56, 0.51), thickness_m=0.1),
            Wall(name="west", start=(0.05, 0.1), end=(0.05, 0.46), thickness_m=0.1),
            Wall(name="east", start=(0.51, 0.1), end=(0.51, 0.46), thickness_m=0.1),
        ),
    )


@pytest.fixture(autouse=True, scope="session")
def _no_cache() -> Iterator[None]:
    """Compute everything again, and leave the user's cache folder alone."""
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROBOTTEAMSIM_CACHE", "")
        yield


@pytest.fixture
def hall_scenario() -> Callable[..., Scenario]:
    """Make a scenario in the hall: two robots, two areas, two victims; keywords replace whole sections."""

    def make(seed: int = 1, **sections: object) -> Scenario:
        fields: dict[str, object] = {
            "name": "hall",
            "plan": _hall(),
            "robots": (PlacedRobot(start_pose=(3.0, 4.0, 0.0)), PlacedRobot(start_pose=(3.0, 6.0, 0.0))),
            "mission": Mission(
                areas=(Area(name="east", center=(16.0, 5.0)), Area(name="west", center=(5.0, 5.0))),
                victims=(Victim(name="ann", position=(9.0, 4.0)), Victim(name="bob", position=(12.0, 7.0))),
                time_limit_s=120.0,
            ),
            "run": Run(seed=seed),
        }
        return Scenario(**(fields | sections))

    return make


@pytest.fixture
def scattered_robots() -> Callable[..., tuple[PlacedRobot, ...]]:
    """Place robots at random where nothing touches them; keywords are fields of `PlacedRobot`."""

    def make(plan: FloorPlan, count: int, generator: np.random.Generator, **fields: object) -> tuple[PlacedRobot, ...]:
        solid, robots = obstacles(plan), []
        while len(robots) < count:
            x, y = generator.uniform(plan.bounds.min, plan.bounds.max).tolist()
            robot = PlacedRobot(start_pose=(x, y, generator.uniform(-math.pi, math.pi)), **fields)
            apart = all(math.dist((x, y), other.start_pose[:2]) > 2.0 * robot.radius_m for other in robots)
            if apart and solid.distance(shapely.Point(x, y)) > robot.radius_m:
                robots.append(robot)
        return tuple(robots)

    return make


@pytest.fixture(scope="session")
def outcome_of() -> Callable[..., Outcome]:
    """Make up the outcome of a trial; keywords replace its figures."""

    def make(trial: Trial, **figures: object) -> Outcome:
        fields: dict[str, object] = {
            "end": "areas_explored",
            "time_s": 100.0,
            "areas_explored": 4,
            "num_areas": 4,
            "victims_saved": 1,
            "num_victims": 1,
            "endangered_links": 0,
            "distance_m": 20.0,
            "contact_s": 0.0,
            "steps": 1001,
            "trajectory_hash": f"{trial.cell:032x}{trial.seed:032x}",
            "details": "{}",
            "paths": None,
            "wall_s": 0.5,
        }
        return Outcome(trial.cell, trial.number, trial.seed, **(fields | figures))

    return make


@pytest.fixture(scope="session")
def stored_campaign(outcome_of) -> Callable[..., StoredCampaign]:
    """Make a campaign as its store gives it back; `figures` returns those of the outcome of a trial.

    In each mission two robots drive 30 m eastwards, 2 m apart; `samples` is the length of their recorded paths.
    """

    def make(design: Design, figures: Callable[[Trial], dict[str, object]], samples: int = 60) -> StoredCampaign:
        x_m = 4.0 + np.linspace(0.0, 30.0, samples)
        paths = encode_paths(np.stack([np.stack([x_m, np.full(samples, y_m)], axis=1) for y_m in (7.0, 9.0)], axis=1))
        driven: dict[str, object] = {"paths": paths, "distance_m": 60.0}
        outcomes = [outcome_of(trial, **(driven | figures(trial))) for trial in design.all_trials()]
        outcomes.sort(key=lambda outcome: (outcome.cell, outcome.number))
        versions = {"robotteamsim": "0.1.0", "numpy": "2"}
        return StoredCampaign(json.loads(json.dumps(design.settings())), versions, tuple(outcomes), "2026-01-01")

    return make


@pytest.fixture
def failed_outcome_of() -> Callable[[Trial], Outcome]:
    """Make up the outcome of a trial that failed."""
    return lambda trial: Outcome(trial.cell, trial.number, trial.seed, error="KeyError: 7", traceback="Traceback ..")


@pytest.fixture(scope="session")
def two_workers() -> Iterator[object]:
    """Two worker processes."""
    from robotteamsim.campaign.workers import local_workers

    with local_workers(2) as workers:
        yield workers


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Start Debian's headless Chromium with software rendering.

    Until it ends, Playwright has an event loop running in this thread, in which others cannot run theirs.
    """
    from playwright.sync_api import sync_playwright

    chromium = shutil.which("chromium-headless-shell")
    assert chromium, "Chromium is missing: `make setup` installs it"
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=chromium, args=_CHROMIUM_FLAGS)
        yield started
        started.close()
