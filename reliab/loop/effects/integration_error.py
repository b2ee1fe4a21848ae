"""Numerical damping of a first-order integration of the numerical substructure."""

from dataclasses import dataclass

from reliab.loop.effects.effect import Effect, Role
from reliab.loop.effects.parameter import Parameter
from reliab.vocabulary import Block, EffectName


@dataclass(frozen=True, kw_only=True)
class IntegrationError(Effect):
    """A controller whose integration is of first order and so evaluates the equation of motion off time.

    To first order in its step such an integrator solves x''(t) = u(t + s) with the acceleration u that the
    equation of motion demands. Forward Euler with the step Δ has s = −Δ, Newmark's method s = (γ − ½)Δ; the
    time shift adds the damping ratio ω₀s/2 to the structure.

    Parameters
    ----------
    numerical_damping_ratio : float
        Damping ratio ω₀s/2 that the integration adds [-]; negative where it feeds energy in.
    """

    name = EffectName.INTEGRATION_ERROR
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
            starts=(0.002,),
        ),
    )

    numerical_damping_ratio: float

    def shift(self, circular_frequency: float) -> float:
        """Time s [s] by which the acceleration is ahead, for a structure of ω₀ [rad/s]."""
        return 2.0 * self.numerical_damping_ratio / circular_frequency
