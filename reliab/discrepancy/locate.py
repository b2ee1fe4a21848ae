"""Where a calibrated model fails: the motion quantities with which its residual is correlated.

The whitened residual is projected on the signals that a family of causes would add to the channel (columns of
the motion, whitened alike, the calibration's own directions taken out). The family that explains most comes
first; what it explains is taken off before the next is looked for, so that shares add up. Under noise alone
the projected energy is χ²-distributed with as many degrees of freedom as the family has columns; Bonferroni's
factor corrects for the number of families.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import special

from reliab.core.arrays import Array
from reliab.core.plain_values import PlainResult
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import MILLI
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem, real_parts
from reliab.signals.noise import NoiseModel

_SIGNIFICANT = 1e-4
_LEAST_SHARE = 0.02  # of the residual's power above the noise, of a finding
LEAST_PROBABILITY = 1e-16
"""Smaller ones mean nothing: no noise is normal so far out."""
_MIDDLE = (0.1, 0.9)  # quantiles of the power between which a finding lies in time and frequency
_BEGIN = 0.05  # quantile of its power in displacement and velocity at which it begins
_INDEPENDENT = 1e-6  # of the largest column: what is left of one that others span
_REMAINDER_KIND = "frequency_band"  # kind of the finding of what no family explains


@dataclass(frozen=True, kw_only=True)
class Finding(PlainResult):
    """A place where the calibrated model fails."""

    block: str  # block, channel: Where in the loop, and in which column
    channel: str
    test: str  # File of the test in which it shows most
    kind: str  # What the residual depends on
    detail: str  # One sentence
    share_of_residual: float  # Part of the residual's power above the noise that it accounts for, in [0, 1]
    p_value: float  # Probability of as much under noise alone, corrected for the number of trials made
    band_hz: tuple[float, float]  # Frequencies between which it lies
    time_s: tuple[float, float]  # Times in that test between which it lies
    displacement_m: float  # Size of the displacement at which it begins
    velocity_m_per_s: float  # Size of the velocity at which it begins

    @property
    def begin(self) -> str:
        """Displacement and velocity at which it begins, as they are shown."""
        size, speed = (
            significant(MILLI * value, 2) for value in (self.displacement_m, self.velocity_m_per_s)
        )
        return f"{size} mm, {speed} mm/s"

    @property
    def chance(self) -> str:
        """Probability of as much under noise alone, as it is shown."""
        return f"{'< ' if self.p_value <= LEAST_PROBABILITY else ''}{self.p_value:.0e}"


_Columns = Callable[[Array, Array, Array, Array], tuple[Array, ...]]

_FAMILIES: dict[str, tuple[str, _Columns]] = {
    "time": (
        "the residual changes in the course of the tests, whatever the motion",
        lambda t, x, v, _a: (t, t * x, t * v),
    ),
    "velocity_reversal": (
        "the residual jumps when the velocity changes sign",
        lambda _t, _x, v, _a: (np.tanh(v / 0.01),),
    ),
    "velocity": (
        "the residual opposes the velocity and dissipates energy",
        lambda _t, _x, v, _a: (v, v * np.abs(v)),
    ),
    "direction": (
        "the residual differs between both directions of motion",
        lambda _t, _x, v, _a: (np.abs(v), v**2),
    ),
    "amplitude": (
        "the residual grows out of proportion with the displacement",
        lambda _t, x, _v, _a: (x**2, x**3, x * np.abs(x)),
    ),
    "acceleration": ("the residual is correlated with the acceleration", lambda _t, _x, _v, a: (a,)),
    "state_plane": (
        "the residual depends on displacement and velocity together",
        lambda _t, x, v, _a: (x * v, x**2 * v, x * v**2, np.abs(x) * np.tanh(v / 0.01)),
    ),
}


def locate(problem: Problem, calibrated_model: Fit, noise: NoiseModel) -> tuple[Finding, ...]:
    """Find the motion quantities with which the residual of the calibrated model is correlated.

    Their shares add up to one with that of the rest, which comes last where it is no noise.
    """
    residual = problem.whiten(calibrated_model.space, calibrated_model.coordinates, noise)
    excess = max(float(residual @ residual) - residual.size, 1e-300)
    basis, remainder = np.linalg.qr(calibrated_model.jacobian)[0], residual
    families = {kind: _columns(problem, noise, columns) for kind, (_, columns) in _FAMILIES.items()}
    parts: list[tuple[Array, str, str, float, float]] = []
    while families:
        projections = {kind: _project(remainder, basis, columns) for kind, columns in families.items()}
        kind = max(projections, key=lambda kind: float(np.sum(projections[kind][0] ** 2)))
        rows, axes = projections[kind]
        energy = float(rows @ rows)
        p_value = min(1.0, len(_FAMILIES) * float(special.chdtrc(axes.shape[1], energy)))
        if p_value >= _SIGNIFICANT or energy < _LEAST_SHARE * excess:
            break
        parts.append((rows, kind, _FAMILIES[kind][0], energy / excess, p_value))
        basis, remainder = np.concatenate([basis, axes], axis=1), remainder - rows
        del families[kind]
    rest_energy = float(remainder @ remainder)
    p_value = float(special.chdtrc(remainder.size, rest_energy))
    if rest_energy - remainder.size > _LEAST_SHARE * excess and p_value < _SIGNIFICANT:
        parts.append(
            (remainder, _REMAINDER_KIND, "no quantity of the motion explains the rest", 1.0, p_value)
        )
    share_sum = 0.0
    findings = []
    for rows, kind, sentence, upper_share, p in parts:
        share = min(upper_share, 1.0 - share_sum)
        share_sum += share
        if share < _LEAST_SHARE:
            break
        findings.append(_finding(problem, noise, rows, kind, sentence, share, max(p, LEAST_PROBABILITY)))
    return tuple(findings)


def _project(residual: Array, basis: Array, columns: Array) -> tuple[Array, Array]:
    """Project a residual on columns without what a basis spans; the orthonormal axes of these, too."""
    free = columns - basis @ (basis.T @ columns)
    axes, sizes, _ = np.linalg.svd(free, full_matrices=False)
    axes = axes[:, sizes > _INDEPENDENT * np.linalg.norm(columns, axis=0).max()]
    return axes @ (axes.T @ residual), axes


def _finding(
    problem: Problem, noise: NoiseModel, rows: Array, kind: str, sentence: str, share: float, p_value: float
) -> Finding:
    """Say in which test, band, time and motion a part of the residual lies."""
    block, owners = problem.block, problem.owners
    power = np.bincount(owners, rows**2, minlength=len(problem.segments))
    test = problem.segments[int(np.argmax(power))].test
    segments = [(place, s) for place, s in enumerate(problem.segments) if s.test == test]
    frequency = np.concatenate([np.concatenate([s.frequency, s.frequency[1:]]) for _, s in segments])
    is_in_test = np.isin(owners, [place for place, _ in segments])
    low, high = _quantiles(frequency, rows[is_in_test] ** 2, _MIDDLE)
    high = max(high, float(segments[0][1].frequency[1]))
    samples = np.concatenate([np.arange(s.begin, s.end) for _, s in segments])
    values = np.concatenate([s.history(rows[owners == place], noise) for place, s in segments])
    first, last = _quantiles(samples / block.rate, values**2, _MIDDLE)
    motion = block.motions[test].values[:, samples]
    size, speed = (_quantiles(np.abs(motion[k] - motion[k].mean()), values**2, (_BEGIN,))[0] for k in (0, 1))
    place = (
        f"most in {block.tests[test].file} from {significant(first)} to {significant(last)} s, at "
        f"{significant(low, 2)} to {significant(high, 2)} Hz, from {significant(MILLI * size, 2)} mm and "
        f"{significant(MILLI * speed, 2)} mm/s on"
    )
    return Finding(
        block=str(block.block),
        channel=str(block.channel),
        test=block.tests[test].file,
        kind=kind,
        detail=f"In {block.channel} of the {block.block} {sentence}: {place}.",
        share_of_residual=share,
        p_value=p_value,
        band_hz=(low, high),
        time_s=(first, last),
        displacement_m=size,
        velocity_m_per_s=speed,
    )


def _quantiles(values: Array, weights: Array, shares: tuple[float, ...]) -> list[float]:
    """Quantiles of values by their weights."""
    order = np.argsort(values)
    cumulative = np.cumsum(weights[order])
    places = np.searchsorted(cumulative, np.array(shares) * cumulative[-1])
    return [float(value) for value in values[order][np.minimum(places, values.size - 1)]]


def _columns(problem: Problem, noise: NoiseModel, family: _Columns) -> Array:
    """Whiten what a family would add to the channel, shape (rows, columns)."""
    block, scales = problem.block, problem.block.scales
    sizes = [[scales.displacement], [scales.velocity], [scales.acceleration]]
    columns: dict[int, tuple[Array, ...]] = {}
    for test in {segment.test for segment in problem.segments}:
        motion = block.motions[test]
        time = np.arange(motion.values.shape[1], dtype=np.float64) * (motion.step / scales.duration)
        columns[test] = family(time, *(motion.values / sizes))
    parts = []
    for segment in problem.segments:
        root = np.sqrt(segment.density(noise))
        rows = [real_parts(segment.spectrum(column), root) for column in columns[segment.test]]
        parts.append(np.stack(rows, axis=1))
    return np.concatenate(parts)
