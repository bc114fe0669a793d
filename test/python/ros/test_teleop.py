from __future__ import annotations

import os
import pty
import termios

import pytest

from robotteamsim.nodes.teleop import FIRST_HOLD_S, REPEAT_HOLD_S, Keys, read_keys, unbuffered

STOP = (0.0, 0.0)


@pytest.fixture
def keys() -> Keys:
    return Keys(0.5, 1.0)


@pytest.fixture
def terminal():
    """Both ends of a terminal: the keyboard's and the program's."""
    keyboard, program = pty.openpty()
    yield keyboard, program
    os.close(keyboard)
    os.close(program)


@pytest.mark.parametrize(
    ("key", "forward", "left"),
    [
        ("u", 0.5, 1.0),
        ("i", 0.5, 0.0),
        ("o", 0.5, -1.0),
        ("j", 0.0, 1.0),
        ("k", 0.0, 0.0),
        ("l", 0.0, -1.0),
        ("m", -0.5, -1.0),
        (",", -0.5, 0.0),
        (".", -0.5, 1.0),
        ("#", 0.0, 0.0),
    ],
)
def test_keys_lie_around_k_as_the_robot_drives(keys, key, forward, left):
    keys.press(key, 10.0)
    assert keys.speeds(10.1) == (forward, left)


def test_nothing_pressed_means_stop(keys):
    assert keys.speeds(0.0) == STOP


def test_pressed_key_holds_until_a_keyboard_would_have_repeated_it(keys):
    keys.press("i", 10.0)
    assert keys.speeds(10.0 + FIRST_HOLD_S - 0.01)[0] == 0.5
    assert keys.speeds(10.0 + FIRST_HOLD_S + 0.01) == STOP


def test_key_let_go_after_repeating_stops_soon(keys):
    keys.press("i", 10.0)
    for step in range(20):
        keys.press("i", 10.5 + 0.03 * step)
    last_s = 10.5 + 0.03 * 19
    assert keys.speeds(last_s + REPEAT_HOLD_S - 0.01)[0] == 0.5
    assert keys.speeds(last_s + REPEAT_HOLD_S + 0.01) == STOP


def test_another_key_takes_over_at_once(keys):
    keys.press("i", 10.0)
    keys.press("j", 10.1)
    assert keys.speeds(10.2) == (0.0, 1.0)


def test_speed_keys_change_speeds_and_keep_the_direction(keys):
    keys.press("u", 10.0)
    for key in "qwe":
        keys.press(key, 10.1)
    assert keys.speed_mps == pytest.approx(0.5 * 1.1 * 1.1)
    assert keys.turn_radps == pytest.approx(1.0 * 1.1 * 1.1)
    for key in "zxc":
        keys.press(key, 10.2)
    assert keys.speed_mps == pytest.approx(0.5 * 1.1 * 1.1 * 0.9 * 0.9)
    assert keys.speeds(10.3)[0] == keys.speed_mps


def test_terminal_gives_keys_at_once_shows_none_and_is_afterwards_as_it_was(terminal):
    keyboard, program = terminal
    before = termios.tcgetattr(program)
    with unbuffered(program):
        os.write(keyboard, b"ik")
        assert list(read_keys(program, 0.05)) == ["i", "k"]
        assert not termios.tcgetattr(program)[3] & termios.ECHO
    assert termios.tcgetattr(program) == before


def test_terminal_is_as_it_was_even_after_an_error(terminal):
    _, program = terminal
    before = termios.tcgetattr(program)
    with pytest.raises(RuntimeError, match="broken"), unbuffered(program):
        raise RuntimeError("broken")
    assert termios.tcgetattr(program) == before


def test_no_key_gives_nothing_after_the_time(terminal):
    assert list(read_keys(terminal[1], 0.01)) == []
