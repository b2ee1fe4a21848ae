"""Moves to and from the position of a test are left out, and a test begins where its command stands."""

import numpy as np
import pandas as pd
import pytest

import reliab
from reliab.core.errors import InputError
from reliab.recordings.behaviour import extent_of_test, zero_of
from reliab.recordings.followed_rows import rows_about_zero
from reliab.recordings.following import Rows
from reliab.recordings.reading import read_recording

RATE = 256.0
TIME = np.arange(int(20 * RATE)) / RATE
_SHAKEN = np.random.default_rng(4).normal(size=TIME.size)
COMMAND = 0.02 * np.sin(6.0 * TIME) * np.clip(TIME, 0.0, 1.0) * np.exp(-TIME / 5.0)
MEASURED = np.interp(TIME - 0.003, TIME, COMMAND)
AWAY = 0.05


def linear(samples):
    return np.linspace(0.0, 1.0, samples)


def smooth(samples):
    return 0.5 - 0.5 * np.cos(np.pi * linear(samples))


def split_in_half(samples):
    half = samples // 2
    return np.concatenate([0.4 * linear(half), np.full(256, 0.4), 0.4 + 0.6 * linear(samples - half)])


def add_moves(history, shape=linear, remainder=512):
    """The history about a position that is reached by a move, and left by another one."""
    way = AWAY * shape(1024)
    stands = np.full(remainder, AWAY)
    return np.concatenate([way, stands, AWAY + history, AWAY + history[-1] + 0.0 * stands, way[::-1]])


def frame(command, reading):
    time = np.arange(command.size) / RATE
    return pd.DataFrame({"time_s": time, "command_m": command, "measured_m": reading})


@pytest.mark.parametrize("shape", [linear, smooth, split_in_half])
@pytest.mark.parametrize("noise", [0.0, 2e-5])
def test_moves_before_and_after_a_test_are_left_out_and_said(shape, noise):
    command = add_moves(COMMAND, shape)
    command = command + noise * np.random.default_rng(1).normal(size=command.size)
    test = read_recording(frame(command, add_moves(MEASURED, shape)))
    assert TIME.size + 400 < test.command.size < TIME.size + 1400
    assert np.ptp(test.command) == pytest.approx(np.ptp(COMMAND), rel=0.05)
    assert any("left out, in which the command only moved" in note for note in test.notes)
    assert "left out" in test.channels[0].corrections[-1]


@pytest.mark.slow
def test_moves_leave_the_error_unchanged():
    remainder = np.zeros(512)
    separate = frame(*(np.concatenate([remainder, history, remainder]) for history in (COMMAND, MEASURED)))
    plain, away = (
        reliab.assess(test, f=1.0, xi=0.05).to_dict()["error"]["rms"]["value"]
        for test in (separate, frame(add_moves(COMMAND), add_moves(MEASURED)))
    )
    assert away == pytest.approx(plain, rel=0.03)


@pytest.mark.parametrize(
    "command",
    [
        COMMAND,
        AWAY + COMMAND,
        np.sin(6.0 * TIME),
        np.sin(0.3 * TIME),
        np.cumsum(_SHAKEN),
        COMMAND + 0.02 * np.clip(TIME - 2.0, 0.0, 1.0),
        np.repeat(np.sin(np.arange(40)), 128),
    ],
    ids=["from rest", "about another zero", "harmonic", "slow", "random", "yielding", "steps"],
)
def test_a_test_without_moves_is_taken_whole(command):
    assert extent_of_test(command, 1.0 / RATE) == (0, command.size)


def test_several_actuators_are_cut_alike():
    columns = {"time_s": np.arange(add_moves(COMMAND).size) / RATE}
    still = np.concatenate([np.zeros(1536), COMMAND, np.zeros(1536)])
    for number, history in (("1", add_moves(COMMAND)), ("2", still)):
        columns |= {f"command_{number}_m": history, f"measured_{number}_m": history}
    test = read_recording(pd.DataFrame(columns), several=True)
    assert TIME.size < test.command.shape[1] < TIME.size + 1400
    assert zero_of(test.command[0]) == pytest.approx(AWAY, rel=0.02)


@pytest.mark.parametrize("pieces", [1, 7, 500])
def test_a_followed_test_with_a_move_is_refused_at_its_end(pieces):
    histories = add_moves(COMMAND), add_moves(MEASURED)
    parts = zip(*(np.array_split(history, pieces) for history in histories), strict=True)
    rows = (Rows(time=None, command=command, measured=reading, name="t.csv") for command, reading in parts)
    with pytest.raises(InputError, match=r"t\.csv: .*a command that also moves by 50(\.\d)? mm"):
        list(rows_about_zero(rows, 1.0 / RATE))
