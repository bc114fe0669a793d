"""Where the robots of a team are, as far as one of them knows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from robotteamsim import _core
from robotteamsim.swarm import Vector


class Places:
    """Where robots are, in `map` [m], in the order of their ids. Robots share it, so it must not be changed."""

    def __init__(self, by_id: Mapping[int, Vector]) -> None:
        self.by_id = by_id

    @cached_property
    def core(self) -> _core.control.Places:
        """These places, as navigators take them."""
        return _core.control.Places(np.array(list(self.by_id), np.int32), self.points_m)

    @cached_property
    def points_m(self) -> np.ndarray:
        """The places, float64, shape (n, 2)."""
        return np.array(list(self.by_id.values())).reshape(-1, 2)

    @cached_property
    def rows(self) -> dict[int, int]:
        """The row of each robot."""
        return {robot_id: row for row, robot_id in enumerate(self.by_id)}


class OtherPlaces(Mapping[int, Vector]):
    """The places of all robots but one, which need not be one of them."""

    def __init__(self, places: Places, own_id: int) -> None:
        """Args: places: of all."""
        self.places, self._own_id = places, own_id
        self._own_row = places.rows.get(own_id, -1)

    def nearest(self, position: Vector) -> Vector:
        """Return the one nearest to a position, the first of ties. Raises: ValueError: there is none."""
        return _core.base.nearest_other(position, self.places.points_m, self._own_row)

    def __getitem__(self, robot_id: int) -> Vector:
        if robot_id == self._own_id:
            raise KeyError(robot_id)
        return self.places.by_id[robot_id]

    def __iter__(self) -> Iterator[int]:
        return (robot_id for robot_id in self.places.by_id if robot_id != self._own_id)

    def __len__(self) -> int:
        return len(self.places.by_id) - (self._own_row >= 0)
