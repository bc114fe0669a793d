"""`import robotteamsim as rts`: the names that most programs need, each imported on first use."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import robotteamsim as rts
from robotteamsim.interface import Controller, Decision
from robotteamsim.scenario import Scenario, load
from robotteamsim.simulation import Simulation

ROOT = Path(__file__).parents[2]


def test_top_level_names_are_those_of_the_packages():
    assert (rts.load, rts.Scenario, rts.Simulation) == (load, Scenario, Simulation)
    assert (rts.Controller, rts.Decision) == (Controller, Decision)


def test_every_name_of_all_can_be_imported_and_is_listed():
    assert set(rts.__all__) <= set(dir(rts))
    assert all(getattr(rts, name) is not None for name in rts.__all__)


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'robotteamsim' has no attribute 'lod'"):
        rts.lod  # noqa: B018


def test_import_of_the_package_imports_none_of_its_parts():
    code = "import sys, robotteamsim; print([n for n in sys.modules if n.startswith('robotteamsim.') or n == 'numpy'])"
    done = subprocess.run((sys.executable, "-c", code), capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_processes_of_other_libraries_find_the_package(tmp_path, method):
    # Stable-Baselines3, Gymnasium and PyTorch start them with the sys.path of their parent.
    script = tmp_path / "started.py"
    script.write_text(
        "import multiprocessing\n"
        "import robotteamsim as rts\n"
        "def read(name):\n"
        "    return rts.Simulation and rts.load(name).num_robots\n"
        "if __name__ == '__main__':\n"
        f"    with multiprocessing.get_context({method!r}).Pool(1) as pool:\n"
        "        print(pool.apply_async(read, ('garage_sar',)).get(20), rts.Simulation.__name__)\n"
    )
    done = subprocess.run((sys.executable, str(script)), capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (0, "3 Simulation\n"), done.stderr


def test_mission_runs_with_top_level_names_alone():
    result = rts.Simulation(rts.load("garage_sar", ["run.seed=7", "mission.time_limit_s=1"])).run()
    assert isinstance(result, rts.Result)
    assert result.time_s == pytest.approx(1.0)


def test_records_and_scenarios_print_as_one_line_and_notebooks_fold_all_keys():
    scenario = rts.load("garage_sar", ["run.seed=7"])
    assert repr(scenario) == "<Scenario garage_sar: 3 robots, 5 areas, 4 victims, plan garage, seed 7>"
    page = scenario._repr_html_()
    assert page.startswith("<details><summary>&lt;Scenario garage_sar: 3 robots")
    assert "noise_db: 10.0" in page
    record = rts.Simulation(scenario).step()
    assert repr(record) == "<StepRecord 1: 0.1 s, running, 0 of 5 areas explored, 0 of 4 victims saved>"


def test_package_is_a_program():
    done = subprocess.run(
        (sys.executable, "-m", "robotteamsim", "--version"), capture_output=True, text=True, check=True
    )
    assert done.stdout == f"robotteamsim {rts.__version__}\n"


@pytest.mark.slow
def test_type_checkers_know_the_types_of_an_installed_package(tmp_path):
    subprocess.run((sys.executable, "-m", "venv", "--without-pip", str(tmp_path / "venv")), check=True)
    (site,) = (tmp_path / "venv").glob("lib/python*/site-packages")
    (site / "dependencies.pth").write_text(next(path for path in sys.path if path.endswith("site-packages")))
    for path in map(Path, rts.__path__):  # the sources; then the stubs of the compiled module
        shutil.copytree(path, site / "robotteamsim", ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True)
    mine = tmp_path / "mine.py"
    mine.write_text(
        "import robotteamsim as rts\n"
        "reveal_type(rts.load('garage_sar'))\n"
        "reveal_type(rts.Simulation(rts.load('garage_sar')).step().mission.areas_explored)\n"
        "rts.Simulation('garage_sar')\n"
    )
    words = (sys.executable, "-m", "mypy", "--python-executable", str(tmp_path / "venv/bin/python"), "mine.py")
    environment = {name: value for name, value in os.environ.items() if name not in ("MYPYPATH", "PYTHONPATH")}
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    found = [line.partition(" ")[2] for line in done.stdout.splitlines() if line.startswith("mine.py:")]
    assert found == [
        'note: Revealed type is "robotteamsim.scenario.scenario.Scenario"',
        'note: Revealed type is "int"',
        'error: Argument 1 to "Simulation" has incompatible type "str"; expected "Scenario | Setup"  [arg-type]',
    ]
    assert 'package_data={\n            "robotteamsim": ["py.typed"],' in (ROOT / "setup.py").read_text()
