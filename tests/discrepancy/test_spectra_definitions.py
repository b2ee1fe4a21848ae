"""Spectra, their segments and their smoothing, by their definitions."""

import numpy as np
import pytest
import scipy

from reliab.discrepancy.campaign.campaign import Stretch
from reliab.discrepancy.segment import (
    Segment,
    _value_and_slope,
    cut_segments,
    energy_of,
    highest_frequency,
    skip_end,
    skip_transient,
)
from reliab.signals import noise
from reliab.signals.noise import NoiseModel, _average, _share, _spectra, harmonics_up_to, reliable_frequency
from reliab.simulation.hybrid_test.open_loop import Motion3
from reliab.structures.structure import Structure

RATE = 256.0
VALUES = np.random.default_rng(1).standard_normal(1200)


def test_a_segment_has_the_fourier_sums_of_its_samples_up_to_its_highest_frequency():
    segment = Segment(test=0, begin=100, end=900, rate=RATE, highest=12.0)
    assert segment.bins == 38  # 12 Hz lie 37.5 spacings of 0.32 Hz up
    assert segment.frequency == pytest.approx(0.32 * np.arange(38))
    turns = np.exp(-2j * np.pi * np.outer(np.arange(38), np.arange(800)) / 800)
    assert segment.spectrum(VALUES) == pytest.approx(turns @ VALUES[100:900] / np.sqrt(800.0))
    power = segment.periodogram_above(VALUES, 0.0)
    assert power.frequency == pytest.approx(0.32 * np.arange(1, 401))
    assert power.power[:37] == pytest.approx(np.abs(segment.spectrum(VALUES)[1:]) ** 2)
    noise = NoiseModel(rate=RATE, weights=np.arange(1.0, 9.0))
    assert segment.density(noise) == pytest.approx(noise.density(segment.frequency))


def test_energy_of_a_spectrum_equals_that_of_the_signal():
    """Parseval, for a signal without power at the Nyquist frequency, which has no partner."""
    segment = Segment(test=0, begin=0, end=801, rate=RATE, highest=0.5 * RATE)
    assert energy_of(segment.spectrum(VALUES)) == pytest.approx(VALUES[:801] @ VALUES[:801])


@pytest.mark.parametrize("place", [0, 1, 2, 3, 40, 77, 78, 79, 80])
def test_value_and_slope_are_exact_for_quadratics_also_beyond_the_last_sample(place):
    places = np.arange(80.0)
    values = 2.0 - 0.3 * places + 0.04 * places**2
    reference = (2.0 - 0.3 * place + 0.04 * place**2, -0.3 + 0.08 * place)
    assert _value_and_slope(values, place) == pytest.approx(reference)


@pytest.mark.parametrize(("stretches", "parts"), [(1, 4), (2, 2), (3, 1), (4, 1), (5, 1)])
@pytest.mark.parametrize("thinning", [1, 3])
def test_segments_are_at_least_three_of_fast_lengths(stretches, parts, thinning):
    stretches_given = [Stretch(test=k, begin=10 + k, end=3000 + k) for k in range(stretches)]
    segments = cut_segments(stretches_given, RATE, lambda test: 10.0 + test, thinning)
    assert len(segments) == stretches * parts
    for number, segment in enumerate(segments):
        stretch = stretches_given[number // parts]
        assert (segment.test, segment.highest, segment.rate) == (stretch.test, 10.0 + stretch.test, RATE)
        edges = np.linspace(stretch.begin, stretch.end, parts + 1).astype(int)[number % parts :][:2]
        assert edges[0] <= segment.begin < edges[0] + thinning
        assert segment.begin % thinning == 0
        length = (segment.end - segment.begin) // thinning
        assert length * thinning == segment.end - segment.begin
        room = (edges[1] - segment.begin) // thinning
        assert length == scipy.fft.prev_fast_len(int(room), real=True)


def test_the_highest_frequency_is_45_hz_or_five_natural_ones_within_the_rate():
    assert highest_frequency(1000.0) == 45.0
    assert highest_frequency(100.0) == pytest.approx(40.0)
    for natural, highest in ((8.9, 45.0), (10.0, 50.0), (100.0, 400.0)):
        structure = Structure(frequency=natural, damping_ratio=0.05)
        assert highest_frequency(1000.0, structure) == pytest.approx(highest)


@pytest.mark.parametrize(("second", "reference"), [(0.0, 22.0), (0.1, 22.0), (0.2, 0.0)])
def test_a_sine_has_harmonics_up_to_the_eleventh(second, reference):
    """Of a second sine's power, a², at most 2 % of the whole may lie elsewhere."""
    time = np.arange(5120) / RATE
    wave = np.sin(2.0 * np.pi * 2.0 * time) + second * np.sin(2.0 * np.pi * 3.1 * time) + 0.3 * time
    assert harmonics_up_to(wave, 1.0 / RATE) == pytest.approx(reference)


def test_power_is_averaged_over_a_widening_band_up_to_the_border():
    frequency = 0.05 * np.arange(1001)
    power = np.random.default_rng(2).exponential(size=1001)
    result = _average(frequency, power, 30.0)
    for place in (0, 1, 40, 590, 600, 601, 640, 999, 1000):
        reach = max(int((0.2 + 0.1 * frequency[place]) / 0.05 + 1e-9), 3)
        interior = np.abs(np.arange(1001) - place) <= reach
        interior &= (frequency <= 30.0 + 1e-9) == (frequency[place] <= 30.0 + 1e-9)
        assert result[place] == pytest.approx(power[interior].mean()), place


def test_the_share_of_a_signal_is_wieners():
    frequency = np.array([1.0, 2.0, 3.0, 4.0, 50.0])
    complete, floor = np.array([10.0, 2.49, 2.51, 1.0, 10.0]), np.ones(5)
    assert _share(frequency, complete, floor, 45.0) == pytest.approx([0.9, 0.0, 1.51 / 2.51, 0.0, 0.0])
    assert _share(np.array([45.0]), np.array([4.0]), np.ones(1), 45.0) == pytest.approx([0.75])


def test_displacements_are_reliable_where_most_of_them_are_clear(monkeypatch):
    """Fifty times the noise's power, at the median of the tests, and 1 Hz at least."""
    frequency = np.arange(0.0, 60.0, 0.5)

    def spectra(last, *_):
        return None, frequency, np.where(frequency <= last, 51.0, 49.0), np.ones(frequency.size)

    monkeypatch.setattr(noise, "_spectra", spectra)
    assert reliable_frequency([4.0, 9.0, 30.0], 0.01, 45.0) == 9.0
    assert reliable_frequency([55.0], 0.01, 45.0) == 45.0
    assert reliable_frequency([0.5], 0.01, 45.0) == 1.0
    assert reliable_frequency([-1.0], 0.01, 45.0) == 1.0


def motion(velocity):
    return Motion3(step=0.01, values=np.stack([np.cumsum(velocity), velocity, np.gradient(velocity)]))


@pytest.mark.parametrize(("first", "begins_late"), [(0.09, False), (0.11, True)])
def test_a_record_begins_in_motion_from_a_tenth_of_the_usual_velocity(first, begins_late):
    velocity = np.sqrt(2.0) * np.sin(2.0 * np.pi * np.arange(2000) / 100.0)
    usual = np.sqrt(np.mean(velocity**2))
    velocity[:5] = first * usual
    begin = skip_transient([Stretch(test=0, begin=0, end=2000)], [motion(velocity)])[0].begin
    # the third reversal comes after 1.5 swings, where the motion has left the tenth again
    assert begin == (152 if begins_late else 0)


def test_an_end_is_left_out_up_to_a_fifth():
    still = motion(np.ones(1000))
    for seconds, end in ((0.5, 950), (1.99, 801), (2.5, 800)):
        assert skip_end([Stretch(test=0, begin=5, end=1000)], [still], seconds)[0].end == end
    places = Stretch(test=0, begin=950, end=1000)
    assert skip_end([places], [still], 0.5) == (places,)
    assert skip_end([Stretch(test=0, begin=949, end=1000)], [still], 0.5)[0].end == 950


def test_a_displacement_is_continued_as_an_odd_function():
    """What swings about the line between its ends has no cosines, so that its spectrum is imaginary."""
    displacement = np.cumsum(np.random.default_rng(4).standard_normal(2000)) + 0.01 * np.arange(2000)
    spectrum, frequency, _, _ = _spectra(displacement, 1.0 / RATE, 45.0)
    assert np.abs(spectrum.real).max() < 1e-9 * np.abs(spectrum.imag).max()
    assert frequency.size == 2000
    assert frequency[-1] == pytest.approx(0.5 * RATE)
