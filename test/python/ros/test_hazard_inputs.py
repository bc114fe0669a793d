"""The maps of fire and smoke as the mission receives them, also from publishers whose maps do not fit together."""

from types import SimpleNamespace

import pytest
from nav_msgs.msg import MapMetaData, OccupancyGrid
from robotteamsim.msg import FloatMap

from robotteamsim.recording.hazard_messages import FIRE_GRID, SOOT, TEMPERATURE
from robotteamsim.ros.nodes.hazards import HazardInputs
from robotteamsim.scenario import load

SETTINGS = SimpleNamespace(scenario=load("garage_fire"), step_ns=100_000_000)


def messages(num_columns: int) -> dict:
    maps = {"resolution_m": 0.5, "width": 2, "height": 1, "data": [20.0, 30.0]}
    info = MapMetaData(resolution=0.5, width=num_columns, height=1)
    return {
        FIRE_GRID: OccupancyGrid(info=info, data=[100] * num_columns),
        TEMPERATURE: FloatMap(**maps),
        SOOT: FloatMap(**maps),
    }


@pytest.mark.parametrize(("num_columns", "fits"), [(2, True), (3, False)])
def test_maps_of_different_sizes_are_ignored(num_columns, fits, caplog):
    step = SimpleNamespace(latest=messages(num_columns).get)
    field = HazardInputs(SETTINGS).field(step)
    assert (field is not None) == fits
    assert ("maps of fire and smoke have different sizes" in caplog.text) != fits
