"""`plan import-stage`."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from robotteamsim.cli import main
from robotteamsim.scenario import load

WORLD = Path(__file__).parents[2] / "data" / "stage" / "hall.world"


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_imported_world_is_a_scenario_to_run(capsys):
    assert main(["plan", "import-stage", str(WORLD)]) == 0
    captured = capsys.readouterr()
    assert captured.out == "hall/hall.yaml: 1 robot; hall/plan.yaml: 6 walls, 1 block\n"
    warnings = captured.err.splitlines()
    assert all(line.startswith(f"robotteamsim: warning: {WORLD}:") for line in warnings)
    assert sum("no effect here" in line for line in warnings) == 1
    assert sorted(path.name for path in Path("hall").iterdir()) == ["hall.yaml", "plan.yaml"]
    assert yaml.safe_load(Path("hall/hall.yaml").read_text())["plan"] == "plan.yaml"
    assert main(["run", "hall/hall.yaml", "--quiet", "--set", "mission.time_limit_s=1"]) == 0


def test_existing_folder_is_kept_unless_it_is_named(refusal):
    Path("hall").mkdir()
    line = refusal("plan", "import-stage", str(WORLD))
    assert line == "hall already exists; choose another folder with --out"
    assert main(["plan", "import-stage", str(WORLD), "--out", "hall"]) == 0
    assert load("hall/hall.yaml").name == "hall"


def test_world_named_plan_does_not_overwrite_its_own_plan(capsys):
    Path("plan.world").write_text(WORLD.read_text().replace("hall.png", str(WORLD.with_name("hall.png"))))
    assert main(["plan", "import-stage", "plan.world", "--out", "."]) == 0
    assert load("scenario.yaml").plan.name == "plan"


def test_rejected_world_leaves_nothing_behind(refusal):
    Path("bad.world").write_text("\nmodel(\n")
    assert refusal("plan", "import-stage", "bad.world") == "bad.world:2: model: '(' is never closed"
    assert [path.name for path in Path().iterdir()] == ["bad.world"]
    assert refusal("plan", "import-stage", "no.world") == "no.world: there is no such file"
