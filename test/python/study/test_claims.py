from __future__ import annotations

import dataclasses

import pytest

from robotteamsim.analysis.report.samples import pooled, read_campaign
from robotteamsim.analysis.report.statistics import Interval
from robotteamsim.analysis.report.wording import share_text
from study.dissertation.claims import judge
from study.dissertation.criteria import over_campaigns

pytestmark = pytest.mark.slow

NOISES_DB = (10.0, 20.0, 30.0)


@pytest.fixture(scope="module")
def verdicts(garage):
    def judged(*noises_db, trials, **keywords):
        campaign = read_campaign(garage(*noises_db, trials=trials, **keywords), "here")
        return {claim.text: claim for claim in judge(campaign, [campaign])}

    return judged


def of(claims, start):
    (found,) = [claim for text, claim in claims.items() if text.startswith(start)]
    return found


@pytest.fixture(scope="module")
def its_own(verdicts):
    return verdicts(*NOISES_DB, trials=120)


def test_the_dissertations_own_missions_reproduce_the_claims_that_their_data_support(its_own):
    verdicts = {}
    for claim in its_own.values():
        verdicts.setdefault(claim.verdict, []).append(claim.text)
    assert len(verdicts["reproduced"]) == 19
    assert [text[:25] for text in verdicts["not reproduced"]] == [
        "Noise does not itself inf",
        "A robot reaches about 4.5",
    ]
    # Three of the 30 durations at 10 dB are near the limit of 600 s: their spread is too uncertain.
    assert verdicts["not shown"] == ["With 10 dB durations have a standard deviation of 55.4 s."]


def test_only_agreement_of_means_is_marked_as_fitted(its_own):
    fitted = [text for text, claim in its_own.items() if claim.fitted]
    assert [text[:26] for text in fitted] == [
        "With 10 dB of noise all fo",
        "With 20 dB the number of v",
        "With 30 dB only half of th",
        "With 10 dB a mission takes",
        "With 20 dB a mission takes",
        "With 30 dB a mission takes",
    ]


def test_team_that_does_better_fails_no_one_sided_claim(verdicts):
    def better(noise_db, values):
        return dataclasses.replace(
            values, time_s=min(values.time_s, 599.0), areas_explored=5, victims_saved=min(4, values.victims_saved + 1)
        )

    claims = verdicts(*NOISES_DB, trials=120, change=better)
    for start in ("All areas", "The limit of 600 s", "With 10 dB of noise", "With 30 dB, 2 of 30"):
        assert of(claims, start).verdict == "reproduced"
    assert of(claims, "With 30 dB only half").verdict == "not reproduced"


def test_rare_rescues_that_never_happen_are_not_reproduced(verdicts):
    def change(noise_db, values):
        return dataclasses.replace(values, victims_saved=min(values.victims_saved, 2) if noise_db == 30.0 else 4)

    assert of(verdicts(*NOISES_DB, trials=120, change=change), "With 30 dB, 2 of 30").verdict == "not shown"
    assert of(verdicts(*NOISES_DB, trials=270, change=change), "With 30 dB, 2 of 30").verdict == "not reproduced"


def test_same_mean_with_a_fifth_of_the_spread_reproduces_the_mean_and_not_the_spread(verdicts):
    means = {10.0: 459.6, 20.0: 382.0, 30.0: 343.5}

    def narrower(noise_db, values):
        return dataclasses.replace(values, time_s=means[noise_db] + (values.time_s - means[noise_db]) / 5.0)

    claims = verdicts(*NOISES_DB, trials=120, change=narrower)
    for noise_db in ("10", "20", "30"):
        assert of(claims, f"With {noise_db} dB a mission").verdict == "reproduced"
        assert of(claims, f"With {noise_db} dB durations").verdict == "not reproduced"
    assert of(claims, "At 20 dB, the fourth victim costs 67 s").verdict == "not reproduced"
    assert "In ours it costs 13 s. Difference: −53.8 [" in of(claims, "At 20 dB, the fourth").why


def test_each_campaign_is_judged_alone_and_all_together(garage):
    def slower(noise_db, values):
        return dataclasses.replace(values, time_s=1.25 * values.time_s)

    stored = [garage(*NOISES_DB, trials=120), garage(*NOISES_DB, trials=120, change=slower)]
    stored[1] = dataclasses.replace(stored[1], settings=stored[1].settings | {"seed": 2})
    parts = [read_campaign(one, "here") for one in stored]
    claims = {claim.text: claim for claim in judge(pooled(stored, ["first", "second"]), parts)}
    assert of(claims, "The more noise, the shorter").campaigns == ("reproduced", "reproduced")
    assert of(claims, "With 30 dB a mission").campaigns == ("reproduced", "not reproduced")
    assert of(claims, "With 30 dB a mission").verdict in ("depends on the seed", "not reproduced")
    assert of(claims, "With 30 dB a mission").passed == 1
    assert of(claims, "A robot reaches").campaigns == ()


def test_verdict_over_campaigns_needs_all_of_them():
    yes, no, open_ = "reproduced", "not reproduced", "not shown"
    assert over_campaigns(yes, (yes, yes, yes)) == yes
    assert over_campaigns(yes, (yes, open_, yes)) == "depends on the seed"
    assert over_campaigns(open_, (yes, no)) == "depends on the seed"
    assert over_campaigns(no, (yes, yes)) == no
    assert over_campaigns(yes, (open_, open_)) == open_


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
    assert of(claims, "The more noise, the shorter").verdict == "reproduced"


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
    assert of(claims, "The more noise, the shorter").verdict == "not reproduced"


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
        limited = figures.time_s == 600.0
        return dataclasses.replace(figures, time_s=595.0, victims_saved=3) if limited else figures

    stored = garage(*NOISES_DB, trials=120, change=excluded)
    outcomes = tuple(
        dataclasses.replace(outcome, end="all_excluded") if outcome.time_s == 595.0 else outcome
        for outcome in stored.outcomes
    )
    campaign = read_campaign(dataclasses.replace(stored, outcomes=outcomes), "here")
    claims = {claim.text: claim for claim in judge(campaign, [campaign])}
    claim = of(claims, "The limit of 600 s")
    assert claim.verdict == "not reproduced"
    assert "0 of our 360 missions reach the limit. All victims are saved in 0 of the 8 that are cut short." in claim.why


def test_shares_of_one_interval_have_one_precision():
    assert share_text(Interval(0.98, 0.93, 0.998)) == "98.0 % [93.0 %, 99.8 %]"
    assert share_text(Interval(0.43, 0.33, 0.53)) == "43 % [33 %, 53 %]"
