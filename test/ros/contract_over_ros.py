"""Runs tests of the contract of worlds (robotteamsim.testing.contract) against worlds behind ROS."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rospy
import yaml
from running import ROSCORE, Program, environment, running, wait_for_port

from robotteamsim.scenario.scenario import Scenario

pytest.register_assert_rewrite("robotteamsim.testing.contract")

RELAXED = [
    pytest.mark.filterwarnings(f"ignore::{name}")
    for name in ("DeprecationWarning", "ResourceWarning", "pytest.PytestUnraisableExceptionWarning")
]
"""rospy leaves sockets open, and calls functions of Python that will be removed some day."""

VARIABLES = ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_HOME", "ROS_LOG_DIR")


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    """Run a ROS master, and make this process a node of it."""
    folder = tmp_path_factory.mktemp("contract")
    with running(ROSCORE, folder) as core, pytest.MonkeyPatch.context() as variables:
        wait_for_port(core.port)
        wanted = environment(folder, core.port)
        for name in VARIABLES:
            variables.setenv(name, wanted[name])
        rospy.init_node("contract_over_ros", disable_rostime=True, disable_signals=True)
        yield core
        # The node lives as long as the process: after a shutdown, rospy's server closes its socket, but goes on to wait
        # for it, which takes a whole processor.
        gc.collect()  # what rospy has left open, while warnings about it are ignored


@pytest.fixture
def readings_of() -> Callable[..., object]:
    """Return what the sensors of a world's robots measure."""
    return lambda world, _robots: world.readings()


def write_scenario(scenario: Scenario, folder: Path) -> Path:
    """Write a scenario to a file and return that."""
    path = folder / "test.yaml"
    path.write_text(yaml.safe_dump(scenario.model_dump(mode="json", by_alias=True)))
    return path
