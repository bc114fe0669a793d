from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest

from robotteamsim.nodes.gate import REANCHOR_S, FairLock, Gate, Pacer


class World:
    """A thread that passes a gate as the world does, and counts its steps."""

    def __init__(self, gate: Gate) -> None:
        self.steps = 0
        self.resets = 0
        self.while_resetting: Callable[[], object] = lambda: None
        self._gate = gate
        self._permits = threading.Semaphore(0)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while self._gate.wait():
            if self._gate.reset_wanted:
                self._gate.do_reset(self._reset)
                continue
            if not self._permits.acquire(timeout=5.0):
                return
            self.steps += 1
            self._gate.passed()

    def _reset(self) -> None:
        self.resets += 1
        self.while_resetting()

    def allow(self, steps: int) -> None:
        self._permits.release(steps)

    def join(self) -> None:
        self._thread.join(5.0)
        assert not self._thread.is_alive()


@pytest.fixture
def gate():
    gate = Gate()
    yield gate
    gate.close()


def test_pause_returns_after_the_current_step_and_no_other_follows(gate):
    world = World(gate)
    world.allow(1)
    threading.Timer(0.05, world.allow, [1]).start()
    assert gate.pause(5.0)
    steps = world.steps
    world.allow(5)
    assert gate.step(1)
    assert world.steps == steps + 1


def test_pause_reports_that_the_current_step_takes_longer(gate):
    World(gate)
    assert not gate.pause(0.01)


def test_step_service_takes_the_given_number_of_steps_while_paused(gate):
    world = World(gate)
    world.allow(100)
    gate.pause(5.0)
    before = world.steps
    assert gate.step(3)
    assert world.steps == before + 3


def test_step_is_rejected_unless_paused(gate):
    assert not gate.step(1)


def test_steps_that_a_pause_takes_away_are_not_done(gate):
    world = World(gate)
    world.allow(1)
    gate.pause(5.0)
    before = world.steps
    with ThreadPoolExecutor() as pool:
        stepping = pool.submit(gate.step, 3)
        world.allow(1)
        while world.steps == before:
            time.sleep(0.001)
        gate.pause(0.0)
        world.allow(5)
        assert not stepping.result(5.0)


def test_reset_passes_a_paused_gate(gate):
    world = World(gate)
    world.allow(1)
    gate.pause(5.0)
    assert gate.reset(5.0)
    assert world.resets == 1


def test_reset_that_is_requested_during_another_is_done_after_it(gate):
    world = World(gate)
    world.allow(1)
    gate.pause(5.0)
    world.while_resetting = lambda: gate.want_reset() if world.resets == 1 else None
    assert gate.reset(5.0)
    assert gate.reset(5.0)
    assert world.resets == 3


def test_lock_passes_over_a_thread_that_gave_up():
    lock, got = FairLock(), []

    def ask(name: str) -> None:
        with lock:
            got.append(name)

    with lock:
        first, second = (threading.Thread(target=ask, args=(name,)) for name in ("first", "second"))
        first.start()
        with pytest.raises(ValueError, match=r"^the current step has not ended within 0.01 s$"), lock.within(0.01):
            got.append("gave up")
        second.start()
    first.join(5.0)
    second.join(5.0)
    assert sorted(got) == ["first", "second"]
    with lock.within(0.01):
        got.append("free again")
    assert got[-1] == "free again"


def test_closed_gate_lets_nobody_wait():
    gate = Gate()
    world = World(gate)
    world.allow(1)
    gate.pause(5.0)
    gate.close()
    world.join()
    assert not gate.wait()


class Wall:
    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_pacer_at_speed_2_lets_one_second_last_half_a_second():
    wall = Wall()
    pacer = Pacer(2.0, wall)
    assert pacer.delay_s(5_000_000_000) == 0.0
    assert pacer.delay_s(6_000_000_000) == pytest.approx(0.5)
    wall.now_s += 0.4
    assert pacer.delay_s(6_000_000_000) == pytest.approx(0.1)


def test_pacer_flat_out_never_waits():
    pacer = Pacer(0.0, Wall())
    assert [pacer.delay_s(time_ns) for time_ns in (0, 10**9, 10**12)] == [0.0, 0.0, 0.0]


def test_pacer_does_not_hurry_after_a_pause():
    wall = Wall()
    pacer = Pacer(1.0, wall)
    pacer.delay_s(0)
    wall.now_s += 10.0 + REANCHOR_S
    assert pacer.delay_s(1_000_000_000) == 0.0
    assert pacer.delay_s(2_000_000_000) == pytest.approx(1.0)


def test_pacer_goes_on_when_time_jumps_back():
    pacer = Pacer(1.0, Wall())
    pacer.delay_s(50_000_000_000)
    assert pacer.delay_s(0) == 0.0
    assert pacer.delay_s(1_000_000_000) == pytest.approx(1.0)


def test_pacer_takes_another_speed_from_now_on():
    wall = Wall()
    pacer = Pacer(0.5, wall)
    pacer.delay_s(0)
    assert pacer.delay_s(1_000_000_000) == pytest.approx(2.0)
    pacer.set_speed(5.0)
    assert pacer.delay_s(1_000_000_000) == 0.0
    assert pacer.delay_s(2_000_000_000) == pytest.approx(0.2)
    pacer.set_speed(0.0)
    assert pacer.is_flat_out
    assert pacer.delay_s(9_000_000_000) == 0.0


@pytest.mark.parametrize("speed", [-1.0, math.nan, math.inf])
def test_pacer_rejects_a_speed_that_is_negative_or_not_finite_and_keeps_its_own(speed):
    pacer = Pacer(2.0, Wall())
    with pytest.raises(ValueError, match=rf"speed must be finite and >= 0, got {speed:g}"):
        pacer.set_speed(speed)
    pacer.delay_s(0)
    assert pacer.delay_s(1_000_000_000) == pytest.approx(0.5)
    with pytest.raises(ValueError, match="speed must be finite"):
        Pacer(speed)


def test_sleep_ends_at_once_when_closed():
    gate = Gate()
    assert gate.sleep(0.001)
    gate.close()
    assert not gate.sleep(3600.0)
