r"""A few poles whose responses represent those of a whole plane of gains and delays.

Every actuator moves the structure's pole p₀ a little. The response 1/(s − p) of a moved pole p with
Re p < 0 is expanded in the functions of Takenaka and Malmquist, in which each further pole p_k follows
an all-pass filter::

    φ_k(s) = 1/(s − p_k) · Π_{i<k} (s + p̄_i)/(s − p_i)
    1/(s − p) = Σ_{k<n} c_k φ_k(s) + γ_n/(s − p) · Π_{i<n} (s + p̄_i)/(s − p_i)
    γ_k = Π_{i<k} (p − p_i)/(p + p̄_i),     c_k = 2Re(p_k) γ_k/(p + p̄_k)

The last term is the error of n functions. The factors of its product have modulus 1 on the imaginary
axis, so that its size is |γ_n|/|s − p| at **every** frequency: the share left out is |γ_n| for any record.
All coefficients but the first are proportional to p − p₀, as the deviation is, so that no digits are lost.

The poles are chosen one after the other among those of actuators with errors of interest: each time the pole
with the largest error so far. Partial fractions give the functions from the responses of the single poles
(`orthogonal`). The fast pair of a late actuator is expanded in those of a few delays by least squares.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.simulation.linear_loop.dominant_pole import (
    ModalLoop,
    comparison_frequencies,
    dominant_pole,
    modal_loop,
)
from reliab.structures.structure import Structure

FARTHEST, _REGION = 0.5, 0.4
"""Largest |p − p₀|/|p + p̄₀| of a pole that is expanded, and of those from which poles are taken."""

_REGION_GAIN, _REGION_LAG, _REGION_LEAD = 2.2, 1.6, 2.5
"""Actuators from which poles are taken: |ln k_p| up to the first times ξ, delays and leads up to the
others times ξ/ω₀."""

_LEFT_OUT = 2e-5  # of the deviation, at which no further pole is taken
_SMALLEST_DEVIATION = 1e-3  # relative to |p + p̄₀|, below which a deviation need not be resolved
_MOST_POLES = 20
_FAST_PAIRS = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class PoleBasis:
    """Poles and fast pairs in which actuators before one structure are expanded."""

    structure: Structure  # The structure under test
    poles: Spectrum  # Poles p_k [1/s], that of the structure first, shape (poles,)
    fast: ModalLoop  # Reduced loops at gain 1 whose fast pairs are used, shape (pairs,)

    @cached_property
    def orthogonal(self) -> Array:
        """Real and imaginary parts of all φ_k from those of the responses 1/(s − p_k).

        Shape (2 poles, 2 poles): partial fractions, Π_{i<k}(p_j + p̄_i)/Π_{i≤k, i≠j}(p_j − p_i).
        """
        p, count = self.poles, self.poles.size
        fractions = np.zeros((count, count), dtype=np.complex128)
        for k in range(count):
            for j in range(k + 1):
                differences = p[j] - np.delete(p[: k + 1], j)
                fractions[k, j] = np.prod(p[j] + p[:k].conj()) / np.prod(differences)
        return np.block([[fractions.real, -fractions.imag], [fractions.imag, fractions.real]])

    def coefficients(self, pole: Spectrum) -> tuple[Spectrum, Array]:
        """Expand responses 1/(s − p).

        Returns `left_out`: |γ_n|, the share that is left out at every frequency [-], shape (cells,); infinite
        for a pole that is too far from the structure's.
        """
        near = distance(pole, complex(self.poles[0])) <= FARTHEST
        pole = np.where(near, pole, self.poles[0])
        coefficients = np.empty((self.poles.size, pole.size), dtype=np.complex128)
        gamma = np.ones_like(pole)
        for k, of_basis in enumerate(self.poles):
            coefficients[k] = 2.0 * of_basis.real * gamma / (pole + of_basis.conjugate())
            gamma = gamma * (pole - of_basis) / (pole + of_basis.conjugate())
        return coefficients, np.where(near, np.abs(gamma), np.inf)

    def fast_coefficients(self, loop: ModalLoop) -> tuple[Array, Array]:
        """Expand the fast pairs of late actuators in those of the basis.

        Returns `left_out`: largest modulus, over the frequencies, of what the expansion leaves out of the
        transfer function from −a_g [s²], shape (cells,).
        """
        at = comparison_frequencies(self.structure)
        exact, of_basis = loop.fast_transfer(at), self.fast.fast_transfer(at)
        coefficients = self._fast_inverse @ _parts(exact)
        return coefficients, np.abs(of_basis @ coefficients - exact).max(axis=0)

    @cached_property
    def _fast_inverse(self) -> Array:
        of_basis = _parts(self.fast.fast_transfer(comparison_frequencies(self.structure)))
        return np.asarray(scipy.linalg.pinv(of_basis, rtol=1e-12), dtype=np.float64)


@lru_cache(maxsize=256)
def pole_basis(structure: Structure) -> PoleBasis:
    """Choose the poles in which actuators before a structure are expanded.

    Returns poles that leave out less than 2e-5 of the deviation of any actuator with an error of up to about
    20 % RMS^R, but no more than twenty.
    """
    undisturbed = structure.pole
    scale = structure.damping_ratio / structure.circular_frequency
    gains = np.exp(structure.damping_ratio * _REGION_GAIN * np.linspace(-1.0, 1.0, 23))
    delays = scale * np.linspace(-_REGION_LEAD, _REGION_LAG, 42)
    gain, delay = (values.ravel() for values in np.meshgrid(gains, delays))
    poles = dominant_pole(structure, gain, delay)
    near = poles[distance(poles, undisturbed) <= _REGION]
    expansion = [undisturbed]
    left_out = (near - undisturbed) / (near + undisturbed.conjugate())
    size = np.maximum(np.abs(left_out), _SMALLEST_DEVIATION)
    while len(expansion) < _MOST_POLES and np.any(np.abs(left_out) > _LEFT_OUT * size):
        worst = complex(near[np.argmax(np.abs(left_out) / size)])
        expansion.append(worst)
        left_out = left_out * (near - worst) / (near + worst.conjugate())
    nodes = scale * _REGION_LAG * np.arange(1, _FAST_PAIRS + 1) / _FAST_PAIRS
    fast = modal_loop(structure, np.ones_like(nodes), nodes)
    return PoleBasis(structure=structure, poles=np.array(expansion), fast=fast)


def distance(pole: Spectrum, from_pole: complex) -> Array:
    """Distance |p − p₀|/|p + p̄₀| of poles [-], shape (cells,); infinite right of the imaginary axis."""
    with np.errstate(divide="ignore", invalid="ignore"):  # no pole where Newton's iteration did not converge
        ratio = np.abs(pole - from_pole) / np.abs(pole + from_pole.conjugate())
        return np.where(pole.real < 0.0, ratio, np.inf)


def _parts(values: Spectrum) -> Array:
    return np.concatenate([values.real, values.imag])
