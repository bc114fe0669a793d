"""`import robotteamsim as rts`: the names that most programs need, each imported on first use."""

from __future__ import annotations

import subprocess
import sys

import pytest

import robotteamsim as rts
from robotteamsim.interface import Controller, Decision
from robotteamsim.scenario import Scenario, load
from robotteamsim.simulation import Simulation


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
