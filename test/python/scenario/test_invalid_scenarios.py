"""Every file of test/data/invalid is refused with the message that its first line states."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import load
from robotteamsim.world import check_places

INVALID = sorted((Path(__file__).parents[2] / "data" / "invalid").glob("*.yaml"))


def test_there_are_at_least_twenty_invalid_scenarios() -> None:
    assert len(INVALID) >= 20


@pytest.mark.parametrize("path", INVALID, ids=lambda path: path.stem)
def test_invalid_scenario_is_refused_with_its_exact_message(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)
    expected = path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# expect: ")
    # A mistake of syntax is told with its line: "name.yaml:4: ...".
    place = f"{path.name}:{expected[5:]}" if expected.startswith("line ") else f"{path.name}: {expected}"
    with pytest.raises(ScenarioError) as raised:
        check_places(load(path.name))
    assert str(raised.value) == place
