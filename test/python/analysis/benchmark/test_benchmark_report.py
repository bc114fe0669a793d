"""The report of a search benchmark from made-up missions."""

from __future__ import annotations

import dataclasses
import json
import math

import pytest

from robotteamsim.analysis.benchmark.measures import last_saved_s, lower_bounds, search_samples
from robotteamsim.analysis.benchmark.report import make_search_report
from robotteamsim.campaign.protocol import SearchProtocol, search_design
from robotteamsim.errors import CampaignError

pytestmark = pytest.mark.slow

DESIGN = search_design(SearchProtocol(("greedy", "random_walk"), ("warehouse",), (20.0,), (3,), trials=2, victims=2))


@pytest.fixture
def outcomes(outcome_of):
    """Missions of the design: greedy saves all after 100 and 150 s, the random walk one victim, then all in 240 s."""
    saved = {(0, 1): (50.0, 100.0), (0, 2): (150.0, 20.0), (1, 1): (None, 60.0), (1, 2): (240.0, 10.0)}
    made = []
    for trial in DESIGN.all_trials():
        times_s = saved[trial.cell, trial.number]
        victims = {f"random_{i}": {"heard_s": 1.0, "saved_s": time_s} for i, time_s in enumerate(times_s, 1)}
        count = sum(time_s is not None for time_s in times_s)
        network = {"split_s": 4.0 * trial.cell, "endangered_s": 9.0, "breaks": trial.number, "messages_lost": 2}
        details = json.dumps({"victims": victims, "network": network})
        made.append(outcome_of(trial, victims_saved=count, num_victims=2, details=details))
    return tuple(sorted(made, key=lambda outcome: (outcome.cell, outcome.number)))


def table(made, name: str) -> list[dict[str, str]]:
    (found,) = (each for each in made.tables if each.name == name)
    return [dict(zip(found.head, row, strict=True)) for row in found.texts]


def test_time_to_save_all_is_that_of_the_last_victim(outcomes):
    assert [last_saved_s(outcome) for outcome in outcomes] == [100.0, 150.0, math.inf, 240.0]
    greedy, walk = search_samples(DESIGN, outcomes, lower_bounds(DESIGN, outcomes))
    assert greedy.restricted_s.tolist() == [100.0, 150.0]
    assert walk.restricted_s.tolist() == [300.0, 240.0]  # The time limit of the warehouse.
    assert greedy.bound_s.tolist() == walk.bound_s.tolist()
    assert (greedy.num_victims, greedy.num_areas) == (2, 4)


def test_tables_contain_the_means_and_the_bound(outcomes):
    made = make_search_report(DESIGN, outcomes, "command", lower_bounds(DESIGN, outcomes))
    bound, greedy, walk = table(made, "search")
    assert bound["controller"] == "clairvoyant (lower bound)"
    assert (greedy["victims saved"][:4], walk["victims saved"][:4]) == ("2.00", "1.50")
    assert greedy["time to save all [s]"].startswith("125.0 [")
    (saved,) = (row for row in table(made, "differences") if row["quantity"] == "victims saved")
    assert saved["difference"].startswith("-0.50 [")
    profile = {row["controller"]: row for row in table(made, "profiles")}
    assert profile["clairvoyant"]["within 1.5"].startswith("100")
    greedy, walk = table(made, "networks")
    assert (greedy["never split"][:5], walk["never split"][:3]) == ("100 %", "0 %")
    assert [row["time split [s]"][:3] for row in (greedy, walk)] == ["0.0", "4.0"]
    assert greedy["links broken"].startswith("1.5 [")
    assert made.notes == ()


def test_missions_that_are_copies_of_each_other_are_reported(outcomes):
    copies = [dataclasses.replace(each, trajectory_hash="same") if each.cell == 1 else each for each in outcomes]
    (note,) = make_search_report(DESIGN, copies, "command", lower_bounds(DESIGN, outcomes)).notes
    assert note.endswith(
        "building = warehouse, noise_db = 20.0, robots = 3, controller = random_walk: 2 missions, 1 different."
    )


def test_benchmark_without_a_mission_that_every_controller_has_finished_has_no_profiles(outcomes):
    ended = (outcomes[0], outcomes[3])
    made = make_search_report(DESIGN, ended, "command", lower_bounds(DESIGN, ended))
    assert len(table(made, "search")) == 3
    assert not [name for name in made.files if "profiles" in name]


def test_unfinished_benchmark_says_so_and_an_empty_one_is_rejected(outcomes):
    made = make_search_report(DESIGN, outcomes[:3], "command", lower_bounds(DESIGN, outcomes[:3]))
    assert made.notes[0] == "This benchmark is unfinished: 3 of 4 missions are done."
    with pytest.raises(CampaignError, match="no mission of this benchmark has ended; nothing to report"):
        make_search_report(DESIGN, (), "command", {})
