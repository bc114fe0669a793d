"""Steps that a bag lacks are counted for each topic, and the totals computed without them are marked."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Reader, Writer

from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.cli import main
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.replay.gaps import Gap, missing_steps, usual_step_ns
from robotteamsim.recording.replay.reading import read_run

STEP_NS = 100_000_000
TRUTH = "/robot_1/base_pose_ground_truth"
PATH_TOTALS = ("distance_m", "mean_speed_mps", "max_speed_mps", "trajectory_hash")


@pytest.fixture
def thinned(tmp_path: Path) -> Callable[..., Path]:
    """Copy a bag without some messages of some topics: those whose number, from 0 on, fulfils a condition."""

    def copy(bag: Path, topics: tuple[str, ...], is_lost: Callable[[int], bool]) -> Path:
        path, numbers, typestore = tmp_path / "thinned.bag", Counter[str](), bag_typestore()
        with Reader(bag) as source, Writer(path) as target:
            copies = {
                each.id: target.add_connection(each.topic, each.msgtype, typestore=typestore)
                for each in source.connections
            }
            for connection, time_ns, data in source.messages():
                number = numbers[connection.topic]
                numbers[connection.topic] += 1
                if connection.topic not in topics or not is_lost(number):
                    target.write(copies[connection.id], time_ns, data)
        return path

    return copy


def test_every_fourth_message_that_a_topic_lacks_is_counted(busy, thinned):
    # 25 s of 10 steps and the first one are 251 messages, numbers 0 to 250; 3, 7, .., 247 are 62 of them.
    totals = run_totals(read_run([thinned(busy.bag, (TRUTH,), lambda number: number % 4 == 3)]))
    assert totals.gaps == (Gap(TRUTH, "robot_1", 62, 251, PATH_TOTALS),)
    assert totals.lacks_steps("distance_m", "robot_1")
    assert not totals.lacks_steps("distance_m", "robot_0")
    assert not totals.lacks_steps("collisions", "robot_1")


def test_complete_bags_have_no_gaps(busy, comes_again, adapted):
    assert [read_run([each.bag]).gaps for each in (busy, comes_again, adapted)] == [(), (), ()]


def test_steps_lost_at_the_end_are_counted_and_a_regularly_thinned_topic_looks_slower(busy, thinned):
    lost = thinned(busy.bag, ("/robot_0/contact", "/network/state"), lambda number: number % 3 > 0 or number > 240)
    gaps = {gap.topic: (gap.missing, gap.expected) for gap in read_run([lost]).gaps}
    # Of 0 to 250 remain 0, 3, .., 240: 81. No two neighbours remain, so the step looks three times as long.
    assert gaps == {"/robot_0/contact": (3, 84), "/network/state": (3, 84)}


def test_one_step_without_any_robot_has_no_hash(busy, thinned):
    truths = tuple(f"/robot_{robot_id}/base_pose_ground_truth" for robot_id in range(5))
    totals = run_totals(read_run([thinned(busy.bag, truths, lambda number: number == 100)]))
    assert [(gap.topic, gap.missing, gap.expected) for gap in totals.gaps] == [(topic, 1, 251) for topic in truths]
    assert totals.trajectory_hash is None


def test_absence_of_a_robot_is_not_a_gap_but_a_step_before_it_is(comes_again, thinned):
    # Robot 1 is absent from 5 to 8 s: message 20 is of the time before.
    lost = thinned(comes_again.bag, (TRUTH,), lambda number: number == 20)
    assert [(gap.topic, gap.missing) for gap in read_run([lost]).gaps] == [(TRUTH, 1)]


def test_intervals_of_real_clocks_lack_messages_only_above_one_and_a_half():
    generator = np.random.default_rng(5)
    stamps_ns = np.cumsum(generator.uniform(0.8, 1.2, 500) * STEP_NS).astype(np.int64)
    assert missing_by_own_step(stamps_ns) == 0
    assert missing_by_own_step(np.delete(stamps_ns, [50, 51, 200])) == 3


def missing_by_own_step(stamps_ns: np.ndarray) -> int:
    return missing_steps(stamps_ns, step_ns=usual_step_ns(stamps_ns))


@pytest.mark.parametrize("in_burst", [2, 3, 8])
def test_bursts_on_a_clock_of_milliseconds_are_complete_and_lack_whole_bursts(write_bag, odometry, tmp_path, in_burst):
    # Messages of one burst are 1 ms apart, bursts 200 ms: each interval is a multiple of the shortest one.
    stamps_ns = [(burst * 200 + number) * 10**6 for burst in range(1, 61) for number in range(in_burst)]

    def gaps(kept: list[int]) -> list[tuple[str, int]]:
        path = tmp_path / f"{len(kept)}.bag"
        samples = [("/robot_0/odom", "nav_msgs/Odometry", ns, odometry(ns, ns / 1e9, 0.0)) for ns in kept]
        return [(gap.topic, gap.missing) for gap in read_run([write_bag(path, samples)]).gaps]

    assert gaps(stamps_ns) == []
    assert gaps([ns for ns in stamps_ns if not 2000 <= ns // 10**6 < 2400]) == [("/robot_0/odom", 2)]


def test_topic_that_pauses_lacks_the_pause():
    stamps_ns = np.arange(250) * STEP_NS
    assert missing_by_own_step(np.append(stamps_ns[:100], stamps_ns[100:] + 36_000 * STEP_NS)) == 36_000


def test_random_losses_of_eight_in_ten_are_counted():
    kept = np.flatnonzero(np.random.default_rng(8).uniform(size=20_000) < 0.2)
    assert missing_by_own_step(kept * STEP_NS) == kept[-1] - kept[0] + 1 - len(kept)


@pytest.mark.parametrize("kept", [1, 2])
def test_topic_with_one_or_two_messages_has_the_step_of_the_others(busy, thinned, kept):
    lost = thinned(busy.bag, (TRUTH,), lambda number: number >= kept)
    assert [(gap.topic, gap.missing, gap.expected) for gap in read_run([lost]).gaps] == [(TRUTH, 251 - kept, 251)]


def test_table_of_bags_has_the_most_steps_that_a_topic_lacks(busy, thinned, tmp_path):
    lost = thinned(busy.bag, (TRUTH, "/network/state"), lambda number: number in (7, 9))
    assert main(["analyse", str(lost), "--csv", str(tmp_path / "tables")]) == 0
    of_topics, (of_bag,) = (rows(tmp_path / "tables" / f"{name}.csv") for name in ("gaps", "bags"))
    assert {row["topic"]: row["missing"] for row in of_topics} == {TRUTH: "2", "/network/state": "2"}
    assert of_bag["most_missing_steps"] == "2"


def test_analyse_names_topic_and_counts_and_marks_totals(busy, thinned, tmp_path, capsys):
    lost = thinned(busy.bag, (TRUTH,), lambda number: number % 4 == 3)
    assert main(["analyse", str(lost), "--csv", str(tmp_path / "tables"), "--json", str(tmp_path / "lost.json")]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert f"{TRUTH}: 62 of 251 steps missing" in lines
    (marked,) = [line.split() for line in lines if line.startswith("robot_1")]
    (other,) = [line.split() for line in lines if line.startswith("robot_0")]
    assert [cell.endswith("*") for cell in marked] == [False, True, True, True, False, False, False, False]
    assert not any("*" in cell for cell in other)
    (gap,) = json.loads((tmp_path / "lost.json").read_text())["bags"][0]["gaps"]
    assert (gap["topic"], gap["missing"], gap["expected"]) == (TRUTH, 62, 251)
    (row,), (of_bag,) = (rows(tmp_path / "tables" / f"{name}.csv") for name in ("gaps", "bags"))
    assert (row["bag"], row["topic"], row["missing"]) == ("thinned", TRUTH, "62")
    assert (of_bag["most_missing_steps"], of_bag["trajectory_hash"]) == ("62", "")


def rows(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


def test_table_of_several_bags_marks_only_totals_of_the_one_with_gaps_and_the_mean(busy, thinned, capsys):
    lost = thinned(busy.bag, (TRUTH,), lambda number: number % 4 == 3)
    assert main(["analyse", str(busy.bag), str(lost)]) == 0
    out = capsys.readouterr().out
    assert f"thinned: {TRUTH}: 62 of 251 steps missing" in out
    rows = {line.split()[0]: line for line in reversed(out.splitlines()) if line.split()[:1]}
    assert ["*" in rows[name] for name in ("busy", "mean")] == [False, True]


def test_complete_bag_has_no_line_about_steps_and_no_mark(busy, capsys):
    assert main(["analyse", str(busy.bag)]) == 0
    out = capsys.readouterr().out
    assert "missing" not in out
    assert "*" not in out


def test_topics_whose_step_nobody_knows_lack_nothing():
    assert usual_step_ns(np.array([0, 5 * STEP_NS])) is None
    assert missing_steps(np.array([0, 5 * STEP_NS])) == 0
    assert missing_steps(np.array([], dtype=np.int64), step_ns=STEP_NS) == 0


def test_steps_up_to_the_end_of_the_mission_count():
    assert missing_steps(np.arange(5) * STEP_NS, end_ns=6 * STEP_NS, step_ns=STEP_NS) == 2
    assert missing_steps(np.array([0]), end_ns=6 * STEP_NS, step_ns=STEP_NS) == 6
