"""A specimen of which nobody recorded the force: the error if it yielded, beside that of a linear one.

Command and measured displacement do not show whether a specimen yielded. A share of the draws of the error
therefore has specimens that yield: stiff as stated up to the largest displacement over a ductility, softer by
any share beyond, with a sharp or a round corner. The test of each is simulated with a perfect actuator under
the demand that it implies, and all that is not known of channels and structure is drawn as well.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from reliab.assessment.rebuilt_error.nonlinear_reference import sweep_models
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.spread import HALF_WIDTH, Spread
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.effects import Hysteresis
from reliab.simulation.hybrid_test import HybridTest
from reliab.structures import Specimen, Structure
from reliab.vocabulary import Metric

DUCTILITIES: Final = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
"""Largest displacement over the yield displacement, from the smallest that is tried."""

_HARDENING = 0.03  # stiffness after yielding over that before
_SHARPNESS = 8.0  # exponent of the hysteresis
_DRAWS = 64
_MOST_HARDENING, _ROUNDEST, _SHARPEST = 0.1, 1.0, 16.0


def yielding_model(
    structure: Structure, displacement: float, hardening: float = _HARDENING, sharpness: float = _SHARPNESS
) -> HybridTest:
    """Test with a perfect actuator of a specimen that yields at a displacement [m], per unit mass."""
    stiffness = structure.experimental_fraction * structure.circular_frequency**2
    bilinear = Hysteresis(
        force_n=(1.0 - hardening) * stiffness * displacement,
        displacement_m=displacement,
        exponent=sharpness,
        lost_share=1.0,
    )
    return HybridTest(structure=structure, specimen=Specimen(stiffness=stiffness), effects=(bilinear,))


def errors_if_yielded(rebuilt: RebuiltError, structure: Structure) -> Spread:
    """Draw the error with specimens that yield to ductilities of one to six, each as likely as another.

    >>> from reliab.assessment.rebuilt_error import rebuild
    >>> time = np.arange(0.0, 30.0, 1.0 / 128.0)
    >>> command = 0.01 * np.sin(6.0 * time) * np.sin(0.1 * time)
    >>> structure = Structure(frequency=1.0, damping_ratio=0.05)
    >>> error = rebuild(command, 0.98 * command, 1.0 / 128.0, structure)
    >>> errors_if_yielded(error, structure).rms.size
    64
    """
    differences = rebuilt.differences[-_DRAWS:]
    generator = np.random.default_rng(rebuilt.seed)
    peak = float(np.abs(rebuilt.histories.measured).max())
    size = len(differences)
    ductility = DUCTILITIES[-1] ** generator.permutation((np.arange(size) + 0.5) / size)
    hardening = _MOST_HARDENING * generator.uniform(size=size)
    sharpness = _ROUNDEST * (_SHARPEST / _ROUNDEST) ** generator.uniform(size=size)
    models = [
        yielding_model(structure, peak / largest, harder, sharp)
        for largest, harder, sharp in zip(ductility, hardening, sharpness, strict=True)
    ]
    unknown = replace(rebuilt.unknown, own_frequency=None)  # which was learned of a linear specimen
    return sweep_models(models, rebuilt.histories, {}, unknown, differences, rebuilt.every, seed=rebuilt.seed)


def widened(rebuilt: RebuiltError, if_yielded: Spread, share: float) -> RebuiltError:
    """Give specimens that yield a share of the probability; the value stays that of a linear specimen."""
    both = rebuilt.draws.together(if_yielded, share)
    half = HALF_WIDTH * both.deviation
    return replace(
        rebuilt,
        draws=both,
        rms=both.estimate(Metric.RMS, rebuilt.rms.value),
        mte=both.estimate(Metric.MTE, rebuilt.mte.value),
        low=both.mean - half,
        high=both.mean + half,
    )


def widening_of_yielding(both: Spread, if_linear: Spread, share: float, metric: Metric) -> Widening:
    """State what specimens that may have yielded add to the interval."""
    width, without = (float(np.diff(draws.interval(metric))[0]) for draws in (both, if_linear))
    difference = abs(both.average(metric) - if_linear.average(metric)) / share  # means of the two kinds
    return Widening(
        name="yielding",
        deviation=0.0,
        contribution=difference * float(np.sqrt(share * (1.0 - share))),
        width=width,
        width_without=without,
        deviation_for_half=None,
    )
