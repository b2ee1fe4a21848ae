"""Where a calibrated model fails: the motion quantities with which its residual is correlated.

Each test projects the whitened residual on the signals that a family of causes would add to the channel
(columns of the motion, whitened alike, the calibration's own directions taken out). Under noise alone the
projected energy is χ²-distributed with as many degrees of freedom as the family has columns; Bonferroni's
factor corrects for the number of families.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem, real_parts
from reliab.renamed import renamed_method
from reliab.signals.noise import NoiseModel
from reliab.simulation.hybrid_test.open_loop import Motion3

_BANDS = ((0.0, 0.5), (0.5, 2.0), (2.0, 8.0), (8.0, 45.0))  # Hz
_SIGNIFICANT = 1e-4
_LISTED = 4
_LEAST_PROBABILITY = 1e-300  # smaller ones are not told from zero


@renamed_method("0.4", "as_dict", "to_dict")
@dataclass(frozen=True, kw_only=True)
class Finding:
    """A place where the calibrated model fails."""

    block: str  # block, channel: Where in the loop, and in which column
    channel: str
    test: str  # File of the test in which it shows most
    kind: str  # What the residual depends on
    detail: str  # One sentence
    share_of_residual: float  # Part of the residual's power above the noise that it accounts for, in [0, 1]
    p_value: float  # Probability of as much under noise alone, corrected for the number of tests made

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of `where`."""
        return {
            "block": self.block,
            "channel": self.channel,
            "test": self.test,
            "kind": self.kind,
            "detail": self.detail,
            "share_of_residual": self.share_of_residual,
            "p_value": self.p_value,
        }


@dataclass(frozen=True)
class _Family:
    kind: str
    sentence: str
    columns: Callable[[Array, Array, Array, Array], tuple[Array, ...]]


_FAMILIES = (
    _Family("offset", "a constant remains", lambda _t, x, _v, _a: (np.ones_like(x),)),
    _Family(
        "time",
        "the residual changes in the course of the tests, whatever the motion",
        lambda t, x, v, _a: (t, t * x, t * v),
    ),
    _Family(
        "velocity_reversal",
        "the residual jumps when the velocity changes sign",
        lambda _t, _x, v, _a: (np.tanh(v / 0.01),),
    ),
    _Family(
        "velocity",
        "the residual opposes the velocity and dissipates energy",
        lambda _t, _x, v, _a: (v, v * np.abs(v)),
    ),
    _Family(
        "amplitude",
        "the residual grows out of proportion with the displacement",
        lambda _t, x, _v, _a: (x**2, x**3, x * np.abs(x)),
    ),
    _Family(
        "acceleration", "the residual is correlated with the acceleration", lambda _t, _x, _v, a: (a,)
    ),
    _Family(
        "state_plane",
        "the residual depends on displacement and velocity together",
        lambda _t, x, v, _a: (x * v, x**2 * v, x * v**2),
    ),
)  # fmt: skip


def locate(problem: Problem, calibrated: Fit, noise: NoiseModel) -> tuple[Finding, ...]:
    """Find the motion quantities with which the residual of the calibrated model is correlated."""
    residual = problem.whitened(calibrated.space, calibrated.coordinates, noise)
    findings = [_along(problem, calibrated, noise, residual, family) for family in _FAMILIES]
    findings += [_in_band(problem, residual, low, high) for low, high in _BANDS]
    trials = len(findings)
    corrected = [(min(1.0, p * trials), share, make) for p, share, make in findings]
    significant = [finding for finding in corrected if finding[0] < _SIGNIFICANT]
    significant.sort(key=lambda finding: -finding[1])
    return tuple(make(p, share) for p, share, make in significant[:_LISTED])


_Make = Callable[[float, float], Finding]


def _along(
    problem: Problem, calibrated: Fit, noise: NoiseModel, residual: Array, family: _Family
) -> tuple[float, float, _Make]:
    columns = _columns(problem, noise, family)
    basis = np.linalg.qr(calibrated.jacobian)[0] if family.kind != "offset" else np.zeros((residual.size, 0))
    columns -= basis @ (basis.T @ columns)
    axes, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    axes = axes[:, sizes > 1e-6 * sizes.max()]
    amounts = axes.T @ residual
    explained = axes @ amounts
    p_value = float(stats.chi2.sf(float(amounts @ amounts), axes.shape[1]))
    share = _share(float(amounts @ amounts), residual)
    strongest = _strongest(problem, explained)
    return p_value, share, _finding(problem, strongest, family.kind, family.sentence)


def _in_band(problem: Problem, residual: Array, low: float, high: float) -> tuple[float, float, _Make]:
    frequency = np.concatenate(
        [np.concatenate([s.frequency[:1], s.frequency[1:], s.frequency[1:]]) for s in problem.segments]
    )
    inside = (frequency >= low) & (frequency < high)
    energy = float((residual[inside] ** 2).sum())
    p_value = float(stats.chi2.sf(energy, max(int(inside.sum()), 1)))
    share = _share(max(energy - float(inside.sum()), 0.0), residual)
    sentence = f"the residual exceeds the noise between {low:g} and {high:g} Hz"
    strongest = _strongest(problem, np.where(inside, residual, 0.0))
    return p_value, share, _finding(problem, strongest, "frequency_band", sentence)


def _share(energy: float, residual: Array) -> float:
    excess = max(float(residual @ residual) - residual.size, energy, 1e-300)
    return float(min(energy / excess, 1.0))


def _strongest(problem: Problem, rows: Array) -> int:
    power = np.bincount(problem.owners, rows**2, minlength=len(problem.segments))
    return problem.segments[int(np.argmax(power))].test


def _finding(problem: Problem, test: int, kind: str, sentence: str) -> _Make:
    block = problem.block

    def make(p_value: float, share: float) -> Finding:
        return Finding(
            block=str(block.block),
            channel=str(block.channel),
            test=block.tests[test].file,
            kind=kind,
            detail=f"In {block.channel} of the {block.block} {sentence}, most in {block.tests[test].file}.",
            share_of_residual=share,
            p_value=max(p_value, _LEAST_PROBABILITY),
        )

    return make


def _columns(problem: Problem, noise: NoiseModel, family: _Family) -> Array:
    """Whiten what a family would add to the channel, shape (rows, columns)."""
    block = problem.block
    columns: dict[int, tuple[Array, ...]] = {}
    for test in {segment.test for segment in problem.segments}:
        columns[test] = family.columns(*_scaled(block.motions[test], block.scales.duration, problem))
    parts = [
        np.stack(
            [
                real_parts(segment.spectrum(column), segment.density(noise))
                for column in columns[segment.test]
            ],
            axis=1,
        )
        for segment in problem.segments
    ]
    return np.concatenate(parts)


def _scaled(motion: Motion3, duration: float, problem: Problem) -> tuple[Array, Array, Array, Array]:
    """Time, displacement, velocity and acceleration over their scales."""
    scales = problem.block.scales
    time: Array = np.arange(motion.values.shape[1], dtype=np.float64) * (motion.step / duration)
    x, v, a = motion.values / [[scales.displacement], [scales.velocity], [scales.acceleration]]
    return time, x, v, a
