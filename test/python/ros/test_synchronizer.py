from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.ros.transport.synchronizer import (
    REPORT_TIMEOUT_S,
    Channel,
    LatestSynchronizer,
    LockstepSynchronizer,
    Step,
)

STEP_NS = 100


@pytest.fixture
def lockstep() -> Callable[..., LockstepSynchronizer]:
    def make(*channels: Channel, silence_limit_s: float = 60.0) -> LockstepSynchronizer:
        return LockstepSynchronizer(channels, step_ns=STEP_NS, silence_limit_s=silence_limit_s)

    return make


def test_lockstep_step_waits_for_every_channel_at_its_stamp(lockstep):
    steps = lockstep(Channel("scan"), Channel("odom"))
    steps.add("scan", 100, "scan 1")
    steps.add("scan", 200, "scan 2")
    assert steps.take_step() is None
    steps.add("odom", 100, "odom 1")
    assert steps.take_step() == Step(100, False, {"scan": ("scan 1",), "odom": ("odom 1",)})
    steps.add("odom", 200, "odom 2")
    assert steps.take_step() == Step(200, False, {"scan": ("scan 2",), "odom": ("odom 2",)})


def test_lockstep_channel_of_the_last_step_gives_nothing_first_and_then_the_message_before(lockstep):
    steps = lockstep(Channel("scan"), Channel("status", of_last_step=True))
    steps.add("status", 0, "started")
    steps.add("scan", 100, "scan 1")
    assert steps.take_step().messages == {"scan": ("scan 1",), "status": ()}
    steps.add("scan", 200, "scan 2")
    steps.add("status", 100, "status 1")
    step = steps.take_step()
    assert (step.latest("scan"), step.latest("status")) == ("scan 2", "status 1")


def test_lockstep_ignores_the_second_copy_of_a_latched_message(lockstep):
    steps = lockstep(Channel("scan"))
    steps.add("scan", 100, "scan 1")
    steps.add("scan", 100, "scan 1")
    assert steps.take_step().stamp_ns == 100
    steps.add("scan", 200, "scan 2")
    assert steps.take_step().messages == {"scan": ("scan 2",)}


def test_lockstep_restarts_when_stamps_jump_back_and_drops_what_is_of_the_old_life(lockstep):
    steps = lockstep(Channel("scan"), Channel("voice"))
    for stamp_ns in (100, 200):
        steps.add("scan", stamp_ns, f"scan {stamp_ns}")
        steps.add("voice", stamp_ns, f"voice {stamp_ns}")
        assert not steps.take_step().restarted
    steps.add("scan", 100, "new scan 100")
    steps.add("voice", 300, "old voice 300")
    steps.add("voice", 100, "new voice 100")
    assert steps.take_step() == Step(100, True, {"scan": ("new scan 100",), "voice": ("new voice 100",)})
    steps.add("scan", 200, "new scan 200")
    steps.add("voice", 200, "new voice 200")
    assert steps.take_step() == Step(200, False, {"scan": ("new scan 200",), "voice": ("new voice 200",)})


def test_lockstep_restart_waits_for_answers_of_the_new_life(lockstep):
    steps = lockstep(Channel("answer"))
    for stamp_ns in (100, 200):
        steps.add("answer", stamp_ns, f"old {stamp_ns}")
        steps.take_step()
    steps.restart()
    steps.add("answer", 300, "old 300")
    assert steps.take_step() is None
    steps.add("answer", 100, "new 100")
    step = steps.take_step()
    assert (step.stamp_ns, step.latest("answer")) == (100, "new 100")


def test_lockstep_gives_a_silent_channel_up_and_waits_for_it_again_when_it_speaks(lockstep):
    steps = lockstep(Channel("answer 0"), Channel("answer 1", may_be_silent=True), silence_limit_s=5.0)
    steps.add("answer 0", 100, "a")
    steps.add("answer 1", 100, "b")
    steps.take_step()
    steps.add("answer 0", 200, "a")
    assert [steps.check_wait(waited_s) for waited_s in (1.0, 4.0)] == [[], []]
    assert steps.take_step() is None
    assert steps.check_wait(5.0) == ["answer 1 has been silent for 5 s; continuing without it"]
    assert steps.take_step().messages == {"answer 0": ("a",), "answer 1": ()}
    steps.add("answer 0", 300, "a")
    assert steps.take_step().messages == {"answer 0": ("a",), "answer 1": ()}
    steps.add("answer 1", 300, "late")
    steps.add("answer 0", 400, "a")
    assert steps.take_step() is None
    steps.add("answer 1", 400, "back")
    assert steps.take_step().latest("answer 1") == "back"


def test_lockstep_waits_without_limit_for_a_channel_that_never_spoke_and_reports_it_once(lockstep):
    steps = lockstep(Channel("scan"), Channel("answer", may_be_silent=True), silence_limit_s=5.0)
    steps.add("scan", 100, "scan 1")
    waits_s = (1.0, REPORT_TIMEOUT_S, REPORT_TIMEOUT_S + 1.0, 1000.0)
    assert [steps.check_wait(waited_s) for waited_s in waits_s] == [[], ["waiting for answer"], [], []]
    assert steps.take_step() is None
    steps.add("answer", 100, "first")
    assert steps.take_step().latest("answer") == "first"


def test_lockstep_does_not_give_up_a_channel_while_others_keep_it_waiting(lockstep):
    steps = lockstep(Channel("voice"), Channel("answer", may_be_silent=True), silence_limit_s=5.0)
    for channel in ("voice", "answer"):
        steps.add(channel, 100, channel)
    steps.take_step()
    assert [steps.check_wait(waited_s) for waited_s in (9.0, 10.0)] == [[], ["waiting for voice, answer"]]
    steps.add("voice", 200, "voice")
    # The controller may have waited for the voice, too: it gets another period to answer.
    assert steps.check_wait(11.0) == []
    steps.add("answer", 200, "answer")
    assert steps.take_step().latest("answer") == "answer"


def test_latest_step_needs_something_new_from_each_needed_channel_and_gets_all_that_came():
    steps = LatestSynchronizer((Channel("scan", needed=True), Channel("odom", needed=True), Channel("rx")))
    steps.add("scan", 100, "scan 1")
    steps.add("scan", 200, "scan 2")
    steps.add("rx", 0, "rx 1")
    steps.add("rx", 0, "rx 2")
    assert steps.take_step() is None
    steps.add("odom", 190, "odom 1")
    step = steps.take_step()
    assert step == Step(200, False, {"scan": ("scan 1", "scan 2"), "odom": ("odom 1",), "rx": ("rx 1", "rx 2")})
    assert step.latest("scan") == "scan 2"
    steps.add("scan", 300, "scan 3")
    steps.add("odom", 290, "odom 2")
    assert steps.take_step().messages == {"scan": ("scan 3",), "odom": ("odom 2",), "rx": ()}


@pytest.mark.parametrize(
    ("stamps", "taken"),
    [
        (range(20, 1020, 20), [20, *range(60, 1020, 100)]),
        ([95, 205, 299, 402, 500, 595], [95, 205, 299, 402, 500, 595]),
        ([100, 900, 920, 1000], [100, 900, 1000]),
    ],
    ids=["frequent", "jittering", "after a gap"],
)
def test_latest_steps_are_a_period_apart_on_average_and_lose_no_message(stamps, taken):
    steps = LatestSynchronizer((Channel("odom", needed=True), Channel("tx")), period_ns=STEP_NS)
    found, messages = [], []
    for stamp_ns in stamps:
        steps.add("tx", stamp_ns, stamp_ns)
        steps.add("odom", stamp_ns, stamp_ns)
        if (step := steps.take_step()) is not None:
            found.append(step.stamp_ns)
            messages += step.messages["tx"]
    assert found == taken
    assert messages == list(stamps)[: len(messages)]


def test_latest_step_with_a_period_comes_at_once_after_time_has_jumped_back():
    steps = LatestSynchronizer((Channel("odom", needed=True),), period_ns=STEP_NS)
    for stamp_ns in (900, 100):
        steps.add("odom", stamp_ns, "odom")
        step = steps.take_step()
    assert step == Step(100, True, {"odom": ("odom",)})
    steps.add("odom", 120, "odom")
    assert steps.take_step() is None


def test_latest_restarts_once_when_needed_stamps_jump_back():
    steps = LatestSynchronizer((Channel("scan", needed=True), Channel("odom", needed=True), Channel("rx")))
    steps.add("scan", 900, "old scan")
    steps.add("odom", 900, "old odom")
    steps.take_step()
    steps.add("rx", 900, "old rx")
    steps.add("odom", 1000, "old odom")
    steps.add("scan", 100, "new scan")
    steps.add("odom", 100, "new odom")
    steps.add("rx", 100, "new rx")
    assert steps.take_step() == Step(100, True, {"scan": ("new scan",), "odom": ("new odom",), "rx": ("new rx",)})
    steps.add("scan", 200, "scan")
    steps.add("odom", 200, "odom")
    assert not steps.take_step().restarted


def test_latest_goes_on_after_two_resets_of_which_a_slow_channel_saw_one():
    steps = LatestSynchronizer((Channel("scan", needed=True), Channel("voice", needed=True)))
    steps.add("scan", 900, "old scan")
    steps.add("voice", 900, "old voice")
    steps.take_step()
    for stamp_ns in (100, 200, 100, 200):
        steps.add("scan", stamp_ns, f"scan {stamp_ns}")
    steps.add("voice", 200, "voice 200")
    assert steps.take_step() == Step(200, True, {"scan": ("scan 100", "scan 200"), "voice": ("voice 200",)})
    steps.add("scan", 300, "scan 300")
    steps.add("voice", 300, "voice 300")
    assert steps.take_step() == Step(300, False, {"scan": ("scan 300",), "voice": ("voice 300",)})


def test_lockstep_channel_that_is_not_always_due_is_waited_for_only_when_it_is(lockstep):
    steps = lockstep(Channel("scan"), Channel("rear", due=lambda stamp_ns: stamp_ns % 200 == 0))
    steps.add("scan", 100, "scan 1")
    assert steps.take_step().messages == {"scan": ("scan 1",), "rear": ()}
    steps.add("scan", 200, "scan 2")
    assert steps.take_step() is None
    steps.add("rear", 200, "rear 2")
    assert steps.take_step().latest("rear") == "rear 2"


@pytest.mark.parametrize(("first_life", "every"), [(2, 2), (3, 2), (2, 3), (4, 3)])
def test_lockstep_channel_that_is_not_always_due_starts_again_with_the_others(lockstep, first_life, every):
    """Whether it was due before time jumped back or not."""
    steps = lockstep(Channel("scan"), Channel("rear", due=lambda stamp_ns: stamp_ns % (100 * every) == 0))
    for life, num_steps in enumerate((first_life, 4)):
        for number in range(1, num_steps + 1):
            steps.add("scan", 100 * number, f"scan {number} of {life}")
            is_due = number % every == 0
            if is_due:
                steps.add("rear", 100 * number, f"rear {number} of {life}")
            step = steps.take_step()
            assert (step.stamp_ns, step.restarted) == (100 * number, (life, number) == (1, 1))
            assert step.latest("rear") == (f"rear {number} of {life}" if is_due else None)


class Present:
    """A message that says which robots are present."""

    def __init__(self, *present: int) -> None:
        self.present = present


PRESENCE = Channel("robots", has_presence=True)


def test_lockstep_step_does_not_wait_for_a_robot_that_is_absent(lockstep):
    steps = lockstep(PRESENCE, Channel("odom 0", robot_id=0), Channel("odom 1", robot_id=1))
    message = Present(1, 0)
    steps.add("odom 0", 100, "here")
    steps.add("robots", 100, message)
    assert steps.take_step() == Step(100, False, {"robots": (message,), "odom 0": ("here",), "odom 1": ()})


def test_lockstep_channel_of_the_last_step_goes_by_who_was_present_then(lockstep):
    steps = lockstep(PRESENCE, Channel("sent", of_last_step=True, robot_id=0))
    steps.add("robots", 100, Present(1))
    assert steps.take_step().messages["sent"] == ()
    steps.add("robots", 200, Present(0))
    assert steps.take_step() is None
    steps.add("sent", 100, "last words")
    assert steps.take_step().messages["sent"] == ("last words",)
    steps.add("robots", 300, Present(1))
    assert steps.take_step().messages["sent"] == ()


def test_lockstep_robot_that_arrives_is_waited_for_and_its_first_message_is_no_restart(lockstep):
    steps = lockstep(PRESENCE, Channel("odom", robot_id=0))
    for stamp_ns in (100, 200):
        steps.add("robots", stamp_ns, Present(0))
        assert steps.take_step().messages["odom"] == ()
    steps.add("robots", 300, Present(1))
    assert steps.take_step() is None
    steps.add("odom", 300, "first")
    step = steps.take_step()
    assert (step.restarted, step.messages["odom"]) == (False, ("first",))


@pytest.mark.parametrize("spoke", [True, False])
def test_lockstep_robot_that_was_away_before_a_restart_is_heard_in_the_time_after(lockstep, spoke):
    steps = lockstep(PRESENCE, Channel("odom", robot_id=0))
    for stamp_ns in (100, 200, 300):
        present = spoke and stamp_ns < 300
        steps.add("robots", stamp_ns, Present(present))
        if present:
            steps.add("odom", stamp_ns, "before")
        steps.take_step()
    steps.add("robots", 100, Present(0))
    assert steps.take_step().restarted
    steps.add("robots", 200, Present(1))
    steps.add("odom", 200, "after")
    step = steps.take_step()
    assert (step.stamp_ns, step.restarted, step.messages["odom"]) == (200, False, ("after",))


def test_lockstep_node_that_begins_late_for_a_absent_robot_restarts_nothing(lockstep):
    steps = lockstep(Channel("answer", may_be_silent=True, robot_id=0))
    for stamp_ns in (100, 200):
        steps.note_presence(stamp_ns, (False,))
        assert steps.take_step().stamp_ns == stamp_ns
    steps.add("answer", 0, "greeting")
    steps.note_presence(300, (True,))
    steps.add("answer", 300, "answer")
    assert steps.take_step() == Step(300, False, {"answer": ("answer",)})


def test_latest_step_goes_on_without_a_robot_that_left():
    robots = [Channel(f"odom {robot_id}", needed=True, robot_id=robot_id) for robot_id in (0, 1)]
    steps = LatestSynchronizer((PRESENCE, *robots))
    steps.add("odom 0", 100, "here")
    assert steps.take_step() is None
    steps.add("robots", 100, Present(1, 0))
    assert steps.take_step().messages["odom 1"] == ()


def test_latest_step_with_no_robot_present_is_made_from_the_report_of_that():
    steps = LatestSynchronizer((PRESENCE, Channel("odom", needed=True, robot_id=0)))
    steps.add("robots", 100, Present(0))
    assert steps.take_step().stamp_ns == 100
    assert steps.take_step() is None
    steps.add("odom", 200, "here")
    steps.add("robots", 200, Present(1))
    assert steps.take_step().messages["odom"] == ("here",)


def test_latest_forgets_that_a_robot_had_left_when_time_jumps_back_before_that():
    steps = LatestSynchronizer((PRESENCE, Channel("odom 0", needed=True), Channel("odom 1", needed=True, robot_id=1)))
    steps.add("odom 0", 900, "here")
    steps.add("robots", 900, Present(1, 0))
    steps.add("odom 0", 100, "here")
    assert steps.take_step() is None
    steps.add("odom 1", 100, "here, too")
    assert steps.take_step() == Step(100, True, {"robots": (), "odom 0": ("here",), "odom 1": ("here, too",)})


def test_latest_keeps_a_thousand_messages_while_another_channel_is_silent():
    steps = LatestSynchronizer([Channel("odom", needed=True), Channel("voice", needed=True)])
    for number in range(1500):
        steps.add("odom", number, number)
    steps.add("voice", 1500, "heard")
    assert steps.take_step().messages["odom"] == tuple(range(500, 1500))


def test_latest_drops_a_single_late_message_and_restarts_when_time_goes_on_from_it():
    steps = LatestSynchronizer([Channel("odom", needed=True)], stale_ns=1000)
    steps.add("odom", 500, "a")
    assert steps.take_step().latest("odom") == "a"
    steps.add("odom", 400, "late")
    assert steps.take_step() is None
    steps.add("odom", 600, "b")
    step = steps.take_step()
    assert (step.stamp_ns, step.restarted, step.messages["odom"]) == (600, False, ("b",))
    for stamp_ns in (100, 200):
        steps.add("odom", stamp_ns, f"new {stamp_ns}")
    step = steps.take_step()
    assert (step.stamp_ns, step.restarted, step.messages["odom"]) == (200, True, ("new 200",))


def test_latest_restarts_at_once_when_time_jumps_back_far():
    steps = LatestSynchronizer([Channel("odom", needed=True)], stale_ns=1000)
    steps.add("odom", 5000, "old")
    steps.add("odom", 100, "new")
    step = steps.take_step()
    assert (step.stamp_ns, step.restarted, step.messages["odom"]) == (100, True, ("new",))


def test_lockstep_drops_a_single_late_message(lockstep):
    steps = lockstep(Channel("odom"))
    for stamp_ns in (100, 200, 300):
        steps.add("odom", stamp_ns, f"odom {stamp_ns}")
        assert steps.take_step() is not None
    steps.add("odom", 200, "late")
    steps.add("odom", 400, "odom 400")
    assert steps.take_step() == Step(400, False, {"odom": ("odom 400",)})


def test_step_after_one_that_was_skipped_has_the_messages_of_both():
    skipped = Step(100, True, {"scan": ("scan 1",), "rx": ("rx 1",)})
    step = Step(200, False, {"scan": ("scan 2",), "tx": ("tx 1",)})
    assert step.after(skipped) == Step(200, False, {"scan": ("scan 1", "scan 2"), "rx": ("rx 1",), "tx": ("tx 1",)})
    assert step.after(None) is step


def test_step_after_a_restart_has_no_messages_from_before():
    step = Step(100, True, {"scan": ("scan 1",)})
    assert step.after(Step(900, False, {"scan": ("old scan",)})) is step
