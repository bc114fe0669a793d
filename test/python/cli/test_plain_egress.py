"""A study of how people leave, without robots, through all commands."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from robotteamsim.cli import main
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.view.from_bag import recording_of

PLAN = """
name: hall
bounds: {max: [20, 6]}
"""
STUDY = """
name: study
plan: hall.yaml
mission:
  time_limit_s: 60
  walk_update_s: 0.1
  exits: [{name: west, center: [2, 3]}]
  victims: [{name: ann, position: [12, 3], flees: true, speed_mps: 1.0}]
people:
  groups: [{name: guest, count: 3, region: {center: [8, 3], radius_m: 2}, flees_after_s: 1}]
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    (folder / "hall.yaml").write_text(PLAN, encoding="utf-8")
    (folder / "study.yaml").write_text(STUDY, encoding="utf-8")
    return folder / "study.yaml"


@pytest.fixture(scope="module")
def bag(study) -> Path:
    path = study.parent / "study.bag"
    assert main(["run", str(study), "--quiet", "--bag", str(path)]) == 0
    return path


def test_run_reports_the_required_time_and_no_robots(study, capsys):
    assert main(["run", str(study)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"people out +4 of 4: west 4", out)
    assert re.search(r"RSET +9\.\d s: 4 people who flee", out)
    assert "driven" not in out
    assert main(["run", str(study), "--json"]) == 0
    values = json.loads(capsys.readouterr().out)
    assert values["egress"]["rset_s"] == pytest.approx(9.0, abs=0.3)
    assert values["robots"] == []


@pytest.mark.parametrize("command", [["run"], ["view"]])
def test_mission_becomes_one_html_file(command, study, tmp_path):
    path = tmp_path / "study.html"
    assert main([*command, str(study), "--html", str(path)]) == 0
    assert "viewer/main" in path.read_text(encoding="utf-8")


def test_viewer_shows_everybody_of_the_bag_safe_and_no_robot(bag):
    last = recording_of(read_run([bag])).frames[-1]
    assert last.poses == ()
    assert [victim.state for victim in last.victims] == ["safe"] * 4


def test_analyse_reports_the_same_of_the_bag_and_draws_it(bag, capsys, tmp_path):
    assert main(["analyse", str(bag), "--png", str(tmp_path / "a.png"), "--csv", str(tmp_path / "csv")]) == 0
    out = capsys.readouterr().out
    assert re.search(r"RSET +9\.\d s: 4 people who flee", out)
    assert "omitted" not in out
    assert "Fiedler" not in out
    with (tmp_path / "csv" / "people.csv").open(newline="", encoding="utf-8") as file:
        assert [row["exit"] for row in csv.DictReader(file)] == ["west"] * 4
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_campaign_and_report_have_the_egress_of_all_trials(study, capsys, tmp_path):
    out = str(tmp_path / "c")
    assert main(["campaign", str(study), "--trials", "3", "--workers", "1", "--out", out]) == 0
    assert main(["report", out]) == 0
    page = (tmp_path / "c" / "report.html").read_text(encoding="utf-8")
    assert "RSET" in page
    assert "Paths of the robots" not in page


def test_map_of_radio_without_a_transmitter_is_refused_in_one_line(study, capsys, tmp_path):
    assert main(["field", "radio", str(study), "--png", str(tmp_path / "f.png")]) == 2
    assert (
        capsys.readouterr().err == "robotteamsim: study: has no robots; expected --at x,y, the place of a transmitter\n"
    )
