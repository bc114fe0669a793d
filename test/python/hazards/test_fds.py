"""Results of FDS: a small run in FDS's own file format."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from burning import STEP_NS, Doors, scenario
from fds_run import Field, write_run

from robotteamsim.errors import ScenarioError
from robotteamsim.hazards.fds import FdsHazards
from robotteamsim.scenario import load
from robotteamsim.scenario.building import Building
from robotteamsim.simulation import Simulation

PLAN = {"name": "room", "bounds": {"max": [4, 3]}}


def temperature_c(x: np.ndarray, y: np.ndarray, time_s: float) -> np.ndarray:
    return 20.0 + 10.0 * x + y + 5.0 * time_s


def soot_kg_m3(x: np.ndarray, y: np.ndarray, time_s: float) -> np.ndarray:
    return 1e-5 * time_s * (1.0 + x) + 0.0 * y


def fds_hazards(folder: str, **keys: object) -> FdsHazards:
    burning = scenario(PLAN, {"fds": folder, **keys})
    return FdsHazards(burning, Building(burning.plan))


HEAT = ("TEMPERATURE", "temp", "C", temperature_c)
SOOT = ("SOOT DENSITY", "rho_soot", "kg/m3", soot_kg_m3)


def test_temperature_and_soot_are_those_of_fds_in_space_and_time(tmp_path):
    hazards = fds_hazards(write_run(tmp_path, [HEAT, SOOT]))
    assert hazards.step(6 * STEP_NS, Doors())  # begins at 5 s
    # The centre (0.75, 1.25) of a cell of 0.5 m is in the middle between four nodes of FDS.
    place = np.array([[0.75, 1.25]])
    assert hazards.field.temperature_c(place) == pytest.approx(temperature_c(0.75, 1.25, 5.0), abs=1e-3)
    assert hazards.field.soot(place) == pytest.approx(1e3 * soot_kg_m3(0.75, 1.25, 5.0), rel=1e-5)
    hazards.step(100 * STEP_NS, Doors())
    assert hazards.field.temperature_c(place) == pytest.approx(temperature_c(0.75, 1.25, 20.0), abs=1e-3)


@pytest.mark.parametrize("cell_m", [0.25, 0.4, 0.5])
@pytest.mark.parametrize("cell_centred", [False, True])
def test_values_between_nodes_and_between_centres_are_interpolated(tmp_path, cell_centred, cell_m):
    hazards = fds_hazards(write_run(tmp_path, [HEAT, SOOT], cell_centred=cell_centred), cell_m=cell_m)
    x, y = np.meshgrid(np.arange(0.3, 3.7, 0.01), np.arange(0.3, 2.7, 0.01))
    # Each value is that of the centre of its cell.
    centres = [cell_m * (np.floor(np.round(each.ravel() / cell_m, 9)) + 0.5) for each in (x, y)]
    inside = (centres[0] >= 0.25) & (centres[0] <= 3.75) & (centres[1] >= 0.25) & (centres[1] <= 2.75)
    found = hazards.field.temperature_c(np.stack((x.ravel(), y.ravel()), axis=1))
    assert found[inside] == pytest.approx(temperature_c(*centres, 0.0)[inside], abs=1e-3)


def test_visibility_and_extinction_become_the_same_soot(tmp_path):
    def extinction(x: np.ndarray, y: np.ndarray, time_s: float) -> np.ndarray:
        return 8.7e3 * soot_kg_m3(x, y, time_s)

    def visibility_m(x: np.ndarray, y: np.ndarray, time_s: float) -> np.ndarray:
        return 3.0 / np.maximum(extinction(x, y, time_s), 3.0 / 30.0)  # FDS, dump.f90 at 0019524c, read.f90 at 520b2f8c

    found = []
    for name, smoke in (
        ("density", SOOT),
        ("extinction", ("SOOT EXTINCTION COEFFICIENT", "ext_soot", "1/m", extinction)),
        ("visibility", ("SOOT VISIBILITY", "VIS_soot", "m", visibility_m)),
    ):
        folder = tmp_path / name
        folder.mkdir()
        hazards = fds_hazards(write_run(folder, [HEAT, smoke]))
        hazards.step(11 * STEP_NS, Doors())  # begins at a time of the results
        found.append(hazards.field.soot_g_m3)
    assert found[1] == pytest.approx(found[0], rel=1e-5)
    assert found[2] == pytest.approx(found[0], rel=1e-5)


def constant(value: float) -> Field:
    return lambda x, y, time_s: np.full(np.broadcast(x, y).shape, value)


def extinction_per_m(folder: str, **keys: object) -> float:
    return float(fds_hazards(folder, **keys).field.extinction_per_m(np.array([[1.25, 1.25]]))[0])


def visible(metres: float) -> tuple[str, str, str, Field]:
    return ("SOOT VISIBILITY", "VIS_Soot", "m", constant(metres))


@pytest.mark.parametrize(("metres", "per_m"), [(30.0, 0.0), (29.0, 3.0 / 29.0), (3.0, 1.0)])
def test_visibility_is_3_over_extinction_and_clear_air_at_30_m(tmp_path, metres, per_m, caplog):
    folder = write_run(tmp_path, [HEAT, visible(metres)])
    for visibility_c in (3.0, 8.0):  # how far the scenario's people see is not a property of the run
        assert extinction_per_m(folder, soot={"visibility_c": visibility_c}) == pytest.approx(per_m, rel=1e-6)
    assert "'" + str(tmp_path / "input.fds") + "' is missing; visibility is read with FDS's defaults" in caplog.text
    assert "VISIBILITY_FACTOR 3, MAXIMUM_VISIBILITY 30" in caplog.text


@pytest.mark.parametrize(
    ("text", "metres", "per_m"),
    [
        ("&HEAD CHID='room'/\n&TAIL/", 30.0, 0.0),
        ("&MISC VISIBILITY_FACTOR=8., MAXIMUM_VISIBILITY=100./", 99.0, 8.0 / 99.0),
        ("&MISC VISIBILITY_FACTOR=8., MAXIMUM_VISIBILITY=100./", 100.0, 0.0),
        ("It's a test\n  &misc FYI='a/b', ! 1/2, don't\n visibility_factor = 8.0D0 /", 4.0, 2.0),
        ("!&MISC VISIBILITY_FACTOR=8./\n&SURF ID='A', FYI='VISIBILITY_FACTOR=8'/", 4.0, 0.75),
    ],
)
def test_factor_and_maximum_of_visibility_are_those_of_the_input_file(tmp_path, caplog, text, metres, per_m):
    folder = write_run(tmp_path, [HEAT, visible(metres)])
    (tmp_path / "input.fds").write_text(text)
    assert extinction_per_m(folder) == pytest.approx(per_m, rel=1e-6)
    assert caplog.text == ""


def test_factor_of_visibility_that_is_no_number_is_one_line(tmp_path):
    folder = write_run(tmp_path, [HEAT, visible(3.0)])
    (tmp_path / "input.fds").write_text("&MISC VISIBILITY_FACTOR=many/")
    with pytest.raises(ScenarioError, match=r"input\.fds': VISIBILITY_FACTOR is 'MANY'; expected a number above 0$"):
        fds_hazards(folder)


def test_lasers_see_as_far_in_a_run_without_smoke_as_without_a_fire(tmp_path):
    folder = write_run(tmp_path, [("TEMPERATURE", "temp", "C", constant(20.0)), visible(30.0)], (60.0, 40.0))
    returns = []
    for more in ([], [f"fire={{fds: {folder}, soot: {{visibility_c: 8}}}}"]):
        simulation = Simulation(load("garage_sar", ["robots.laser.range_max_m=30", *more]))
        ranges_m = [simulation.step() for _ in range(15)][-1].state.ranges_m
        returns.append((np.asarray(ranges_m) < 30.0).sum())
    assert returns[0] == returns[1] > 400


def test_of_several_heights_the_nearest_to_the_key_is_read(tmp_path, caplog):
    heat = [("TEMPERATURE", "temp", "C", constant(value)) for value in (70.0, 120.0, 170.0)]
    smoke = [("SOOT DENSITY", "rho", "kg/m3", constant(value)) for value in (1e-4, 2e-4)]
    folder = write_run(tmp_path, [*heat, *smoke], heights=[1, 2, 3, 1, 3])  # at 0.5, 1.0, 1.5, 0.5 and 1.5 m
    place = np.array([[1.25, 1.25]])
    for keys, celsius, soot_g_m3 in (({}, 170.0, 0.2), ({"fds_height_m": 0.9}, 70.0, 0.1)):
        field = fds_hazards(folder, **keys).field
        assert field.temperature_c(place) == pytest.approx(celsius)
        assert field.soot(place) == pytest.approx(soot_g_m3)
    assert caplog.text == ""


def test_temperature_and_smoke_at_different_heights_are_reported(tmp_path, caplog):
    fds_hazards(write_run(tmp_path, [HEAT, SOOT], heights=[4, 1]))
    assert "read TEMPERATURE at 2.00 m and SOOT DENSITY at 0.50 m" in caplog.text


def test_meshes_with_unequal_numbers_of_frames_give_those_that_all_have(tmp_path):
    hazards = fds_hazards(write_run(tmp_path, [HEAT, SOOT], (2.0, 3.0), frames=[3, 2]))
    places = np.array([[0.75, 1.25], [3.25, 1.25]])  # one in each mesh
    for begin_s in (5.0, 10.0, 20.0):
        hazards.step(round(begin_s + 1) * STEP_NS, Doors())
        expected = temperature_c(places[:, 0], places[:, 1], min(begin_s, 10.0))
        assert hazards.field.temperature_c(places) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("first", [0, 1, 2])
def test_names_are_exact_or_have_a_species_best_soot(tmp_path, first):
    others = [
        ("RADIATIVE TEMPERATURE", "temp", "C", constant(900.0)),
        ("FOG VISIBILITY", "VIS_fog", "m", constant(5.0)),
        ("WATER VAPOR DENSITY", "rho", "kg/m3", constant(1.0)),
    ]
    slices = [*others[first:], HEAT, visible(3.0), *others[:first]]
    hazards = fds_hazards(write_run(tmp_path, slices))
    place = np.array([[1.25, 1.25]])
    assert hazards.field.temperature_c(place) == pytest.approx(temperature_c(1.25, 1.25, 0.0), abs=1e-3)
    assert hazards.field.extinction_per_m(place) == pytest.approx(1.0)


def test_smoke_of_another_species_is_read_where_there_is_no_soot(tmp_path):
    folder = write_run(tmp_path, [HEAT, ("MY SMOKE EXTINCTION COEFFICIENT", "ext", "1/m", constant(0.5))])
    assert extinction_per_m(folder) == pytest.approx(0.5)


@pytest.mark.parametrize(("index", "unit", "expected"), [(0, "K", "C"), (1, "mg/m3", "kg/m3")])
def test_unit_that_is_not_of_fds_is_one_line(tmp_path, index, unit, expected):
    slices = [HEAT, SOOT]
    slices[index] = (*slices[index][:2], unit, slices[index][3])
    name = slices[index][0]
    with pytest.raises(ScenarioError, match=f"the unit of {name} is '{unit}'; expected '{expected}'$"):
        fds_hazards(write_run(tmp_path, slices))


def test_height_of_fds_without_fds_is_one_line():
    with pytest.raises(ScenarioError, match=r"fire\.fds_height_m: 2 is only allowed together with fds"):
        scenario(PLAN, {"fds_height_m": 2.0})


def test_clock_of_fds_begins_at_its_ignition(tmp_path):
    hazards = fds_hazards(write_run(tmp_path, [HEAT, SOOT]), fds_ignition_s=7.0)
    place = np.array([[0.75, 1.25]])
    for begin_s in range(1, 13):
        hazards.step((begin_s + 1) * STEP_NS, Doors())
        fds_s = max(begin_s - 7.0, 0.0)
        assert hazards.field.temperature_c(place) == pytest.approx(temperature_c(0.75, 1.25, fds_s), abs=1e-3)
        assert len(hazards.ignited) == (begin_s >= 7)
    # The hottest corner, without flames.
    assert hazards.ignited[0].position_m == (3.75, 2.75)


def test_egress_times_count_from_the_ignition_of_fds(tmp_path):
    folder = write_run(tmp_path, [HEAT, SOOT])
    simulation = Simulation(scenario(PLAN, {"fds": folder, "fds_ignition_s": 7.0}))
    for _ in range(12):
        simulation.step()
    # The clock of the mission begins with the first step, which is at 1 s of the world.
    assert simulation.mission.egress.ignition_s == 7.0


def test_ignition_of_fds_without_fds_is_one_line():
    with pytest.raises(ScenarioError, match=r"fire\.fds_ignition_s: 7 is only allowed together with fds"):
        scenario(PLAN, {"fds_ignition_s": 7.0})


def test_mission_runs_in_a_fire_of_fds(tmp_path):
    simulation = Simulation(scenario(PLAN, {"fds": write_run(tmp_path, [HEAT, SOOT])}))
    fields = [record.hazards for record in (simulation.step() for _ in range(12)) if record.hazards is not None]
    assert len(fields) == 11
    assert fields[-1].temperatures_c.max() > fields[0].temperatures_c.max()


@pytest.mark.parametrize(
    ("slices", "message"),
    [
        ([HEAT], "has no horizontal slice of SOOT DENSITY, EXTINCTION COEFFICIENT, VISIBILITY; found TEMPERATURE$"),
        ([SOOT], "has no horizontal slice of TEMPERATURE; found SOOT DENSITY$"),
        ([], "has no horizontal slice of TEMPERATURE; found none$"),
    ],
)
def test_folder_without_smoke_or_temperature_is_rejected_in_one_line(slices, message, tmp_path):
    with pytest.raises(ScenarioError, match=message) as caught:
        Simulation(scenario(PLAN, {"fds": write_run(tmp_path, slices)}))
    assert "fire.fds: " in str(caught.value)
    assert "\n" not in str(caught.value)


def test_file_that_breaks_off_is_rejected(tmp_path):
    folder = Path(write_run(tmp_path, [HEAT, SOOT]))
    for file in folder.glob("*.sf"):
        file.write_bytes(file.read_bytes()[:100])
    with pytest.raises(ScenarioError, match=r"fire\.fds: '.*' cannot be read as results of FDS: "):
        Simulation(scenario(PLAN, {"fds": str(folder)}))


@pytest.mark.parametrize("axis", ["TRNX", "TRNY", "TRNZ"])
def test_number_of_lines_that_the_file_does_not_have_is_rejected_before_they_are_read(tmp_path, axis):
    file = Path(write_run(tmp_path, [HEAT, SOOT])) / "room.smv"
    file.write_text(file.read_text().replace(f"{axis}\n    0\n", f"{axis}\n  999999999\n"))
    lines = file.read_text().splitlines()
    place = f"line {lines.index('  999999999') + 1}"
    message = f"room.smv', {place}: says that 999999999 lines follow; the file has {len(lines)}"
    with pytest.raises(ScenarioError, match=f"{re.escape(message)}$"):
        Simulation(scenario(PLAN, {"fds": str(tmp_path)}))


def test_number_of_limits_of_particles_is_checked_too(tmp_path):
    write_run(tmp_path, [HEAT, SOOT])
    (tmp_path / "room_1.prt5.bnd").write_text(" 0.000000E+00    1\n 999999999   0\n")
    with pytest.raises(ScenarioError, match=r"room_1\.prt5\.bnd', line 2: says that 999999999 lines follow; .* has 2$"):
        Simulation(scenario(PLAN, {"fds": str(tmp_path)}))


def test_part_of_the_results_that_is_not_needed_may_be_unreadable_without_a_traceback(tmp_path, caplog):
    file = Path(write_run(tmp_path, [HEAT, SOOT])) / "room.smv"
    file.write_text(file.read_text().replace("VENT\n    0    0", "VENT\n    9    0"))
    Simulation(scenario(PLAN, {"fds": str(tmp_path)}))
    assert caplog.text == ""


@pytest.mark.parametrize(
    ("quantity", "value", "message"),
    [
        ("TEMPERATURE", np.nan, "a temperature is not finite$"),
        ("TEMPERATURE", np.inf, "a temperature is not finite$"),
        ("SOOT DENSITY", np.nan, "a value of SOOT DENSITY is not finite$"),
        ("SOOT DENSITY", np.inf, "a value of SOOT DENSITY is not finite$"),
        ("SOOT DENSITY", 1e37, r"SOOT DENSITY means more than 1e\+09 g/m\^3 of soot$"),
        ("SOOT DENSITY", -0.5, "a value of SOOT DENSITY is -0.5; expected at least 0$"),
    ],
)
def test_values_that_no_fire_has_are_rejected(tmp_path, quantity, value, message):
    def odd(x: np.ndarray, y: np.ndarray, time_s: float) -> np.ndarray:
        return np.full(np.broadcast(x, y).shape, value)

    slices = [(*one[:3], odd) if one[0] == quantity else one for one in (HEAT, SOOT)]
    with pytest.raises(ScenarioError, match=message):
        Simulation(scenario(PLAN, {"fds": write_run(tmp_path, slices)}))


def test_rounding_below_zero_is_no_smoke(tmp_path):
    def rounded(x: np.ndarray, y: np.ndarray, time_s: float) -> np.ndarray:
        return np.full(np.broadcast(x, y).shape, -1e-9)

    hazards = fds_hazards(write_run(tmp_path, [HEAT, (*SOOT[:3], rounded)]))
    assert hazards.field.soot_g_m3.min() == hazards.field.soot_g_m3.max() == 0.0


def test_folder_that_is_not_of_fds_is_rejected(tmp_path):
    with pytest.raises(ScenarioError, match=r"fire\.fds: '.*nowhere' is not a folder; expected the results of FDS"):
        Simulation(scenario(PLAN, {"fds": str(tmp_path / "nowhere")}))
    with pytest.raises(ScenarioError, match=r"has no \.smv file; expected the results of FDS"):
        Simulation(scenario(PLAN, {"fds": str(tmp_path)}))


def test_without_fdsreader_one_line_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "fdsreader", None)
    with pytest.raises(ScenarioError, match=r"fire\.fds: .* it comes with the extra 'fds' "):
        Simulation(scenario(PLAN, {"fds": str(tmp_path)}))


def test_caches_of_fdsreader_are_neither_read_nor_written(tmp_path):
    folder = write_run(tmp_path, [HEAT, SOOT])
    before = sorted(path.name for path in tmp_path.iterdir())
    Simulation(scenario(PLAN, {"fds": folder}))
    assert sorted(path.name for path in tmp_path.iterdir()) == before
