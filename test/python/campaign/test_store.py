from __future__ import annotations

import contextlib
import datetime
import json
import os
import sqlite3
from typing import get_args

import pytest

import robotteamsim
from robotteamsim.campaign import check_folder, open_store, read_store
from robotteamsim.errors import CampaignError
from robotteamsim.mission.status import MissionEnd

SWEEP = "voice.noise_db=10,20"


def refusal(folder, design):
    with pytest.raises(CampaignError) as raised, open_store(folder, design):
        pass
    assert "\n" not in str(raised.value)
    return str(raised.value)


def test_store_returns_the_kept_outcomes(short_design, outcome_of, failed_outcome_of, tmp_path):
    design = short_design(SWEEP)
    trials = list(design.all_trials())
    outcomes = [outcome_of(trials[3], time_s=0.1 + 0.2), failed_outcome_of(trials[0])]
    with open_store(tmp_path / "made" / "c", design) as store:
        for outcome in outcomes:
            store.keep(outcome)
        assert store.outcomes() == (outcomes[1], outcomes[0])
        assert store.missing() == trials[1:3]
    stored = read_store(tmp_path / "made" / "c")
    assert stored.outcomes == (outcomes[1], outcomes[0])
    assert stored.versions["robotteamsim"] == robotteamsim.__version__
    assert stored.settings["trials"] == 2


def test_store_knows_when_it_was_started_and_the_last_command_that_ran_it(short_design, tmp_path):
    for command in ("first", "second", ""):
        with open_store(tmp_path, short_design(SWEEP), command):
            pass
    stored = read_store(tmp_path)
    assert stored.started == datetime.date.today().isoformat()
    assert stored.command == "second"


def test_trial_is_kept_only_once(short_design, outcome_of, tmp_path):
    design = short_design(SWEEP)
    trial = next(design.all_trials())
    with open_store(tmp_path, design) as store:
        store.keep(outcome_of(trial))
        with pytest.raises(CampaignError, match=r"UNIQUE constraint failed: trial\.cell, trial\.number"):
            store.keep(outcome_of(trial))


def test_growing_store_can_be_read(short_design, outcome_of, tmp_path):
    design = short_design(SWEEP)
    with open_store(tmp_path, design) as store:
        store.keep(outcome_of(next(design.all_trials())))
        assert len(read_store(tmp_path).outcomes) == 1


def test_csv_has_a_line_per_trial_by_cell_then_number(short_design, outcome_of, failed_outcome_of, tmp_path):
    design = short_design("control.algorithm=rdpso,random_walk", "voice.noise_db=10")
    trials = list(design.all_trials())
    with open_store(tmp_path, design) as store:
        store.keep(failed_outcome_of(trials[3]))
        network = {"split_s": 1.5, "endangered_s": 2.5, "breaks": 3, "messages_lost": 4}
        store.keep(outcome_of(trials[0], details=json.dumps({"network": network})))
        lines = store.export().read_text().splitlines()
    assert lines == [
        "control.algorithm,voice.noise_db,trial,seed,end,time_s,areas_explored,num_areas,victims_saved,num_victims,"
        "endangered_links,discoveries_delivered,mean_delivery_delay_s,max_delivery_delay_s,distance_m,contact_s,steps,"
        "trajectory_hash,controller_failed,error,split_s,endangered_s,breaks,messages_lost,base_areas,base_victims",
        f"rdpso,10.0,1,{trials[0].seed},areas_explored,100.0,4,4,1,1,0,,,,20.0,0.0,1001,{0:032x}{trials[0].seed:032x},,,"
        "1.5,2.5,3,4,,",
        f"random_walk,10.0,2,{trials[3].seed},,,,,,,,,,,,,,,,KeyError: 7,,,,,,",
    ]


def test_csv_does_not_depend_on_the_order_or_the_time_of_computing(short_design, outcome_of, tmp_path):
    design = short_design(SWEEP)
    outcomes = [outcome_of(trial, wall_s=index) for index, trial in enumerate(design.all_trials())]
    texts = []
    for name, order in (("a", outcomes), ("b", [outcome_of(trial) for trial in reversed(list(design.all_trials()))])):
        with open_store(tmp_path / name, design) as store:
            for outcome in order:
                store.keep(outcome)
            texts.append(store.export().read_bytes())
    assert texts[0] == texts[1]


def test_store_of_other_settings_is_rejected(short_design, tmp_path):
    with open_store(tmp_path, short_design(SWEEP)):
        pass
    wanted = f"{tmp_path}: contains a campaign with seed = 1, not 2; choose another folder"
    assert refusal(tmp_path, short_design(SWEEP, seed=2)) == wanted
    assert refusal(tmp_path, short_design(SWEEP, seed=2, trials=3)) == wanted
    assert read_store(tmp_path).settings["trials"] == 2


def test_store_goes_on_with_more_trials_of_the_same_design(short_design, outcome_of, tmp_path):
    design, more = short_design(SWEEP), short_design(SWEEP, trials=3)
    outcomes = [outcome_of(trial) for trial in design.all_trials()]
    with open_store(tmp_path, design) as store:
        for outcome in outcomes:
            store.keep(outcome)
    with open_store(tmp_path, more) as store:
        assert store.missing() == list(more.all_trials())[4:]
        assert [trial.number for trial in store.missing()] == [3, 3]
        assert store.outcomes() == tuple(sorted(outcomes, key=lambda outcome: (outcome.cell, outcome.number)))
    assert read_store(tmp_path).settings["trials"] == 3


def test_store_of_more_trials_is_rejected(short_design, tmp_path):
    with open_store(tmp_path, short_design(SWEEP, trials=3)):
        pass
    wanted = f"{tmp_path}: contains a campaign with trials = 3, not 2; choose another folder"
    assert refusal(tmp_path, short_design(SWEEP, trials=2)) == wanted


def test_store_of_another_version_is_rejected(short_design, tmp_path, monkeypatch):
    with open_store(tmp_path, short_design(SWEEP)):
        pass
    monkeypatch.setattr(robotteamsim, "__version__", "9.9")
    wanted = f"{tmp_path}: contains a campaign of version 0.1.0, not 9.9; choose another folder"
    assert refusal(tmp_path, short_design(SWEEP)) == wanted


def test_folder_of_something_else_is_rejected_and_left_alone(short_design, tmp_path):
    (tmp_path / "thesis.tex").touch()
    wanted = f"{tmp_path}: contains 'thesis.tex' and no campaign; expected a new or an empty folder"
    assert refusal(tmp_path, short_design(SWEEP)) == wanted
    assert os.listdir(tmp_path) == ["thesis.tex"]


def test_other_databases_and_files_under_the_stores_name_are_rejected(short_design, tmp_path):
    path = tmp_path / "campaign.sqlite"
    path.write_text("no database" * 100)
    assert refusal(tmp_path, short_design(SWEEP)) == f"{path}: file is not a database"
    path.unlink()
    with contextlib.closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE other (x)")
    assert refusal(tmp_path, short_design(SWEEP)) == f"{path}: is not the store of a campaign"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("UPDATE trial SET seed = 'x'", "trial 1 of cell 0: Expected `int`, got `str` - at `$.seed`"),
        ("UPDATE trial SET time_s = 9e999", "trial 1 of cell 0: Expected `float` <= 1000000000000.0 - at `$.time_s`"),
        ("UPDATE trial SET time_s = NULL", "trial 1 of cell 0: time_s is missing"),
        ("UPDATE trial SET cell = 7", "trial: there is no cell 7"),
        ("UPDATE trial SET number = 70", "trial 70 of cell 0: expected 1 to 2"),
        (
            "UPDATE trial SET \"end\" = 'x'",
            f"trial 1 of cell 0: end: 'x' is not valid; expected one of {', '.join(get_args(MissionEnd))}",
        ),
        (
            "UPDATE trial SET areas_explored = 1 + num_areas",
            "trial 1 of cell 0: areas_explored: 5 is above num_areas, 4",
        ),
        (
            "UPDATE trial SET victims_saved = 1 + num_victims",
            "trial 1 of cell 0: victims_saved: 2 is above num_victims, 1",
        ),
        (
            'UPDATE trial SET details = \'{"egress": {"people": 7}}\'',
            "trial 1 of cell 0: Expected `array`, got `int` - at `$.egress.people`",
        ),
        ("UPDATE trial SET details = '[]'", "trial 1 of cell 0: Expected `object`, got `array`"),
        ("UPDATE campaign SET value = 'x' WHERE name = 'format'", "has format x; expected 4: choose another folder"),
        ("UPDATE campaign SET value = '{}' WHERE name = 'versions'", "versions: robotteamsim is missing"),
        ("UPDATE campaign SET value = '[3]' WHERE name = 'settings'", "settings: Expected `object`, got `array`"),
        (
            "UPDATE campaign SET value = replace(value, '[[10.0], [20.0]]', '[[10.0], [20.0, 3]]')",
            "settings: cell 1 has 2 values for 1 key",
        ),
        ("DELETE FROM campaign WHERE name = 'settings'", "campaign: Object missing required field `settings`"),
        ("DROP TABLE trial", "has no table trial"),
        ("ALTER TABLE trial ADD COLUMN more", "trial: 24 columns; expected 23"),
        (
            "DROP TABLE campaign; CREATE VIEW campaign AS WITH RECURSIVE r(name) AS (SELECT 1 UNION ALL "
            "SELECT name + 1 FROM r) SELECT name, name AS value FROM r",
            "has no table campaign",
        ),
    ],
)
def test_damaged_store_is_rejected_with_its_first_wrong_value(short_design, outcome_of, tmp_path, change, message):
    design = short_design(SWEEP)
    with open_store(tmp_path, design) as store:
        store.keep(outcome_of(next(design.all_trials())))
    with contextlib.closing(sqlite3.connect(tmp_path / "campaign.sqlite")) as database:
        database.executescript(change)
    wanted = f"{tmp_path / 'campaign.sqlite'}: {message}"
    with pytest.raises(CampaignError) as raised:
        read_store(tmp_path)
    assert str(raised.value) == wanted
    assert refusal(tmp_path, design) == wanted


def test_file_and_folders_below_a_file_are_rejected(short_design, tmp_path):
    file = tmp_path / "file"
    file.touch()
    assert refusal(file, short_design(SWEEP)) == f"{file}: is not a folder"
    assert refusal(file / "c", short_design(SWEEP)) == f"{file / 'c'}: cannot be created: {file} is not a folder"


def test_campaign_that_runs_is_rejected_to_others(short_design, tmp_path):
    design = short_design(SWEEP)
    with open_store(tmp_path, design):
        assert refusal(tmp_path, design) == f"{tmp_path}: another process is running this campaign"
    with open_store(tmp_path, design):
        pass


def test_checking_a_folder_leaves_nothing(short_design, tmp_path):
    check_folder(tmp_path / "c" / "d", short_design(SWEEP))
    assert os.listdir(tmp_path) == []


def test_store_of_another_format_is_rejected(short_design, tmp_path):
    path = tmp_path / "campaign.sqlite"
    with open_store(tmp_path, short_design(SWEEP)):
        pass
    with contextlib.closing(sqlite3.connect(path)) as database, database:
        database.execute("UPDATE campaign SET value = '5' WHERE name = 'format'")
    assert refusal(tmp_path, short_design(SWEEP)) == f"{path}: has format 5; expected 4: choose another folder"
    with pytest.raises(CampaignError, match="has format 5"):
        read_store(tmp_path)
