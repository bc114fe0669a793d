"""`plan import-stage` and `plan export-stage`."""

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
    assert line == "hall already exists; choose a folder with --out"
    assert main(["plan", "import-stage", str(WORLD), "--out", "hall"]) == 0
    assert load("hall/hall.yaml").name == "hall"


def test_world_named_plan_does_not_overwrite_its_own_plan(capsys):
    Path("plan.world").write_text(WORLD.read_text().replace("hall.png", str(WORLD.with_name("hall.png"))))
    assert main(["plan", "import-stage", "plan.world", "--out", "."]) == 0
    assert load("scenario.yaml").plan.name == "plan"


def test_refused_world_leaves_nothing_behind(refusal):
    Path("bad.world").write_text("\nmodel(\n")
    assert refusal("plan", "import-stage", "bad.world") == "bad.world:2: model: '(' is never closed"
    assert [path.name for path in Path().iterdir()] == ["bad.world"]
    assert refusal("plan", "import-stage", "no.world") == "no.world: there is no such file"


def test_exported_scenario_is_a_world_and_its_bitmap(capsys):
    assert main(["plan", "export-stage", "tutorial_arena", "--out", "out", "--resolution", "0.1"]) == 0
    captured = capsys.readouterr()
    assert captured.out == "out/tutorial_arena.world: 1 robot; out/tutorial_arena.png: walls and closed doors\n"
    assert captured.err.startswith("robotteamsim: warning: odometry: drifts by the alphas here")
    assert sorted(path.name for path in Path("out").iterdir()) == ["tutorial_arena.png", "tutorial_arena.world"]
    assert main(["plan", "import-stage", "out/tutorial_arena.world", "--out", "back"]) == 0
    assert load("back/tutorial_arena.yaml").plan.bounds == load("tutorial_arena").plan.bounds


def test_exported_scenario_takes_settings(capsys):
    assert main(["plan", "export-stage", "garage_sar", "--out", "out", "--set", "robots.count=5"]) == 0
    assert Path("out/garage_sar.world").read_text().count("robot_kind_0( pose") == 5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["export-stage", "garage_sra", "--out", "out"], "garage_sra: no shipped scenario of this name"),
        (
            ["export-stage", "garage_sar", "--out", "out", "--resolution", "0"],
            "argument --resolution: 0 is not above 0",
        ),
        (["export-stage", "garage_sar", "--out", "out", "--resolution", "nan"], "argument --resolution: 'nan' is not"),
        (["export-stage", "garage_sar"], "the following arguments are required: --out"),
    ],
)
def test_bad_export_is_refused_and_leaves_nothing_behind(refusal, arguments, message):
    assert refusal("plan", *arguments).startswith(message)
    assert list(Path().iterdir()) == []
