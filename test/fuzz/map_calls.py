"""Valid calls of `robotteamsim._core.maps`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from call_trees import Call, new

from robotteamsim.geometry import Pose

_CELLS = np.zeros((8, 12), np.bool_)
_CELLS[3, 2:9] = True
_GRID = (_CELLS, (-1.0, 2.0), 0.5)
_FAN = new("world.Fan", beams=7, angle_min_rad=-1.5, angle_max_rad=1.5, forward_m=0.1, left_m=0.02, range_max_m=6.0)
_FIELD = new("maps.DistanceField", *_GRID)
_MODEL = new("maps.BeamModel", _FIELD, _FAN, 0.05)
_SCAN, _BEAMS = np.full(7, 2.0, np.float32), np.array([0, 3, 6], np.int32)
_POSE = Pose(-0.6, 2.4, 0.3)


def map_calls() -> Iterator[Call]:
    """Yield them."""
    yield _FIELD.of(("distances_m",), ("trace", (-0.6, 2.4), 0.3, 6.0))
    yield _MODEL.of(("log_likelihood", _POSE, _SCAN, _BEAMS, 0.1, 0.05), ("agreement", _POSE, _SCAN, _BEAMS, 0.3, 0.05))
    filtered = new(
        "maps.ParticleFilter",
        beams=_MODEL,
        sigma_m=0.1,
        outliers=0.05,
        power=0.3,
        mean=_POSE,
        spread=(0.1, 0.1, 0.05),
        noise=np.full((5, 3), 0.1),
    )
    yield filtered.of(
        ("move", Pose(0.06, 0.0, 0.1), (0.01, 0.001, 0.001, 0.0001), 0.1, False, np.full((5, 3), 0.1)),
        ("move", Pose(0.06, 0.01, 0.1), (0.01, 0.001, 0.001, 0.0001), 0.1, True, np.full((5, 3), 0.1)),
        ("shift", (0.5, 0.0)),
        ("weigh", _SCAN, _BEAMS),
        ("resample", 0.5),
        ("drawn", 3, 0.5),
        ("mean",),
    )
    points = np.array([[0.5, 0.1], [1.0, 0.1], [1.5, 0.2]])
    yield new("maps.SubmapSearch", *_GRID, 0.5).of(("find", points, 0.5, 0.8, 0.5, 0.3, 20))
    tuning = {"cell_m": 0.05, "update_m": 0.2, "update_rad": 0.1, "beams": 181, "reach_m": 0.3, "kernel_m": 0.07}
    tuning |= {"sigma_m": 0.02, "outlier_m": 0.03, "submap_m": 0.5, "lost_share": 0.4}
    parameters = new("maps.MapperParameters", **tuning)
    certain, masked = (0.0,) * 6, np.zeros(7, np.bool_)
    yield new("maps.Mapper", fan=_FAN, range_min_m=0.05, parameters=parameters, start=_POSE).of(
        ("step", Pose(0.0, 0.0, 0.0), certain, _SCAN, masked),
        ("due_at", Pose(0.4, 0.0, 0.1)),
        ("step", Pose(0.4, 0.0, 0.1), (1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-5), _SCAN, masked),
        ("step", Pose(0.8, 0.1, 0.2), (2e-4, 0.0, 0.0, 2e-4, 0.0, 2e-5), _SCAN, masked),
        ("pose",),
        ("covariance",),
        ("is_lost",),
        ("bytes",),
        ("take_changes", 2),
        ("num_submaps",),
    )
