"""Every case of test/data/invalid_scenarios.yaml is refused with its exact message."""

from __future__ import annotations

from pathlib import Path

import pytest
from invalid_scenarios import CASES, message_of, text_of

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import load
from robotteamsim.setup import resolve


@pytest.mark.parametrize("name", CASES)
def test_invalid_scenario_is_rejected_with_its_exact_message(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(f"{name}.yaml").write_text(text_of(name), encoding="utf-8")
    expected = message_of(name)
    # A syntax error names its line: "name.yaml:4: ...".
    place = f"{name}.yaml:{expected[5:]}" if expected.startswith("line ") else f"{name}.yaml: {expected}"
    with pytest.raises(ScenarioError) as raised:
        resolve(load(f"{name}.yaml"))
    assert str(raised.value) == place
