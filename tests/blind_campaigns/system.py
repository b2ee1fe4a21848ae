"""What stands in the laboratory: structure, actuator, specimen and the effects that hide in them."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from blind_campaigns.march import neutral_parameters

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Linear structure of one degree of freedom; without `mass_kg` forces are per unit mass."""

    frequency_hz: float
    damping_ratio: float
    mass_kg: float | None = None
    experimental_fraction: float = 1.0

    @property
    def omega(self) -> float:
        """Undamped circular frequency [rad/s]."""
        return 2.0 * math.pi * self.frequency_hz

    @property
    def mass(self) -> float:
        """Mass [kg], 1 when forces are per unit mass."""
        return 1.0 if self.mass_kg is None else self.mass_kg

    @property
    def own_spring(self) -> float:
        """Stiffness αω₀²m of the spring that is tested when there is no other specimen [N/m]."""
        return self.experimental_fraction * self.omega**2 * self.mass


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """Gain and pure delay between the command and the piston."""

    gain: float = 1.0
    delay_s: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """Linear specimen: stiffness, damping, mass."""

    stiffness_n_per_m: float
    damping_n_s_per_m: float = 0.0
    mass_kg: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A physical effect of a given size; `parameters` are SI values under the names of README.md."""

    name: str
    block: str
    channel: str
    parameters: dict[str, float]
    fields: dict[str, tuple[str, float]] = field(default_factory=dict, repr=False)


@dataclass(frozen=True, kw_only=True)
class Rig:
    """The true system of a campaign, or what is believed of it."""

    structure: Structure | None = None
    actuator: Actuator = field(default_factory=Actuator)
    specimen: Specimen | None = None
    effects: tuple[Effect, ...] = ()
    excitation_scale: float = 1.0

    def without(self, effect: Effect) -> "Rig":
        """Return the same rig in which one effect is missing."""
        return replace(self, effects=tuple(other for other in self.effects if other is not effect))

    def adding(self, effect: Effect) -> "Rig":
        """Return the same rig with one more effect."""
        return replace(self, effects=(*self.effects, effect))

    def find(self, name: str) -> Effect | None:
        """Return the effect of that name, if it is there."""
        return next((effect for effect in self.effects if effect.name == name), None)

    def parameters(self) -> NDArray[np.void]:
        """Return the record that the compiled equations read."""
        record = neutral_parameters()
        record["gain"], record["delay"] = self.actuator.gain, self.actuator.delay_s
        if self.structure is not None:
            record["omega"], record["damping_ratio"] = self.structure.omega, self.structure.damping_ratio
            record["mass"], record["fraction"] = self.structure.mass, self.structure.experimental_fraction
        if self.specimen is not None:
            record["stiffness"] = self.specimen.stiffness_n_per_m
            record["damping"] = self.specimen.damping_n_s_per_m
            record["inertia"] = self.specimen.mass_kg
        for effect in self.effects:
            _install(record, effect)
        return record


def _install(record: NDArray[np.void], effect: Effect) -> None:
    """Add an effect's parameters to their fields, or set fields whose neutral value is not zero."""
    neutral = neutral_parameters()
    for parameter, (name, factor) in effect.fields.items():
        value = effect.parameters[parameter] * factor
        record[name] = record[name] + value if neutral[name][0] == 0.0 else value
