"""Any text in a world file is imported or rejected in one line."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.setup import resolve
from robotteamsim.stage import import_world
from robotteamsim.stage.world_file import read_tokens

pytestmark = pytest.mark.slow

DATA = Path(__file__).parents[2] / "data" / "stage"

JUNK = ["(", ")", "[", "]", '"', '"x"', "0", "-1", "1e9", "999999999", "0.000001", "nan", "model", "position", "ranger"]
JUNK += ["define", 'include "a.world"', "size", "pose", "samples", "block", "sensor", "boundary 1", "bitmap"]
JUNK += ["#", "\x00"]


def _words(file: str) -> list[str]:
    tokens = read_tokens(DATA / file, file)
    return [f'"{token.value}"' if token.kind == "text" else token.value for token in tokens]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that has the bitmap of the worlds."""
    folder = tmp_path_factory.mktemp("stage")
    (folder / "hall.png").write_bytes((DATA / "hall.png").read_bytes())
    return folder


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    words=st.sampled_from([_words("hall.world"), _words("patrol/patrol.world")]),
    changes=st.lists(st.tuples(st.integers(0, 10_000), st.sampled_from([*JUNK, ""])), min_size=1, max_size=3),
)
@example(words=_words("hall.world"), changes=[])
@example(words=_words("patrol/patrol.world"), changes=[(6890, "0.000001")])
def test_changed_world_is_imported_or_rejected_in_one_line(folder, words, changes):
    words = [word.replace("../hall.png", "hall.png") for word in words]
    for place, junk in changes:
        words[place % len(words)] = junk
    path = folder / "a.world"
    path.write_text("\n".join(words), encoding="utf-8")
    try:
        scenario = import_world(path).scenario
        outcome = "no robot" if scenario is None else str(len(resolve(scenario).robots))
    except ScenarioError as error:
        outcome = str(error)
    assert outcome in ("no robot", "1", "2") or outcome.startswith(str(path))
    assert "\n" not in outcome


ROBOT = "define rob position ( size [0.4 0.4 0.4] )\nrob( pose [ 5 5 0 0 ] )\n"
FLOOR = 'model( size [10 10 1] boundary 1 obstacle_return 1 ranger_return 1 name "{name}" )\n'


@pytest.mark.parametrize(
    ("text", "name", "of_scenario"),
    [
        (FLOOR.format(name="m" * 90) + ROBOT, "m" * 80 + "_boundary_south", "a"),
        (FLOOR.format(name="a\x1bb") + ROBOT, r"a\x1bb_boundary_south", "a"),
        (f'name "{"n" * 101}"\n' + FLOOR.format(name="floor") + ROBOT, "floor_boundary_south", "n" * 100),
    ],
)
def test_name_that_a_plan_cannot_have_is_made_one(tmp_path, text, name, of_scenario):
    path = tmp_path / "a.world"
    path.write_text(text.replace("boundary 1", "boundary 1 noblocks 1").replace("pose [ 5 5", "pose [ 0 0"), "utf-8")
    found = import_world(path)
    assert (found.plan.walls[0].name, found.scenario.name) == (name, of_scenario)


def test_thousands_of_models_of_one_name_and_with_boundaries_are_imported_fast(tmp_path):
    # 2 s of processor time; 72 s when each name and each boundary was compared with all before.
    path = tmp_path / "a.world"
    same = "".join(f'model( size [0.1 0.1 1] name "box" pose [{i % 60} {i // 60 + 20} 0 0] )\n' for i in range(6000))
    rooms = "".join(
        f"model( size [0.5 0.5 1] boundary 1 noblocks 1 pose [{i % 60} {-i // 60 - 20} 0 0] )\n" for i in range(600)
    )
    path.write_text(same + rooms + ROBOT, encoding="utf-8")
    begin_s = time.process_time()
    plan = import_world(path).scenario.plan
    assert time.process_time() - begin_s < 20.0
    assert len({block.name for block in plan.blocks}) == 6000
    assert len(plan.walls) == 2400
