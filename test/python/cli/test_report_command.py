"""`robotteamsim report`."""

from __future__ import annotations

import json
import os

import pytest

from robotteamsim.campaign import make_design, open_store
from robotteamsim.campaign.factors import Factor
from robotteamsim.cli import main


@pytest.fixture
def campaign_folder(tmp_path, outcome_of):
    """The folder of a campaign of the garage, of which some trials are done."""

    def make(done: int, seed: int = 1):
        noise = Factor("voice.noise_db", (10.0, 20.0), "--noise")
        design = make_design("garage_sar", trials=2, seed=seed, factors=[noise])
        folder = tmp_path / (f"campaign_{seed}" if seed > 1 else "campaign")
        with open_store(folder, design) as store:
            for trial in list(design.all_trials())[:done]:
                store.keep(outcome_of(trial, time_s=400.0, num_areas=5, areas_explored=5, num_victims=4))
        return folder

    return make


@pytest.mark.slow
def test_report_is_written_next_to_the_store_or_to_the_given_folder(capsys, campaign_folder, tmp_path):
    folder = campaign_folder(4)
    assert main(["report", str(folder), "--no-players"]) == 0
    captured = capsys.readouterr()
    assert captured.out.endswith(f"written {folder}/report.html\n")
    assert main(["report", str(folder), "--no-players", "--each-pair", "--out", str(tmp_path / "docs"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["report"] == str(tmp_path / "docs" / "report.html")
    assert document["notes"] == []
    for name in ("report.html", "figures/times.png", "tables/missions.tex"):
        assert (tmp_path / "docs" / name).read_bytes() == (folder / name).read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "suffixes"),
    [("", {".png"}), ("--svg", {".png", ".svg"}), ("--pdf --svg", {".pdf", ".png", ".svg"})],
)
def test_figures_are_pdf_and_svg_when_asked_for(campaign_folder, tmp_path, options, suffixes):
    assert (
        main(["report", str(campaign_folder(4)), "--no-players", *options.split(), "--out", str(tmp_path / "o")]) == 0
    )
    files = {path.suffix: path.read_bytes() for path in (tmp_path / "o" / "figures").iterdir()}
    assert set(files) == suffixes
    starts = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}
    assert all(data.startswith(starts[suffix]) for suffix, data in files.items())


@pytest.mark.slow
def test_report_for_a_paper_writes_narrow_figures_as_pdf_and_the_same_page(campaign_folder, tmp_path):
    folder = str(campaign_folder(4))
    for options in ((), ("--width", "column", "--svg")):
        assert main(["report", folder, "--no-players", *options, "--out", str(tmp_path / "".join(options))]) == 0
    narrow = tmp_path / "--widthcolumn--svg" / "figures"
    assert 'width="252pt"' in (narrow / "times.svg").read_text()
    assert (narrow / "times.pdf").is_file()
    pages = {path.read_bytes() for path in tmp_path.rglob("report.html")}
    assert len(pages) == 1


def test_unfinished_campaign_gets_a_report_that_says_so(capsys, campaign_folder):
    folder = campaign_folder(1)
    assert main(["report", str(folder)]) == 0
    out = capsys.readouterr().out
    assert "This campaign is unfinished: 1 of 4 trials are done." in out
    assert "\nOmitted, because no mission has ended: 20 dB.\n" in out


@pytest.mark.slow
def test_several_campaigns_get_one_report(refusal, campaign_folder, tmp_path):
    folders = [str(campaign_folder(4, seed)) for seed in (1, 2)]
    assert refusal("report", *folders) == "--out: missing; expected a folder for the report of several campaigns"
    assert main(["report", *folders, "--no-players", "--out", str(tmp_path / "docs")]) == 0
    assert "4 trials each in 2 campaigns, seeds 1, 2." in (tmp_path / "docs" / "report.html").read_text()


def test_campaign_without_missions_is_rejected_and_nothing_is_written(refusal, campaign_folder, tmp_path):
    folder = campaign_folder(0)
    before = sorted(os.listdir(folder))
    assert refusal("report", folder, "--out", tmp_path / "out") == (
        f"{folder}: no mission of this campaign has ended yet; nothing to report"
    )
    assert sorted(os.listdir(folder)) == before
    assert not (tmp_path / "out").exists()


def test_folders_without_a_campaign_are_rejected(refusal, tmp_path):
    wanted = "contains no campaign: there is no campaign.sqlite"
    assert refusal("report", tmp_path) == f"{tmp_path}: {wanted}"
    assert refusal("report", tmp_path / "nowhere") == f"{tmp_path / 'nowhere'}: {wanted}"
    (tmp_path / "campaign.sqlite").write_text("no database" * 100)
    assert refusal("report", tmp_path) == f"{tmp_path / 'campaign.sqlite'}: file is not a database"
    assert os.listdir(tmp_path) == ["campaign.sqlite"]


def test_unwritable_folder_is_rejected_before_the_report_is_made(refusal, campaign_folder, monkeypatch, tmp_path):
    monkeypatch.setattr("robotteamsim.analysis.report.make_report", None)
    folder = campaign_folder(1)
    (tmp_path / "file").touch()
    assert refusal("report", folder, "--out", tmp_path / "file" / "x").startswith(
        f"{tmp_path / 'file' / 'x'}: cannot be "
    )
