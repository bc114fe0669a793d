from __future__ import annotations

import json

import pytest

from robotteamsim import rng
from robotteamsim.campaign import make_design
from robotteamsim.campaign.design import cell_name, settings_difference
from robotteamsim.campaign.factors import Factor, parse_override, parse_sweep
from robotteamsim.errors import CampaignError, ScenarioError


def values(design):
    return [cell.values for cell in design.cells]


def test_cells_are_all_combinations_the_first_key_slowest(short_design):
    design = short_design("voice.noise_db=10,20", "control.alpha=0.3,0.5,0.7")
    assert design.keys == ("voice.noise_db", "control.alpha")
    assert values(design) == [(n, a) for n in (10.0, 20.0) for a in (0.3, 0.5, 0.7)]
    assert design.cells[4].scenario.voice.noise_db == 20.0
    assert design.cells[4].scenario.control.alpha == 0.5


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({}, "hall"),
        ({"voice.noise_db": 10.0, "control.algorithm": "pso"}, "10 dB, algorithm = pso"),
        ({"radio.exponent": 2.0, "voice.exponent": 3.0}, "radio.exponent = 2.0, voice.exponent = 3.0"),
        ({"plan": "a/folder/with/a/long/name/plan.yaml"}, "plan = a/folder/with/a/long/name/plan.yaml"),
        ({"control.algorithm": "my_controllers:PheromonePatient"}, "algorithm = my_controllers:PheromonePatient"),
        ({"robots.start": [11.25, 12.25, 13.25, 14.25]}, "start = [11.25, 12...25, 14.25]"),
        ({"run.realtime": True, "relays.count": 3}, "realtime = true, count = 3"),
    ],
)
def test_cell_is_named_by_the_last_parts_of_its_keys_if_they_differ(settings, name):
    assert cell_name(settings, "hall") == name


def test_groups_combine_with_every_sweep_and_show_the_default_where_they_are_silent():
    groups = [[], [Factor("control.c1", (0.5,), "d.yaml"), Factor("control.c2", (0.6,), "d.yaml")]]
    design = make_design("tutorial_arena", trials=1, factors=[parse_sweep("voice.noise_db=10,20")], groups=groups)
    assert design.keys == ("control.c1", "control.c2", "voice.noise_db")
    assert values(design) == [(0.08, 0.11, 10.0), (0.08, 0.11, 20.0), (0.5, 0.6, 10.0), (0.5, 0.6, 20.0)]


def test_commas_within_brackets_part_no_values(short_design):
    design = short_design("mission.victims.0.position=[7, 7],[6.5, 7]")
    assert values(design) == [([7.0, 7.0],), ([6.5, 7.0],)]


def test_schedules_are_swept_as_whole_lists(short_design):
    design = short_design("schedule=[],[{at_s: 1, remove: 0}],[{at_s: 1, remove: 0}, {at_s: 2, spawn: 0}]")
    assert [len(cell.scenario.schedule) for cell in design.cells] == [0, 1, 2]
    assert design.cells[1].values == ([{"at_s": 1.0, "remove": 0}],)


def test_later_overrides_win_and_hold_in_all_cells(short_design):
    design = short_design("voice.noise_db=10,20", overrides=(parse_override("mission.time_limit_s=3"),))
    assert {cell.scenario.mission.time_limit_s for cell in design.cells} == {3.0}


def test_trials_take_turns_between_cells(short_design):
    trials = list(short_design("voice.noise_db=10,20", trials=3).all_trials())
    assert [(trial.cell, trial.number) for trial in trials] == [(0, 1), (1, 1), (0, 2), (1, 2), (0, 3), (1, 3)]


def test_seeds_are_those_of_the_projects_streams(short_design):
    trial = list(short_design("voice.noise_db=10,20", seed=5).all_trials())[3]
    assert trial.seed == rng.stream(5, "campaign", "voice.noise_db=20.0", 2).integers(2**53)


def test_seeds_differ_between_trials_cells_and_campaigns(short_design):
    seeds = [trial.seed for s in (1, 2) for trial in short_design("voice.noise_db=10,20", seed=s).all_trials()]
    assert len(set(seeds)) == len(seeds) == 8


def test_a_cells_seeds_depend_neither_on_other_cells_nor_on_the_form_of_its_values(short_design):
    def of_20_db(*sweeps, trials=2):
        design = short_design(*sweeps, trials=trials)
        return [t.seed for t in design.all_trials() if design.cells[t.cell].scenario.voice.noise_db == 20.0]

    assert of_20_db("voice.noise_db=20") == of_20_db("voice.noise_db=10,2e1,30")
    assert of_20_db("voice.noise_db=20.0", trials=3)[:2] == of_20_db("voice.noise_db=20")


def test_paired_trials_of_equal_number_have_the_same_seed_in_all_cells(short_design):
    seeds = {}
    for trial in short_design("voice.noise_db=10,20", paired=True).all_trials():
        seeds.setdefault(trial.number, set()).add(trial.seed)
    assert [len(of_number) for of_number in seeds.values()] == [1, 1]
    assert seeds[1] != seeds[2]


@pytest.mark.parametrize(
    ("sweeps", "wanted"),
    [
        (["voice.noise=1,2"], "--sweep: voice.noise: unknown key; did you mean 'noise_db'?"),
        (["voice.noise_db=1,loud"], "--sweep: voice.noise_db: 'loud' is not a number"),
        (["voice.noise_db=1,1.0"], "--sweep: duplicate cell: voice.noise_db=1.0"),
        (["voice.noise_db=1", "voice.noise_db=2"], "--sweep: voice.noise_db: already varied by --sweep"),
        (["mission.time_limit_s=1,2"], "--set: mission.time_limit_s: already varied by --sweep"),
        (["schedule.0.at_s=5,8"], "--sweep: schedule.0: the file has no list schedule; set the whole list"),
        (["schedule=[{at_s: 1, remove: 7}]"], "--sweep: schedule.0.remove: there is no robot 7; expected 0 to 0"),
        (
            ["schedule=[],[{at_s: 1, remove: 0}, {at_s: 2, spawn: 0, pose: [-9, 0, 0]}]"],
            "--sweep: schedule.1.pose: [-9, 0]: robot 0 lies outside the plan, [-2, -2] .. [8, 8]",
        ),
        (
            ["control.localisation=odometry,tf"],
            "--sweep: control.localisation: 'tf' is available only in ROS; expected ground_truth, odometry or laser",
        ),
        (["run.seed=1,2"], "--sweep: run.seed: not allowed: the seed of each trial is derived from --seed"),
    ],
)
def test_wrong_sweeps_are_rejected(short_design, sweeps, wanted):
    with pytest.raises((CampaignError, ScenarioError)) as refusal:
        short_design(*sweeps)
    assert str(refusal.value) == wanted


@pytest.mark.parametrize("text", ["control.alpha", "control.alpha=", "=1,2"])
def test_sweeps_of_another_form_are_rejected(text):
    with pytest.raises(CampaignError, match="is not of the form KEY=A,B,C, such as control"):
        parse_sweep(text)


def test_wrong_numbers_are_rejected(short_design):
    with pytest.raises(CampaignError, match=r"^--trials: 0 is below 1$"):
        short_design(trials=0)
    with pytest.raises(CampaignError, match=r"^--seed: -1 is not between 0 and 2\^53$"):
        short_design(seed=-1)
    with pytest.raises(CampaignError, match=r"^2000000 trials in all; expected at most 1000000$"):
        short_design("voice.noise_db=1,2", trials=1_000_000)


def test_settings_are_plain_and_equal_for_equal_designs(short_design):
    first, second = (short_design("voice.noise_db=10,20").settings() for _ in range(2))
    assert settings_difference(json.loads(json.dumps(first)), second) is None


@pytest.mark.parametrize(
    ("changed", "wanted"),
    [
        ({"trials": 3}, "trials = 2, not 3"),
        ({"seed": 4}, "seed = 1, not 4"),
        ({"paired": True}, "paired = false, not true"),
        ({"overrides": (parse_override("control.alpha=0.5"),)}, "control.alpha = 0.38, not 0.5"),
        ({"overrides": (parse_override("plan.doors=[]"),)}, None),
        ({"overrides": (parse_override("mission.victims=[]"),)}, "mission.victims = nothing, not []"),
    ],
)
def test_difference_between_settings_is_named(short_design, changed, wanted):
    sweep = "voice.noise_db=10,20"
    assert settings_difference(short_design(sweep).settings(), short_design(sweep, **changed).settings()) == wanted


def test_difference_within_a_file_that_a_cell_names_is_found(short_design, tmp_path):
    plan = tmp_path / "plan.yaml"

    def settings(width_m):
        plan.write_text(f"name: hall\nbounds: {{max: [{width_m}, 9.0]}}\n")
        return short_design(f"plan={plan}").settings()

    assert settings_difference(settings(9.0), settings(9.0)) is None
    assert settings_difference(settings(9.0), settings(9.5)).startswith("fingerprint = ")
