r"""The loop with an actuator that leads: x_m(t) = k_p x_c(t + T).

Compensation that overshoots makes the actuator early. The loop then is an equation with advanced argument,
which cannot be marched forward; what a test shows is its bounded solution. Its transfer function
from −a_g to the measured displacement, ::

    k_p e^(sT)/Q(s),   Q(s) = s² + 2ξω₀s + (1−α)ω₀² + αk_pω₀²e^(sT)

has one pole pair p, p̄ left of the imaginary axis and, for leads below `longest_lead`, all others far to
the right of it, at about 5/T or more. The command is therefore the response of the pair plus a direct term
for the other poles, which look ahead by less than T::

    1/Q(s) = r/(s − p) + r̄/(s − p̄) + c + O(sT³/1000),   r = 1/Q'(p),   c of the order of T²/200

and the measured displacement is k_p times the command, shifted ahead by T.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array, Spectrum
from reliab.simulation.linear_loop.dominant_pole import pole_or_own
from reliab.structures import Structure


@dataclass(frozen=True, kw_only=True)
class LeadingLoop:
    """Dominant pole pair, feed-through and lead, one entry per cell."""

    # pole, residue: Pole p [1/s] and residue k_p r [s] of k_p times the command's response to −a_g, complex,
    # shape (cells,); their conjugates belong to them
    pole: Spectrum
    residue: Spectrum
    feedthrough: Array  # k_p c, direct term of the other poles [s²], shape (cells,)
    # Lead T by which the measured displacement is ahead [s], positive, shape (cells,)
    lead: Array

    def command(self, gain: Array) -> "LeadingLoop":
        """Take the loop from −a_g to the command, of actuators of given gains [-], shape (cells,)."""
        return LeadingLoop(
            pole=self.pole,
            residue=self.residue / gain,
            feedthrough=self.feedthrough / gain,
            lead=np.zeros_like(self.lead),
        )

    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function from −a_g [s²] at frequencies s [rad/s] that broadcast with the cells."""
        pair = self.residue / (s - self.pole) + self.residue.conj() / (s - self.pole.conj())
        return np.asarray(np.exp(s * self.lead) * (pair + self.feedthrough))


def leading_loop(structure: Structure, gain: Array, lead: Array) -> LeadingLoop:
    """Split the loop of a leading actuator into its dominant pair and a feed-through."""
    w0, xi, alpha = structure.circular_frequency, structure.damping_ratio, structure.experimental_fraction
    coupled = alpha * gain * w0**2
    pole, oscillates = pole_or_own(structure, gain, -lead)
    slope = 2.0 * pole + 2.0 * xi * w0 + lead * coupled * np.exp(pole * lead)
    residue = np.where(oscillates, gain / slope, 0.0)
    static = gain / ((1.0 - alpha) * w0**2 + coupled)
    feedthrough = static + 2.0 * (residue / pole).real
    return LeadingLoop(pole=pole, residue=residue, feedthrough=feedthrough, lead=lead)
