"""The report of a campaign plays its best, median and worst mission."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

import robotteamsim
from robotteamsim.campaign import Outcome, make_design, open_store, run_trial
from robotteamsim.campaign.factors import parse_override, parse_sweep
from robotteamsim.cli import main

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def outcomes() -> list[Outcome]:
    """Run five short missions."""
    design = _design()
    trials = list(design.all_trials())
    return [run_trial(design.cells[trial.cell].scenario, trial, robotteamsim.__version__) for trial in trials]


def _design():
    limit = parse_override("mission.time_limit_s=3")
    return make_design("garage_sar", trials=5, overrides=[limit], factors=[parse_sweep("voice.noise_db=20")])


@pytest.fixture
def campaign(tmp_path: Path, outcomes: list[Outcome]) -> Callable[..., Path]:
    """Store the missions with made-up numbers of victims saved; `hash_of` replaces the hash of each."""

    def make(victims_saved: tuple[int, ...], trajectory_hash: str = "") -> Path:
        with open_store(tmp_path / "campaign", _design()) as store:
            for outcome, count in zip(outcomes, victims_saved, strict=True):
                own = trajectory_hash or outcome.trajectory_hash
                store.keep(dataclasses.replace(outcome, victims_saved=count, trajectory_hash=own))
        return tmp_path / "campaign"

    return make


def test_report_plays_the_best_the_median_and_the_worst_mission(
    browser: Browser, campaign: Callable[..., Path], outcomes: list[Outcome]
) -> None:
    folder = campaign((1, 4, 0, 3, 2))
    assert main(["report", str(folder)]) == 0
    page, wrong = browser.new_page(), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda request: wrong.append(request.url) if request.url.startswith("http") else None)
    page.goto(f"file://{folder / 'report.html'}")
    page.locator("figure iframe").scroll_into_view_if_needed()
    player = page.frame_locator("figure iframe")
    player.locator("body[data-ready]").wait_for(state="attached", timeout=120_000)
    seeds = [outcome.seed for outcome in outcomes]
    titles = player.locator("#mission option").all_inner_texts()
    assert titles == [
        f"best: 20 dB, seed {seeds[1]}, 4/4 victims, 0/5 areas, 3.0 s",
        f"median: 20 dB, seed {seeds[4]}, 2/4 victims, 0/5 areas, 3.0 s",
        f"worst: 20 dB, seed {seeds[2]}, 0/4 victims, 0/5 areas, 3.0 s",
    ]
    player.locator("#mission").select_option("2")
    expect(player.locator(".view")).to_have_attribute("data-robots", "3")
    assert wrong == []
    page.close()


def test_report_without_players_has_none(campaign: Callable[..., Path]) -> None:
    folder = campaign((1, 4, 0, 3, 2))
    assert main(["report", str(folder), "--no-players"]) == 0
    assert "<iframe" not in (folder / "report.html").read_text(encoding="utf-8")


def test_missions_that_this_version_computes_otherwise_are_not_played(
    campaign: Callable[..., Path], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = campaign((1, 4, 0, 3, 2), trajectory_hash="0" * 64)
    assert main(["report", str(folder)]) == 0
    # A line is broken within a path that is longer than the terminal is wide.
    printed, said = (
        capsys.readouterr().out,
        f"No mission can be played: {folder}: this version computes another mission",
    )
    assert "".join(said.split()) in "".join(printed.split())
    assert "<iframe" not in (folder / "report.html").read_text(encoding="utf-8")


def test_missions_of_the_last_report_are_not_simulated_again(
    campaign: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / "cache"))
    folder, pages = str(campaign((1, 4, 0, 3, 2))), []
    for out in ("first", "again"):
        assert main(["report", folder, "--out", str(tmp_path / out)]) == 0
        pages.append((tmp_path / out / "report.html").read_bytes())
        monkeypatch.setattr("robotteamsim.view.campaign_missions.repeat_mission", None)
    assert pages[0] == pages[1]
    assert b"<iframe" in pages[0]


def test_kept_missions_of_foreign_code_are_not_played_without_leave(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    own = "robotteamsim.control.baselines.random_walk:RandomWalkController"
    options = ["--set", f"control.algorithm={own}", "--set", "mission.time_limit_s=1", "--trials", "1", "--quiet"]
    assert main(["campaign", "garage_sar", *options, "--workers", "1", "--out", "c"]) == 0
    assert main(["report", "c", "--allow-code"]) == 0
    assert "<iframe" in Path("c/report.html").read_text(encoding="utf-8")
    assert main(["report", "c"]) == 0
    assert "--allow-code" in capsys.readouterr().out
    assert "<iframe" not in Path("c/report.html").read_text(encoding="utf-8")
