"""`plan import` of worlds of Stage, and `plan export-stage`."""

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
    assert main(["plan", "import", str(WORLD)]) == 0
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
    line = refusal("plan", "import", str(WORLD))
    assert line == "hall already exists; choose another name with --out, or --force replaces it"
    assert main(["plan", "import", str(WORLD), "--out", "hall"]) == 0
    assert load("hall/hall.yaml").name == "hall"


def test_world_named_plan_does_not_overwrite_its_own_plan(capsys):
    Path("plan.world").write_text(WORLD.read_text().replace("hall.png", str(WORLD.with_name("hall.png"))))
    assert main(["plan", "import", "plan.world", "--out", "."]) == 0
    assert load("scenario.yaml").plan.name == "plan"


def test_rejected_world_leaves_nothing_behind(refusal):
    Path("bad.world").write_text("\nmodel(\n")
    assert refusal("plan", "import", "bad.world") == "bad.world:2: model: '(' is never closed"
    assert [path.name for path in Path().iterdir()] == ["bad.world"]
    assert refusal("plan", "import", "no.world") == "no.world: there is no such file"


ROOM = "model( size [ 10 8 1 ] pose [ 5 4 0 0 ] noblocks 1 boundary 1 )\n"


def test_world_without_robots_is_written_as_a_plan_alone(capsys):
    Path("room.world").write_text(ROOM)
    assert main(["plan", "import", "room.world"]) == 0
    assert capsys.readouterr().out == "room/plan.yaml: 4 walls, 0 blocks\n"
    assert [path.name for path in Path("room").iterdir()] == ["plan.yaml"]


def test_all_refusals_of_a_world_are_printed(capsys):
    Path("a.world").write_text(f"{ROOM}puck()\nposition( pose [ 2 2 ] )\n")
    assert main(["plan", "import", "a.world"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        "robotteamsim: a.world:2: puck: unknown model 'puck'",
        "robotteamsim: a.world:3: pose: [2 2] is not 4 numbers, [x y z heading]",
    ]
    assert not Path("a").exists()


def test_exported_scenario_is_imported_and_runs(capsys, refusal):
    assert main(["plan", "export-stage", "garage_sar", "--out", "w"]) == 0
    captured = capsys.readouterr()
    assert captured.out == "w/garage_sar.world: 3 robots\n"
    assert "robotteamsim: warning: not in Stage: bays, areas, victims" in captured.err.splitlines()
    line = "w/garage_sar.world already exists; choose another name with --out, or --force replaces it"
    assert refusal("plan", "export-stage", "garage_sar", "--out", "w") == line
    assert main(["plan", "export-stage", "garage_sar", "--out", "w", "--force", "--set", "run.step_s=0.05"]) == 0
    assert main(["plan", "import", "w/garage_sar.world", "--out", "s"]) == 0
    again = load("s/garage_sar.yaml")
    assert (again.plan.walls, again.run.step_s) == (load("garage_sar").plan.walls, 0.05)
    assert main(["plan", "import", "w/garage_sar.world", "--out", "s", "--force"]) == 0


def test_exported_plan_has_no_robots(capsys):
    assert main(["plan", "export-stage", "office", "--out", "."]) == 0
    assert capsys.readouterr().out == "office.world: no robot\n"
    assert main(["plan", "import", "office.world", "--out", "p"]) == 0
    assert main(["plan", "export-stage", "p/plan.yaml", "--out", "."]) == 0
    assert Path("plan.world").read_text() == Path("office.world").read_text()
