"""Fire and smoke from the results of FDS, which the package fdsreader reads."""

from __future__ import annotations

import functools
import io
import itertools
import logging
import re
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

_logger = logging.getLogger(__name__)
_KEY = "fire.fds"
_TEMPERATURE, _VISIBILITY = "TEMPERATURE", "VISIBILITY"
_UNITS = {_TEMPERATURE: "C", "SOOT DENSITY": "kg/m3", "EXTINCTION COEFFICIENT": "1/m", _VISIBILITY: "m"}
"""The units of FDS (data.f90 at 00879a5d) of the quantities that are read: temperature, and what shows smoke."""
_G_PER_KG = 1e3
_MIN_VISIBILITY_M = 1e-3
_MOST_SOOT_G_M3 = 1e9
_SAME_HEIGHT_M = 0.01
_ROUNDING = 1e-6
"""Values of FDS may be below 0 by so little, and the relative rounding of a visibility at its maximum."""

_MISC = re.compile(r"^\s*&MISC\b((?:'[^']*'|\"[^\"]*\"|![^\n]*+|[^'\"!/])*+)/", re.MULTILINE)
"""The namelist MISC of FDS's input file; a slash in a text or a comment does not end it."""
_Convert = Callable[[np.ndarray], np.ndarray]

_LINE_COUNTS = {
    ".smv": r"^[ \t]*(?:TRN.*\n|(?:PRT5|EVA5).*\n.*\n|CLASS_OF_(?:PARTICLES|HUMANS).*\n.*\n.*\n)[ \t]*(\d+)(?!\S)",
    ".bnd": r"^[ \t]*(\d+)(?!\S)",
}
"""Where fdsreader reads as many lines as a number says, by the suffix of the file. In a .bnd file the other numbers are
not whole."""


class FdsHazards:
    """Fire and smoke of a run of FDS, in cells of the plan: each has the values at its centre.

    Its clock, and with it the fire, begins at `fire.fds_ignition_s`; until then the field is as at its time 0. Between
    two times of the results, and between nodes or centres of cells of FDS, temperature and soot are interpolated
    linearly; after the last time they stay.
    """

    def __init__(self, scenario: Scenario, building: Building) -> None:
        """Read the folder. Raises: PlacementError: it is not that of a run of FDS, or shows no temperature or smoke."""
        fire = scenario.fire
        assert fire is not None
        assert fire.fds is not None
        self._fire, self._step_ns = fire, scenario.run.step_ns
        self._ignition_ns = round(fire.fds_ignition_s * 1e9)
        self._ambient = ambient_field(fire, building)
        self._temperature, self._soot = building.shared(_samples, fire)
        self.field = self._at(0.0)
        self.version = 1
        """Of the last update."""
        self.updated = False
        """Whether the last step was an update."""
        self.ignited: tuple[Ignited, ...] = ()
        """The place that burns first, once the clock of FDS has begun."""

    def step(self, sim_time_ns: int, doors: ClosedDoors) -> bool:
        """Advance to the step with this stamp [ns]; return whether this was an update. Doors change nothing."""
        begin_ns = sim_time_ns - self._step_ns
        if not self.ignited and begin_ns >= self._ignition_ns:
            self.ignited = (Ignited("", self._hottest_m()),)
        self.updated = self._fire.updates_at(sim_time_ns, self._step_ns)
        if self.updated:
            self.field = self._at(begin_ns / 1e9)
            self.version += 1
        return self.updated

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
        soot_g_m3 = self._soot.at(time_s).astype(np.float32)
        origin_m, resolution_m = self._ambient.origin_m, self._ambient.resolution_m
        return HazardField(origin_m, resolution_m, temperatures_c, soot_g_m3, states, self._fire)


class _Samples:
    """Temperature or soot in the cells of a grid, over time."""

    def __init__(self, found: Any, root: str, cells: HazardField, outside: float, convert: _Convert) -> None:
        """Read a slice. Args: root: folder of the run.  outside: the value of cells that the slice does not cover."""
        parts = _by_mesh(found, root)
        times_s = [np.asarray(part.times, dtype=np.float64) for part in parts]
        if not np.isfinite(np.concatenate(times_s)).all():
            raise ValueError("a time is not finite")
        # A run that goes on, or was ended, has written more frames of some meshes than of others.
        self._times_s = functools.reduce(np.intersect1d, times_s, times_s[0])
        if not len(self._times_s):
            raise ValueError("there are no times yet")
        rows, cols = cells.states.shape
        x = cells.origin_m[0] + cells.resolution_m * (np.arange(cols) + 0.5)
        y = cells.origin_m[1] + cells.resolution_m * (np.arange(rows) + 0.5)
        self.values = np.full((len(self._times_s), rows, cols), outside, dtype=np.float32)
        """Of all times, float32, shape (times, rows, cols)."""
        for part in parts:
            points, nodes = (part.subslices[0].get_coordinates(ignore_cell_centered=nodes) for nodes in (False, True))
            in_x, in_y = _within(nodes["x"], x), _within(nodes["y"], y)
            frames = np.intersect1d(self._times_s, part.times, return_indices=True)[2]
            for values, frame in zip(self.values, frames, strict=True):
                given = convert(np.asarray(part.subslices[0].data[frame], dtype=np.float64))  # by x and y
                along_x = _between(given, points["x"], x[in_x])
                values[np.ix_(in_y, in_x)] = _between(along_x.T, points["y"], y[in_y])

    def at(self, time_s: float) -> np.ndarray:
        """Return the values at a time, float64, shape (rows, cols)."""
        values: np.ndarray = _between(self.values, self._times_s, np.array([time_s]))[0]
        return values


def _by_mesh(found: Any, root: str) -> list[Any]:
    """Return the part of a slice in each mesh as a slice of its own; the times of a whole one are those of one part."""
    quantity = found.quantity
    of_all = {"quantity": quantity.name, "short_name": quantity.short_name, "unit": quantity.unit}
    own = ("mesh", "filename", "dimension", "extent", "bound_indices")
    parts = [of_all | {key: getattr(part, key) for key in own} for part in found.subslices]
    return [type(found)(root, found.id, found.cell_centered, [part]) for part in parts]


def _within(nodes: Sequence[float], places: np.ndarray) -> np.ndarray:
    """Return the indices of the places between the first and the last node."""
    return np.flatnonzero((places >= nodes[0] - _ROUNDING) & (places <= nodes[-1] + _ROUNDING))


def _between(values: np.ndarray, points: Sequence[float] | np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return values at places along the first axis, linear between its points, constant beyond them, as float64."""
    at = np.asarray(points, dtype=np.float64)
    after = np.clip(np.searchsorted(at, places), min(1, len(at) - 1), len(at) - 1)
    before = np.maximum(after - 1, 0)
    width = np.where(after > before, at[after] - at[before], 1.0)
    share = np.clip((places - at[before]) / width, 0.0, 1.0).reshape(-1, *[1] * (values.ndim - 1))
    between: np.ndarray = values[before] * (1.0 - share) + values[after] * share
    return between


def _samples(building: Building, fire: Fire) -> tuple[_Samples, _Samples]:
    """Return the temperature [degC] and the soot [g/m^3] of the results in `fire.fds`."""
    assert fire.fds is not None
    run, ambient = _run(fire.fds), ambient_field(fire, building)
    root = str(run.root_path)
    try:  # the data are read only now
        heat, smoke = _at_one_height([each for each in run.slices if each.orientation == 3], fire)
        temperature = _Samples(heat, root, ambient, fire.heat.ambient_c, lambda values: values)
        soot = _Samples(smoke, root, ambient, 0.0, _soot_of(smoke, fire, Path(run.smv_file_path)))
    except PlacementError:
        raise
    except Exception as error:
        raise _unreadable(fire.fds, error) from None
    if not np.isfinite(temperature.values).all():
        raise _mistake(f"'{fire.fds}': a temperature is not finite")
    return temperature, soot


def _soot_of(smoke: Any, fire: Fire, smv: Path) -> _Convert:
    """Return what converts values of a slice of smoke to soot [g/m^3]."""
    kind, extinction_m2_g = _kind(_name(smoke)), fire.soot.extinction_m2_g
    factor, most_m = _visibility(smv) if kind == _VISIBILITY else (0.0, 0.0)

    def soot_g_m3(values: np.ndarray) -> np.ndarray:
        if not np.isfinite(values).all():
            raise _mistake(f"'{fire.fds}': a value of {kind} is not finite")
        if (values < -_ROUNDING).any():
            raise _mistake(f"'{fire.fds}': a value of {kind} is {values.min():g}; expected at least 0")
        if kind == "SOOT DENSITY":
            soot = _G_PER_KG * values
        elif kind == _VISIBILITY:  # at its maximum, FDS means clear air
            is_smoke = values < most_m * (1.0 - _ROUNDING)
            soot = np.where(is_smoke, factor / np.maximum(values, _MIN_VISIBILITY_M), 0.0) / extinction_m2_g
        else:
            soot = values / extinction_m2_g
        if not soot.max() < _MOST_SOOT_G_M3:
            raise _mistake(f"'{fire.fds}': {kind} means more than {_MOST_SOOT_G_M3:g} g/m^3 of soot")
        return np.maximum(soot, 0.0)

    return soot_g_m3


def _at_one_height(slices: Sequence[Any], fire: Fire) -> tuple[Any, Any]:
    """Return the slices of temperature and smoke: at one height if there are such, nearest to that of the scenario.

    Raises: PlacementError: there is none, or its unit is not that of FDS.
    """
    heat = _named(slices, _TEMPERATURE)
    smokes = [name for name in _UNITS if name != _TEMPERATURE]
    smoke: list[Any] = next(filter(None, (_named(slices, name) for name in smokes)), [])
    for wanted, found in ((_TEMPERATURE, heat), (", ".join(smokes), smoke)):
        if not found:
            known = ", ".join(sorted({_name(each) for each in slices})) or "none"
            raise _mistake(f"'{fire.fds}' has no horizontal slice of {wanted}; found {known}")

    def distance(pair: tuple[Any, Any]) -> tuple[bool, float]:
        one_m, other_m = map(_height_m, pair)
        return abs(one_m - other_m) > _SAME_HEIGHT_M, abs(one_m - fire.fds_height_m) + abs(other_m - fire.fds_height_m)

    chosen = min(itertools.product(heat, smoke), key=distance)
    for each in chosen:
        unit, expected = each.quantity.unit.strip(), _UNITS[_kind(_name(each))]
        if unit != expected:
            raise _mistake(f"'{fire.fds}': the unit of {_name(each)} is '{unit}'; expected '{expected}'")
    if distance(chosen)[0]:
        heights = " and ".join(f"{_name(each)} at {_height_m(each):.2f} m" for each in chosen)
        _logger.warning("%s: '%s' has no temperature and smoke at one height; read %s", _KEY, fire.fds, heights)
    return chosen


def _named(slices: Sequence[Any], quantity: str) -> list[Any]:
    """Return the slices of a quantity: with exactly this name, of soot, or of the first other species."""
    names = [name for name in map(_name, slices) if _kind(name) == quantity]
    best = min(names, key=lambda name: (name != quantity, name != f"SOOT {quantity}"), default=None)
    return [each for each in slices if _name(each) == best]


def _visibility(smv: Path) -> tuple[float, float]:
    """Return C and the maximum [m] of FDS's visibility, C / K: from the input file that a .smv file names."""
    # The defaults of FDS: cons.f90 at 002ad224, read.f90 at 520b2f8c.
    keys = {"VISIBILITY_FACTOR": 3.0, "MAXIMUM_VISIBILITY": 30.0}
    named = (after.strip() for line, after in itertools.pairwise(_lines(smv)) if line.strip() == "INPF")
    path = smv.with_name(Path(next(named, f"{smv.stem}.fds")).name)
    if not path.is_file():
        given = ", ".join(f"{key} {value:g}" for key, value in keys.items())
        _logger.warning("%s: '%s' is missing; visibility is read with FDS's defaults, %s", _KEY, path, given)
        return keys["VISIBILITY_FACTOR"], keys["MAXIMUM_VISIBILITY"]
    misc = " ".join(_MISC.findall("".join(_lines(path)).upper()))
    factor, most_m = (_number(path, misc, key, default) for key, default in keys.items())
    return factor, most_m


def _number(path: Path, misc: str, key: str, default: float) -> float:
    """Return a number of a namelist in Fortran. Raises: PlacementError: it is not a number above 0."""
    found = re.search(rf"\b{key}\s*=\s*([^\s,]*)", re.sub(r"'[^']*'|\"[^\"]*\"|![^\n]*", " ", misc))
    if found is None:
        return default
    try:
        number = float(found[1].replace("D", "E"))
    except ValueError:
        number = 0.0
    if not 0.0 < number < np.inf:
        raise _mistake(f"'{path}': {key} is '{found[1]}'; expected a number above 0")
    return number


def _run(folder: str) -> Any:
    """Return the run of FDS in a folder. Raises: PlacementError: there is none, or no fdsreader."""
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
        return fdsreader.Simulation(folder)
    except PlacementError:
        raise
    except Exception as error:  # fdsreader has no error class for files that it cannot read
        raise _unreadable(folder, error) from None


def _check_counts(folder: Path) -> None:
    """Raises: PlacementError: a number of lines is larger than its file; fdsreader would read on after the end."""
    for path in sorted(folder.iterdir()):
        lines = _lines(path) if path.suffix in _LINE_COUNTS else []
        text = "".join(lines)
        for found in re.finditer(_LINE_COUNTS.get(path.suffix, ""), text, re.MULTILINE) if lines else ():
            if int(found[1]) > len(lines):
                place = f"'{path}', line {text.count(chr(10), 0, found.end()) + 1}"
                raise _mistake(f"{place}: says that {found[1]} lines follow; the file has {len(lines)}")


def _lines(path: Path) -> list[str]:
    with io.TextIOWrapper(open_regular(path), errors="replace") as file:
        return file.readlines()


def _unreadable(folder: str, error: Exception) -> PlacementError:
    reason = " ".join(str(error).split()) or type(error).__name__
    return _mistake(f"'{folder}' cannot be read as results of FDS: {reason}")


def _name(found: Any) -> str:
    return str(found.quantity.name).strip().upper()


def _kind(name: str) -> str:
    """Return the quantity that a name is of: FDS writes a species before the quantity, such as SOOT VISIBILITY."""
    ends = (quantity for quantity in _UNITS if quantity != _TEMPERATURE and name.endswith(f" {quantity}"))
    return next(ends, name)


def _height_m(found: Any) -> float:
    return float(found.subslices[0].get_coordinates()["z"][0])


def _mistake(text: str) -> PlacementError:
    return PlacementError(f"{_KEY}: {text}", _KEY)
