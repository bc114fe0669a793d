"""Runs the tests of the contract of worlds with pytest, for `check_world`."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from robotteamsim._core.state import State
from robotteamsim.scenario.sections import PlacedRobot, Team
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.testing import contract
from robotteamsim.testing.contract.two_rooms import scenario_of
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.world import make_world


class _Plugin:
    """The fixtures of the tests, for a kind of world, and what fails."""

    def __init__(self, kind: str) -> None:
        self._kind = kind
        self.failures: list[str] = []

    @pytest.fixture
    def world_of(self) -> Callable[..., AnyWorld]:
        """Make the world of `scenario_of`."""

        def make(*robots: tuple[float, float, float] | PlacedRobot, **keys: Any) -> AnyWorld:
            scenario = scenario_of(self._kind, *robots, **keys)
            assert not isinstance(scenario.robots, Team)
            return make_world(scenario, scenario.robots)

        return make

    @pytest.fixture
    def readings_of(self) -> Callable[[AnyWorld, Sequence[PlacedRobot]], State]:
        """Return what the sensors of a world's robots measure."""
        return lambda world, robots: RobotSensors(world, robots, 1).read()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a failure."""
        if report.failed:
            crash = getattr(report.longrepr, "reprcrash", None)
            why = " ".join((crash.message if crash else report.longreprtext).split())
            name = report.nodeid.rpartition("::")[2].removeprefix("test_").replace("_", " ")
            self.failures.append(f"{name}: {why:.200}")


def failures_of(world: str) -> list[str]:
    """Return what a world does other than its contract says, a line for each test that failed."""
    plugin, out = _Plugin(world), StringIO()
    (folder,) = contract.__path__
    files = [str(path) for path in sorted(Path(folder).glob("*.py")) if path.stem not in ("__init__", "two_rooms")]
    with redirect_stdout(out):  # Without the settings of the user's own tests.
        status = pytest.main(["-c", os.devnull, "-p", "no:cacheprovider", "-q", *files], plugins=[plugin])
    if status not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        return [*plugin.failures, " ".join(out.getvalue().split())]
    return plugin.failures
