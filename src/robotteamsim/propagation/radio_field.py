"""Radio propagation between robots: the one-slope model and multi-wall losses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.propagation.faces import radio_faces
from robotteamsim.propagation.field_map import FieldMap, map_array
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.plan import grid_shape, shape_over
from robotteamsim.scenario.sections import Radio

Point = tuple[float, float]


class RadioField:
    """Path loss and signal strength on one floor [dissertation, eq. 2-4]; docs/propagation.md defines them.

    L(d) = l0 + l_c + 10 gamma log10(d) + losses of walls and closed doors on the straight line; rssi = tx power - L.
    Positions are rounded to whole millimetres, so that L(a, b) and L(b, a) are bit-identical.
    Raises: ScenarioError: as `radio_faces`.
    """

    def __init__(self, plan: FloorPlan, radio: Radio) -> None:
        self._plan = plan
        self._faces = radio_faces(plan, radio)
        self.core_faces = self._faces.core()
        """The faces and the model in C++, for the network."""
        self.core_model = _core.propagation.RadioModel(
            tx_power_dbm=radio.tx_power_dbm,
            constant_loss_db=radio.constant_loss_db,
            slope_db=radio.slope_db,
            min_distance_m=radio.min_distance_m,
            floor_loss_db=radio.floor_loss_db,
            floor_exponent=radio.floor_exponent,
        )

    def path_loss_db(self, a_m: Point, b_m: Point, floors_crossed: int = 0) -> float:
        """Return L of eq. (3) between two points in `map` [dB].

        Args:   floors_crossed: k_f of eq. (4), the ceilings in between; the walls are always those of this plan.
        Raises: ValueError: a coordinate is not finite, or floors_crossed is negative.
        """
        return _core.propagation.path_loss_db(self.core_faces, self.core_model, a_m, b_m, floors_crossed)

    def rssi_matrix_dbm(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the signal strength between all pairs of robots [dBm].

        Args:    positions_m: shape (n, 2), in `map` [m].
        Returns: float64, shape (n, n), exactly symmetric; 0 on the diagonal.
        Raises:  ValueError: another shape, or a coordinate is not finite (the message names the robot).
        """
        positions_m = np.asarray(positions_m, dtype=np.float64)
        if positions_m.ndim != 2 or positions_m.shape[1] != 2:
            raise ValueError(f"positions_m must have shape (n, 2), got {positions_m.shape}")
        return _core.propagation.rssi_matrix_dbm(self.core_faces, self.core_model, positions_m)

    def rssi_map_dbm(
        self,
        tx_m: Point,
        resolution_m: float,
        *,
        floors_crossed: int = 0,
        bounds: Bounds | None = None,
        out: np.ndarray | None = None,
        threads: int = 1,
    ) -> FieldMap:
        """Return the signal strength of a transmitter at the centre of each cell [dBm], including cells in walls.

        The walls are counted exactly; the logarithm is accurate to 4e-5 dB, compared with `path_loss_db`. Resolutions
        of whole millimetres are by far the fastest.
        Args:   bounds: of the map, such as those of a level; by default, of the plan.
                out: float32, shape (rows, cols), C-contiguous: the map is written here, without allocating memory.
                threads: number of threads, 0 for one per core; it does not change the values.
        Raises: ValueError: the transmitter's position is not finite, the resolution is not above 0, or `out` has
                another shape or type.
        """
        keys = {"floors_crossed": floors_crossed, "threads": threads}
        return self.best_rssi_map_dbm([tx_m], resolution_m, bounds=bounds, out=out, **keys)

    def best_rssi_map_dbm(
        self,
        transmitters_m: Sequence[Point],
        resolution_m: float,
        *,
        floors_crossed: int = 0,
        bounds: Bounds | None = None,
        out: np.ndarray | None = None,
        threads: int = 1,
    ) -> FieldMap:
        """Return, per cell, the strongest signal of several transmitters [dBm]; otherwise as `rssi_map_dbm`.

        Raises: ValueError: as there, or no transmitters.
        """
        bounds = bounds or self._plan.bounds
        values = map_array(shape_over(bounds, resolution_m), out)
        origin_m = bounds.min
        _core.propagation.write_best_rssi_map_dbm(
            self.core_faces, self.core_model, transmitters_m, floors_crossed, origin_m, resolution_m, values, threads
        )
        return FieldMap(origin_m, resolution_m, values)

    def rssi_maps_dbm(self, transmitters_m: Sequence[Point], resolution_m: float, threads: int = 1) -> list[FieldMap]:
        """Return the map of each transmitter, as `rssi_map_dbm` does; each thread computes whole maps.

        Raises: ValueError: as there, or no transmitters.
        """
        rows, columns = grid_shape(self._plan, resolution_m)
        values = np.empty((len(transmitters_m), rows, columns), np.float32)
        origin_m = self._plan.bounds.min
        rows_of_all, faces, model = values.reshape(-1, columns), self.core_faces, self.core_model
        _core.propagation.write_rssi_maps_dbm(
            faces, model, transmitters_m, 0, origin_m, resolution_m, rows_of_all, threads
        )
        return [FieldMap(origin_m, resolution_m, part) for part in values]

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door. Raises: ValueError: no such door."""
        self.core_faces.set_active(self._faces.door_face(name), closed)


def shared_radio_field(building: MapSource, radio: Radio) -> RadioField:
    """Return the field that all robots of a building share; its doors must not be changed."""
    return building.shared(_radio_field, radio.model_dump_json())


def _radio_field(building: MapSource, radio_json: str) -> RadioField:
    return RadioField(building.plan, Radio.model_validate_json(radio_json))
