"""Verification on held-out tests: residual over signal before and after effects are added."""

from collections.abc import Sequence

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.result.gap import Gap
from reliab.discrepancy.spectra.floor import floors
from reliab.discrepancy.spectra.segment import Segment
from reliab.effects import Effect


def residuals(proof: Problem, fitted: Fit, *, without: Sequence[type[Effect]] = ()) -> dict[int, Array]:
    """Measured minus predicted channel on held-out tests."""
    return proof.residuals(fitted.space, fitted.space.neutralised(fitted.coordinates, without))


def held_out_nrmse(proof: Problem, residual: dict[int, Array]) -> float:
    """RMS of residuals over RMS of the signal, over all held-out stretches."""
    return float(np.sqrt(_energy(proof, residual) / _signal_energy(proof)))


def errors_by_test(proof: Problem, residual: dict[int, Array]) -> dict[str, float]:
    """RMS of residuals over RMS of the signal in each held-out test, by file."""
    values = {}
    for test in dict.fromkeys(segment.test for segment in proof.segments):
        segments = [segment for segment in proof.segments if segment.test == test]
        energy = sum(float((_cut(s, residual[test]) ** 2).sum()) for s in segments)
        signal = sum(float((_cut(s, proof.block.measured(test)) ** 2).sum()) for s in segments)
        values[proof.block.tests[test].file] = float(np.sqrt(energy / max(signal, 1e-300)))
    return values


def gap(proof: Problem, before: dict[int, Array], after: dict[int, Array]) -> Gap:
    """Compare residuals before and after with the part of the recordings that is not repeatable."""
    block = proof.block
    tests = tuple(dict.fromkeys(segment.test for segment in proof.segments))
    known = floors(
        block.tests, tests, block.channel, block.inputs, rate=block.rate, highest=block.highest_signal
    )
    samples = sum(segment.end - segment.begin for segment in proof.segments)
    unit = _signal_energy(proof) / samples
    return Gap(
        held_out=tuple(block.tests[test].file for test in tests),
        channel=str(block.channel),
        before=held_out_nrmse(proof, before),
        after=held_out_nrmse(proof, after),
        floors={str(floor.source): float(np.sqrt(floor.mean_square / unit)) for floor in known},
        tests_before=errors_by_test(proof, before),
        tests_after=errors_by_test(proof, after),
    )


def _cut(segment: Segment, values: Array) -> Array:
    return values[segment.begin : segment.end]


def _energy(proof: Problem, residual: dict[int, Array]) -> float:
    return sum(float((_cut(segment, residual[segment.test]) ** 2).sum()) for segment in proof.segments)


def _signal_energy(proof: Problem) -> float:
    """Energy of the channel over all held-out stretches."""
    parts = [_cut(segment, proof.block.measured(segment.test)) for segment in proof.segments]
    return max(sum(float((part**2).sum()) for part in parts), 1e-300)
