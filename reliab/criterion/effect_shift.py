"""What effects in a test do to the criterion of its actuator."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours

THRESHOLD, CONFIDENCE = 0.05, 0.95
"""Error on the boundary [-] and share of the motions for which the criterion holds, as in the paper."""

_COARSE = 1.0  # amplitude step: eleven points a contour are enough for a ratio
_PHASE_STEP = 0.08  # rad; errors of the step cancel in the ratio


def criterion_shift(test: HybridTest, shaking: Sequence[Excitation]) -> dict[str, float]:
    """Divide the criterion of a model by that of the same model without its effects.

    Returns the ratios of the ellipse parameters a and b [-], zero where effects alone exceed the error.

    The criterion is the paper's, the 5 % quantile of a lognormal distribution of a and of b over the ground
    motions. Both criteria are those of an actuator's gain and delay, see
    :class:`reliab.simulation.effect_loop.EffectLoop`: an effect of the specimen or of the shaking belongs to
    the behaviour under test and may make a test more tolerant; any other effect uses part of the tolerable
    error, so that less is left for the actuator.

    >>> from reliab.effects.registry import find_effect
    >>> from reliab.structures.structure import Structure
    >>> lag = find_effect("first_order_lag")(time_constant_s=0.0005)
    >>> test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.02), effects=(lag,))
    >>> record = np.sin(2.0 * np.pi * np.arange(0.0, 10.0, 0.01))
    >>> shift = criterion_shift(test, [Excitation(acceleration=record, time_step=0.01)])
    >>> shift["b"] < shift["a"] <= 1.0
    True
    """
    if not shaking:
        raise InputError("A criterion needs ground motions", value="none", remedy="Give at least one")
    pairs = [
        (_axes(test, excitation), _axes(replace(test, effects=()), excitation)) for excitation in shaking
    ]
    sound = np.array([pair for pair in pairs if np.isfinite(pair).all()]).reshape(-1, 2, 2)
    if sound.size == 0:
        raise InputError(
            "The boundary of equal error must be an ellipse under at least one ground motion",
            value=f"none of {len(pairs)}",
            remedy="Choose a smaller error threshold",
        )
    ratios = _criterion(sound[:, 0]) / _criterion(sound[:, 1])
    return dict(zip("ab", ratios.tolist(), strict=True))


def _axes(test: HybridTest, excitation: Excitation) -> tuple[float, float]:
    """Ellipse parameters a and b under a motion; NaN where the boundary is no ellipse."""
    loop = EffectLoop(excitation=excitation, test=test, phase_step=_PHASE_STEP)
    (contour,) = motion_contours(loop, (THRESHOLD,), amplitude_step=_COARSE)
    ellipse = Ellipse.fit(contour)
    return (ellipse.a, ellipse.b) if ellipse.n == 0 or min(ellipse.a, ellipse.b) > 0.0 else (np.nan, np.nan)


def _criterion(axes: Array) -> Array:
    """Quantiles of a and b, shape (2,), of their values over the motions, shape (motions, 2)."""
    if not axes.all():
        return np.zeros(2)
    logarithms = np.log(axes)
    return np.asarray(np.exp(logarithms.mean(axis=0) + ndtri(1.0 - CONFIDENCE) * logarithms.std(axis=0)))
