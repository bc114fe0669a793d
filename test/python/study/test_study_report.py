from __future__ import annotations

import csv
import io
import re

import pytest

from robotteamsim.campaign import make_design, open_store
from robotteamsim.campaign.factors import Factor
from robotteamsim.errors import CampaignError
from study.dissertation.__main__ import main
from study.dissertation.report import make_study
from study.dissertation.wording import DISSERTATION

pytestmark = pytest.mark.slow

NOISES_DB = (10.0, 20.0, 30.0)


@pytest.fixture(scope="module")
def study(garage):
    return make_study([garage(*NOISES_DB, trials=30)], ["here"])


@pytest.fixture(scope="module")
def few(garage):
    """Four missions a level, of which the dissertation has one."""
    return make_study([garage(10.0, 15.0, trials=4)], ["here"])


def text(study):
    return study.report.page


def test_report_has_figures_16_to_22_and_the_others(study):
    names = [name for name in study.report.files if name.endswith(".png")]
    assert [re.sub(r"figures/|\.png", "", name) for name in names] == [
        "fig16_voice_lowest",
        "fig17_voice_highest",
        "fig18_network",
        "fig19_victims",
        "fig20_times",
        "equivalence",
        "survival",
        "fig21_areas",
        "fig22_endangered",
        "paths",
    ]
    page = text(study)
    assert "Victims saved (Figure 19)" in page
    assert DISSERTATION in page


def test_page_says_each_claim_with_its_verdict(study):
    page = text(study)
    assert len(study.claims) == 22
    assert page.count('class="badge ') == 22
    assert "With 10 dB of noise all four victims are saved in each mission." in page


def test_first_paragraph_says_that_agreement_of_means_is_calibration(study):
    page = text(study)
    first = re.sub("<[^>]*>", "", page[page.index("<p ") : page.index("</p>")])
    assert first.startswith("The floor plan is ours, because that of the dissertation is lost")
    assert "is therefore calibration and confirms nothing. The test is what was not fitted: trend, spread," in first
    assert "But 3 of them, trends and the median at 30 dB, follow from the fitted means." in first
    assert first.endswith("the published missions are the same, so they are not replications.")
    assert page.index("</p>") < page.index('class="badge ')
    assert page.index('id="not-fitted"') < page.index('id="fitted"')


def test_table_of_durations_by_victims_saved_has_those_of_table_6(study):
    rows = csv.DictReader(io.StringIO(study.report.files["tables/durations_by_victims.csv"].decode()))
    theirs = {(row[""], row["saved"]): row for row in rows}
    assert theirs["20 dB, dissertation", "3"]["missions"] == "9"
    assert [theirs["20 dB, dissertation", saved]["time [s]"] for saved in "34"] == ["351.0", "418.2"]
    assert [theirs["20 dB, dissertation", saved]["SD"] for saved in "34"] == ["13.1", "23.8"]
    single = theirs["30 dB, dissertation", "4"]
    assert (single["time [s]"], single["time [s] low"]) == ("390.0", "")


def test_table_of_missions_has_the_figures_of_tables_8_and_9(study):
    rows = list(csv.DictReader(io.StringIO(study.report.files["tables/missions.csv"].decode())))
    theirs = {row[""]: row for row in rows if row[""].endswith("dissertation")}
    assert [row["time [s]"] for row in theirs.values()] == ["459.6", "382.0", "343.5"]
    assert all(float(row["time [s] low"]) < float(row["time [s]"]) < float(row["time [s] high"]) for row in rows)
    assert [row["median"] for row in theirs.values()] == ["445.5", "374.5", "339.5"]
    assert [row["mode"] for row in theirs.values()] == ["447", "348", "327"]
    assert [row["victims saved"] for row in theirs.values()] == ["4.00", "3.30", "2.10"]
    assert [row["areas"] for row in theirs.values()] == ["4.93", "5.00", "5.00"]


def test_sections_of_claims_are_in_the_contents(study):
    links = re.findall(r'href="#([^"]*)"', text(study))
    assert {"not-fitted", "fitted"} <= set(links)
    assert all(f'id="{link}"' in text(study) for link in links)


def test_few_missions_show_no_claim(few):
    assert {claim.verdict for claim in few.claims} <= {"not shown", "not reproduced"}


def test_campaign_without_a_setting_of_the_dissertation_is_rejected(garage):
    with pytest.raises(CampaignError, match=r"^here: has no setting of the dissertation; expected garage_sar with 10,"):
        make_study([garage(15.0, trials=1)], ["here"])


def test_level_that_the_dissertation_lacks_is_noted(few):
    assert few.report.notes == ("The dissertation has no missions with 15 dB; these are not compared.",)


@pytest.fixture
def folder(tmp_path, outcome_of):
    """The folder of a campaign of the garage whose four missions save one victim each."""

    def make(seed):
        noise = Factor("voice.noise_db", (10.0, 20.0), "--noise")
        design = make_design("garage_sar", trials=2, seed=seed, factors=[noise])
        with open_store(tmp_path / f"campaign_{seed}", design) as store:
            for trial in design.all_trials():
                store.keep(outcome_of(trial, time_s=400.0, num_areas=5, areas_explored=5, num_victims=4))
        return str(tmp_path / f"campaign_{seed}")

    return make


def test_command_prints_each_claim_with_its_pass_rate(capsys, folder, tmp_path):
    assert main(["report", folder(1), folder(2), "--no-players", "--out", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    assert out.startswith("The floor plan is ours, because that of the dissertation is lost")
    lines = out.splitlines()
    tested, fitted = lines.index("Not fitted: the test"), lines.index("Fitted: calibration")
    assert tested < fitted
    assert lines[fitted + 1].startswith("not reproduced  0 of 2      With 10 dB of noise all four victims")
    assert "4 trials each in 2 campaigns, seeds 1, 2." in (tmp_path / "out" / "report.html").read_text()


def test_command_prints_tables_6_to_9(capsys, folder, tmp_path):
    assert main(["tables", folder(1)]) == 0
    assert capsys.readouterr().out.count("\nTable ") == 3
    assert main(["tables", str(tmp_path)]) == 1
    assert (
        capsys.readouterr().err
        == f"study.dissertation: {tmp_path}: contains no campaign: there is no campaign.sqlite\n"
    )
