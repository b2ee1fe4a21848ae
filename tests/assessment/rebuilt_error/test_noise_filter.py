"""Filters that the noise of a channel shows, against filters of SciPy."""

import numpy as np
import pytest
import scipy

from reliab.assessment.budget.sizes import exact_equipment, ordinary_equipment
from reliab.assessment.error_of_test import Question, error_of_test
from reliab.assessment.rebuilt_error.noise import filter_of_noise
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import Recording
from reliab.signals.filters import LowPass
from reliab.structures.structure import Structure

RATE = 1024.0
TIME = np.arange(0.0, 20.0, 1.0 / RATE)
COMMAND = 0.01 * np.sin(6.0 * TIME) * np.sin(0.3 * TIME) * np.minimum(TIME / 4.0, 1.0)
MOVED = 0.99 * np.interp(TIME - 0.002, TIME, COMMAND)
NOISE = 3e-5 * np.random.default_rng(5).standard_normal(TIME.size)


def filter_values(values, corner, order=2):
    """Analogue filter, at rest before and after."""
    padded_record = np.concatenate([np.zeros(4096), values, np.full(4096, values[-1])])
    place = np.fft.rfftfreq(padded_record.size, 1.0 / RATE)
    gain = scipy.signal.freqs(*scipy.signal.butter(order, corner, analog=True), worN=place)[1]
    return np.fft.irfft(np.fft.rfft(padded_record) * gain, padded_record.size)[4096 : 4096 + values.size]


@pytest.mark.parametrize(("corner", "order"), [(60.0, 2), (120.0, 4), (250.0, 8)])
def test_a_filter_is_seen_with_its_delay(corner, order):
    result = filter_of_noise(COMMAND, filter_values(MOVED + NOISE, corner, order), 1.0 / RATE)
    assert result.delay == pytest.approx(LowPass(corner=corner, order=order).delay, rel=0.15)


def test_white_slow_or_converter_noise_shows_no_filter():
    slow = scipy.signal.lfilter([1.0 - 0.9], [1.0, -0.9], NOISE)
    step = 2.0 * np.ptp(MOVED) / 2**12
    for read in (
        MOVED + NOISE,
        MOVED + slow,
        step * np.round((MOVED + NOISE) / step),
        filter_values(MOVED, 80.0) + NOISE,  # the filter comes before the noise
        MOVED,
    ):
        assert filter_of_noise(COMMAND, read, 1.0 / RATE) is None


def test_a_reading_that_stands_still_at_times_shows_none():
    read = filter_values(MOVED + NOISE, 80.0)
    read[1::20] = read[0:-1:20]
    assert filter_of_noise(COMMAND, read, 1.0 / RATE) is None


def test_its_power_falls_by_half_at_the_corner():
    frequency = np.array([0.0, 50.0, 5000.0])
    assert LowPass(corner=50.0, order=4).power(frequency) == pytest.approx([1.0, 0.5, 1e-16])


@pytest.mark.slow
def test_the_interval_holds_the_error_with_and_without_its_delay_until_filters_are_stated():
    read = filter_values(MOVED + NOISE, 60.0)
    recording = Recording(command=COMMAND, measured=read, time_step=1.0 / RATE)
    structure = Structure(frequency=1.0, damping_ratio=0.05)

    def asked(stated_values):
        question = Question(
            structure=structure,
            stated=stated_values,
            equipment=ordinary_equipment(),
            metric=Metric.RMS,
            threshold=0.05,
            model=None,
            seed=0,
            linear_specimen=True,
        )
        return error_of_test(recording, question)

    error, stated_values = asked({}), asked({"filter_delay": StatedValue(0.0, 0.05)})
    late = scipy.signal.lfilter(*scipy.signal.butter(2, 60.0, fs=RATE), COMMAND)
    bare = error_of_test(
        Recording(command=late, measured=read, time_step=1.0 / RATE),
        Question(
            structure=structure,
            stated={},
            equipment=exact_equipment(),
            metric=Metric.RMS,
            threshold=0.05,
            model=None,
            seed=0,
        ),
    )
    assert error.rebuilt.rms.low < bare.rebuilt.rms.value < 0.7 * error.rebuilt.rms.value
    assert stated_values.rebuilt.rms.low > bare.rebuilt.rms.value
    assert "open_filter" in error.rebuilt.inferred.sizes
    assert "open_filter" not in stated_values.rebuilt.inferred.sizes
