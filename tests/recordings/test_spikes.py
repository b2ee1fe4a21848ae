"""Spikes are jumps away from a history and back, by their definition, and are bridged by straight lines."""

import numpy as np
import pytest

from reliab.recordings.recording import Recording
from reliab.recordings.spikes import spikes, without_spikes

HISTORY = np.sin(np.arange(0.0, 40.0, 0.05))
USUAL = float(np.quantile(np.abs(np.diff(HISTORY)), 0.995))


def with_a_jump(size, begin=300, width=1):
    values = HISTORY.copy()
    values[begin : begin + width] += size
    return values


@pytest.mark.parametrize(
    ("values", "marked"),
    [
        (with_a_jump(6.0 * USUAL), [300]),
        (with_a_jump(-6.0 * USUAL), [300]),
        (with_a_jump(2.0 * USUAL), []),  # no more than the history moves by itself
        (with_a_jump(1.0, width=8), list(range(300, 308))),
        (with_a_jump(1.0, width=9), []),  # a stretch that lasts is a motion
        (with_a_jump(1.0, width=HISTORY.size), []),  # it never comes back
        (with_a_jump(1.0) + with_a_jump(1.0, begin=500) - HISTORY, [300, 500]),
    ],
)
def test_a_spike_leads_away_and_back(values, marked):
    assert np.flatnonzero(spikes(values)).tolist() == marked


def test_in_a_history_that_mostly_stands_small_steps_are_no_spikes():
    """A step of less than a hundredth of the peak is none, though the usual step is zero."""
    still = np.zeros(4000)
    still[2000:2100] = 1.0
    peak = float(np.quantile(still, 0.995))
    assert peak == 1.0
    for size, marked in ((0.005, []), (0.02, [500])):
        values = still.copy()
        values[500] = size
        assert np.flatnonzero(spikes(values)).tolist() == marked


def test_each_history_is_bridged_where_it_had_its_spikes():
    sound = Recording(command=HISTORY, measured=0.9 * HISTORY, time_step=0.01)
    assert without_spikes(sound)[0] is sound
    recording = Recording(command=with_a_jump(3.0), measured=0.9 * with_a_jump(-3.0, 500, 2), time_step=0.01)
    bridged, in_command, in_measured = without_spikes(recording)
    assert np.flatnonzero(in_command).tolist() == [300]
    assert np.flatnonzero(in_measured).tolist() == [500, 501]
    assert bridged.command[300] == pytest.approx(0.5 * (HISTORY[299] + HISTORY[301]))
    ends = 0.9 * HISTORY[[499, 502]]
    np.testing.assert_allclose(bridged.measured[500:502], ends[0] + np.diff(ends) * [1 / 3, 2 / 3])
    np.testing.assert_array_equal(np.delete(bridged.command, 300), np.delete(HISTORY, 300))
