"""Held samples and spikes of a channel."""

import numpy as np
import pandas as pd
import pytest

import reliab
from reliab.core.errors import InputError
from reliab.recordings.behaviour import find_hold, remove_spikes, spikes
from reliab.recordings.followed_rows import rows_at_equal_steps
from reliab.recordings.following import Rows
from reliab.recordings.reading import read_recording
from reliab.recordings.recording import Recording

RATE, SIZE, DELAY = 1024.0, 12288, 2e-3
TIME = np.arange(SIZE) / RATE


def motion(time):
    start = np.clip(time, 0.0, 1.0)
    return 0.02 * np.sin(5.6 * time) * np.exp(-time / 9.0) * start**3 * (10.0 - 15.0 * start + 6.0 * start**2)


COMMAND, MEASURED = motion(TIME), motion(TIME - DELAY) + 1e-6 * np.random.default_rng(2).normal(size=SIZE)


def hold_values(values, rows):
    return np.repeat(values[::rows], rows)[: values.size]


def hold_at_rate(rate):
    """Values that a slower computer made at its own instants, as a faster logger sees them."""
    return motion(np.floor(TIME * rate + 1e-9) / rate)


def frame(command, reading):
    return pd.DataFrame({"time_s": TIME, "command_m": command, "measured_m": reading})


@pytest.mark.parametrize("rows", [2, 3, 8, 40])
def test_held_command_is_restored(rows):
    test = read_recording(frame(hold_values(COMMAND, rows), MEASURED))
    np.testing.assert_allclose(test.command, COMMAND, atol=2e-6)
    np.testing.assert_array_equal(test.measured, MEASURED)
    assert f"holds each value for {rows} samples" in test.channels[0].corrections[0]


def test_a_rest_between_motions_stays_one():
    command = np.concatenate([COMMAND[:4096], np.full(4096, COMMAND[4095]), COMMAND[4096:8192]])
    test = read_recording(frame(hold_values(command, 8), np.roll(command, 2)))
    np.testing.assert_allclose(test.command[4200:8100], command[4200:8100], atol=1e-7)


@pytest.mark.parametrize("rate", [150.0, 300.0])
def test_values_of_a_clock_without_a_whole_ratio_are_put_where_they_were_made(rate):
    test = read_recording(frame(hold_at_rate(rate), MEASURED))
    late = np.linalg.lstsq(np.gradient(COMMAND, TIME)[:, np.newaxis], COMMAND - test.command)[0][0]
    assert abs(late) < 0.1 / RATE


def test_hold_leaves_the_error_unchanged():
    plain, slow = (
        reliab.assess(frame(command, MEASURED), f=1.0, xi=0.05).to_dict()
        for command in (COMMAND, hold_values(COMMAND, 8))
    )
    assert slow["d_ms"] == pytest.approx(plain["d_ms"], abs=0.01)
    assert slow["error"]["rms"]["value"] == pytest.approx(plain["error"]["rms"]["value"], rel=0.01)


@pytest.mark.parametrize(
    "values",
    [
        COMMAND,
        COMMAND.round(4),
        (1e4 * MEASURED).round() / 1e4,
        hold_values(COMMAND, 500),
        np.where(np.arange(SIZE) % 50 == 0, np.roll(COMMAND, 1), COMMAND),
        0.0 * COMMAND,
    ],
    ids=["every row", "rounded", "rounded noise", "steps of a test", "few repeats", "at rest"],
)
def test_changing_rows_are_no_hold(values):
    assert find_hold(values, 1.0 / RATE) is None


@pytest.mark.parametrize(("channel", "rows"), [("command", 8), ("measured", 4)])
def test_a_followed_test_with_held_values_is_refused_with_its_line(channel, rows):
    histories = {"command": COMMAND, "measured": MEASURED}
    histories[channel] = hold_values(histories[channel], rows)
    part = Rows(time=TIME, **histories, lines=np.arange(SIZE) + 2, name="t.csv")
    with pytest.raises(
        InputError, match=rf"t\.csv, line 12289: The {channel} displacement holds each value for {rows} rows"
    ):
        list(rows_at_equal_steps(iter([part]), 1.0 / RATE))


HISTORY = np.sin(np.arange(0.0, 40.0, 0.05))
USUAL = float(np.quantile(np.abs(np.diff(HISTORY)), 0.995))


def insert_jump(size, begin=300, width=1):
    values = HISTORY.copy()
    values[begin : begin + width] += size
    return values


@pytest.mark.parametrize(
    ("values", "marks"),
    [
        (insert_jump(6.0 * USUAL), [300]),
        (insert_jump(-6.0 * USUAL), [300]),
        (insert_jump(2.0 * USUAL), []),  # no more than the history moves by itself
        (insert_jump(1.0, width=8), list(range(300, 308))),
        (insert_jump(1.0, width=9), []),  # a stretch that lasts is a motion
        (insert_jump(1.0, width=HISTORY.size), []),  # it never comes back
        (insert_jump(1.0) + insert_jump(1.0, begin=500) - HISTORY, [300, 500]),
    ],
)
def test_a_spike_leads_away_and_back(values, marks):
    assert np.flatnonzero(spikes(values)).tolist() == marks


def test_small_steps_of_a_resting_history_are_no_spikes():
    """A step of less than a hundredth of the peak is none, though the usual step is zero."""
    still = np.zeros(4000)
    still[2000:2100] = 1.0
    peak = float(np.quantile(still, 0.995))
    assert peak == 1.0
    for size, marks in ((0.005, []), (0.02, [500])):
        values = still.copy()
        values[500] = size
        assert np.flatnonzero(spikes(values)).tolist() == marks


def test_each_history_is_bridged_where_it_had_its_spikes():
    sound = Recording(command=HISTORY, measured=0.9 * HISTORY, time_step=0.01)
    assert remove_spikes(sound)[0] is sound
    recording = Recording(command=insert_jump(3.0), measured=0.9 * insert_jump(-3.0, 500, 2), time_step=0.01)
    bridge, command_spikes, measured_spikes = remove_spikes(recording)
    assert np.flatnonzero(command_spikes).tolist() == [300]
    assert np.flatnonzero(measured_spikes).tolist() == [500, 501]
    assert bridge.command[300] == pytest.approx(0.5 * (HISTORY[299] + HISTORY[301]))
    ends = 0.9 * HISTORY[[499, 502]]
    np.testing.assert_allclose(bridge.measured[500:502], ends[0] + np.diff(ends) * [1 / 3, 2 / 3])
    np.testing.assert_array_equal(np.delete(bridge.command, 300), np.delete(HISTORY, 300))
