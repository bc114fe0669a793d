"""Maps for the tests of maps."""

import pytest

from robotteamsim.scenario import load
from robotteamsim.setup import resolve


@pytest.fixture(scope="session")
def garage_cells():
    """Return the cells of the garage, 0.1 m."""
    return resolve(load("garage_sar")).building.grid(0.1).cells
