from __future__ import annotations

import pytest

from robotteamsim.campaign.factors import parse_override, parse_sweep, read_design_file
from robotteamsim.errors import RobotTeamSimError


def test_values_are_read_as_yaml():
    factor = parse_sweep("control.algorithm=rdpso, random_walk,'7', 1e-1, true")
    assert (factor.key, factor.values) == ("control.algorithm", ("rdpso", "random_walk", "7", 0.1, True))
    assert parse_override("a.b=[1, 2]").values == ([1, 2],)


def test_design_file_is_read(tmp_path):
    path = tmp_path / "d.yaml"
    path.write_text(
        "trials: 7\nseed: 3\nset: {control.alpha: 0.5}\nsweep: {voice.noise_db: [10, 20]}\ncells: [{a: 1}]\n"
    )
    design = read_design_file(path)
    assert (design.trials, design.seed, design.overrides) == (7, 3, {"control.alpha": 0.5})
    assert (design.sweep, design.cells) == ({"voice.noise_db": (10, 20)}, ({"a": 1},))


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("trails: 3", "trails: unknown key; did you mean 'trials'?"),
        ("trials: 0", "trials: 0 is below 1"),
        ("sweep: {voice.noise_db: 10}", "sweep.voice.noise_db: 10 is not a list"),
        ("- 1", "[1] is not a design: lines of KEY: VALUE"),
    ],
)
def test_wrong_design_file_is_rejected(tmp_path, text, wanted):
    path = tmp_path / "d.yaml"
    path.write_text(text)
    with pytest.raises(RobotTeamSimError) as refusal:
        read_design_file(path)
    assert str(refusal.value) == f"{path}: {wanted}"
