"""Fixtures shared by the tests of the command line."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.cli import main


@pytest.fixture
def refusal(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Run a command that must be rejected, and return the one line that it prints."""

    def run(*arguments: object) -> str:
        assert main([str(argument) for argument in arguments]) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.count("\n") == 1
        assert captured.err.startswith("robotteamsim: ")
        return captured.err.removeprefix("robotteamsim: ").rstrip("\n")

    return run
