"""The tables of `frame.toml`: the keys allowed, and the matrices that they describe."""

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from reliab.arrays import Array
from reliab.effects import Effect, find_effect
from reliab.errors import InputError
from reliab.simulation.frames.described_table import DescribedTable
from reliab.simulation.frames.transfer_table import TransferTable
from reliab.structures import Specimen, drift_interface, floor_interface
from reliab.structures.frames import Frame, PlanarFrame, modal_damping, rayleigh_damping, shear_frame

Row = tuple[float, ...]

Positive = Annotated[float, Field(gt=0.0)]

NotNegative = Annotated[float, Field(ge=0.0)]


class PlanarTable(DescribedTable):
    """A regular moment frame of columns and beams, whose floors are degrees of freedom."""

    storeys: Annotated[int, Field(ge=1)] = Field(description="Number of storeys")
    bays: Annotated[int, Field(ge=1)] = Field(description="Number of bays")
    elastic_modulus_pa: Positive = Field(description="Elastic modulus")
    column_inertia_m4: Positive = Field(description="Second moment of area of a column")
    beam_inertia_m4: Positive = Field(description="Second moment of area of a beam")
    storey_height_m: Positive = Field(description="Height of a storey")
    bay_width_m: Positive = Field(description="Width of a bay")
    fixed_base: bool = Field(
        default=False, description="Whether columns are clamped at the ground, not hinged"
    )

    @property
    def stiffness(self) -> Array:
        """Condensed lateral stiffness [N/m]."""
        return PlanarFrame(
            storeys=self.storeys,
            bays=self.bays,
            elastic_modulus=self.elastic_modulus_pa,
            column_inertia=self.column_inertia_m4,
            beam_inertia=self.beam_inertia_m4,
            storey_height=self.storey_height_m,
            bay_width=self.bay_width_m,
            fixed_base=self.fixed_base,
        ).lateral_stiffness()


class FrameTable(DescribedTable):
    """Mass and stiffness of the whole structure, each in one of its ways."""

    masses_kg: Row | None = Field(default=None, description="Masses of the floors, from the ground up")
    mass_matrix_kg: tuple[Row, ...] | None = Field(default=None, description="Mass matrix, by rows")
    storey_stiffnesses_n_per_m: Row | None = Field(
        default=None, description="Stiffnesses of the storeys of a shear frame, from the ground up"
    )
    stiffness_matrix_n_per_m: tuple[Row, ...] | None = Field(
        default=None, description="Stiffness matrix, by rows"
    )
    planar: PlanarTable | None = Field(default=None, description="Stiffness from columns and beams")
    names: tuple[str, ...] = Field(
        default=(), description="Names of the degrees of freedom; without them “1”, “2”, …"
    )
    influence: Row | None = Field(
        default=None, description="How the ground moves the degrees of freedom; without it each by 1"
    )

    @model_validator(mode="after")
    def _one_of_each(self) -> Self:
        masses = (self.masses_kg, self.mass_matrix_kg)
        stiffnesses = (self.storey_stiffnesses_n_per_m, self.stiffness_matrix_n_per_m, self.planar)
        if sum(value is not None for value in masses) != 1:
            message = "give masses_kg or mass_matrix_kg"
            raise ValueError(message)
        if sum(value is not None for value in stiffnesses) != 1:
            message = "give storey_stiffnesses_n_per_m, stiffness_matrix_n_per_m or the table planar"
            raise ValueError(message)
        return self

    @property
    def matrices(self) -> tuple[Array, Array]:
        """M [kg] and K [N/m]."""
        if self.masses_kg is not None and self.storey_stiffnesses_n_per_m is not None:
            return shear_frame(self.masses_kg, self.storey_stiffnesses_n_per_m)
        mass = np.diag(self.masses_kg) if self.masses_kg is not None else _matrix(self.mass_matrix_kg)
        if self.planar is not None:
            return mass, self.planar.stiffness
        if self.stiffness_matrix_n_per_m is not None:
            return mass, _matrix(self.stiffness_matrix_n_per_m)
        storeys = self.storey_stiffnesses_n_per_m or ()
        return mass, shear_frame([1.0] * len(storeys), storeys)[1]


class DampingTable(DescribedTable):
    """Damping of the whole structure: `ratio`, `ratios`, `rayleigh_ratios` or `matrix_n_s_per_m`."""

    ratio: NotNegative | None = Field(default=None, description="Damping ratio of all modes")
    ratios: Row | None = Field(default=None, description="Damping ratio of each mode, the slowest first")
    rayleigh_ratios: tuple[float, float] | None = Field(
        default=None, description="Damping ratios of Rayleigh damping at two frequencies"
    )
    rayleigh_frequencies_hz: tuple[Positive, Positive] | None = Field(
        default=None, description="These two frequencies"
    )
    matrix_n_s_per_m: tuple[Row, ...] | None = Field(default=None, description="Damping matrix, by rows")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        ways = (self.ratio, self.ratios, self.rayleigh_ratios, self.matrix_n_s_per_m)
        if sum(value is not None for value in ways) != 1:
            message = "give one of ratio, ratios, rayleigh_ratios and matrix_n_s_per_m"
            raise ValueError(message)
        if (self.rayleigh_ratios is None) != (self.rayleigh_frequencies_hz is None):
            message = "rayleigh_ratios and rayleigh_frequencies_hz belong together"
            raise ValueError(message)
        return self

    def matrix(self, mass: Array, stiffness: Array) -> Array:
        """C [N·s/m]."""
        if self.matrix_n_s_per_m is not None:
            return _matrix(self.matrix_n_s_per_m)
        if self.rayleigh_ratios is not None and self.rayleigh_frequencies_hz is not None:
            return rayleigh_damping(mass, stiffness, self.rayleigh_ratios, self.rayleigh_frequencies_hz)
        return modal_damping(mass, stiffness, self.ratio if self.ratio is not None else self.ratios or ())


class EffectTable(BaseModel):
    """What the specimen does beyond its linear part: an effect of the library with its parameters."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str = Field(description="Name of the effect; its parameters stand beside it")

    @property
    def effect(self) -> Effect:
        """The effect."""
        kind, given = find_effect(self.name), dict(self.model_extra or {})
        known = [parameter.name for parameter in kind.parameters]
        unknown = sorted(set(given) - set(known))
        if unknown:
            raise InputError(
                f"The parameters of {self.name} are {', '.join(known)}",
                value=", ".join(unknown),
                remedy="Give these, in SI units",
            )
        try:
            return kind(**given)
        except TypeError:
            missing = [name for name in known if name not in given]
            raise InputError(f"{self.name} needs its parameters", value=f"no {', '.join(missing)}") from None


class SpecimenTable(DescribedTable):
    """The specimen, and the interface at which it is attached."""

    degree_of_freedom: str | int | None = Field(
        default=None, description="Floor that the specimen connects with the ground, or with `below`"
    )
    below: str | int | None = Field(default=None, description="Floor at its other end; without it the ground")
    direction: Row | None = Field(
        default=None,
        description="Interface displacement by degree of freedom, in place of `degree_of_freedom`",
    )
    stiffness_n_per_m: NotNegative = Field(default=0.0, description="Stiffness of the specimen")
    damping_n_s_per_m: float | None = Field(default=None, description="Damping coefficient of the specimen")
    damping_ratio: NotNegative | None = Field(
        default=None, description="Damping ratio of the specimen by itself, in place of its coefficient"
    )
    mass_kg: NotNegative = Field(default=0.0, description="Mass of the specimen")
    part_of_structure: bool = Field(
        default=True, description="Whether the matrices hold the specimen; if not, it is added to them"
    )
    effects: tuple[EffectTable, ...] = Field(default=(), description="What it does beyond its linear part")

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if (self.degree_of_freedom is None) == (self.direction is None):
            message = "give degree_of_freedom or direction"
            raise ValueError(message)
        if self.below is not None and self.degree_of_freedom is None:
            message = "below needs degree_of_freedom"
            raise ValueError(message)
        if self.damping_n_s_per_m is not None and self.damping_ratio is not None:
            message = "give damping_n_s_per_m or damping_ratio"
            raise ValueError(message)
        return self

    @property
    def specimen(self) -> Specimen:
        """Linear part."""
        damping = self.damping_n_s_per_m or 0.0
        if self.damping_ratio is not None:
            damping = 2.0 * self.damping_ratio * math.sqrt(self.stiffness_n_per_m * self.mass_kg)
        return Specimen(stiffness=self.stiffness_n_per_m, damping=damping, mass=self.mass_kg)

    def interface(self, frame: Frame) -> Array:
        """γ."""
        if self.direction is not None:
            return np.asarray(self.direction, dtype=np.float64)
        if self.below is not None:
            return drift_interface(frame, self.degree_of_freedom or "", self.below)
        return floor_interface(frame, self.degree_of_freedom or "")


class ErrorTable(DescribedTable):
    """The response whose error counts."""

    of: str = Field(
        default="interface", description="The interface, a degree of freedom by its name, or “drift”"
    )
    between: tuple[str, str] | None = Field(default=None, description="Upper and lower floor of a drift")

    @model_validator(mode="after")
    def _drift(self) -> Self:
        if (self.of == "drift") != (self.between is not None):
            message = 'between belongs to of = "drift"'
            raise ValueError(message)
        return self

    def output(self, frame: Frame) -> Array | None:
        """Weights of the degrees of freedom; None for the measured interface displacement."""
        if self.of == "interface":
            return None
        return (
            floor_interface(frame, self.of) if self.between is None else drift_interface(frame, *self.between)
        )


class FrameDescription(DescribedTable):
    """A structure of which one part stands in the laboratory."""

    name: str = Field(default="frame", description="Free text")
    kind: Literal["frame"] = Field(default="frame", description="What the file describes")
    frame: FrameTable = Field(description="Mass and stiffness")
    damping: DampingTable = Field(description="Damping")
    specimen: SpecimenTable = Field(description="Specimen and interface")
    error: ErrorTable = Field(default=ErrorTable(), description="Whose error counts")
    transfer_system: TransferTable | None = Field(
        default=None, description="The rig, whose error `reliab criterion` states"
    )


def _matrix(rows: tuple[Row, ...] | None) -> Array:
    """Matrix of rows, which must be of one length."""
    rows = rows or ()
    if len({len(row) for row in rows}) != 1:
        raise InputError(
            "The rows of a matrix must be of one length", value=f"lengths {[len(row) for row in rows]}"
        )
    return np.array(rows, dtype=np.float64)
