"""How well the radio models predict Wi-Fi that others measured on a floor: python -m study.wifi.floor --data FOLDER

FOLDER is a copy of github.com/IS2AI/WiFine [khassanov2021]; README.md describes the method. Each radio's place, its
signal at 1 m and its exponent are fitted to the walks of `train` for each model alike, and judged on the walks of
`test`. Written: one row per model and treatment of weak signals, and a figure.
Usage: python -m study.wifi.floor --data FOLDER [--workers 2]
"""

from __future__ import annotations

import argparse
import csv
import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.sparse.csgraph import connected_components

from robotteamsim import palette
from robotteamsim.analysis.plan_picture import draw_floor_plan
from robotteamsim.formats.image import ImageImporter
from robotteamsim.propagation import RadioField
from robotteamsim.propagation.radio_field import Point
from robotteamsim.scenario import Block, FloorPlan, Wall
from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.image_walls import THICKEST_M
from robotteamsim.scenario.materials import Layer, Material
from robotteamsim.scenario.sections import Radio
from study.intervals import mean_with_interval

RESULTS = Path(__file__).with_name("floor.csv")
PICTURE = Path(__file__).with_name("floor.png")

COLUMNS = 436
"""Of signals in each file; then num_visible_APs, timestamp, x, y, z and floorID."""
NOT_HEARD_DBM = -100.0
ORIGIN_M = (87.83, 48.11)
"""Of the data set's frame in the image's, turned by 180 degrees: 99.9 % of the places then are on free floor."""
METRES_PER_PIXEL = 0.1

# Columns that say enough of a place on this floor: heard often, near somewhere, and on the walks of the test.
LEAST_TRAIN, LEAST_TEST, NEAR_DBM = 800, 60, -45.0
SAME_RADIO_DB = 3.0
"""Columns that differ by less on average are names of one radio: the next difference is 3.3 dB."""

LATTICE_M, REACH_M, STRONGEST = 1.0, 10.0, 30
ROUNDS = 50

MAPS, SHOWN = ("one slope", "Table 3 times a factor"), 7
"""Models and radio of the maps in the figure."""

STUD = Material(
    name="stud",
    layers=(
        Layer(of="plasterboard", thickness_m=0.0125),
        Layer(of="air", thickness_m=0.075),
        Layer(of="plasterboard", thickness_m=0.0125),
    ),
)
CONCRETE = Material(name="concrete", layers=(Layer(of="concrete", thickness_m=0.2),))


Row = dict[str, str | int | float]


@dataclass(frozen=True, slots=True)
class Walks:
    """What was measured on walks.

    places_m: shape (n, 2), in the frame of the image [m].
    rssi_dbm: shape (n, columns); NaN where a column was not heard.
    """

    places_m: np.ndarray
    rssi_dbm: np.ndarray


@dataclass(frozen=True, slots=True)
class Model:
    """A model of the losses of walls. factor: of these losses; None: fitted for each radio."""

    walls: str
    factor: float | None


MODELS = {
    "one slope": Model("thickness", 0.0),
    "Table 3": Model("thickness", 1.0),
    "layers, all stud": Model("stud", 1.0),
    "layers, concrete from 1 m": Model("hull", 1.0),
    "layers, concrete above 0.2 m": Model("thick", 1.0),
    "Table 3 times a factor": Model("thickness", None),
    "one loss for all walls": Model("stud", None),
}
"""The models; `plans` explains what their walls are."""

WEAK = ("bounded", "measured", "all bounded")
"""How weak signals are treated. bounded: a reading at the receiver's floor means "at most that", and names that are
not heard are left out. measured: a reading at the floor is a measurement. all bounded: names that are not heard are at
most the floor, too."""


@dataclass(frozen=True, slots=True)
class Readings:
    """Of one radio on walks: the index of the place, the signal, and whether it is only an upper bound; shape (m,)."""

    place: np.ndarray
    rssi_dbm: np.ndarray
    at_floor: np.ndarray


@dataclass(frozen=True, slots=True)
class Fit:
    """A radio in a model.

    at_1_m_dbm: transmit power - l0.
    factor:     of the losses of walls.
    squares:    the sum of the squared errors [dB^2].
    """

    place_m: Point
    at_1_m_dbm: float
    exponent: float
    factor: float
    squares: float


@dataclass(frozen=True, slots=True)
class Judged:
    """A fit on the walks of the test.

    rmse_db:        of all readings, see `bounded_errors_db`.
    above_floor_db: RMSE of the readings above the floor.
    """

    fit: Fit
    rmse_db: float
    above_floor_db: float


Judgements = Mapping[tuple[str, str], Judged]
"""Of one radio, by treatment of weak signals and model."""


def read_walks(files: Iterable[Path]) -> Walks:
    """Return the walks of some files of the data set."""
    rows = np.concatenate([np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2) for file in files])
    rssi_dbm = rows[:, :COLUMNS]
    places_m = np.array(ORIGIN_M) - rows[:, COLUMNS + 2 : COLUMNS + 4]
    return Walks(places_m, np.where(rssi_dbm > NOT_HEARD_DBM, rssi_dbm, np.nan))


def chosen_columns(train: Walks, test: Walks) -> np.ndarray:
    """Return the indices of the columns that say enough, in order."""
    often = np.isfinite(train.rssi_dbm).sum(axis=0) >= LEAST_TRAIN
    tested = np.isfinite(test.rssi_dbm).sum(axis=0) >= LEAST_TEST
    near = np.nan_to_num(train.rssi_dbm, nan=NOT_HEARD_DBM).max(axis=0) >= NEAR_DBM
    return np.flatnonzero(often & tested & near)


def columns_of_radios(rssi_dbm: np.ndarray) -> list[np.ndarray]:
    """Return the columns of each radio: an access point sends several networks, each with a name, from one antenna."""
    count = rssi_dbm.shape[1]
    differ_db = np.full((count, count), np.inf)
    for column in range(count):
        errors_db = np.abs(rssi_dbm - rssi_dbm[:, [column]])
        both = np.isfinite(errors_db).any(axis=0)
        differ_db[column, both] = np.nanmean(errors_db[:, both], axis=0)
    number, radio = connected_components(differ_db < SAME_RADIO_DB, directed=False)
    return [np.flatnonzero(radio == one) for one in range(number)]


def plans(drawing: Path) -> dict[str, FloorPlan]:
    """Return the floor by what its walls are made of: unknown, or a guess by the thickness in the drawing.

    hull:  concrete from `THICKEST_M` on: outer walls, shafts and pillars.
    thick: concrete above 0.2 m.
    stud:  no concrete. All other walls are stud walls.
    """
    plan = ImageImporter().read(drawing, metres_per_pixel=METRES_PER_PIXEL).plan
    thickest_stud_m = {"hull": 0.9, "thick": 0.2, "stud": math.inf}
    return {"thickness": plan} | {name: with_materials(plan, most_m) for name, most_m in thickest_stud_m.items()}


def with_materials(plan: FloorPlan, thickest_stud_m: float) -> FloorPlan:
    """Return a plan whose walls and blocks are studs up to a thickness, and concrete above."""

    def made_of(element: Wall | Block) -> dict[str, str]:
        is_stud = (element.thickness_m or THICKEST_M) <= thickest_stud_m
        return {"material": STUD.name if is_stud else CONCRETE.name}

    walls = tuple(wall.model_copy(update=made_of(wall)) for wall in plan.walls)
    blocks = tuple(block.model_copy(update=made_of(block)) for block in plan.blocks)
    return plan.model_copy(update={"walls": walls, "blocks": blocks, "materials": (STUD, CONCRETE)})


def wall_field(plan: FloorPlan) -> RadioField:
    """Return the radio field of the losses of walls alone."""
    return RadioField(plan, Radio(walls="material", constant_loss_db=0.0, slope_db=SMALLEST))


def wall_losses_db(field: RadioField, place_m: Point, others_m: np.ndarray) -> np.ndarray:
    """Return the losses of walls between a place and others, shape (n,)."""
    return np.array([field.path_loss_db(place_m, (x, y)) for x, y in others_m.tolist()]).round(2)


def tens_of_distance(place_m: Point, others_m: np.ndarray) -> np.ndarray:
    """Return 10 log10 of the distances between a place and others in metres, shape (n,)."""
    distances_m = np.maximum(np.hypot(*(others_m - place_m).T), Radio().min_distance_m)
    return np.asarray(10.0 * np.log10(distances_m))


def candidates_m(walks: Walks, columns: np.ndarray, plan: FloorPlan) -> list[Point]:
    """Return a lattice around the middle of the strongest readings of a radio, within the plan."""
    strongest_dbm = np.nan_to_num(walks.rssi_dbm[:, columns], nan=NOT_HEARD_DBM).max(axis=1)
    middle_m = np.median(walks.places_m[np.argsort(-strongest_dbm, kind="stable")[:STRONGEST]], axis=0).round()
    steps = np.arange(-REACH_M, REACH_M + LATTICE_M, LATTICE_M)
    around_m = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    places_m = middle_m + around_m[np.hypot(*around_m.T) <= REACH_M]
    return [(x, y) for x, y in places_m.tolist() if plan.bounds.contains((x, y))]


def readings_of(walks: Walks, columns: np.ndarray, floor_dbm: float, weak: str) -> Readings:
    """Return the readings of a radio by a treatment of weak signals."""
    rssi_dbm = walks.rssi_dbm[:, columns]
    if weak == "all bounded":
        rssi_dbm = np.nan_to_num(rssi_dbm, nan=floor_dbm)
    place, column = np.nonzero(np.isfinite(rssi_dbm))
    values_dbm = rssi_dbm[place, column]
    return Readings(place, values_dbm, (values_dbm <= floor_dbm) & (weak != "measured"))


def bounded_errors_db(predicted_dbm: np.ndarray, readings: Readings) -> np.ndarray:
    """Return measured - predicted; 0 where a reading is an upper bound and the prediction keeps it."""
    errors_db = readings.rssi_dbm - predicted_dbm
    return np.asarray(np.where(readings.at_floor, np.minimum(errors_db, 0.0), errors_db))


def least_squares(terms: np.ndarray, readings: Readings) -> tuple[np.ndarray, float]:
    """Return the coefficients of the terms, shape (m, k), with the least sum of squared errors, and the sum.

    The errors are those of `bounded_errors_db`, so the sum is convex; each round solves for the readings that count.
    """
    counted = np.ones(len(terms), dtype=bool)
    for _ in range(ROUNDS):
        weighted = (terms * counted[:, None]).T
        coefficients = np.linalg.lstsq(weighted @ terms, weighted @ readings.rssi_dbm, rcond=None)[0]
        errors_db = bounded_errors_db(terms @ coefficients, readings)
        now = ~readings.at_floor | (errors_db < 0.0)
        if np.array_equal(now, counted):
            break
        counted = now
    return coefficients, float(errors_db @ errors_db)


def fit_at(place_m: Point, model: Model, tens: np.ndarray, walls_db: np.ndarray, readings: Readings) -> Fit:
    """Return the best fit of a model with the radio at a place. Args: tens, walls_db: at each place, shape (n,)."""
    tens, walls_db = tens[readings.place], walls_db[readings.place]
    terms = [np.ones(len(tens)), -tens]
    if model.factor is None:
        (at_1_m, exponent, factor), squares = least_squares(np.stack([*terms, -walls_db], axis=1), readings)
        return Fit(place_m, float(at_1_m), float(exponent), float(factor), squares)
    without_walls = replace(readings, rssi_dbm=readings.rssi_dbm + model.factor * walls_db)
    (at_1_m, exponent), squares = least_squares(np.stack(terms, axis=1), without_walls)
    return Fit(place_m, float(at_1_m), float(exponent), model.factor, squares)


def best_fits(
    candidates: Sequence[Point],
    places_m: np.ndarray,
    fields: Mapping[str, RadioField],
    readings: Mapping[str, Readings],
) -> dict[tuple[str, str], Fit]:
    """Return the best fit of a radio by treatment of weak signals and model.

    Args: places_m: of the walks.  fields: by `Model.walls`.  readings: by treatment.
    """
    best: dict[tuple[str, str], Fit] = {}
    for place_m in candidates:
        tens = tens_of_distance(place_m, places_m)
        walls_db = {walls: wall_losses_db(field, place_m, places_m) for walls, field in fields.items()}
        for (weak, some), (name, model) in itertools.product(readings.items(), MODELS.items()):
            fit = fit_at(place_m, model, tens, walls_db[model.walls], some)
            if (weak, name) not in best or fit.squares < best[weak, name].squares:
                best[weak, name] = fit
    return best


def predicted_dbm(fit: Fit, field: RadioField, places_m: np.ndarray) -> np.ndarray:
    """Return the signal of a fitted radio at places, shape (n,)."""
    walls_db = wall_losses_db(field, fit.place_m, places_m)
    return fit.at_1_m_dbm - fit.exponent * tens_of_distance(fit.place_m, places_m) - fit.factor * walls_db


def judged(fit: Fit, field: RadioField, test: Walks, readings: Readings, floor_dbm: float) -> Judged:
    """Return a fit with its errors on the walks of the test."""
    predictions_dbm = predicted_dbm(fit, field, test.places_m)[readings.place]
    errors_db = bounded_errors_db(predictions_dbm, readings)
    return Judged(fit, rms(errors_db), rms((readings.rssi_dbm - predictions_dbm)[readings.rssi_dbm > floor_dbm]))


def rms(values: np.ndarray) -> float:
    """Return the root of the mean square."""
    return math.sqrt(float(np.mean(values**2)))


def judge_radio(columns: np.ndarray, train: Walks, test: Walks, floor: Mapping[str, FloorPlan]) -> Judgements:
    """Fit a radio on the walks of `train` and judge it on those of `test`, by treatment and model."""
    floor_dbm = float(np.nanmin(train.rssi_dbm[:, columns]))
    fields = {walls: wall_field(plan) for walls, plan in floor.items()}
    readings = {weak: readings_of(train, columns, floor_dbm, weak) for weak in WEAK}
    fits = best_fits(candidates_m(train, columns, floor["thickness"]), train.places_m, fields, readings)
    return {
        (weak, name): judged(
            fit, fields[MODELS[name].walls], test, readings_of(test, columns, floor_dbm, weak), floor_dbm
        )
        for (weak, name), fit in fits.items()
    }


def table(radios: Sequence[Judgements]) -> list[Row]:
    """Return a row per treatment of weak signals and model: over all radios, with intervals of 95 %."""
    rows = []
    for weak, name in itertools.product(WEAK, MODELS):
        some = [radio[weak, name] for radio in radios]
        rmse_db = np.array([one.rmse_db for one in some])
        change_db = rmse_db - [radio[weak, "one slope"].rmse_db for radio in radios]
        row: Row = {"weak": weak, "model": name, "radios": len(radios), "rmse_db": rounded(rmse_db.mean())}
        row["above_floor_db"] = rounded(sum(one.above_floor_db for one in some) / len(some))
        row |= zip(("change_db", "low_db", "high_db"), map(rounded, mean_with_interval(change_db)), strict=True)
        row["better"] = int(np.count_nonzero(change_db < 0.0))
        for quantity, values in (
            ("rmse_db", rmse_db),
            ("exponent", [one.fit.exponent for one in some]),
            ("factor", [one.fit.factor for one in some]),
        ):
            quartiles = np.percentile(values, (25, 50, 75)).tolist()
            row |= zip((f"{quantity}_q{part}" for part in (1, 2, 3)), map(rounded, quartiles), strict=True)
        rows.append(row)
    return rows


def rounded(value: float) -> float:
    """Return a value for the table; no -0."""
    return round(float(value), 2) + 0.0


def draw(radios: Sequence[Judgements], maps: Mapping[str, np.ndarray], test: Walks, plan: FloorPlan) -> None:
    """Draw the error of each radio in each model, and the errors of one radio on the floor, by model."""
    figure = Figure(figsize=(12.0, 6.4), dpi=120, layout="constrained")
    axes = figure.subplot_mosaic([["errors", name] for name in maps], width_ratios=(1.0, 1.2))
    draw_errors(axes["errors"], radios)
    for name, errors_db in maps.items():
        draw_floor_plan(axes[name], plan)
        heard = np.isfinite(errors_db)
        x_m, y_m = test.places_m[heard].T
        points = axes[name].scatter(x_m, y_m, 16, errors_db[heard], cmap="PuOr", vmin=-15.0, vmax=15.0, zorder=4, lw=0)
        place_m = radios[SHOWN]["bounded", name].fit.place_m
        axes[name].plot(*place_m, "*", color=palette.GREEN, mec=palette.INK, ms=15, zorder=5)
        axes[name].set_title(f"{name}: errors of one radio", fontsize=11, color=palette.INK)
        axes[name].set(xticks=(), yticks=())
    bar = figure.colorbar(points, ax=[axes[name] for name in maps], shrink=0.7, extend="both")
    bar.set_label("measured - predicted [dB]", color=palette.SOFT_INK)
    kinds = {"no walls": palette.FAINT_INK, "losses as stated": palette.VERMILLION, "losses fitted": palette.BLUE}
    handles = [Line2D([], [], marker="o", ls="", color=colour, label=kind) for kind, colour in kinds.items()]
    figure.legend(handles=handles, loc="outside lower left", ncols=3, frameon=False)
    figure.savefig(PICTURE)


def errors_on_floor_db(fit: Fit, field: RadioField, test: Walks, readings: Readings) -> np.ndarray:
    """Return the mean error of a radio at each place of the test, shape (n,); NaN where it was not heard."""
    errors_db = bounded_errors_db(predicted_dbm(fit, field, test.places_m)[readings.place], readings)
    sums, counts = (np.bincount(readings.place, weights, len(test.places_m)) for weights in (errors_db, None))
    return np.asarray(np.divide(sums, counts, out=np.full(len(sums), np.nan), where=counts > 0))


def draw_errors(axes: Axes, radios: Sequence[Judgements]) -> None:
    """Draw the error of each radio in each model."""
    rmse_db = np.array([[radio["bounded", name].rmse_db for name in MODELS] for radio in radios])
    rows = np.arange(len(MODELS))
    axes.plot(rmse_db.T, rows, color=palette.GRID, lw=0.8, zorder=1)
    for row, values_db in zip(rows, rmse_db.T, strict=True):
        fitted = list(MODELS.values())[row].factor is None
        colour = palette.BLUE if fitted else palette.VERMILLION if row else palette.FAINT_INK
        axes.plot(values_db, np.full(len(values_db), row), "o", color=colour, ms=5, alpha=0.6, mec="none")
        axes.plot(values_db.mean(), row, "|", color=colour, ms=30, mew=3)
        axes.annotate(
            f"{values_db.mean():.1f}", (values_db.mean(), row - 0.3), ha="center", color=colour, weight="bold"
        )
    axes.set_yticks(rows, list(MODELS))
    axes.set(ylim=(len(MODELS) - 0.5, -0.6), xlim=(0.0, None))
    axes.set_xlabel("error on the walks of the test, RMSE [dB]", color=palette.SOFT_INK)
    axes.set_title(f"{len(radios)} radios and their mean", fontsize=11, color=palette.INK)
    axes.grid(axis="x", color=palette.GRID, lw=0.6)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(left=False, colors=palette.INK)


def write(rows: list[Row]) -> None:
    """Print the table, and write it."""
    with RESULTS.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(RESULTS.read_text(encoding="utf-8"))


def walks_of_floor(folder: Path) -> tuple[Walks, Walks]:
    """Return the walks of `train` and `test` on floor 4, with the columns that say enough. Raises: OSError."""
    train, test = (read_walks(sorted((folder / part).glob(f"{part}_4_*.csv"))) for part in ("train", "test"))
    columns = chosen_columns(train, test)
    return Walks(train.places_m, train.rssi_dbm[:, columns]), Walks(test.places_m, test.rssi_dbm[:, columns])


def main() -> None:
    """Fit and judge all radios; print and write the table, draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="a copy of github.com/IS2AI/WiFine")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    drawing = options.data / "floor_layouts" / "Floor_4_10cm.png"
    if not drawing.is_file():
        parser.error(f"--data {options.data}: no {drawing.relative_to(options.data)}; expected a copy of WiFine")
    train, test = walks_of_floor(options.data)
    floor, radios = plans(drawing), columns_of_radios(train.rssi_dbm)
    print(f"{len(train.places_m)} and {len(test.places_m)} places, {train.rssi_dbm.shape[1]} names")
    with ProcessPoolExecutor(options.workers) as pool:
        results = list(pool.map(partial(judge_radio, train=train, test=test, floor=floor), radios))
    write(table(results))
    readings = readings_of(test, radios[SHOWN], float(np.nanmin(train.rssi_dbm[:, radios[SHOWN]])), "bounded")
    fields = {name: wall_field(floor[MODELS[name].walls]) for name in MAPS}
    fits = {name: results[SHOWN]["bounded", name].fit for name in MAPS}
    maps = {name: errors_on_floor_db(fits[name], fields[name], test, readings) for name in MAPS}
    draw(results, maps, test, floor["thickness"])


if __name__ == "__main__":
    main()
