"""Missions and campaigns in notebooks: tables with pictures, players, data frames."""

from __future__ import annotations

import html
import re
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

from robotteamsim.campaign import open_store, run_trial
from robotteamsim.campaign.design import make_design
from robotteamsim.campaign.factors import parse_override, parse_sweep
from robotteamsim.errors import CampaignError, ScenarioError
from robotteamsim.notebook import read_bag, read_campaign, simulate
from robotteamsim.recording import BagWriter
from robotteamsim.scenario import Scenario, load
from robotteamsim.simulation import Simulation


def test_a_simulated_mission_is_a_table_with_its_result_and_a_picture(hall_scenario: Callable[..., Scenario]) -> None:
    expected = Simulation(hall_scenario(seed=4)).run()
    mission = simulate(hall_scenario(), seed=4)
    assert mission.result is not None
    assert mission.result.trajectory_hash == expected.trajectory_hash
    page = mission._repr_html_()
    cells = dict(re.findall(r"<th [^>]*>([^<]*)</th><td>([^<]*)</td>", page))
    assert cells["seed"] == "4"
    assert cells["victims saved"] == f"{expected.victims_saved} of 2"
    assert page.count("<polyline") == 2
    assert page.count("<title>ann: ") == page.count("<title>bob: ") == 1


@pytest.mark.slow
def test_a_bag_is_the_mission_that_it_recorded(hall_scenario: Callable[..., Scenario], tmp_path: Path) -> None:
    simulation = Simulation(hall_scenario())
    result = simulation.run([BagWriter(tmp_path / "hall.bag")])
    mission = read_bag(tmp_path / "hall.bag")
    assert mission.values["areas explored"] == f"{result.areas_explored} of 2"
    assert mission.values["driven"] == f"{sum(robot.distance_m for robot in result.robots):.1f} m"
    assert mission.result is None


@pytest.mark.slow
def test_player_runs_within_the_page_of_a_notebook(
    browser: Browser, hall_scenario: Callable[..., Scenario], tmp_path: Path
) -> None:
    mission = simulate(hall_scenario())
    page, wrong = browser.new_page(), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html>{mission.show()._repr_html_()}", encoding="utf-8")
    page.goto(f"file://{path}")
    player = page.frame_locator("iframe")
    player.locator("body[data-ready]").wait_for(state="attached", timeout=120_000)
    assert player.locator(".view").get_attribute("data-robots", timeout=60_000) == "2"
    assert wrong == []
    page.close()


def test_names_with_markup_are_text(hall_scenario: Callable[..., Scenario]) -> None:
    name = "<script>alert(1)</script>"
    mission = simulate(hall_scenario(name=name), settings={"mission.time_limit_s": 2.0})
    shown = mission._repr_html_()
    assert "<script>" not in shown
    assert html.escape(name) in shown


@pytest.mark.parametrize("given", ["garage_sar", load("garage_sar")], ids=["name", "scenario"])
def test_another_algorithm_drops_keys_that_it_lacks(given: str | Scenario) -> None:
    mission = simulate(given, settings={"control.algorithm": "greedy", "mission.time_limit_s": 2.0})
    assert mission.values["end"].endswith("after 2.0 s")


def test_settings_are_checked() -> None:
    with pytest.raises(ScenarioError, match=r"control\.alpah: unknown key"):
        simulate("garage_sar", settings={"control.alpah": 0.5})


def test_code_that_a_file_names_runs_only_if_it_is_allowed(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(
        "name: mine\nplan: garage\nrobots: [{start_pose: [3, 4, 0]}]\ncontrol: {algorithm: 'some.module:Class'}\n",
        encoding="utf-8",
    )
    with pytest.raises(ScenarioError, match="if you trust the file, add allow_code=True"):
        simulate(path)


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """Store two trials each of two noises."""
    short = parse_override("mission.time_limit_s=1")
    design = make_design("garage_sar", trials=2, overrides=[short], factors=[parse_sweep("voice.noise_db=10,30")])
    with open_store(tmp_path / "campaign", design) as store:
        for trial in design.all_trials():
            store.keep(run_trial(design.cells[trial.cell].scenario, trial, "0.1.0"))
    return tmp_path / "campaign"


def test_a_campaign_is_a_data_frame_with_settings_and_results(campaign: Path) -> None:
    frame = read_campaign(campaign)
    assert frame[["voice.noise_db", "trial"]].to_numpy().tolist() == [[10, 1], [10, 2], [30, 1], [30, 2]]
    assert frame.groupby("voice.noise_db")["time_s"].mean().tolist() == pytest.approx([1.0, 1.0])
    assert set(frame["end"]) == {"time_limit"}


def test_without_pandas_one_line_says_how_to_install_it(campaign: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError) as missing:
        read_campaign(campaign)
    line = "this needs the Python package pandas, which is not installed: it comes with the extra 'notebook'"
    assert str(missing.value).startswith(line)


def test_folder_without_campaign_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(CampaignError, match="contains no campaign"):
        read_campaign(tmp_path)


def test_numbers_of_numpy_are_accepted_as_settings() -> None:
    mission = simulate("garage_sar", seed=np.int64(3), settings={"mission.time_limit_s": np.float64(2.0)})
    assert mission.result is not None
    assert mission.result.seed == 3
