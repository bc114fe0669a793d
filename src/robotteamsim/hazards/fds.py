"""Fire and smoke from the results of FDS, which the package fdsreader reads."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robotteamsim.errors import PlacementError
from robotteamsim.extras import missing_extra
from robotteamsim.hazards.field import BURNING, HazardField, Ignited
from robotteamsim.hazards.source import ClosedDoors, ambient_field
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.user_files import open_regular

_KEY = "fire.fds"
_TEMPERATURE = "TEMPERATURE"
_G_PER_KG = 1e3
_MIN_VISIBILITY_M = 1e-3
_MOST_SOOT_G_M3 = 1e9
_ROUNDING = 1e-6
"""Values of FDS may be below 0 by so little."""

_LINE_COUNTS = {
    ".smv": {"TRN": 1, "CLASS_OF_PARTICLES": 3, "CLASS_OF_HUMANS": 3, "PRT5": 2, "EVA5": 2},
    ".bnd": {"": 0},
}
"""Where fdsreader reads as many lines as a number says: by the suffix of the file, the beginning of a line, and how
many lines after that the number is. In a .bnd file the other numbers are not whole."""


def _soot_of(fire: Fire) -> dict[str, Callable[[np.ndarray], np.ndarray]]:
    """Return the quantities that show smoke, and how each becomes soot [g/m^3]."""
    extinction_m2_g, c = fire.soot.extinction_m2_g, fire.soot.visibility_c
    return {
        "SOOT DENSITY": lambda kg_m3: kg_m3 * _G_PER_KG,
        "EXTINCTION COEFFICIENT": lambda per_m: per_m / extinction_m2_g,
        "VISIBILITY": lambda metres: c / np.maximum(metres, _MIN_VISIBILITY_M) / extinction_m2_g,
    }


class FdsHazards:
    """Fire and smoke of a run of FDS, in cells of the plan: each has the values of the point nearest to its centre.

    Its clock, and with it the fire, begins at `fire.fds_ignition_s`; until then the field is as at its time 0. Between
    two times of the results, values are interpolated linearly; after the last one they stay.
    """

    def __init__(self, scenario: Scenario, building: Building) -> None:
        """Read the folder. Raises: PlacementError: it is not that of a run of FDS, or shows no temperature or smoke."""
        fire = scenario.fire
        assert fire is not None
        assert fire.fds is not None
        self._fire, self._step_ns = fire, scenario.run.step_ns
        self._ignition_ns = round(fire.fds_ignition_s * 1e9)
        self._ambient = ambient_field(fire, building)
        self._temperature, self._smoke, smoke = building.shared(_samples, fire)
        self._soot_of = _soot_of(fire)[smoke]
        self.field = self._at(0.0)
        self.version = 1
        """Of the last update."""
        self.updated = False
        """Whether the last step was an update."""
        self.ignited: tuple[Ignited, ...] = ()
        """The place that burns first, once the clock of FDS has begun."""

    def step(self, sim_time_ns: int, doors: ClosedDoors) -> bool:
        """Advance to the step with this stamp [ns]; return whether this was an update. Doors change nothing."""
        self.updated = self._fire.updates_at(sim_time_ns, self._step_ns)
        if not self.updated:
            return False
        self.field = self._at((sim_time_ns - self._step_ns) / 1e9)
        self.version += 1
        if not self.ignited and sim_time_ns - self._step_ns >= self._ignition_ns:
            self.ignited = (Ignited("", self._hottest_m()),)
        return True

    def ignite(self, position_m: Point) -> None:
        """Raises: ValueError: the results of FDS cannot be changed."""
        raise ValueError("ignite: the fire is a result of FDS, fire.fds, which cannot be changed")

    def burnt_doors(self) -> tuple[str, ...]:
        """Return no doors."""
        return ()

    def _hottest_m(self) -> Point:
        """Return the centre of the cell that is hottest at the first time with flames; without flames, of all times."""
        peaks_c = self._temperature.values.max(axis=(1, 2))
        flames = np.flatnonzero(peaks_c >= self._fire.heat.flame_c)
        hottest = self._temperature.values[flames[0] if len(flames) else peaks_c.argmax()]
        row, col = np.unravel_index(hottest.argmax(), hottest.shape)
        (x, y), cell_m = self._ambient.origin_m, self._ambient.resolution_m
        return x + cell_m * (float(col) + 0.5), y + cell_m * (float(row) + 0.5)

    def _at(self, time_s: float) -> HazardField:
        time_s = max(time_s - self._ignition_ns / 1e9, 0.0)
        temperatures_c = self._temperature.at(time_s).astype(np.float32)
        states = np.where(temperatures_c >= self._fire.heat.flame_c, BURNING, 0).astype(np.uint8)
        soot_g_m3 = self._soot_of(self._smoke.at(time_s)).astype(np.float32)
        origin_m, resolution_m = self._ambient.origin_m, self._ambient.resolution_m
        return HazardField(origin_m, resolution_m, temperatures_c, soot_g_m3, states, self._fire)


class _Samples:
    """The values of a slice in the cells of a grid, over time."""

    def __init__(self, found: Any, cells: HazardField, outside: float) -> None:
        """Args: outside: the value of cells that the slice does not cover."""
        self._times_s = np.asarray(found.times, dtype=np.float64)
        rows, cols = cells.states.shape
        x = cells.origin_m[0] + cells.resolution_m * (np.arange(cols) + 0.5)
        y = cells.origin_m[1] + cells.resolution_m * (np.arange(rows) + 0.5)
        self.values = np.full((len(self._times_s), rows, cols), outside, dtype=np.float32)
        """Of all times, float32, shape (times, rows, cols)."""
        for part in found.subslices:
            points = part.get_coordinates()
            covered_x, near_x = _nearest(points["x"], x)
            covered_y, near_y = _nearest(points["y"], y)
            data = np.asarray(part.data)  # by time, x and y
            picked = data[:, near_x[covered_x]][:, :, near_y[covered_y]]
            self.values[np.ix_(np.arange(len(data)), covered_y, covered_x)] = picked.transpose(0, 2, 1)
        if not len(self._times_s):
            raise ValueError("there are no times yet")
        if not np.isfinite(self._times_s).all():
            raise ValueError("a time is not finite")

    def at(self, time_s: float) -> np.ndarray:
        """Return the values at a time, float64, shape (rows, cols)."""
        after = int(np.searchsorted(self._times_s, time_s, side="right"))
        if after == 0 or after == len(self._times_s):
            nearest: np.ndarray = self.values[min(after, len(self._times_s) - 1)].astype(np.float64)
            return nearest
        begin_s, end_s = self._times_s[after - 1 : after + 1]
        fraction = (time_s - begin_s) / (end_s - begin_s)
        before, now = self.values[after - 1].astype(np.float64), self.values[after].astype(np.float64)
        # Where both are infinite, as the visibility outside the slice, their difference is not a number.
        values: np.ndarray = np.where(before == now, before, before + fraction * (now - before))
        return values


def _samples(building: Building, fire: Fire) -> tuple[_Samples, _Samples, str]:
    """Return temperature and smoke of the results in `fire.fds`, and the name of the quantity that shows smoke."""
    assert fire.fds is not None
    slices = _horizontal_slices(fire.fds)
    kinds = _soot_of(fire)
    smoke = next((name for name in kinds if _find(slices, name)), None)
    for wanted, found in ((_TEMPERATURE, _find(slices, _TEMPERATURE)), (", ".join(kinds), smoke)):
        if not found:
            known = ", ".join(sorted({_name(each) for each in slices})) or "none"
            raise _mistake(f"'{fire.fds}' has no horizontal slice of {wanted}; found {known}")
    assert smoke is not None
    ambient = ambient_field(fire, building)
    try:
        temperature = _Samples(_find(slices, _TEMPERATURE), ambient, fire.heat.ambient_c)
        shown = _Samples(_find(slices, smoke), ambient, np.inf if smoke == "VISIBILITY" else 0.0)
    except Exception as error:  # the data are read only now, see `_horizontal_slices`
        raise _unreadable(fire.fds, error) from None
    if not np.isfinite(temperature.values).all():
        raise _mistake(f"'{fire.fds}': a temperature is not finite")
    if np.isnan(shown.values).any() or (smoke != "VISIBILITY" and np.isinf(shown.values).any()):
        raise _mistake(f"'{fire.fds}': a value of {smoke} is not finite")
    if (shown.values < -_ROUNDING).any():
        raise _mistake(f"'{fire.fds}': a value of {smoke} is {shown.values.min():g}; expected at least 0")
    np.maximum(shown.values, 0.0, out=shown.values)
    with np.errstate(over="ignore"):
        most_g_m3 = kinds[smoke](shown.values).max()
    if not most_g_m3 < _MOST_SOOT_G_M3:
        raise _mistake(f"'{fire.fds}': {smoke} means more than {_MOST_SOOT_G_M3:g} g/m^3 of soot")
    return temperature, shown, smoke


def _nearest(points: Sequence[float], places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the indices of the places within the points' range, and for each place the index of the nearest point."""
    sorted_points = np.asarray(points, dtype=np.float64)
    half = 0.5 * (sorted_points[1] - sorted_points[0]) if len(sorted_points) > 1 else 0.0
    is_covered = (places >= sorted_points[0] - half) & (places <= sorted_points[-1] + half)
    nearest = np.abs(places[:, None] - sorted_points[None, :]).argmin(axis=1)
    return np.flatnonzero(is_covered), nearest


def _horizontal_slices(folder: str) -> list[Any]:
    """Return the horizontal slices in a folder. Raises: PlacementError: there is no run of FDS, or no fdsreader."""
    try:
        import fdsreader
    except ImportError as error:
        raise _mistake(missing_extra(error) or str(error)) from None
    if not Path(folder).is_dir():
        raise _mistake(f"'{folder}' is not a folder; expected the results of FDS")
    if not any(Path(folder).glob("*.smv")):
        raise _mistake(f"'{folder}' has no .smv file; expected the results of FDS")
    for each in Path(folder).iterdir():
        if each.exists() and not (each.is_file() or each.is_dir()):  # fdsreader would wait for a FIFO
            raise _mistake(f"'{each}' is not a regular file")
    # Its caches are pickles: a folder from elsewhere could run code.
    fdsreader.settings.ENABLE_CACHING = False
    # It prints a traceback for each part that it cannot read, such as vents, which are not used here.
    fdsreader.settings.IGNORE_ERRORS = True
    try:
        _check_counts(Path(folder))
        found = fdsreader.Simulation(folder).slices
        return [each for each in found if each.orientation == 3]
    except PlacementError:
        raise
    except Exception as error:  # fdsreader has no error class for files that it cannot read
        raise _unreadable(folder, error) from None


def _check_counts(folder: Path) -> None:
    """Raises: PlacementError: a number of lines is larger than its file; fdsreader would read on after the end."""
    for path in sorted(folder.iterdir()):
        places = _LINE_COUNTS.get(path.suffix)
        if places is None:
            continue
        with io.TextIOWrapper(open_regular(path), errors="replace") as file:
            lines = [line.split() for line in file]
        for number, words in enumerate(lines, start=1):
            for keyword, offset in places.items():
                if " ".join(words).startswith(keyword) and (count := _first_number(lines, number + offset)) > len(
                    lines
                ):
                    raise _mistake(
                        f"'{path}', line {number + offset}: says that {count} lines follow; the file has {len(lines)}"
                    )


def _first_number(lines: Sequence[Sequence[str]], number: int) -> int:
    """Return the whole number with which a line, by its number from 1 on, begins; 0 if there is none."""
    try:
        return int(lines[number - 1][0])
    except (IndexError, ValueError):
        return 0


def _unreadable(folder: str, error: Exception) -> PlacementError:
    reason = " ".join(str(error).split()) or type(error).__name__
    return _mistake(f"'{folder}' cannot be read as results of FDS: {reason}")


def _find(slices: Sequence[Any], quantity: str) -> Any:
    """Return the first slice of a quantity, also of one species such as soot; None if there is none."""
    return next((each for each in slices if _name(each).endswith(quantity)), None)


def _name(found: Any) -> str:
    return str(found.quantity.name).strip().upper()


def _mistake(text: str) -> PlacementError:
    return PlacementError(f"{_KEY}: {text}", _KEY)
