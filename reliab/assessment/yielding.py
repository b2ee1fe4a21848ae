"""A specimen of which nobody recorded the force: the error if it yielded or hardened.

A specimen that yields is stiff as stated up to the largest displacement over a ductility, and softer beyond.
The error of each follows from the test's own displacements.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from reliab.assessment.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.yielding_sweep import (
    errors_with_specimens,
    yielding_specimen,
)
from reliab.core.vocabulary import Metric
from reliab.effects.cubic_stiffness import CubicStiffness
from reliab.effects.effect import SteppedEffect

DUCTILITIES: Final = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
"""Largest displacement over the yield displacement, from the smallest that is tried."""

HARDENINGS: Final = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
"""Force beyond the linear one at the largest displacement over that, from the smallest that is tried."""

_HARDENING = 0.03  # stiffness after yielding over that before
_SHARPNESS = 8.0  # exponent of the hysteresis


def errors_of_ductilities(
    rebuilt: RebuiltError, metric: Metric, ductilities: Sequence[float] = DUCTILITIES
) -> dict[float, float]:
    """Errors if the specimen yielded to each ductility, with all else as stated."""
    peak = _largest(_thin_histories(rebuilt))
    specimens = [yielded(peak, ductility) for ductility in ductilities]
    return dict(zip(ductilities, _errors(rebuilt, metric, specimens), strict=True))


def errors_of_hardenings(
    rebuilt: RebuiltError, metric: Metric, hardenings: Sequence[float] = HARDENINGS
) -> dict[float, float]:
    """Errors if the specimen hardened with the cube of its displacement, by each share at its largest."""
    peak = _largest(_thin_histories(rebuilt))
    specimens = [hardening_specimen(peak, hardening) for hardening in hardenings]
    return dict(zip(hardenings, _errors(rebuilt, metric, specimens), strict=True))


def yielded(peak: float, ductility: float) -> SteppedEffect:
    """Return a specimen that yields at a largest displacement [m] over a ductility."""
    return yielding_specimen(peak / ductility, _HARDENING, _SHARPNESS)


def hardening_specimen(peak: float, hardening: float) -> SteppedEffect:
    """Return a specimen whose force at a largest displacement [m] exceeds the linear one by a share of it."""
    return CubicStiffness(cubic_n_per_m3=hardening / peak**2)


def largest_displacement(rebuilt: RebuiltError) -> float:
    """Largest measured displacement of a test [m]."""
    return _largest(_thin_histories(rebuilt))


def _thin_histories(rebuilt: RebuiltError) -> Histories:
    return rebuilt.histories.thin(samples_in_step_of_structure(rebuilt.structure, rebuilt.time_step))


def _largest(histories: Histories) -> float:
    """Largest measured displacement [m]; 1 m of a specimen that stands still, which never yields."""
    return float(np.abs(histories.measured).max()) or 1.0


def _errors(rebuilt: RebuiltError, metric: Metric, specimens: Sequence[SteppedEffect]) -> list[float]:
    square, largest, ideal = errors_with_specimens(specimens, _thin_histories(rebuilt), rebuilt.structure).T
    errors = (np.sqrt(square) if metric is Metric.RMS else largest) / ideal
    return [float(error) for error in errors]
