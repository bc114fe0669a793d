from __future__ import annotations

import csv
import dataclasses
import io
import re

import pytest
from PIL import Image

from robotteamsim.analysis.report import make_report
from robotteamsim.campaign.factors import Factor

NOISES_DB = (10.0, 20.0, 30.0)


@pytest.fixture(scope="module")
def garage_report(garage):
    return make_report(garage(*NOISES_DB, trials=30), "here")


@pytest.fixture(scope="module")
def sweep_report(arena):
    """One of one mission a cell, of several keys and no reference."""
    factors = (
        Factor("control.alpha", (0.3, 0.5), "--sweep"),
        Factor("control.algorithm", ("rdpso", "random_walk"), "--sweep"),
    )
    return make_report(arena(*factors, trials=1), "here")


def text(report):
    return report.files["report.html"].decode()


def test_report_has_figures_16_to_22_and_the_others(garage_report):
    names = [name for name in garage_report.files if name.endswith(".png")]
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
    for name in names:
        image = Image.open(io.BytesIO(garage_report.files[name]))
        assert len(image.convert("RGB").getcolors(1_000_000)) > 10


def test_page_needs_no_other_file(garage_report):
    page = text(garage_report)
    assert page.count('src="data:image/png;base64,') == 10
    assert not re.search(r'(src|href)="(?!data:)', page)


def test_page_says_each_claim_with_its_verdict(garage_report):
    page = text(garage_report)
    assert len(garage_report.claims) == 12
    assert page.count('class="badge ') == 12
    assert "With 10\N{NO-BREAK SPACE}dB of noise all four victims are saved in each mission." in page


def test_same_store_gives_the_same_bytes(garage, garage_report):
    assert make_report(garage(*NOISES_DB, trials=30), "here").files == garage_report.files


def test_table_of_missions_has_the_figures_of_tables_8_and_9(garage_report):
    rows = list(csv.DictReader(io.StringIO(garage_report.files["tables/missions.csv"].decode())))
    theirs = {row[""]: row for row in rows if row[""].endswith("dissertation")}
    assert [row["time [s]"] for row in theirs.values()] == ["459.6", "382.0", "343.5"]
    assert all(float(row["time [s] low"]) < float(row["time [s]"]) < float(row["time [s] high"]) for row in rows)
    assert [row["median"] for row in theirs.values()] == ["445.5", "374.5", "339.5"]
    assert [row["mode"] for row in theirs.values()] == ["447", "348", "327"]
    assert [row["victims saved"] for row in theirs.values()] == ["4.00", "3.30", "2.10"]
    assert [row["areas"] for row in theirs.values()] == ["4.93", "5.00", "5.00"]


def test_latex_tables_escape_what_latex_reads(garage_report):
    tests = garage_report.files["tables/tests.tex"].decode()
    assert r"95 \%" in tests
    assert r"p $\ge$ 0.05" in tests
    assert tests.count(r"\begin{tabular}") == tests.count(r"\end{tabular}") == 1
    body = [line for line in tests.splitlines() if line.endswith(r" \\")]
    assert len({line.count("&") for line in body}) == 1


def test_latex_tables_fit_the_width_of_the_text_and_say_what_they_need(garage_report):
    missions, claims = (garage_report.files[f"tables/{name}.tex"].decode() for name in ("missions", "claims"))
    assert missions.startswith("% \\usepackage{adjustbox,booktabs}\n")
    assert r"\begin{adjustbox}{max width=\linewidth}" in missions
    assert claims.startswith("% \\usepackage{array,booktabs,longtable}\n")
    shares = [float(share) for share in re.findall(r"p\{([\d.]+)\\dimexpr\\linewidth-8\\tabcolsep\\relax\}", claims)]
    assert len(shares) == 4
    assert sum(shares) == pytest.approx(1.0, abs=0.002)
    assert shares[3] > shares[0] > max(shares[1:3])
    for table in (missions, claims):
        assert re.findall(r"\\begin\{(\w+)\}", table) == re.findall(r"\\end\{(\w+)\}", table)[::-1]


def test_page_breaks_no_line_within_an_interval_or_before_a_unit(garage_report):
    page = re.sub(r'src="[^"]*"', "", text(garage_report))
    for unbroken in ("100 % [88 %, 100 %]", "p = 0.006", "−80 dBm"):
        assert unbroken.replace(" ", "\N{NO-BREAK SPACE}") in page


def test_unfinished_campaign_is_reported_as_such(garage):
    stored = garage(10.0, trials=4)
    failed = dataclasses.replace(stored.outcomes[1], error="KeyError: 7", time_s=None)
    report = make_report(dataclasses.replace(stored, outcomes=(stored.outcomes[0], failed, stored.outcomes[2])), "here")
    assert report.notes[0].startswith("This campaign is unfinished: 3 of 4 trials are done.")
    assert report.notes[1].startswith("Omitted: 1 failed trial;")
    assert report.notes[0].partition(" The same")[0] in text(report)
    assert {claim.verdict for claim in report.claims} <= {"not shown", "not reproduced"}


def test_other_campaigns_get_all_but_the_comparison(sweep_report):
    assert sweep_report.claims == ()
    assert sweep_report.notes == (
        "The dissertation has no missions of these settings: it has garage_sar with 10, 20 and 30 dB of noise. "
        "Therefore nothing is compared with it, and none of its claims is judged.",
    )
    page = text(sweep_report)
    assert "dissertation’s claims" not in page
    assert "(Figure 19)" not in page
    assert "alpha = 0.3, algorithm = random_walk" in page
    assert "tables/tests.csv" not in sweep_report.files
    assert "tables/differences.csv" in sweep_report.files
    assert "figures/paths.png" in sweep_report.files


def test_names_of_settings_cannot_break_the_page(arena):
    stored = arena(trials=2)
    settings = {**stored.settings, "scenario": {**stored.settings["scenario"], "name": "<b>&_x"}}
    report = make_report(dataclasses.replace(stored, settings=settings), "here")
    assert "<b>&_x" not in text(report)
    assert "&lt;b&gt;&amp;_x" in text(report)
    assert r"$<$b$>$\&\_x" in report.files["tables/missions.tex"].decode()


def test_written_files_are_those_of_the_report(garage_report, tmp_path):
    assert garage_report.write(tmp_path / "a" / "b") == tmp_path / "a" / "b" / "report.html"
    written = {str(p.relative_to(tmp_path / "a" / "b")): p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    assert written == garage_report.files
