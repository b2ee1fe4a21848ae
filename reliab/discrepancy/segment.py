"""Stretches of tests whose residuals are judged, and left out, as one.

Ends that a model cannot predict are left out: at the start of a record that does not begin at rest the model
forgets an unknown initial state; what an integration demands at its end moves the command after it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import fft

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.discrepancy.campaign.campaign import Campaign, Channel, Stretch
from reliab.effects.effect import Scales
from reliab.signals.noise import NoiseModel, Periodogram, noise_shapes, smooth_displacement
from reliab.simulation.hybrid_test.open_loop import Motion3
from reliab.structures.structure import Structure

_FEWEST_SEGMENTS = 4
_REST_SHARE = 0.1  # of the RMS of the velocity
_FIRST = 5  # samples
_REVERSALS = 3  # after which the motion has gone through a whole swing
_LARGEST_SHARE = 0.2  # of a record


@dataclass(frozen=True, kw_only=True)
class Segment:
    """A stretch of a test, seen in the frequency domain up to a highest frequency."""

    test: int  # Index of the test
    begin: int  # begin, end: First sample and the one after the last
    end: int
    rate: float  # Sampling rate [Hz]
    highest: float  # Highest frequency that counts [Hz]

    @cached_property
    def bins(self) -> int:
        """Number of frequencies that count, zero among them."""
        return int(self.highest / self.rate * (self.end - self.begin)) + 1

    @cached_property
    def frequency(self) -> Array:
        """Frequencies that count [Hz], shape (bins,)."""
        return np.arange(self.bins) * self.rate / (self.end - self.begin)

    @cached_property
    def _shapes(self) -> Array:
        return noise_shapes(self.frequency, self.rate)

    def density(self, noise: NoiseModel) -> Array:
        """Return the expected periodogram of a noise at the frequencies that count, shape (bins,)."""
        return np.asarray(noise.weights @ self._shapes)

    def full_spectrum(self, values: Array) -> Spectrum:
        """Discrete Fourier transform over √n, all frequencies."""
        n = self.end - self.begin
        return np.asarray(fft.rfft(values[self.begin : self.end]) / np.sqrt(n), dtype=np.complex128)

    def spectrum(self, values: Array) -> Spectrum:
        """Discrete Fourier transform over √n at the frequencies that count, shape (bins,)."""
        return np.asarray(self.full_spectrum(values)[: self.bins])

    def coarse_spectrum(self, values: Array, thinning: int) -> Spectrum:
        """Return the same of values of which only each `thinning`-th is there.

        Sums over coarse and fine instants differ where a segment does not end as it begins, by the terms of
        Euler and Maclaurin: half of the ends' difference in value, a twelfth of that in slope.
        """
        n = self.end - self.begin
        first, last = self.begin // thinning, self.end // thinning
        sums = thinning * fft.rfft(values[first:last])[: self.bins]
        if thinning > 1:
            (begin, rise), (end, fall) = _value_and_slope(values, first), _value_and_slope(values, last)
            turn = 2.0 * np.pi / n * np.arange(self.bins)
            slope_term = (fall - rise) / thinning - 1j * turn * (end - begin)
            sums += 0.5 * (thinning - 1) * (end - begin) - (thinning**2 - 1) / 12.0 * slope_term
        return np.asarray(sums / np.sqrt(n))

    def history(self, rows: Array, noise: NoiseModel) -> Array:
        """Return the history whose spectrum, whitened by a noise, has given real parts, shape (n,)."""
        n = self.end - self.begin
        white = np.zeros(n // 2 + 1, dtype=np.complex128)
        white[0] = rows[0]
        white[1 : self.bins] = (rows[1 : self.bins] + 1j * rows[self.bins :]) / np.sqrt(2.0)
        white[: self.bins] *= np.sqrt(self.density(noise))
        return np.asarray(fft.irfft(white * np.sqrt(n), n))

    def periodogram_above(self, values: Array, limit: float) -> Periodogram:
        """Power at all frequencies above a limit [Hz]."""
        frequency = fft.rfftfreq(self.end - self.begin, 1.0 / self.rate)
        power = np.abs(self.full_spectrum(values)) ** 2
        return Periodogram(frequency=frequency[frequency > limit], power=power[frequency > limit])


def split_by_segment(segments: Sequence[Segment], rows: Array) -> Iterator[tuple[Segment, Array]]:
    """Divide residuals, shape (rows,), into those of each segment: real parts, then imaginary ones."""
    ends = np.cumsum([2 * segment.bins - 1 for segment in segments])
    return zip(segments, np.split(rows, ends[:-1]), strict=True)


def energy_of(spectrum: Spectrum) -> float:
    """Energy of a signal at the frequencies of its one-sided spectrum."""
    power = np.abs(spectrum) ** 2
    return float(power[0] + 2.0 * power[1:].sum())


def _value_and_slope(values: Array, place: int) -> tuple[float, float]:
    """Value at a place, which may be the one after the last, and what it grows by from place to place."""
    near = values[max(place - 3, 0) : place + 3]
    if place == values.size:
        near = np.append(near, 3.0 * near[-1] - 3.0 * near[-2] + near[-3])
    centre = min(place, 3)
    if 0 < centre < near.size - 1:
        return float(near[centre]), float(0.5 * (near[centre + 1] - near[centre - 1]))
    return float(near[centre]), float(np.gradient(near, edge_order=2)[centre])


def cut_segments(
    stretches: Sequence[Stretch], rate: float, highest: Callable[[int], float], thinning: int = 1
) -> tuple[Segment, ...]:
    """Cut stretches of tests into at least four segments, whole stretches if there are as many.

    `rate`, `highest` [Hz].
    """
    parts = 1 if len(stretches) >= _FEWEST_SEGMENTS - 1 else -(-_FEWEST_SEGMENTS // len(stretches))
    segments = []
    for stretch in stretches:
        edges = np.linspace(stretch.begin, stretch.end, parts + 1).astype(int)
        for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            first = -(-begin // thinning) * thinning
            length = thinning * fft.prev_fast_len((end - first) // thinning, real=True)
            segments.append(
                Segment(
                    test=stretch.test,
                    begin=first,
                    end=first + length,
                    rate=rate,
                    highest=highest(stretch.test),
                )
            )
    return tuple(segments)


def skip_transient(
    stretches: Sequence[Stretch], motions: Sequence[Motion3], memory: float = 0.0
) -> tuple[Stretch, ...]:
    """Leave out the start of records that begin while the piston moves.

    Motion before the record leaves the rig in a state, of a lag or of a hysteresis, that is not recorded. The
    error of a simulation that starts without this state vanishes after one swing, that of an oscillator after
    its free vibration has died away.

    `memory` [s].
    """
    stretches_left = []
    for stretch in stretches:
        velocity = motions[stretch.test].values[1][: stretch.end]
        usual = float(np.sqrt(np.mean(velocity**2)))
        is_moved = float(np.abs(velocity[:_FIRST]).mean()) >= _REST_SHARE * usual
        begin = stretch.begin
        if begin == 0 and is_moved:
            moving = np.flatnonzero(np.abs(velocity) > _REST_SHARE * usual)
            reversals = moving[1:][np.diff(np.sign(velocity[moving])) != 0.0]
            most = int(_LARGEST_SHARE * stretch.end)
            swing = int(reversals[_REVERSALS - 1]) if reversals.size >= _REVERSALS else most
            begin = min(max(swing, int(memory / motions[stretch.test].step)), most)
        stretches_left.append(replace(stretch, begin=begin))
    return tuple(stretches_left)


def skip_end(
    stretches: Sequence[Stretch], motions: Sequence[Motion3], unanswered: float
) -> tuple[Stretch, ...]:
    """Leave out the end of records whose output shows in the input only after it.

    `unanswered` [s].
    Returns the same parts; those that reach into this time end where it begins, unless they lie within it.
    """
    stretches_left = []
    for stretch in stretches:
        motion = motions[stretch.test]
        size = motion.values.shape[1]
        end = size - min(round(unanswered / motion.step), int(_LARGEST_SHARE * size))
        stretches_left.append(replace(stretch, end=min(stretch.end, end)) if stretch.begin < end else stretch)
    return tuple(stretches_left)


HIGHEST_SIGNAL = 45.0
"""Highest frequency [Hz] at which the test of a structure of some hertz may hold a signal."""

_HARMONICS = 5.0  # of a structure, at which a stiffness that grows with the square still answers
_LARGEST_RATE_SHARE = 0.4  # of the sampling rate


def highest_frequency(rate: float, structure: Structure | None = None) -> float:
    """Highest frequency [Hz] at which a test may hold a signal; above it is noise.

    `rate` [Hz].
    Returns 45 Hz, or five times the natural frequency, but no more than the sampling rate allows.

    >>> highest_frequency(1024.0)
    45.0
    >>> highest_frequency(1024.0, Structure(frequency=20.0, damping_ratio=0.02))
    100.0
    """
    natural = 0.0 if structure is None else structure.frequency
    return min(max(HIGHEST_SIGNAL, _HARMONICS * natural), _LARGEST_RATE_SHARE * rate)


def smooth_motion(displacement: Array, step: float, highest: float) -> Motion3:
    """Motion behind a noisy displacement.

    `displacement` [m]; `step` [s]; `highest` [Hz].
    """
    return Motion3.interpolate(smooth_displacement(displacement, step, highest), step)


def motions_of(campaign: Campaign) -> tuple[Motion3, ...]:
    """Motion of the piston in every test from the channels: the command, else the smoothed reading."""
    highest, motions = highest_frequency(campaign.rate, campaign.structure), list[Motion3]()
    for test in campaign.tests:
        if Channel.COMMAND in test.channels:
            motions.append(Motion3.interpolate(test.channels[Channel.COMMAND], campaign.step))
        else:
            motions.append(smooth_motion(test.channels[Channel.MEASURED], campaign.step, highest))
    return tuple(motions)


def scales_of(campaign: Campaign, motions: Sequence[Motion3]) -> Scales:
    """Peaks of the motion and the force over the tests that are not held out."""
    fitted_tests = [k for k, test in enumerate(campaign.tests) if not test.held_out]
    centred_motions = [
        motions[k].values - [[motions[k].values[0].mean()], [0.0], [0.0]] for k in fitted_tests
    ]
    peaks = np.max([np.quantile(np.abs(history), 0.9995, axis=1) for history in centred_motions], axis=0)
    if not peaks.min() > 0.0:
        raise InputError(
            "The displacement must move in at least one test that is not held out",
            value="a constant",
            remedy="Check that the column holds the recording, in metres",
        )
    specimen = campaign.nominal.specimen
    force = 0.0 if specimen is None else specimen.stiffness * float(peaks[0])
    if Channel.FORCE in campaign.channels:
        forces = [campaign.tests[k].channels[Channel.FORCE] for k in fitted_tests]
        force = max(float(np.abs(values - np.median(values)).max()) for values in forces)
    return Scales(
        displacement=float(peaks[0]),
        velocity=float(peaks[1]),
        acceleration=float(peaks[2]),
        force=force if force > 0.0 else 1.0,
        duration=max(campaign.tests[k].size for k in fitted_tests) * campaign.step,
    )
