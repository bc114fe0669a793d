"""Any text in a world file is imported or rejected in one line."""

from __future__ import annotations

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
def test_changed_world_is_imported_or_rejected_in_one_line(folder, words, changes):
    words = [word.replace("../hall.png", "hall.png") for word in words]
    for place, junk in changes:
        words[place % len(words)] = junk
    path = folder / "a.world"
    path.write_text("\n".join(words), encoding="utf-8")
    try:
        outcome = str(len(resolve(import_world(path).scenario).robots))
    except ScenarioError as error:
        outcome = str(error)
    assert outcome in ("1", "2") or outcome.startswith(str(path))
    assert "\n" not in outcome
