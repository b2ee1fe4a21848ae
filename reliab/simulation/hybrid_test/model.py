"""The model of a whole hybrid test: structure, actuator, specimen and effects."""

from dataclasses import dataclass, field, replace
from typing import Self

from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.effects.effect import Effect, Role, Setting
from reliab.effects.registry import library
from reliab.simulation.integrators import LinearSubstructure
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """An actuator that arrives late and at slightly the wrong amplitude, x_m(t) = k_p x_c(t − τ).

    >>> Actuator(gain=0.99, delay=0.001)
    Actuator(gain=0.99, delay=0.001)
    """

    gain: float = 1.0  # Amplitude gain k_p [-], positive
    delay: float = 0.0  # Delay τ [s], not negative

    def __post_init__(self) -> None:
        require_physical("actuator's gain", self.gain)
        require_physical("actuator's delay", self.delay, zero=True)


@dataclass(frozen=True, kw_only=True)
class HybridTest:
    """A hybrid test as a laboratory runs it.

    >>> test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.02), mass=1000.0)
    >>> round(test.specimen.stiffness)
    39478
    """

    structure: Structure | None = None  # The whole structure; absent when there is no numerical substructure
    mass: float = 1.0  # Its mass [kg]; 1 when forces are per unit mass
    actuator: Actuator = field(default_factory=Actuator)  # Gain and delay
    specimen: Specimen | None = None  # The linear specimen; by default the structure's own spring αω₀²m
    effects: tuple[Effect, ...] = ()  # Further effects; within a block they act in the order of the library
    moved_before: float = 0.0  # Largest displacement of the specimen in earlier tests [m]

    def __post_init__(self) -> None:
        require_physical("mass", self.mass, label="mass of the structure")
        if self.specimen is None and self.structure is not None:
            w0, alpha = self.structure.circular_frequency, self.structure.experimental_fraction
            object.__setattr__(self, "specimen", Specimen(stiffness=alpha * w0**2 * self.mass))
        order = {name: place for place, name in enumerate(library())}
        effects_in_order = sorted(self.effects, key=lambda effect: order.get(effect.name, len(order)))
        object.__setattr__(self, "effects", tuple(effects_in_order))

    def adding(self, *effects: Effect) -> Self:
        """Return the same test with more effects."""
        return replace(self, effects=(*self.effects, *effects))

    def acting(self, *roles: Role) -> tuple[Effect, ...]:
        """Effects of given roles, in order."""
        return tuple(effect for effect in self.effects if effect.role in roles)

    def setting(self, step: float) -> Setting:
        """Properties of this test that effects need, for a step [s]."""
        specimen = self.specimen or Specimen(stiffness=0.0)
        return Setting(
            step=step,
            stiffness=specimen.stiffness,
            damping=specimen.damping,
            moved_before=self.moved_before,
        )

    @property
    def substructure(self) -> LinearSubstructure:
        """The numerical substructure per unit mass, as it is integrated."""
        if self.structure is None:
            raise InputError("A closed loop needs a numerical substructure", remedy="Add a [structure] table")
        w0, alpha = self.structure.circular_frequency, self.structure.experimental_fraction
        return LinearSubstructure(
            damping=2.0 * self.structure.damping_ratio * w0, stiffness=(1.0 - alpha) * w0**2
        )
