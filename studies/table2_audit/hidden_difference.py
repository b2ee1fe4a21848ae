"""What may have been different when a published row was computed: time step, duration, component.

Another scale or unit of the record would change nothing, because the error of a test is relative.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.significant_digits import significant
from reliab.motions.motion import Motion
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours

Pair = tuple[float, float]

NO_ELLIPSE: Pair = (np.nan, np.nan)
_LONGEST, _POINTS = 4.0, 33  # durations are tried from a quarter to four times the record's own
_LEAST_CHANGE = 0.1
_SAME = 0.02


def simulate_ellipse(
    acceleration: Array, time_step: float, structure: Structure, end: float = -1.0
) -> Ellipse:
    """Ellipse of 5 % RMS^R of a record.

    `acceleration`: ground acceleration [m/s²], shape (n,); `time_step`: step between samples [s]; `end`: end
    of the window over which the error is computed [s], the record's own by default. Result: a [-], b [ms²]
    and the fitting error of equation (10) [ms⁴]; a or b is not positive where the boundary is no ellipse.
    """
    excitation = Excitation(acceleration=acceleration, time_step=time_step, window=(0.0, end))
    (contour,) = motion_contours(Loop(excitation=excitation, structure=structure))
    return Ellipse.fit(contour)


def logarithms(ellipse: Ellipse) -> Pair:
    """Logarithms of a and b [ms²]; NaN where the boundary is no ellipse."""
    if min(ellipse.a, ellipse.b) <= 0.0:
        return NO_ELLIPSE
    return float(np.log(ellipse.a)), float(np.log(ellipse.b))


@dataclass(frozen=True, kw_only=True, eq=False)
class Difference:
    """A way in which a row may have been computed differently, with its choices.

    `pairs`: ln a and ln b that it leads to, shape (choices, 2); NaN where there is no ellipse.
    """

    kind: str
    details: tuple[str, ...]
    pairs: Array

    def distances(self, printed: Array) -> Array:
        """Larger of the differences of ln a and ln b to a printed pair, shape (choices,).

        Both must be explained; a choice without an ellipse is infinitely far.
        """
        return np.asarray(np.nan_to_num(np.abs(self.pairs - printed).max(axis=1), nan=np.inf))


def differences(
    motion: Motion, siblings: Sequence[Motion], steps: Sequence[float], structure: Structure
) -> tuple[Difference, ...]:
    """Work out what every difference would have led to.

    `steps`: time steps that occur in the suite [s].
    """
    other_steps = [step for step in steps if abs(step / motion.time_step - 1.0) > _SAME]
    time_steps = Difference(
        kind="time step",
        details=tuple(f"{step:.4g} s instead of {motion.time_step:.4g} s" for step in other_steps),
        pairs=_table([simulate_ellipse(motion.acceleration, step, structure) for step in other_steps]),
    )
    components = Difference(
        kind="component",
        details=tuple(f"{sibling.name} instead" for sibling in siblings),
        pairs=_table(
            [simulate_ellipse(sibling.acceleration, sibling.time_step, structure) for sibling in siblings]
        ),
    )
    kinds = (time_steps, _durations(motion, structure), components)
    return tuple(difference for difference in kinds if difference.details)


def _table(ellipses: Sequence[Ellipse]) -> Array:
    return np.array([logarithms(ellipse) for ellipse in ellipses], dtype=np.float64).reshape(-1, 2)


def _durations(motion: Motion, structure: Structure) -> Difference:
    """Shorter and longer windows; beyond the record the structure vibrates freely."""
    ratios = np.geomspace(1.0 / _LONGEST, _LONGEST, _POINTS)
    different = ratios[np.abs(np.log(ratios)) > np.log1p(_LEAST_CHANGE)]
    quiet = np.zeros(int(np.ceil(_LONGEST * motion.duration / motion.time_step)) + 2)
    quiet[: motion.acceleration.size] = motion.acceleration
    lengths = (different * motion.duration).tolist()
    ellipses = [simulate_ellipse(quiet, motion.time_step, structure, length) for length in lengths]
    details = tuple(
        f"{significant(length)} s instead of {significant(motion.duration)} s" for length in lengths
    )
    return Difference(kind="duration", details=details, pairs=_table(ellipses))
