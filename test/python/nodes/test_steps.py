"""Messages of several topics, collected by their stamps."""

from __future__ import annotations

import threading

import pytest

from robotteamsim.nodes.steps import MAX_STEPS, Steps

PACE, OTHER = "pace", "other"


@pytest.fixture
def warned() -> list[str]:
    return []


@pytest.fixture
def steps(warned) -> Steps:
    """Steps that need two topics."""
    return Steps(PACE, lambda _, values: [name for name in (PACE, OTHER) if name not in values], warned.append)


def add(steps: Steps, stamp_ns: int, *topics: str) -> None:
    for topic in topics:
        steps.add(topic, stamp_ns, f"{topic} {stamp_ns}")


def test_step_is_complete_with_all_its_topics_in_any_order(steps):
    add(steps, 1, OTHER, PACE)
    step = steps.take()
    assert (step.stamp_ns, step.restarted, step.values) == (1, False, {PACE: "pace 1", OTHER: "other 1"})


def test_messages_of_different_stamps_are_not_mixed(steps):
    add(steps, 1, PACE)
    add(steps, 2, OTHER, PACE)
    step = steps.take()
    assert step.stamp_ns == 2
    assert step.values[PACE] == "pace 2"
    assert step.each[:-1] == ({PACE: "pace 1"},)


def test_newest_complete_step_is_taken_and_has_the_others_before_it(steps):
    for stamp_ns in (1, 2, 3):
        add(steps, stamp_ns, PACE, OTHER)
    step = steps.take()
    assert step.stamp_ns == 3
    assert [values[OTHER] for values in step.each[:-1]] == ["other 1", "other 2"]


def test_topic_without_a_message_keeps_that_of_a_step_left_out(steps):
    add(steps, 1, "rare")
    add(steps, 2, PACE, OTHER)
    assert steps.take().values["rare"] == "rare 1"


def test_stamp_0_belongs_to_no_step_and_restarts_time(steps):
    add(steps, 5, PACE, OTHER)
    assert not steps.take().restarted
    steps.add(PACE, 0, "start")
    add(steps, 1, PACE, OTHER)
    step = steps.take()
    assert (step.stamp_ns, step.restarted) == (1, True)


def test_messages_before_a_jump_back_in_time_are_not_used(steps):
    add(steps, 5, OTHER)
    add(steps, 6, PACE, OTHER)
    add(steps, 1, PACE, OTHER)
    step = steps.take()
    assert (step.stamp_ns, step.restarted, len(step.each)) == (1, True, 1)
    for stamp_ns in (5, 6):
        add(steps, stamp_ns, PACE)
    steps.close()
    assert steps.take() is None


def test_message_that_comes_twice_changes_nothing(steps):
    add(steps, 1, PACE, PACE, OTHER)
    assert not steps.take().restarted
    add(steps, 1, PACE)
    add(steps, 2, PACE, OTHER)
    assert (step := steps.take()).stamp_ns == 2
    assert not step.restarted


def test_steps_that_never_become_complete_are_dropped(steps):
    for stamp_ns in range(1, 2 * MAX_STEPS):
        add(steps, stamp_ns, OTHER)
    add(steps, 2 * MAX_STEPS, PACE, OTHER)
    assert len(steps.take().each) <= MAX_STEPS + 1


def steps_that_end_with_a_warning(warned: list[str]) -> Steps:
    def warn(line: str) -> None:
        warned.append(line)
        steps.close()

    steps = Steps(PACE, lambda *_: [OTHER], warn)
    return steps


def test_wait_is_reported_with_the_missing_topics(warned, monkeypatch):
    monkeypatch.setattr("robotteamsim.nodes.steps.REPORT_TIMEOUT_S", 0.0)
    monkeypatch.setattr("robotteamsim.nodes.steps.CHECK_PERIOD_S", 0.0)
    steps = steps_that_end_with_a_warning(warned)
    add(steps, 1, PACE)
    assert steps.take() is None
    assert warned == ["waiting for other"]


@pytest.mark.parametrize(
    "later", [[(5, OTHER)], [(ns, OTHER) for ns in range(7, 8 + MAX_STEPS)]], ids=["jump back", "too many steps"]
)
def test_complete_step_that_loses_a_value_before_it_is_taken_is_not_used(steps, later):
    add(steps, 6, PACE, OTHER)
    for stamp_ns, topic in later:
        add(steps, stamp_ns, topic)
    last_ns = later[-1][0] + 10
    add(steps, last_ns, OTHER)
    threading.Timer(0.1, steps.add, (PACE, last_ns, "late")).start()
    step = steps.take()
    assert (step.stamp_ns, step.values[PACE]) == (last_ns, "late")
