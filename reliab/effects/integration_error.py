"""A numerical substructure that is integrated explicitly with a coarse step."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.effects.effect import Effect, Parameter, Role


@dataclass(frozen=True, kw_only=True)
class IntegrationError(Effect):
    """A controller whose integration yields the demanded acceleration late, early or too small.

    The controller knows the acceleration u that the equation of motion demands at its own instants, a step Δ
    apart, and moves by Newmark's explicit scheme, x₁ = x₀ + Δv₀ + ½Δ²u₀, v₁ = v₀ + Δ((1 − γ)u₀ + γu₁). With
    z = iωΔ the command's acceleration is, below half of the controller's rate, H(z)·u with

        H(z) = (1 − e⁻ᶻ)(1/z + γ) = 1 + (γ − ½)z + (1/6 − γ/2)z² + …

    To first order x''(t) = u(t + s) with s = (γ − ½)Δ: a time shift, that adds the damping ratio ω₀s/2 to the
    structure. The central differences have γ = ½ and add none. Forward Euler is the same scheme with γ = −½,
    but for the command, which moves in straight lines: H = 1 + (γ − ½)(1 − e⁻ᶻ) = e⁻ᶻ. An integration that
    removes damping is assumed to be of this kind.

    >>> euler = IntegrationError(numerical_damping_ratio=-0.01, step_s=0.02 / 6.0)
    >>> bool(np.isclose(euler.transfer(np.array([10.0]), 6.0)[0], np.exp(-20j * np.pi * 0.02 / 6.0)))
    True
    """

    name = "integration_error"
    block = Block.NUMERICAL
    role = Role.INTEGRATION
    description = "the numerical substructure is integrated with an error that adds or removes damping"
    parameters = (
        Parameter(
            name="numerical_damping_ratio",
            units="-",
            meaning="damping ratio that the integration adds",
            signed=True,
            typical=0.05,
            lower=-0.5,
            upper=0.5,
            starts=(0.002, 0.004, 0.008, -0.002),
        ),
        Parameter(
            name="step_s",
            units="s",
            meaning="step of the integration",
            typical=0.004,
            spread=1.2,
            lower=1e-4,
            upper=0.1,
            starts=(0.002, 0.008, 0.03, 0.002),
        ),
    )

    # Damping ratio ω₀s/2 that the integration adds [-]; negative where it feeds energy in
    numerical_damping_ratio: float
    step_s: float = 0.001  # Step Δ of the integration [s]

    def shift(self, circular_frequency: float) -> float:
        """Time s [s] by which the acceleration is ahead, for a structure of ω₀ [rad/s]."""
        return 2.0 * self.numerical_damping_ratio / circular_frequency

    def transfer(self, frequency: Array, circular_frequency: float) -> Spectrum:
        """Transfer function H [-] from the demanded to the command's acceleration.

        `frequency`: frequencies [Hz]; `circular_frequency`: ω₀ of the structure [rad/s].
        """
        gamma = 0.5 + self.shift(circular_frequency) / self.step_s
        turns = np.asarray(frequency) * self.step_s
        change = 1.0 - np.exp(-2j * np.pi * turns)
        moved = 1.0 - 0.5 * change if self.moves_straight else np.exp(-1j * np.pi * turns) * np.sinc(turns)
        return np.asarray(moved + gamma * change, dtype=np.complex128)

    @property
    def velocity_lead(self) -> float:
        """Time [s] by which the velocity that damps is ahead of the command's."""
        return 0.5 * self.step_s if self.moves_straight else 0.0

    @property
    def moves_straight(self) -> bool:
        """Whether the command moves in straight lines between the controller's instants."""
        return self.numerical_damping_ratio < 0.0
