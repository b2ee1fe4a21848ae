"""A specimen of which nobody recorded the force: the error if it yielded, compared with that of a linear one.

Command and measured displacement do not show whether a specimen yielded. A share of the draws of the error
therefore has specimens that yield: stiff as stated up to the largest displacement over a ductility, softer by
any share beyond, with a sharp or a round corner. The error of each follows from the test's own displacements,
and all that is not known of channels and structure is drawn as well.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from reliab.assessment.rebuilt_error.interval import Histories
from reliab.assessment.rebuilt_error.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import Estimate, Spread
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.assessment.rebuilt_error.yielding_sweep import (
    YieldingDraws,
    errors_with_specimens,
    yielding_specimen,
)
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.effects.cubic_stiffness import CubicStiffness
from reliab.effects.effect import SteppedEffect
from reliab.effects.hysteresis import Hysteresis
from reliab.structures.partition import Partition

DUCTILITIES: Final = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
"""Largest displacement over the yield displacement, from the smallest that is tried."""

HARDENINGS: Final = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
"""Force beyond the linear one at the largest displacement over that, from the smallest that is tried."""

_HARDENING = 0.03  # stiffness after yielding over that before
_SHARPNESS = 8.0  # exponent of the hysteresis
_DRAWS = 64
_MOST_HARDENING, _ROUNDEST, _SHARPEST = 0.1, 1.0, 16.0


def errors_of_ductilities(
    rebuilt: RebuiltError, metric: Metric, ductilities: Sequence[float] = DUCTILITIES
) -> dict[float, float]:
    """Errors if the specimen yielded to each ductility, with all else as stated."""
    peak = _largest(_thinned(rebuilt))
    specimens = [yielding_specimen(peak / ductility, _HARDENING, _SHARPNESS) for ductility in ductilities]
    return dict(zip(ductilities, _errors(rebuilt, metric, specimens), strict=True))


def errors_of_hardenings(
    rebuilt: RebuiltError, metric: Metric, hardenings: Sequence[float] = HARDENINGS
) -> dict[float, float]:
    """Errors if the specimen hardened with the cube of its displacement, by each share at its largest."""
    peak = _largest(_thinned(rebuilt))
    specimens = [CubicStiffness(cubic_n_per_m3=hardening / peak**2) for hardening in hardenings]
    return dict(zip(hardenings, _errors(rebuilt, metric, specimens), strict=True))


def _thinned(rebuilt: RebuiltError) -> Histories:
    return rebuilt.histories.thinned(samples_in_step_of_structure(rebuilt.structure, rebuilt.time_step))


def _largest(histories: Histories) -> float:
    """Largest measured displacement [m]; 1 m of a specimen that stands still, which never yields."""
    return float(np.abs(histories.measured).max()) or 1.0


def _errors(rebuilt: RebuiltError, metric: Metric, specimens: Sequence[SteppedEffect]) -> list[float]:
    square, largest, ideal = errors_with_specimens(specimens, _thinned(rebuilt), rebuilt.structure).T
    errors = (np.sqrt(square) if metric is Metric.RMS else largest) / ideal
    return [float(error) for error in errors]


def draw_yielding(rebuilt: RebuiltError) -> Spread:
    """Draw the error with specimens that yield to ductilities of one to six, each as likely as another.

    >>> from reliab.assessment.rebuilt_error.rebuild import rebuild
    >>> from reliab.structures.structure import Structure
    >>> time = np.arange(0.0, 30.0, 1.0 / 128.0)
    >>> command = 0.01 * np.sin(6.0 * time) * np.sin(0.1 * time)
    >>> structure = Structure(frequency=1.0, damping_ratio=0.05)
    >>> draw_yielding(rebuild(command, 0.98 * command, 1.0 / 128.0, structure)).rms.size
    64
    """
    return _draws(rebuilt).errors()


def exact_if_yielding(rebuilt: RebuiltError) -> Iterator[tuple[Partition, Array]]:
    """Structures and exact responses at the interface [m] of these draws, each shape (1, m)."""
    return _draws(rebuilt).exact()


def _draws(rebuilt: RebuiltError) -> YieldingDraws:
    """Draws of a test, whose frequency was learned of a linear specimen."""
    return YieldingDraws(
        specimens=_drawn_specimens(rebuilt),
        histories=rebuilt.histories,
        structure=rebuilt.structure,
        unknown=replace(rebuilt.unknown, own_frequency=None),
        differences=rebuilt.differences[-_DRAWS:],
        every=rebuilt.every,
        seed=rebuilt.seed,
    )


def _drawn_specimens(rebuilt: RebuiltError) -> list[Hysteresis]:
    """Draw specimens that yield."""
    size = len(rebuilt.differences[-_DRAWS:])
    generator = np.random.default_rng(rebuilt.seed)
    peak = _largest(rebuilt.histories)
    ductility = DUCTILITIES[-1] ** generator.permutation((np.arange(size) + 0.5) / size)
    hardening = _MOST_HARDENING * generator.uniform(size=size)
    sharpness = _ROUNDEST * (_SHARPEST / _ROUNDEST) ** generator.uniform(size=size)
    return [
        yielding_specimen(peak / largest, harder, sharp)
        for largest, harder, sharp in zip(ductility, hardening, sharpness, strict=True)
    ]


def widened(rebuilt: RebuiltError, if_yielded: Spread, share: float) -> RebuiltError:
    """Give specimens that yield a share of the probability; the value stays that of a linear specimen.

    The interval holds that of a linear specimen as well: of a specimen that yields or not, as of one that
    stayed linear, nine of ten errors lie in it.
    """
    both = rebuilt.draws.together(if_yielded, share)

    def estimate(metric: Metric) -> Estimate:
        linear = rebuilt.estimate(metric)
        return linear.with_ends_of(both.estimate(metric, linear.value))

    return replace(
        rebuilt,
        draws=both,
        rms=estimate(Metric.RMS),
        mte=estimate(Metric.MTE),
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
