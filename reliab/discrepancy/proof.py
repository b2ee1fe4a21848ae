"""The proof on held-out tests: what is left of the signal before and after effects are added."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.result import Gap
from reliab.discrepancy.spectra.noise import NoiseModel
from reliab.discrepancy.spectra.segment import Segment
from reliab.loop.effects import Effect

Array = NDArray[np.float64]


def residuals(proof: Problem, one: Fit, *, without: Sequence[type[Effect]] = ()) -> dict[int, Array]:
    """Measured minus predicted channel on held-out tests.

    Parameters
    ----------
    proof : Problem
        The held-out stretches.
    one : Fit
        A model fitted to the other tests.
    without : sequence of type, optional
        Offsets that count as effects and are therefore left out.

    Returns
    -------
    dict of int to numpy.ndarray
        By index of the test, over the whole test.
    """
    return proof.residuals(one.space, one.space.neutralised(one.coordinates, without))


def held_out_nrmse(proof: Problem, left: dict[int, Array]) -> float:
    """RMS of residuals over RMS of the signal, over all held-out stretches."""
    return float(np.sqrt(_energy(proof, left) / _signal_energy(proof)))


def gap(proof: Problem, before: dict[int, Array], after: dict[int, Array], noise: NoiseModel) -> Gap:
    """Compare residuals before and after with the noise.

    Parameters
    ----------
    proof : Problem
        The held-out stretches.
    before, after : dict of int to numpy.ndarray
        Residuals by test.
    noise : NoiseModel
        Noise as the final model leaves it on the other tests.

    Returns
    -------
    Gap
        In numbers.
    """
    block = proof.block
    tests = dict.fromkeys(segment.test for segment in proof.segments)
    return Gap(
        held_out=tuple(block.tests[test].file for test in tests),
        channel=str(block.channel),
        before=held_out_nrmse(proof, before),
        after=held_out_nrmse(proof, after),
        floor=float(np.sqrt(_noise_energy(proof, after, noise) / _signal_energy(proof))),
    )


def _cut(segment: Segment, values: Array) -> Array:
    return values[segment.begin : segment.end]


def _energy(proof: Problem, left: dict[int, Array]) -> float:
    return sum(float((_cut(segment, left[segment.test]) ** 2).sum()) for segment in proof.segments)


def _signal_energy(proof: Problem) -> float:
    """Energy of the channel about the mean of its tests."""
    parts = [_cut(segment, proof.block.measured(segment.test)) for segment in proof.segments]
    return max(sum(float((part**2).sum()) for part in parts), 1e-300)


def _noise_energy(proof: Problem, left: dict[int, Array], noise: NoiseModel) -> float:
    """Energy of the noise: as modelled where models are judged, as measured above."""
    total = 0.0
    for segment in proof.segments:
        power = np.abs(segment.full_spectrum(left[segment.test])) ** 2
        frequency = np.arange(power.size) * segment.rate / (segment.end - segment.begin)
        below = frequency <= segment.highest
        power[below] = noise.density(frequency[below])
        total += 2.0 * float(power[1:].sum()) + float(power[0])
    return total
