"""Check for a nonlinear specimen: force that no spring, dashpot or mass explains.

The recorded force is explained twice, first by displacement, velocity and acceleration of the measured
motion, a constant and a drift, then with additional shapes that another specimen would show: powers of
displacement and velocity, friction, elastic–plastic springs in series (Jenkins elements, whose sums
approximate any rate-independent hysteresis: Iwan 1966, J. Appl. Mech. 33), and masses that swing on springs
of their own. Each explanation is fitted on one half of the test, in short blocks, and judged on the other
half; of all kinds of shapes, used singly and together, the best fit is taken. Noise, a late sensor or a late
force are not predicted better by such shapes; a nonlinear specimen is.
"""

from dataclasses import dataclass
from itertools import chain

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.signals.spectra import convolve_valid

_SAMPLES_PER_PERIOD = 48.0  # samples in a period
_BAND = 10.0  # natural frequencies that are kept
_BLOCK = 0.4  # periods
_RIDGE = 1e-5  # of the mean square of a shape: what the fitted half cannot tell stays small
_YIELDS = (0.05, 0.15, 0.3, 0.5, 0.75)  # of the largest displacement, where a Jenkins element slips
_TURNS_OVER = 0.02  # of the largest velocity, over which friction changes sign
_TUNINGS = tuple(0.5 * 1.12**k for k in range(20))  # frequencies of swinging masses over the structure's
_DAMPING_RATIO = 0.05  # of these
_GAIN = 0.25  # share of the residual that must vanish on the other half
_LEAST = 0.004  # share of the force below which nothing is called nonlinear
# The same of masses that swing, whose motion is that of the specimen with less noise: it explains a little
_LEAST_OF_MASSES = 0.02
FEWEST_PERIODS = 4.0
"""Periods of the structure over which a specimen is examined at least."""


@dataclass(frozen=True, kw_only=True)
class SpecimenCheck:
    """Whether the force shows a nonlinear specimen."""

    nonlinear: bool  # Whether it does
    share: float  # RMS of the force that only nonlinear shapes predict, over the RMS of the force [-]
    # Share of the linear specimen's squared residual that they remove on data that were not fitted [-]
    gain: float


def examine_specimen(
    measured_displacement: Array, force: Array, time_step: float, frequency: float
) -> SpecimenCheck:
    """Compare recorded forces with those of a linear specimen, and answer for the most nonlinear one.

    `measured_displacement` [m] and `force` [N], shape (n,), or (p, n) of several actuators, each of which may
    move all; `time_step` [s]; `frequency` [Hz].

    >>> time = np.arange(0.0, 30.0, 0.005)
    >>> moved = np.sin(6.0 * time) * np.sin(0.1 * time)
    >>> examine_specimen(moved, 40.0 * moved, 0.005, 1.0).nonlinear
    False
    >>> examine_specimen(moved, 40.0 * moved + 6.0 * moved**3, 0.005, 1.0).nonlinear
    True
    """
    if measured_displacement.shape != force.shape:
        raise InputError(
            "Displacement and force must have the same length",
            value=f"{measured_displacement.size}, {force.size}",
        )
    periods = measured_displacement.shape[-1] * time_step * frequency
    if periods < FEWEST_PERIODS:
        raise InputError(
            f"A specimen is examined over at least {FEWEST_PERIODS:.0f} periods",
            value=significant(periods, 2),
            remedy="Give the whole test",
        )
    low_pass = _low_pass(frequency, time_step)
    stride = max(int(1.0 / (_SAMPLES_PER_PERIOD * frequency * time_step)), 1)

    def smooth(history: Array) -> Array:
        return convolve_valid(history, low_pass)[::stride]

    rows = np.atleast_2d(measured_displacement)
    velocities = np.gradient(rows, time_step, axis=1)
    accelerations = np.gradient(velocities, time_step, axis=1)
    histories = (*rows, *velocities, *accelerations)
    linear = [smooth(history) for history in histories]
    size = linear[0].size
    linear += [np.ones(size), np.linspace(-1.0, 1.0, size)]  # zero and drift of the load cell
    kinds = zip(*map(_shapes, rows, velocities), strict=True)
    groups = [[smooth(shape) for shape in chain(*kind)] for kind in kinds]
    targets = [smooth(row) for row in np.atleast_2d(force)]
    checks = [_compare(linear, groups, target, _LEAST) for target in targets]
    if len(rows) == 1:
        masses = [smooth(row) for row in swinging_masses(accelerations[0], time_step, frequency)]
        checks.append(_compare(linear, [masses], targets[0], _LEAST_OF_MASSES))
    return max(checks, key=lambda check: (check.nonlinear, check.share))


def _compare(linear: list[Array], groups: list[list[Array]], target: Array, least: float) -> SpecimenCheck:
    """Compare what linear shapes explain of a force with what they and groups of others do.

    `least`: share of the force from which on it matters [-].
    """
    block = max(int(_BLOCK * _SAMPLES_PER_PERIOD), 1)
    half = (np.arange(target.size) // block) % 2 == 0
    plain = _cross_validation_residual(np.stack(linear), target, half)
    rich = min(
        _cross_validation_residual(np.stack(linear + shapes), target, half)
        for shapes in [*groups, list(chain(*groups))]
    )
    power = float(target @ target)
    if not power > 0.0:
        return SpecimenCheck(nonlinear=False, share=0.0, gain=0.0)
    explained_share = max(plain - rich, 0.0)
    gain = explained_share / plain if plain > 0.0 else 0.0
    share = float(np.sqrt(explained_share / power))
    return SpecimenCheck(nonlinear=bool(gain > _GAIN and share > least), share=share, gain=gain)


def _low_pass(frequency: float, step: float) -> Array:
    reach = max(round(1.0 / (_BAND * frequency * step)), 1)
    window = np.hanning(2 * reach + 3)[1:-1]
    return np.asarray(window / window.sum())


def _shapes(measured_displacement: Array, velocity: Array) -> list[list[Array]]:
    """Shapes of elastic, dissipating and yielding specimens."""
    x = measured_displacement / max(float(np.abs(measured_displacement).max()), np.finfo(float).tiny)
    v = velocity / max(float(np.abs(velocity).max()), np.finfo(float).tiny)
    return [
        [x * np.abs(x), x**3, x**2],
        [v * np.abs(v), x**2 * v, np.tanh(v / _TURNS_OVER)],
        [slider_elongation(x, limit) for limit in _YIELDS],
    ]


def swinging_masses(acceleration: Array, time_step: float, frequency: float) -> list[Array]:
    """Accelerations [m/s²] of masses on springs and dashpots of their own, tuned about a frequency [Hz]."""
    answers = []
    for tuning in _TUNINGS:
        rate = 2.0 * np.pi * tuning * frequency
        passed = [2.0 * _DAMPING_RATIO * rate, rate**2]
        coefficients = scipy.signal.bilinear(passed, [1.0, *passed], 1.0 / time_step)
        answers.append(scipy.signal.lfilter(*coefficients, acceleration))
    return answers


@compiled
def slider_elongation(displacement: Array, limit: float) -> Array:
    """Elastic elongation of a spring in series with a slider that gives way at `limit`, shape (n,)."""
    answer = np.empty_like(displacement)
    elongation = 0.0
    for i in range(displacement.size):
        increment = displacement[i] - displacement[i - 1] if i > 0 else displacement[0]
        elongation = min(max(elongation + increment, -limit), limit)
        answer[i] = elongation
    return answer


def _cross_validation_residual(rows: Array, target: Array, half: NDArray[np.bool_]) -> float:
    """Sum of squared residuals on each half with the coefficients fitted to the other half."""
    scale = np.maximum(np.sqrt((rows**2).mean(axis=1, keepdims=True)), np.finfo(float).tiny)
    scaled_rows = rows / scale
    total = 0.0
    for fitted_half in (half, ~half):
        training, validation = scaled_rows[:, fitted_half], scaled_rows[:, ~fitted_half]
        normal = training @ training.T + _RIDGE * fitted_half.sum() * np.eye(scaled_rows.shape[0])
        values = np.linalg.solve(normal, training @ target[fitted_half])
        residual = target[~fitted_half] - values @ validation
        total += float(residual @ residual)
    return total
