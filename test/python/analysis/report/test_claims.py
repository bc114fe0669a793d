from __future__ import annotations

import dataclasses

import pytest

from robotteamsim.analysis.report.claims import judge
from robotteamsim.analysis.report.comparison import compare
from robotteamsim.analysis.report.samples import read_campaign
from robotteamsim.analysis.report.statistics import Interval
from robotteamsim.analysis.report.wording import share_text

NOISES_DB = (10.0, 20.0, 30.0)


@pytest.fixture(scope="module")
def verdicts(garage):
    def judged(*noises_db, trials, **keywords):
        campaign = read_campaign(garage(*noises_db, trials=trials, **keywords), "here")
        return {claim.text: claim for claim in judge(campaign, compare(campaign))}

    return judged


def of(claims, start):
    (found,) = [claim for text, claim in claims.items() if text.startswith(start)]
    return found


@pytest.fixture(scope="module")
def its_own(verdicts):
    return verdicts(*NOISES_DB, trials=120)


def test_the_dissertations_own_missions_reproduce_the_claims_that_their_data_support(its_own):
    reproduced = [claim.text for claim in its_own.values() if claim.verdict == "reproduced"]
    contradicted = [claim.text for claim in its_own.values() if claim.verdict == "not reproduced"]
    assert len(reproduced) == 10
    assert [text[:25] for text in contradicted] == ["Noise does not itself inf", "A robot reaches about 4.5"]


def test_claim_that_its_own_data_contradict_is_marked(its_own):
    why = of(its_own, "Noise does not itself").why
    assert why.startswith("The dissertation's own data contradict this: with all four saved, ")
    assert "10 dB takes 459.6 s and 20 dB 418.2 s on average" in why
    assert "p = 0.006" in why


def test_radio_ranges_are_those_of_its_equations(its_own):
    why = of(its_own, "A robot reaches").why
    assert "3.5 m at −60 dBm, not 4.5 m; 9.4 m at −70 dBm; 25.4 m at −80 dBm" in why


def test_few_missions_show_nothing(verdicts):
    claims = verdicts(*NOISES_DB, trials=30)
    assert {claim.verdict for claim in claims.values()} == {"not shown", "not reproduced"}
    assert (
        "Our missions agree so far, but 30 per level are too few; 100 are needed."
        in of(claims, "With 10 dB of noise").why
    )


def test_shorter_missions_reproduce_no_duration(verdicts):
    claims = verdicts(*NOISES_DB, trials=120, change=lambda noise_db, f: dataclasses.replace(f, time_s=0.7 * f.time_s))
    for start in ("With 10 dB a mission", "With 20 dB a mission", "With 30 dB a mission"):
        assert of(claims, start).verdict == "not reproduced"
        assert "The whole interval is outside." in of(claims, start).why
    assert of(claims, "The more noise").verdict == "reproduced"


def test_durations_near_an_end_of_the_margin_are_not_shown(verdicts):
    claims = verdicts(*NOISES_DB, trials=120, change=lambda noise_db, f: dataclasses.replace(f, time_s=0.91 * f.time_s))
    assert of(claims, "With 10 dB a mission").verdict == "not shown"
    assert "The interval is too wide or too near a limit to decide" in of(claims, "With 10 dB a mission").why


def test_one_victim_fewer_reproduces_no_rescue_rate(verdicts):
    claims = verdicts(
        *NOISES_DB, trials=120, change=lambda noise_db, f: dataclasses.replace(f, victims_saved=f.victims_saved - 1)
    )
    for start in ("With 10 dB of noise", "With 20 dB the number", "With 30 dB only"):
        assert of(claims, start).verdict == "not reproduced"


def test_equal_durations_at_all_levels_are_no_trend(verdicts):
    claims = verdicts(*NOISES_DB, trials=120, change=lambda noise_db, f: dataclasses.replace(f, time_s=400.0))
    assert of(claims, "The more noise").verdict == "not reproduced"


def test_endangered_links_and_missed_areas_are_found(verdicts):
    claims = verdicts(
        10.0, trials=120, change=lambda noise_db, f: dataclasses.replace(f, endangered_links=1, areas_explored=3)
    )
    assert of(claims, "With a threshold").verdict == "not reproduced"
    assert of(claims, "All areas are explored").verdict == "not reproduced"
    assert "the median distance to the nearest robot is 2.0 m, the maximum 2.0 m." in of(claims, "With a threshold").why


def test_one_level_has_no_trend_and_no_claim_over_levels(verdicts):
    claims = verdicts(20.0, trials=120)
    assert [text for text in claims if text.startswith(("The more noise", "Noise does not", "The limit"))] == []
    assert of(claims, "With 20 dB the number").verdict == "reproduced"


def test_levels_that_the_dissertation_lacks_are_not_judged(verdicts):
    assert verdicts(15.0, 25.0, trials=3) == {}


def test_missions_that_end_by_exclusion_do_not_reach_the_limit(garage):
    def excluded(noise_db, figures):
        return dataclasses.replace(figures, time_s=min(figures.time_s, 595.0))

    stored = garage(*NOISES_DB, trials=120, change=excluded)
    outcomes = tuple(
        dataclasses.replace(outcome, end="all_excluded") if outcome.time_s == 595.0 else outcome
        for outcome in stored.outcomes
    )
    campaign = read_campaign(dataclasses.replace(stored, outcomes=outcomes), "here")
    claims = {claim.text: claim for claim in judge(campaign, compare(campaign))}
    claim = of(claims, "The limit of 600 s")
    assert claim.verdict == "not reproduced"
    assert claim.why == (
        "0 of our 360 missions reach it: 0.0 % [0.0 %, 1.0 %], dissertation 2.2 % [0.3 %, 7.8 %]. "
        "8 of ours ended earlier because all robots were excluded."
    )


def test_shares_of_one_interval_have_one_precision():
    assert share_text(Interval(0.98, 0.93, 0.998)) == "98.0 % [93.0 %, 99.8 %]"
    assert share_text(Interval(0.43, 0.33, 0.53)) == "43 % [33 %, 53 %]"
