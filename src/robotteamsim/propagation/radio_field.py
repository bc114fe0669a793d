"""How radio fades between robots: the one-slope model and multi-wall losses."""

from __future__ import annotations

import numpy as np

from robotteamsim import _core
from robotteamsim.propagation.faces import radio_faces
from robotteamsim.propagation.field_map import FieldMap
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import occupancy_grid
from robotteamsim.scenario.sections import Radio


class RadioField:
    """Path loss and signal strength on one floor [dissertation, eq. 2-4]; docs/propagation.md has the definition.

    L(d) = l0 + l_c + 10 gamma log10(d) + losses of walls and closed doors on the straight way; rssi = tx power - L.
    Positions are rounded to whole millimetres, so that L(a, b) and L(b, a) are the same to the bit.
    Raises: ScenarioError: the plan or the radio section does not make faces, see `radio_faces`.
    """

    def __init__(self, plan: FloorPlan, radio: Radio) -> None:
        self._plan = plan
        self._faces = radio_faces(plan, radio)
        self._core_faces = self._faces.core()
        self._model = _core.RadioModel(
            tx_power_dbm=radio.tx_power_dbm,
            constant_loss_db=radio.constant_loss_db,
            slope_db=radio.slope_db,
            min_distance_m=radio.min_distance_m,
        )

    def path_loss_db(self, a_m: tuple[float, float], b_m: tuple[float, float]) -> float:
        """Return L of eq. (3) between two points in `map` [dB]. Raises: ValueError: a coordinate is not finite."""
        return _core.path_loss_db(self._core_faces, self._model, a_m, b_m)

    def rssi_matrix_dbm(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the signal strength between all pairs of robots [dBm].

        Args:    positions_m: shape (n, 2), in `map` [m].
        Returns: float64, shape (n, n), symmetric to the bit; 0 on the diagonal.
        Raises:  ValueError: another shape; a coordinate is not finite (the message names the robot).
        """
        positions_m = np.asarray(positions_m, dtype=np.float64)
        if positions_m.ndim != 2 or positions_m.shape[1] != 2:
            raise ValueError(f"positions_m must have shape (n, 2), got {positions_m.shape}")
        return _core.rssi_matrix_dbm(self._core_faces, self._model, positions_m)

    def rssi_map_dbm(self, tx_m: tuple[float, float], resolution_m: float) -> FieldMap:
        """Return what a receiver at the centre of each cell gets from a transmitter [dBm], cells in walls included.

        Raises: ValueError: the transmitter's position is not finite, or the resolution not above 0.
        """
        grid = occupancy_grid(self._plan, resolution_m)
        return FieldMap.over(
            grid,
            _core.rssi_map_dbm(self._core_faces, self._model, tx_m, grid.origin_m, resolution_m, *grid.cells.shape),
        )

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door. Raises: ValueError: no such door."""
        self._core_faces.set_active(self._faces.door_face(name), closed)
