from __future__ import annotations

import dataclasses
import io
import re

import pytest
from PIL import Image

from robotteamsim.analysis.report import PAPERS, make_report
from robotteamsim.campaign.factors import Factor

pytestmark = pytest.mark.slow

NOISES_DB = (10.0, 20.0, 30.0)
PHONE_PX = 390


@pytest.fixture(scope="module")
def garage_report(garage):
    return make_report([garage(*NOISES_DB, trials=30)], ["here"])


@pytest.fixture(scope="module")
def sweep_report(arena):
    """One of one mission a cell, of several keys."""
    factors = (
        Factor("control.c1", (0.3, 0.5), "--sweep"),
        Factor("control.algorithm", ("rdpso", "pso"), "--sweep"),
    )
    return make_report([arena(*factors, trials=1)], ["here"])


def text(report):
    return report.page


def test_report_has_its_figures(garage_report):
    names = [name for name in garage_report.files if name.endswith(".png")]
    assert [re.sub(r"figures/|\.png", "", name) for name in names] == [
        "victims",
        "times",
        "survival",
        "saved",
        "areas",
        "endangered",
        "paths",
    ]
    for name in names:
        image = Image.open(io.BytesIO(garage_report.files[name]))
        assert len(image.convert("RGB").getcolors(1_000_000)) > 10


def test_page_needs_no_other_file(garage_report):
    page = text(garage_report)
    pictures = [name for name in garage_report.files if name.endswith(".png")]
    assert page.count('src="data:image/png;base64,') == len(pictures)
    assert not re.search(r'(src|href)="(?!data:|#)', page)


def test_page_has_contents_date_version_and_the_commands_that_repeat_it(garage):
    stored = dataclasses.replace(
        garage(10.0, 20.0, trials=3), started="2026-01-02", command="robotteamsim campaign garage_sar --out DIR"
    )
    other = dataclasses.replace(stored, settings=stored.settings | {"seed": 2}, command="the second <command>")
    page = text(make_report([stored, other], ["first", "second"]))
    links = re.findall(r'href="#([^"]*)"', page)
    assert {"comparison", "figures", "tables", "reading", "repeating", "times"} <= set(links)
    assert all(f'id="{link}"' in page for link in links)
    assert "6 trials each in 2 campaigns, seeds 1, 2. Run on 2026-01-02 by robotteamsim 0.1.0." in page
    assert "<code>robotteamsim campaign garage_sar --out DIR</code>" in page
    assert "<code>the second &lt;command&gt;</code>" in page


def test_comparison_of_two_algorithms_opens_the_report(arena):
    algorithms = Factor("control.algorithm", ("rdpso", "random_walk"), "--sweep")
    stored = arena(algorithms, trials=3)
    report = make_report([stored], ["here"])
    # Of 20 partitions of the durations 21, 22, 23 and 26, 27, 28 two are as extreme; all other quantities are equal.
    assert report.opening == (
        "random_walk compared with rdpso: victims saved 1.00 instead of 0.00 (difference 1.00, no interval, "
        "larger in 100 % of comparisons, p = 0.10); time [s] 27.0 instead of 22.0 (difference 5.0 "
        "[2.7, 7.3], larger in 100 % of comparisons, p = 0.10).",
    )
    page = text(report)
    assert page.index('id="table-differences"') < page.index('id="figures"')


def test_quantity_that_is_equal_in_all_missions_is_called_equal(arena):
    stored = arena(Factor("control.algorithm", ("rdpso", "random_walk"), "--sweep"), trials=3)
    times_s = [dataclasses.replace(o, time_s=20.0 + o.number, victims_saved=1) for o in stored.outcomes]
    pairs = dataclasses.replace(stored, settings=stored.settings | {"paired": True}, outcomes=times_s)
    opening = make_report([pairs], ["here"]).opening
    assert "time [s] equal (22.0)" in opening[0]


def test_paired_campaign_is_compared_in_pairs(arena):
    stored = arena(Factor("control.algorithm", ("rdpso", "random_walk"), "--sweep"), trials=4)
    paired = dataclasses.replace(stored, settings=stored.settings | {"paired": True})
    (opening,) = make_report([paired], ["here"]).opening
    assert opening.startswith("random_walk compared with rdpso, in 4 pairs of missions with the same seed: ")
    # All differences of pairs are 5 s: two of the 16 assignments of signs are as extreme.
    assert "time [s] 27.5 instead of 22.5 (difference 5.0, no interval, larger in 100 % of" in opening
    assert "p = 0.12" in opening


def test_each_pair_of_algorithms_is_compared_on_request(arena):
    stored = arena(Factor("control.algorithm", ("rdpso", "random_walk", "pso"), "--sweep"), trials=3)

    def compared(**options):
        table = make_report([stored], ["here"], **options).tables[0]
        return {row[:2] for row in table.texts if row[2] == "time [s]"}

    with_first = {("rdpso", "random_walk"), ("rdpso", "pso")}
    assert compared() == with_first
    assert compared(each_pair=True) == with_first | {("random_walk", "pso")}


def test_more_pairs_than_anybody_reads_are_compared_on_request(arena):
    stored = arena(Factor("control.alpha", tuple(0.1 + 0.05 * i for i in range(13)), "--sweep"), trials=1)
    report = make_report([stored], ["here"])
    assert report.notes == ("Settings are not compared: they are 78 pairs; `report --each-pair` compares them.",)
    assert "differences" not in [table.name for table in report.tables]
    assert make_report([stored], ["here"], each_pair=True).tables[0].name == "differences"


def test_report_of_a_campaign_does_not_mention_the_study(garage_report, sweep_report):
    for report in (garage_report, sweep_report):
        assert "dissertation" not in text(report).lower()


def test_same_store_gives_the_same_bytes(garage, garage_report):
    assert make_report([garage(*NOISES_DB, trials=30)], ["here"]).files == garage_report.files


def test_latex_tables_escape_special_characters(garage_report):
    differences = garage_report.files["tables/differences.tex"].decode()
    assert r"95 \%" in differences
    assert r"p $<$ 0.001" in differences
    assert differences.count(r"\begin{tabular}") == differences.count(r"\end{tabular}") == 1
    body = [line for line in differences.splitlines() if line.endswith(r" \\")]
    assert len({line.count("&") for line in body}) == 1


def test_unfinished_campaign_is_reported_as_such(garage):
    stored = garage(10.0, trials=4)
    failed = dataclasses.replace(stored.outcomes[1], error="KeyError: 7", time_s=None)
    some = dataclasses.replace(stored, outcomes=(stored.outcomes[0], failed, stored.outcomes[2]))
    report = make_report([some], ["here"])
    assert report.notes[0].startswith("This campaign is unfinished: 3 of 4 trials are done.")
    assert report.notes[1].startswith("Omitted: 1 failed trial;")
    assert report.notes[0].partition(" The same")[0] in text(report)


def test_campaign_of_several_keys_names_them(sweep_report):
    assert sweep_report.notes == ()
    page = text(sweep_report)
    assert "c1 = 0.3, algorithm = pso" in page
    assert "tables/differences.csv" in sweep_report.files
    assert "figures/paths.png" in sweep_report.files


def test_latex_tables_fit_the_text_width_and_name_their_packages(garage_report):
    missions = garage_report.files["tables/missions.tex"].decode()
    assert missions.startswith("% \\usepackage{adjustbox,booktabs}\n")
    assert r"\begin{adjustbox}{max width=\linewidth}" in missions
    assert re.findall(r"\\begin\{(\w+)\}", missions) == re.findall(r"\\end\{(\w+)\}", missions)[::-1]


def test_wide_latex_tables_of_a_paper_in_columns_span_both(garage):
    report = make_report([garage(10.0, 20.0, trials=4)], ["here"], paper=PAPERS["column"])
    kinds = {table.name: re.findall(r"begin\{(table\*?)\}", table.latex(in_columns=True)) for table in report.tables}
    assert (kinds["missions"], kinds["durations_by_victims"]) == (["table*"], ["table"])
    written = report.files["tables/missions.tex"].decode()
    assert re.findall(r"\\begin\{([\w*]+)\}", written) == re.findall(r"\\end\{([\w*]+)\}", written)[::-1]


def test_names_of_settings_cannot_break_the_page(arena):
    stored = arena(trials=2)
    settings = {**stored.settings, "scenario": {**stored.settings["scenario"], "name": "<b>&_x"}}
    report = make_report([dataclasses.replace(stored, settings=settings)], ["here"])
    assert "<b>&_x" not in text(report)
    assert "&lt;b&gt;&amp;_x" in text(report)
    assert r"$<$b$>$\&\_x" in report.files["tables/missions.tex"].decode()


def test_written_files_are_those_of_the_report(garage_report, tmp_path):
    assert garage_report.write(tmp_path / "a" / "b") == tmp_path / "a" / "b" / "report.html"
    written = {str(p.relative_to(tmp_path / "a" / "b")): p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    assert written == garage_report.files


def test_tables_with_long_names_fit_a_laptop(browser, arena, tmp_path):
    algorithms = Factor("control.algorithm", ("rdpso", "random_walk"), "--sweep")
    page_text = text(make_report([arena(algorithms, trials=3)], ["here"]))
    page_text = page_text.replace("random_walk", "my_controllers:PheromonePatient").replace(
        ">rdpso<", ">my_controllers:PheromoneGreedy<"
    )
    (tmp_path / "report.html").write_text(page_text)
    page = browser.new_page(viewport={"width": 1200, "height": 800})
    page.goto(f"file://{tmp_path}/report.html")
    widths = page.evaluate("[...document.querySelectorAll('.scroll')].map((e) => [e.scrollWidth, e.clientWidth])")
    page.close()
    assert all(needed_px <= there_px for needed_px, there_px in widths)


@pytest.fixture
def phone(browser, garage_report, tmp_path):
    """Open the report on a screen as wide as a phone's."""
    (tmp_path / "report.html").write_bytes(garage_report.files["report.html"])
    page = browser.new_page(viewport={"width": PHONE_PX, "height": 844})
    page.goto(f"file://{tmp_path}/report.html")
    yield page
    page.close()


def test_tables_fit_a_phone(phone):
    right_px = phone.evaluate("[...document.querySelectorAll('td')].map((cell) => cell.getBoundingClientRect().right)")
    assert len(right_px) > 100
    assert max(right_px) <= PHONE_PX
    assert phone.evaluate("document.documentElement.scrollWidth") <= PHONE_PX
