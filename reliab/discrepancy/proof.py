"""Verification on held-out tests: residual over signal before and after effects are added."""

from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import combinations

import numpy as np
from scipy import fft

from reliab.core.arrays import Array
from reliab.discrepancy.campaign.campaign import Channel, MeasuredTest
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.result.gap import Gap, HeldOutTest
from reliab.discrepancy.segment import energy_of
from reliab.signals.noise import converter_step, near_mains
from reliab.signals.spectra import detrend, hann, kind_of_motion, periodogram

_SAME_INPUT = 0.02  # RMS of a difference over that of the input
_MOTION_AT_REST = 0.002  # of the input's range
_SHORTEST_REST = 0.25  # s
_FEWEST_SAMPLES = 64
_NOTHING = 1e-300  # energy of a channel that does not move
_WHITE = 1.25  # ratio of the power in both halves of a band of white noise


def compute_nrmse(proof: Problem, residual: dict[int, Array]) -> float:
    """RMS of residuals over RMS of the signal, over all held-out stretches."""
    return float(np.sqrt(sum(_energies(proof, residual).values()) / _signal_energy(proof)))


def _signal_energy(proof: Problem) -> float:
    return max(sum(_energies(proof, _measurements(proof)).values()), _NOTHING)


def _measurements(proof: Problem) -> dict[int, Array]:
    """Measured channel of every held-out test."""
    return {segment.test: proof.block.measured(segment.test) for segment in proof.segments}


def _energies(proof: Problem, values: dict[int, Array]) -> dict[int, float]:
    """Energy of values over the held-out stretches of each test, within the band of a narrow block only."""
    energies: dict[int, float] = {}
    for segment in proof.segments:
        part = values[segment.test][segment.begin : segment.end]
        narrow = proof.block.is_narrow
        energy = energy_of(segment.spectrum(values[segment.test])) if narrow else float((part**2).sum())
        energies[segment.test] = energies.get(segment.test, 0.0) + energy
    return energies


def gap(
    proof: Problem,
    residuals_before: dict[int, Array],
    residuals_after: dict[int, Array],
    noise_like: frozenset[int] = frozenset(),
) -> Gap:
    """Compare residuals before and after with the part of the recordings that is not repeatable.

    `noise_like` holds the tests in which what the model leaves is spread as noise is.
    """
    block, tests = proof.block, []
    signals, before, after = (
        _energies(proof, values) for values in (_measurements(proof), residuals_before, residuals_after)
    )
    noise_floors = floors(
        block.tests, signals, block.channel, block.inputs, rate=block.rate, highest=block.highest_signal
    )
    samples = _energies(proof, {test: np.ones(block.tests[test].size) for test in signals})
    unit = _signal_energy(proof) / sum(samples.values())
    # Of noise that is white over all frequencies a narrow block has this share
    share = block.highest / (0.5 * block.rate) if block.is_narrow else 1.0
    for test, energy in signals.items():
        signal = max(energy, _NOTHING)
        tests.append(
            HeldOutTest(
                file=block.tests[test].file,
                kind=kind_of_motion(block.tests[test].channels[block.inputs[0]], block.rate),
                before=float(np.sqrt(before[test] / signal)),
                after=float(np.sqrt(after[test] / signal)),
                size=float(np.sqrt(signal / samples[test] / unit)),
                noise_like=test in noise_like,
            )
        )
    return Gap(
        channel=str(block.channel),
        before=compute_nrmse(proof, residuals_before),
        after=compute_nrmse(proof, residuals_after),
        floors={str(name): float(np.sqrt(share * square / unit)) for name, square in noise_floors.items()},
        tests=tuple(tests),
    )


class Source(StrEnum):
    """Where a floor comes from, the most reliable source first."""

    REPEATED_TESTS = "repeated tests"
    REPEATED_CYCLES = "repeated cycles"
    BAND_ABOVE = "band above the motion"
    AT_REST = "rest"


def floors(
    tests: Sequence[MeasuredTest],
    held_out: Iterable[int],
    channel: Channel,
    inputs: Sequence[Channel],
    *,
    rate: float,
    highest: float,
) -> dict[Source, float]:
    """Estimate the mean square of what is not repeatable, from every source that the recordings offer.

    `rate`, `highest` [Hz]; returns squares of the channel's unit.
    """
    proof = [tests[k] for k in held_out]
    ways = {
        Source.REPEATED_TESTS: _repeat_variances(tests, channel, inputs),
        Source.REPEATED_CYCLES: _cycle_variances(proof, channel, inputs),
        Source.BAND_ABOVE: _band_variances(proof, channel, rate, highest),
        Source.AT_REST: _rest_variances(proof, channel, inputs, rate),
    }
    values_by_source = {source: [value for value in values if value > 0.0] for source, values in ways.items()}
    return {source: float(np.mean(values)) for source, values in values_by_source.items() if values}


def _repeat_variances(
    tests: Sequence[MeasuredTest], channel: Channel, inputs: Sequence[Channel]
) -> Iterator[float]:
    for first, second in combinations(tests, 2):
        if first.motion and first.motion == second.motion and first.size == second.size:
            pairs = [(first.channels[c], second.channels[c]) for c in inputs]
            if all(_close(a, b) for a, b in pairs):
                yield float(np.var(first.channels[channel] - second.channels[channel])) / 2.0


def _close(first: Array, second: Array) -> bool:
    return bool(np.std(first - second) < _SAME_INPUT * max(float(np.std(first)), 1e-300))


def _cycle_variances(
    tests: Sequence[MeasuredTest], channel: Channel, inputs: Sequence[Channel]
) -> Iterator[float]:
    for test in tests:
        driven = test.channels[inputs[-1]]
        lag = _period(driven)
        if lag is None:
            continue
        inner = slice(int(lag), None)  # the first cycle may start from rest
        x, y = driven[inner], test.channels[channel][inner]
        if y.size > 2 * lag and _close(x[lag:], x[:-lag]):
            yield float(np.mean((y[lag:] - y[:-lag]) ** 2)) / 2.0


def _period(values: Array) -> int | None:
    """Return after how many samples a channel repeats itself best, None if it never swings."""
    centred_values = values - values.mean()
    size = fft.next_fast_len(2 * centred_values.size, real=True)
    power = np.abs(fft.rfft(centred_values, size)) ** 2
    correlation = fft.irfft(power, size)[: centred_values.size // 3]
    negative = np.flatnonzero(correlation < 0.0)
    if not negative.size:
        return None
    weighted = correlation[negative[0] :] / (centred_values.size - np.arange(negative[0], correlation.size))
    return int(negative[0] + np.argmax(weighted))


def _band_variances(
    tests: Sequence[MeasuredTest], channel: Channel, rate: float, highest: float
) -> Iterator[float]:
    """Level of the band above the motion where it is white, so that it holds below as well, with pickup."""
    for test in tests:
        values = test.channels[channel]
        power = periodogram(detrend(values), hann(values.size))
        frequency = fft.rfftfreq(values.size, 1.0 / rate)[1:]
        is_above = (frequency > highest) & (frequency < 0.49 * rate)
        mains = near_mains(frequency, 0.5 * rate)
        level = power[is_above & ~mains]
        if level.size < 2 * _FEWEST_SAMPLES:
            continue
        low, high = (float(np.mean(half)) for half in np.array_split(level, 2))
        if max(low, high) < _WHITE * min(low, high):
            white = float(np.mean(level))
            pickup = float(np.maximum(power[is_above & mains] - white, 0.0).sum()) * 2.0 / values.size
            yield white + pickup


def _rest_variances(
    tests: Sequence[MeasuredTest], channel: Channel, inputs: Sequence[Channel], rate: float
) -> Iterator[float]:
    """Variance of the channel while nothing drives it, at the begin and at the end of a test.

    A converter whose input rests shows nothing of its own error, which comes with the motion.
    """
    shortest = max(int(_SHORTEST_REST * rate), _FEWEST_SAMPLES)
    for test in tests:
        driven = np.stack([test.channels[c] for c in inputs])
        conversion = converter_step(test.channels[channel]) ** 2 / 12.0
        reach = _MOTION_AT_REST * np.ptp(driven, axis=1, keepdims=True)
        for order in (slice(None), slice(None, None, -1)):
            is_moving = (np.abs(driven[:, order] - driven[:, order][:, :1]) > reach).any(axis=0)
            length = int(np.argmax(is_moving)) if is_moving.any() else is_moving.size
            if length >= shortest:
                yield max(float(np.var(detrend(test.channels[channel][order][:length]))), conversion)
