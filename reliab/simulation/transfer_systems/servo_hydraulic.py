"""A servo-hydraulic actuator whose oil column and specimen act on each other."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.simulation.transfer_systems.transfer_function import Plant, TransferSystem
from reliab.structures.specimen import Specimen


@dataclass(frozen=True, kw_only=True)
class ServoHydraulic(TransferSystem):
    """Servo-valve, actuator and displacement loop of a hydraulic ram that pushes a specimen.

    The error g·u − x drives the valve a₁β₀/(s² + β₁s + β₂); the flow less a₂x' makes, through 1/(s + a₃), the
    force F, which moves the specimen 1/(m_e s² + c_e s + k_e). The defaults are those of the virtual
    hybrid-simulation benchmark.

    Silva, C. E., Gomez, D., Maghareh, A., Dyke, S. J. and Spencer, B. F. (2020). Benchmark control problem
    for real-time hybrid simulation. *Mech. Syst. Signal Process.* 135, 106381.

    >>> specimen = Specimen(stiffness=1.19e6, damping=114.2, mass=29.13)
    >>> gain = abs(ServoHydraulic().transfer(np.array([2j * np.pi * 3.6124]), specimen)[0])
    >>> round(float(gain), 3)
    0.915
    """

    input_gain: float = 1.0261  # g [-]
    valve_gain: float = 2.1283e13  # a₁β₀ [N/(m·s³)]
    piston_coupling: float = 4.2297e6  # a₂ [N/m]
    leakage: float = 3.3  # a₃ [1/s]
    valve_damping: float = 425.0  # valve_damping, valve_stiffness: β₁ [1/s] and β₂ [1/s²]
    valve_stiffness: float = 9.9976e4

    def __post_init__(self) -> None:
        for name in (
            *("input_gain", "valve_gain", "piston_coupling"),
            *("leakage", "valve_damping", "valve_stiffness"),
        ):
            label = f"{name.replace('_', ' ')} of a servo-hydraulic actuator"
            require_physical("number", getattr(self, name), label=label)

    def perturb(self, deviations: Array) -> Self:
        """Return the actuator with leakage, valve damping and stiffness off by deviations [SI], (3,)."""
        leakage, damping, stiffness = map(float, deviations)
        return replace(
            self,
            leakage=self.leakage + leakage,
            valve_damping=self.valve_damping + damping,
            valve_stiffness=self.valve_stiffness + stiffness,
        )

    def plant(self, specimen: Specimen) -> Plant:
        """States: valve flow, its rate, force, displacement, velocity; without a moving mass fewer."""
        if specimen.mass > 0.0:
            return self._massive_plant(specimen)
        return self._massless_plant(specimen)

    def _massive_plant(self, specimen: Specimen) -> Plant:
        dynamics = np.zeros((5, 5))
        dynamics[0, 1] = 1.0
        dynamics[1] = [-self.valve_stiffness, -self.valve_damping, 0.0, -self.valve_gain, 0.0]
        dynamics[2] = [1.0, 0.0, -self.leakage, 0.0, -self.piston_coupling]
        dynamics[3, 4] = 1.0
        dynamics[4, 2:] = [1.0, -specimen.stiffness, -specimen.damping]
        dynamics[4] /= specimen.mass
        rows = np.eye(5)
        return Plant(
            dynamics=dynamics,
            command=self.input_gain * self.valve_gain * rows[1],
            nonlinear=rows[4] / specimen.mass,
            displacement=rows[3],
            velocity=rows[4],
            force=rows[2],
            contains_nonlinear=True,
            differentiated=-self.piston_coupling * rows[2],
        )

    def _massless_plant(self, specimen: Specimen) -> Plant:
        """Force and displacement are one state, F = kx; a dashpot makes the velocity another."""
        k, c = specimen.stiffness, specimen.damping
        if k <= 0.0:
            raise InputError(
                "A specimen without moving mass needs a stiffness to hold the actuator",
                value=f"{k:g} N/m",
                remedy="Give the specimen its moving mass, with the clevis and the piston rod",
            )
        if c > 0.0:
            raise InputError(
                "A specimen with damping needs a moving mass before this actuator",
                value="0 kg",
                remedy="Give the mass of the clevis and the piston rod",
            )
        dynamics = np.zeros((3, 3))
        dynamics[0, 1] = 1.0
        dynamics[1] = [-self.valve_stiffness, -self.valve_damping, -self.valve_gain]
        dynamics[2] = np.array([1.0, 0.0, -self.leakage * k]) / (k + self.piston_coupling)
        rows = np.eye(3)
        return Plant(
            dynamics=dynamics,
            command=self.input_gain * self.valve_gain * rows[1],
            nonlinear=np.zeros(3),
            displacement=rows[2],
            velocity=dynamics[2],
            force=k * rows[2],
            differentiated=np.zeros(3),
        )

    def transfer(self, s: Spectrum, specimen: Specimen) -> Spectrum:
        """Measured over sent displacement [-] at s [rad/s]."""
        impedance = specimen.stiffness + s * (specimen.damping + s * specimen.mass)
        valve = s * s + self.valve_damping * s + self.valve_stiffness
        loop = valve * ((s + self.leakage) * impedance + self.piston_coupling * s) + self.valve_gain
        return np.asarray(self.input_gain * self.valve_gain / loop)
