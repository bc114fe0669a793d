from __future__ import annotations

import contextlib
import json
import os
import shutil
import sys
from pathlib import Path

import cv2
import pytest
from PIL import Image, ImageSequence

from robotteamsim.cli import main

SHORT = ("--set", "mission.time_limit_s=2", "--quiet")


@pytest.fixture(scope="module")
def bags(tmp_path_factory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("bags")
    paths = folder / "one.bag", folder / "two.bag"
    for seed, path in enumerate(paths, 1):
        assert main(["run", "garage_sar", "--seed", str(seed), *SHORT, "--bag", str(path)]) == 0
    return paths


def test_one_bag_is_summarised_in_detail(capsys, bags):
    assert main(["analyse", str(bags[0])]) == 0
    out = capsys.readouterr().out
    assert "one: garage_sar, 3 robots, 10 dB noise" in out
    assert "0.0 s   mission starts: 5 areas, 4 victims, 10 dB noise" in out
    assert "time limit reached" in out
    assert "robot_2" in out
    assert "omitted" not in out


def test_several_bags_are_one_table_with_their_means(capsys, bags):
    assert main(["analyse", *map(str, bags)]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [words[:3] for words in lines if words[:1] in (["one"], ["two"])] == [
        ["one", "time", "limit"],
        ["two", "time", "limit"],
    ]
    assert ["mean", "0.00", "0.00", "2.0"] in [words[:4] for words in lines]


@pytest.mark.parametrize("width", [40, 60, 80])
def test_tables_fit_narrow_terminals_without_cutting_anything(capsys, monkeypatch, bags, width):
    def words(columns: int, *arguments: Path) -> tuple[set[str], int]:
        monkeypatch.setenv("COLUMNS", str(columns))
        assert main(["analyse", *map(str, arguments)]) == 0
        lines = capsys.readouterr().out.splitlines()
        table = [line for line in lines if not line.startswith("  ") or line.rstrip()[-1:].isdigit()]
        return set(" ".join(table).replace("─", "").split()), max(
            len(line) for line in lines if "trajectories" not in line
        )

    wide, _ = words(200, *bags)
    narrow, longest = words(width, *bags)
    assert longest <= width
    assert narrow == wide


def test_bags_of_one_name_are_distinguished_by_their_folders(capsys, bags, tmp_path):
    for folder in "ab":
        (tmp_path / folder).mkdir()
        shutil.copy(bags[0], tmp_path / folder / "mission.bag")
    with contextlib.chdir(tmp_path):
        assert main(["analyse", "a/mission.bag", "b/mission.bag", "--json", "-"]) == 0
    names = [bag["bag"] for bag in json.loads(capsys.readouterr().out)["bags"]]
    assert names == ["a/mission.bag", "b/mission.bag"]


def test_bags_that_differ_in_their_suffix_have_different_names(bags, tmp_path):
    other, tables = tmp_path / "two.bag", tmp_path / "tables"
    shutil.copy(bags[0], other)
    assert main(["run", "garage_sar", *SHORT, "--mcap", str(tmp_path / "two.mcap")]) == 0
    assert main(["analyse", str(other), str(tmp_path / "two.mcap"), "--csv", str(tables)]) == 0
    rows = (tables / "bags.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert [Path(row.split(",")[0]).name for row in rows] == ["two.bag", "two.mcap"]


def test_json_is_printed_alone_or_written(capsys, bags, tmp_path):
    assert main(["analyse", str(bags[0]), "--json", "-"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["bags"][0]["mission"]["time_s"] == 2.0
    assert main(["analyse", str(bags[0]), "--json", str(tmp_path / "a.json")]) == 0
    assert json.loads((tmp_path / "a.json").read_text()) == printed


def test_csv_goes_into_a_folder_that_is_made(capsys, bags, tmp_path):
    assert main(["analyse", *map(str, bags), "--csv", str(tmp_path / "new")]) == 0
    names = [
        "bags.csv",
        "contexts.csv",
        "events.csv",
        "exits.csv",
        "gaps.csv",
        "network.csv",
        "paths.csv",
        "people.csv",
        "progress.csv",
        "robots.csv",
        "victims.csv",
    ]
    assert sorted(os.listdir(tmp_path / "new")) == names
    assert len((tmp_path / "new" / "bags.csv").read_text().splitlines()) == 3


def test_name_of_a_bag_is_no_formula_in_any_table(bags, tmp_path):
    bag = tmp_path / "=1+1.bag"
    bag.write_bytes(bags[0].read_bytes())
    assert main(["analyse", str(bag), "--csv", str(tmp_path / "new")]) == 0
    lines = [line for path in (tmp_path / "new").iterdir() for line in path.read_text().splitlines()[1:]]
    assert {line.split(",")[0] for line in lines} == {"'=1+1"}


@pytest.mark.slow
def test_png_is_drawn_of_several_bags_too(capsys, bags, tmp_path):
    assert main(["analyse", *map(str, bags), "--png", str(tmp_path / "a.png"), "--scenario", "garage_sar"]) == 0
    assert cv2.imread(str(tmp_path / "a.png")).shape[0] > 800
    assert os.listdir(tmp_path) == ["a.png"]


@pytest.mark.slow
def test_gif_shows_the_mission(capsys, bags, tmp_path):
    path = tmp_path / "a.gif"
    assert main(["analyse", str(bags[0]), "--gif", str(path), "--seconds", "1"]) == 0
    with Image.open(path) as film:
        assert film.size == (960, 540)
        assert sum(frame.info["duration"] for frame in ImageSequence.Iterator(film)) == 1000


def test_mp4_without_ffmpeg_is_rejected_before_the_bag_is_read(refusal, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    assert refusal("analyse", "a.bag", "--mp4", tmp_path / "a.mp4").startswith(
        "an MP4 needs ffmpeg, which is not installed"
    )


def test_wrong_bag_leaves_nothing_behind(refusal, bags, tmp_path):
    broken = tmp_path / "broken.bag"
    broken.write_bytes(bags[0].read_bytes()[:100_000])
    outputs = ("--json", tmp_path / "a.json", "--csv", tmp_path / "tables", "--png", tmp_path / "a.png")
    assert refusal("analyse", bags[1], broken, *outputs).startswith(f"{broken}: is damaged: ")
    assert list(tmp_path.iterdir()) == [broken]


def test_two_runs_are_no_parts_of_a_recording(refusal, bags):
    assert refusal("analyse", "--join", *bags).endswith("overlap in time, so they are not parts of one recording")


@pytest.mark.slow
def test_mcap_file_gives_the_numbers_of_a_bag(capsys, tmp_path):
    bag, mcap = tmp_path / "one.bag", tmp_path / "one.mcap"
    assert main(["run", "garage_sar", *SHORT, "--bag", str(bag), "--mcap", str(mcap)]) == 0
    documents = []
    for path in (bag, mcap):
        assert main(["analyse", str(path), "--json", "-"]) == 0
        documents.append(json.loads(capsys.readouterr().out))
    assert documents[0] == documents[1]
