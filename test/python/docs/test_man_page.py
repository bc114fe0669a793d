"""The man page and the completion scripts know every command and option."""

from __future__ import annotations

import runpy
import subprocess
from pathlib import Path

import pytest

from robotteamsim.cli import main

DOCS = Path(__file__).parents[3] / "docs"


def test_man_page_has_the_commands_and_options_of_the_command_line(monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    page = runpy.run_path(str(DOCS / "make_man_page.py"))["man_page"]()
    for word in ("campaign", "export\\-stage", "\\-\\-scheduler", "\\-\\-debug"):
        assert word in page
    assert "\nrobotteamsim \\- simulate teams" in page
    assert "\n.nf\nrobotteamsim run [\\-h]" in page


def test_bash_completes_commands_options_and_scenarios(capsys):
    assert main(["completion", "bash"]) == 0
    script = capsys.readouterr().out

    def completed(*words: str) -> list[str]:
        line = " ".join(f"'{word}'" for word in words)
        ask = f"COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _shtab_robotteamsim"
        ask += "; printf '%s\\n' \"${COMPREPLY[@]}\""
        done = subprocess.run(["bash", "-c", f"{script}\n{ask}"], capture_output=True, text=True, check=True)
        return done.stdout.split()

    assert "campaign" in completed("robotteamsim", "ca")
    assert "--seed" in completed("robotteamsim", "run", "--se")
    assert "garage_sar" in completed("robotteamsim", "run", "gar")
    assert completed("robotteamsim", "run", "garage_sar", "--set", "voice.no") == ["voice.noise_db="]
    assert "control.network=" in completed("robotteamsim", "run", "--set", "control.n")


@pytest.mark.parametrize("shell", ["zsh", "fish", "tcsh"])
def test_other_shells_have_a_script(capsys, shell):
    assert main(["completion", shell]) == 0
    assert "robotteamsim" in capsys.readouterr().out
