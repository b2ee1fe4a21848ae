"""Tables of structure, actuator and specimen, alike in `campaign.toml` and `model.toml`."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from reliab.core.physical_range import Physical
from reliab.simulation.hybrid_test.model import Actuator
from reliab.structures.specimen import Specimen
from reliab.structures.structure import Structure


class ModelPart(BaseModel):
    """A table that has no keys but its own."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class StructureTable(ModelPart):
    """Nominal structure of one degree of freedom, as the operator assumes it."""

    frequency_hz: Annotated[float, Physical("natural frequency")] = Field(description="Natural frequency")
    damping_ratio: Annotated[float, Physical("damping ratio")] = Field(description="Damping ratio ξ")
    mass_kg: Annotated[float, Physical("mass")] | None = Field(
        default=None, description="Mass, which scales the force; without it forces are those of a unit mass"
    )
    experimental_fraction: Annotated[float, Physical("share of the stiffness in the laboratory")] = Field(
        default=1.0, description="Share α of the stiffness that stands in the laboratory"
    )

    def build(self) -> Structure:
        """Return the structure."""
        return Structure(
            frequency=self.frequency_hz,
            damping_ratio=self.damping_ratio,
            experimental_fraction=self.experimental_fraction,
        )


class ActuatorTable(ModelPart):
    """Nominal actuator. Left out where the command is not recorded."""

    gain: Annotated[float, Physical("actuator's gain")] = Field(
        default=1.0, description="Measured over commanded displacement"
    )
    delay_s: Annotated[float, Physical("actuator's delay", zero=True)] = Field(
        default=0.0, description="Time by which the piston is late"
    )

    def build(self) -> Actuator:
        """Return the actuator."""
        return Actuator(gain=self.gain, delay=self.delay_s)


class SpecimenTable(ModelPart):
    """Nominal specimen, where it is not the structure's own spring."""

    stiffness_n_per_m: Annotated[float, Physical("stiffness", zero=True)] = Field(
        default=0.0, description="Stiffness"
    )
    damping_n_s_per_m: Annotated[float, Physical("damping coefficient", zero=True)] = Field(
        default=0.0, description="Damping coefficient"
    )
    mass_kg: Annotated[float, Physical("mass", zero=True)] = Field(
        default=0.0, description="Mass that moves with the piston"
    )

    def build(self) -> Specimen:
        """Return the specimen."""
        return Specimen(stiffness=self.stiffness_n_per_m, damping=self.damping_n_s_per_m, mass=self.mass_kg)
