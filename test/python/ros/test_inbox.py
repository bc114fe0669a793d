from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from robotteamsim.ros.transport.inbox import Channel, Inbox, LatestInbox, LockstepInbox, Step

STEP_NS = 100


class Taker:
    """Takes from an inbox in a thread of its own; joins with a time limit."""

    def __init__(self, inbox: Inbox) -> None:
        self.step: Step | None = None
        self._inbox = inbox
        self._thread = threading.Thread(target=self._take, daemon=True)
        self._thread.start()

    def _take(self) -> None:
        self.step = self._inbox.take()

    @property
    def is_waiting(self) -> bool:
        return self._thread.is_alive()

    def result(self) -> Step | None:
        self._thread.join(5.0)
        assert not self._thread.is_alive()
        return self.step


@pytest.fixture
def lines() -> list[str]:
    return []


@pytest.fixture
def lockstep(lines: list[str]) -> Callable[..., LockstepInbox]:
    def make(*channels: Channel, silence_limit_s: float = 60.0) -> LockstepInbox:
        return LockstepInbox(channels, lines.append, step_ns=STEP_NS, silence_limit_s=silence_limit_s)

    return make


def test_lockstep_step_waits_for_every_channel_at_its_stamp(lockstep):
    inbox = lockstep(Channel("scan"), Channel("odom"))
    taker = Taker(inbox)
    inbox.put("scan", 100, "scan 1")
    inbox.put("scan", 200, "scan 2")
    assert taker.is_waiting
    inbox.put("odom", 100, "odom 1")
    assert taker.result() == Step(100, False, {"scan": ("scan 1",), "odom": ("odom 1",)})
    inbox.put("odom", 200, "odom 2")
    assert inbox.take() == Step(200, False, {"scan": ("scan 2",), "odom": ("odom 2",)})


def test_lockstep_channel_of_the_last_step_gives_nothing_first_and_then_the_message_before(lockstep):
    inbox = lockstep(Channel("scan"), Channel("status", of_last_step=True))
    inbox.put("status", 0, "I am there")
    inbox.put("scan", 100, "scan 1")
    assert inbox.take().messages == {"scan": ("scan 1",), "status": ()}
    inbox.put("scan", 200, "scan 2")
    inbox.put("status", 100, "status 1")
    step = inbox.take()
    assert (step.latest("scan"), step.latest("status")) == ("scan 2", "status 1")


def test_lockstep_ignores_the_second_copy_of_a_latched_message(lockstep):
    inbox = lockstep(Channel("scan"))
    inbox.put("scan", 100, "scan 1")
    inbox.put("scan", 100, "scan 1")
    assert inbox.take().stamp_ns == 100
    inbox.put("scan", 200, "scan 2")
    assert inbox.take().messages == {"scan": ("scan 2",)}


def test_lockstep_restarts_when_stamps_jump_back_and_drops_what_is_of_the_old_life(lockstep):
    inbox = lockstep(Channel("scan"), Channel("voice"))
    for stamp_ns in (100, 200):
        inbox.put("scan", stamp_ns, f"scan {stamp_ns}")
        inbox.put("voice", stamp_ns, f"voice {stamp_ns}")
        assert not inbox.take().restarted
    inbox.put("scan", 100, "new scan 100")
    inbox.put("voice", 300, "old voice 300")
    inbox.put("voice", 100, "new voice 100")
    assert inbox.take() == Step(100, True, {"scan": ("new scan 100",), "voice": ("new voice 100",)})
    inbox.put("scan", 200, "new scan 200")
    inbox.put("voice", 200, "new voice 200")
    assert inbox.take() == Step(200, False, {"scan": ("new scan 200",), "voice": ("new voice 200",)})


def test_lockstep_restart_waits_for_answers_of_the_new_life(lockstep):
    inbox = lockstep(Channel("answer"))
    for stamp_ns in (100, 200):
        inbox.put("answer", stamp_ns, f"old {stamp_ns}")
        inbox.take()
    inbox.restart()
    taker = Taker(inbox)
    inbox.put("answer", 300, "old 300")
    assert taker.is_waiting
    inbox.put("answer", 100, "new 100")
    step = taker.result()
    assert (step.stamp_ns, step.latest("answer")) == (100, "new 100")


@pytest.fixture
def quick_rings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotteamsim.ros.transport.inbox.RING_S", 0.01)
    monkeypatch.setattr("robotteamsim.ros.transport.inbox.PATIENCE_S", 0.02)


@pytest.mark.usefixtures("quick_rings")
def test_lockstep_gives_a_silent_channel_up_and_waits_for_it_again_when_it_speaks(lockstep, lines):
    inbox = lockstep(Channel("answer 0"), Channel("answer 1", may_be_silent=True), silence_limit_s=0.05)
    inbox.put("answer 0", 100, "a")
    inbox.put("answer 1", 100, "b")
    inbox.take()
    inbox.put("answer 0", 200, "a")
    assert inbox.take().messages == {"answer 0": ("a",), "answer 1": ()}
    assert lines == ["waiting for answer 1", "answer 1 has been silent for 0 s; going on without it"]
    inbox.put("answer 0", 300, "a")
    assert inbox.take().messages == {"answer 0": ("a",), "answer 1": ()}
    assert len(lines) == 2
    inbox.put("answer 1", 300, "late")
    inbox.put("answer 0", 400, "a")
    inbox.put("answer 1", 400, "back")
    assert inbox.take().latest("answer 1") == "back"


@pytest.mark.usefixtures("quick_rings")
def test_lockstep_waits_without_limit_for_a_channel_that_never_spoke_and_says_so_once(lockstep, lines):
    told = threading.Event()
    inbox = LockstepInbox(
        (Channel("scan"), Channel("answer", may_be_silent=True)),
        lambda line: (lines.append(line), told.set()),
        step_ns=STEP_NS,
        silence_limit_s=0.01,
    )
    inbox.put("scan", 100, "scan 1")
    taker = Taker(inbox)
    assert told.wait(5.0)
    inbox.put("answer", 100, "first")
    assert taker.result().latest("answer") == "first"
    assert lines == ["waiting for answer"]


@pytest.mark.usefixtures("quick_rings")
def test_lockstep_does_not_give_up_a_channel_while_others_keep_it_waiting(lines):
    told = threading.Event()
    inbox = LockstepInbox(
        (Channel("voice"), Channel("answer", may_be_silent=True)),
        lambda line: (lines.append(line), told.set()),
        step_ns=STEP_NS,
        silence_limit_s=0.01,
    )
    for channel in ("voice", "answer"):
        inbox.put(channel, 100, channel)
    inbox.take()
    taker = Taker(inbox)
    assert told.wait(5.0)
    assert lines == ["waiting for voice, answer"]
    inbox.put("answer", 200, "answer")
    inbox.put("voice", 200, "voice")
    assert taker.result().latest("answer") == "answer"


def test_closed_inbox_gives_none_even_to_one_who_waits(lockstep):
    inbox = lockstep(Channel("scan"))
    taker = Taker(inbox)
    inbox.close()
    assert taker.result() is None
    assert inbox.take() is None


def test_latest_step_needs_something_new_from_each_needed_channel_and_gets_all_that_came():
    inbox = LatestInbox((Channel("scan", needed=True), Channel("odom", needed=True), Channel("rx")), print)
    taker = Taker(inbox)
    inbox.put("scan", 100, "scan 1")
    inbox.put("scan", 200, "scan 2")
    inbox.put("rx", 0, "rx 1")
    inbox.put("rx", 0, "rx 2")
    assert taker.is_waiting
    inbox.put("odom", 190, "odom 1")
    step = taker.result()
    assert step == Step(200, False, {"scan": ("scan 1", "scan 2"), "odom": ("odom 1",), "rx": ("rx 1", "rx 2")})
    assert step.latest("scan") == "scan 2"
    inbox.put("scan", 300, "scan 3")
    inbox.put("odom", 290, "odom 2")
    assert inbox.take().messages == {"scan": ("scan 3",), "odom": ("odom 2",), "rx": ()}


def test_latest_restarts_once_when_needed_stamps_jump_back():
    inbox = LatestInbox((Channel("scan", needed=True), Channel("odom", needed=True), Channel("rx")), print)
    inbox.put("scan", 900, "old scan")
    inbox.put("odom", 900, "old odom")
    inbox.take()
    inbox.put("rx", 900, "old rx")
    inbox.put("odom", 1000, "old odom")
    inbox.put("scan", 100, "new scan")
    inbox.put("odom", 100, "new odom")
    inbox.put("rx", 100, "new rx")
    assert inbox.take() == Step(100, True, {"scan": ("new scan",), "odom": ("new odom",), "rx": ("new rx",)})
    inbox.put("scan", 200, "scan")
    inbox.put("odom", 200, "odom")
    assert not inbox.take().restarted


def test_latest_goes_on_after_two_resets_of_which_a_slow_channel_saw_one():
    inbox = LatestInbox((Channel("scan", needed=True), Channel("voice", needed=True)), print)
    inbox.put("scan", 900, "old scan")
    inbox.put("voice", 900, "old voice")
    inbox.take()
    for stamp_ns in (100, 200, 100, 200):
        inbox.put("scan", stamp_ns, f"scan {stamp_ns}")
    inbox.put("voice", 200, "voice 200")
    assert inbox.take() == Step(200, True, {"scan": ("scan 100", "scan 200"), "voice": ("voice 200",)})
    inbox.put("scan", 300, "scan 300")
    inbox.put("voice", 300, "voice 300")
    assert inbox.take() == Step(300, False, {"scan": ("scan 300",), "voice": ("voice 300",)})


def test_lockstep_channel_with_turns_is_waited_for_in_these_alone(lockstep):
    inbox = lockstep(Channel("scan"), Channel("rear", due=lambda stamp_ns: stamp_ns % 200 == 0))
    inbox.put("scan", 100, "scan 1")
    assert inbox.take().messages == {"scan": ("scan 1",), "rear": ()}
    inbox.put("scan", 200, "scan 2")
    taker = Taker(inbox)
    assert taker.is_waiting
    inbox.put("rear", 200, "rear 2")
    assert taker.result().latest("rear") == "rear 2"


@pytest.mark.parametrize(("first_life", "every"), [(2, 2), (3, 2), (2, 3), (4, 3)])
def test_lockstep_channel_with_turns_begins_again_with_the_others(lockstep, first_life, every):
    """Whether it had a turn before time jumped back or not."""
    inbox = lockstep(Channel("scan"), Channel("rear", due=lambda stamp_ns: stamp_ns % (100 * every) == 0))
    for life, steps in enumerate((first_life, 4)):
        for number in range(1, steps + 1):
            inbox.put("scan", 100 * number, f"scan {number} of {life}")
            has_turn = number % every == 0
            if has_turn:
                inbox.put("rear", 100 * number, f"rear {number} of {life}")
            step = Taker(inbox).result()
            assert (step.stamp_ns, step.restarted) == (100 * number, (life, number) == (1, 1))
            assert step.latest("rear") == (f"rear {number} of {life}" if has_turn else None)


class Who:
    """A message that tells who is there."""

    def __init__(self, *present: int) -> None:
        self.present = present


WHO = Channel("who", tells_who=True)


def test_lockstep_step_does_not_wait_for_a_robot_that_is_not_there(lockstep):
    inbox = lockstep(WHO, Channel("odom 0", robot_id=0), Channel("odom 1", robot_id=1))
    told = Who(1, 0)
    inbox.put("odom 0", 100, "here")
    inbox.put("who", 100, told)
    assert inbox.take() == Step(100, False, {"who": (told,), "odom 0": ("here",), "odom 1": ()})


def test_lockstep_channel_of_the_last_step_goes_by_who_was_there_then(lockstep):
    inbox = lockstep(WHO, Channel("sent", of_last_step=True, robot_id=0))
    inbox.put("who", 100, Who(1))
    assert inbox.take().messages["sent"] == ()
    inbox.put("who", 200, Who(0))
    taker = Taker(inbox)
    assert taker.is_waiting
    inbox.put("sent", 100, "last words")
    assert taker.result().messages["sent"] == ("last words",)
    inbox.put("who", 300, Who(1))
    assert inbox.take().messages["sent"] == ()


def test_lockstep_robot_that_comes_is_waited_for_and_its_first_message_is_no_restart(lockstep):
    inbox = lockstep(WHO, Channel("odom", robot_id=0))
    for stamp_ns in (100, 200):
        inbox.put("who", stamp_ns, Who(0))
        assert inbox.take().messages["odom"] == ()
    inbox.put("who", 300, Who(1))
    taker = Taker(inbox)
    assert taker.is_waiting
    inbox.put("odom", 300, "first")
    step = taker.result()
    assert (step.restarted, step.messages["odom"]) == (False, ("first",))


@pytest.mark.parametrize("spoke", [True, False])
def test_lockstep_robot_that_was_away_before_a_restart_is_heard_in_the_time_after(lockstep, spoke):
    inbox = lockstep(WHO, Channel("odom", robot_id=0))
    for stamp_ns in (100, 200, 300):
        present = spoke and stamp_ns < 300
        inbox.put("who", stamp_ns, Who(present))
        if present:
            inbox.put("odom", stamp_ns, "before")
        inbox.take()
    inbox.put("who", 100, Who(0))
    assert inbox.take().restarted
    inbox.put("who", 200, Who(1))
    inbox.put("odom", 200, "after")
    step = inbox.take()
    assert (step.stamp_ns, step.restarted, step.messages["odom"]) == (200, False, ("after",))


def test_lockstep_node_that_begins_late_for_a_robot_that_is_not_there_restarts_nothing(lockstep):
    inbox = lockstep(Channel("answer", may_be_silent=True, robot_id=0))
    for stamp_ns in (100, 200):
        inbox.note_who(stamp_ns, (False,))
        assert inbox.take().stamp_ns == stamp_ns
    inbox.put("answer", 0, "greeting")
    inbox.note_who(300, (True,))
    inbox.put("answer", 300, "answer")
    assert inbox.take() == Step(300, False, {"answer": ("answer",)})


def test_latest_step_goes_on_without_a_robot_that_left():
    robots = [Channel(f"odom {robot_id}", needed=True, robot_id=robot_id) for robot_id in (0, 1)]
    inbox = LatestInbox((WHO, *robots), print)
    inbox.put("odom 0", 100, "here")
    taker = Taker(inbox)
    assert taker.is_waiting
    inbox.put("who", 100, Who(1, 0))
    assert taker.result().messages["odom 1"] == ()


def test_latest_step_with_nobody_there_is_made_from_what_tells_so():
    inbox = LatestInbox((WHO, Channel("odom", needed=True, robot_id=0)), print)
    inbox.put("who", 100, Who(0))
    assert inbox.take().stamp_ns == 100
    taker = Taker(inbox)
    assert taker.is_waiting
    inbox.put("odom", 200, "here")
    inbox.put("who", 200, Who(1))
    assert taker.result().messages["odom"] == ("here",)
