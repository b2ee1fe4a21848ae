"""Net damping ratio of the loop with its actuator while the test runs: below zero the loop gains energy.

The actuator's error puts the restoring force k(x_m − x_c) into the loop. The part in phase with the velocity
acts as added damping, positive or negative: with x_m − x_c = a x_c + b x_c' + c ::

    ξ_net = ξ + αω₀b/2

(for a delay τ it is ξ − αω₀τ/2, whose zero is the stability limit to first order; the balance of energy is
that of Mosqueda, Stojadinovic and Mahin 2007, J. Struct. Eng. 133, 1). a, b and c are those of least squares
over a window that forgets exponentially, so that a wrong gain or an offset is not taken for damping while the
motion grows. The loop is called unstable where ξ_net lies below zero by twice its standard error while the
motion is among the largest of the test: play may feed energy into small motions without letting them grow.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.rebuilt_error.whole_structure import WholeStructure, first_mode

Array = NDArray[np.float64]

MEMORY = 2.0
"""Periods after which the window has forgotten all but 1/e."""

SETTLED = 1.0
"""Periods of motion before the indicator is trusted."""

_INDEPENDENT = 4.0  # samples in a period of which the errors count as independent
_SIGNIFICANT = 2.0  # standard errors
_LARGE = 0.5  # of the largest power of the motion so far
_SINGULAR = 1e-12


@dataclass(frozen=True, kw_only=True)
class NetDamping:
    """Net damping of the loop with its actuator.

    Attributes
    ----------
    ratio, deviation : float
        ξ_net and its standard error [-].
    unstable : bool
        Whether the loop gains energy beyond doubt in a motion that is among the largest so far.
    """

    ratio: float
    deviation: float
    unstable: bool


@dataclass(frozen=True, kw_only=True)
class Damping:
    """Properties of the first mode that the indicator needs.

    Attributes
    ----------
    ratio : float
        ξ of the lowest mode [-].
    factor : float
        k_e ν²/(2ω₀m) [1/s], half of αω₀ for one degree of freedom.
    forgetting : float
        Weight that is left of the past after a step [-].
    samples : float
        Samples in a period [-].
    """

    ratio: float
    factor: float
    forgetting: float
    samples: float

    @classmethod
    def of(cls, structure: WholeStructure, time_step: float) -> "Damping":
        """Take the lowest mode of a structure.

        Parameters
        ----------
        structure : WholeStructure
            The whole structure.
        time_step : float
            Step between samples [s].

        Returns
        -------
        Damping
            Of the lowest mode that moves the interface.
        """
        shape = first_mode(structure)
        mass = float(shape @ structure.mass @ shape)
        w0 = float(np.sqrt(shape @ structure.stiffness @ shape / mass))
        return cls(
            ratio=float(shape @ structure.damping @ shape) / (2.0 * w0 * mass),
            factor=structure.specimen_stiffness / (2.0 * w0 * mass),
            forgetting=float(np.exp(-time_step * w0 / (2.0 * np.pi * MEMORY))),
            samples=2.0 * np.pi / (w0 * time_step),
        )

    def net(self, moments: Array, motion: Array) -> NetDamping | None:
        """Return the net damping of the loop with its actuator.

        Parameters
        ----------
        moments, motion : numpy.ndarray
            As `RunningError` sums them, shapes (4, 4) and (2,).

        Returns
        -------
        NetDamping or None
            None before the motion has settled.
        """
        power = float(moments[1, 1])
        if motion[0] < SETTLED * self.samples or not power > 0.0:
            return None
        scale = np.sqrt(np.maximum(np.diag(moments), np.finfo(float).tiny))
        joint = moments / np.outer(scale, scale)
        inverse = np.linalg.pinv(joint[:3, :3], rcond=_SINGULAR, hermitian=True)
        values = inverse @ joint[:3, 3]
        rest = max(float(joint[3, 3] - values @ joint[:3, 3]), 0.0)
        independent = max(_INDEPENDENT * float(moments[2, 2]) / self.samples, 1.0)
        units = float(self.factor * scale[3] / scale[1])
        ratio = float(self.ratio) + units * float(values[1])
        deviation = units * float(np.sqrt(max(float(inverse[1, 1]), 0.0) * rest / independent))
        return NetDamping(
            ratio=ratio,
            deviation=deviation,
            unstable=bool(ratio + _SIGNIFICANT * deviation < 0.0 and power > _LARGE * motion[1]),
        )
