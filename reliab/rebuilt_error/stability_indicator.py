"""Does the loop gain energy? The damping ratio that the actuator leaves, while the test runs.

The actuator's error puts the restoring force k(x_m − x_c) into the loop, whose work on the command's
motion is damping that the structure does not have, or lacks. Over a moving window ::

    ξ_net = ξ + (ω₀/2) Σ α (x_m − x_c) Δx_c / (Σ Δx_c²/Δt)

(equate the work 2ξω₀Σx_c'²Δt of the damping with αω₀²Σ(x_m − x_c)Δx_c; for a delay τ it is ξ − αω₀τ/2,
whose zero is the stability limit to first order; the balance of energy is that of Mosqueda, Stojadinovic
and Mahin 2007, J. Struct. Eng. 133, 1). The window forgets exponentially. The loop diverges where ξ_net
stays below zero, and the indicator says so while the motion is still small.
"""

from dataclasses import dataclass

import numpy as np

from reliab.rebuilt_error.whole_structure import WholeStructure, first_mode

MEMORY = 2.0
"""Periods after which the window has forgotten all but 1/e."""

SETTLED = 1.0
"""Periods of motion before the indicator is trusted."""


@dataclass(frozen=True, kw_only=True)
class Damping:
    """First-mode damping as the indicator needs it.

    Attributes
    ----------
    ratio : float
        ξ of the lowest mode [-].
    factor : float
        k_e ν²/(2ω₀m) [1/s], half of αω₀ for one degree of freedom.
    forgetting : float
        Weight that is left of the past after a step [-].
    """

    ratio: float
    factor: float
    forgetting: float

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
        )
