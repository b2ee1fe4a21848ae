"""The tables of `frame.toml`: the keys allowed, and the matrices that they describe."""

import math
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from reliab.errors import InputError
from reliab.loop.effects import Effect, find_effect
from reliab.loop.hybrid_test.specimen import Specimen
from reliab.loop.partition.described_table import DescribedTable
from reliab.loop.partition.partition import drift_interface, floor_interface
from reliab.loop.partition.transfer_table import TransferTable
from reliab.loop.structures import Frame, PlanarFrame, modal_damping, rayleigh_damping, shear_frame

Array = NDArray[np.float64]

Row = tuple[float, ...]

Positive = Annotated[float, Field(gt=0.0)]

NotNegative = Annotated[float, Field(ge=0.0)]


class PlanarTable(DescribedTable):
    """`[frame.planar]`: a regular moment frame of columns and beams."""

    storeys: Annotated[int, Field(ge=1)]
    bays: Annotated[int, Field(ge=1)]
    elastic_modulus_pa: Positive
    column_inertia_m4: Positive
    beam_inertia_m4: Positive
    storey_height_m: Positive
    bay_width_m: Positive
    fixed_base: bool = False

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
    """`[frame]`: mass and stiffness."""

    masses_kg: Row | None = None
    mass_matrix_kg: tuple[Row, ...] | None = None
    storey_stiffnesses_n_per_m: Row | None = None
    stiffness_matrix_n_per_m: tuple[Row, ...] | None = None
    planar: PlanarTable | None = None
    names: tuple[str, ...] = ()
    influence: Row | None = None

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
    """`[damping]`: exactly one way of describing it."""

    ratio: NotNegative | None = None
    ratios: Row | None = None
    rayleigh_ratios: tuple[float, float] | None = None
    rayleigh_frequencies_hz: tuple[Positive, Positive] | None = None
    matrix_n_s_per_m: tuple[Row, ...] | None = None

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
    """`[[specimen.effects]]`: an effect of the library with its parameters."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str

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
    """`[specimen]`: the specimen and where it is attached."""

    degree_of_freedom: str | int | None = None
    below: str | int | None = None
    direction: Row | None = None
    stiffness_n_per_m: NotNegative = 0.0
    damping_n_s_per_m: float | None = None
    damping_ratio: NotNegative | None = None
    mass_kg: NotNegative = 0.0
    part_of_structure: bool = True
    effects: tuple[EffectTable, ...] = ()

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
    """`[error]`: the response whose error counts."""

    of: str = "interface"
    between: tuple[str, str] | None = None

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
    """The whole file."""

    name: str = "frame"
    kind: Literal["frame"] = "frame"
    frame: FrameTable
    damping: DampingTable
    specimen: SpecimenTable
    error: ErrorTable = ErrorTable()
    transfer_system: TransferTable | None = None


def _matrix(rows: tuple[Row, ...] | None) -> Array:
    """Matrix of rows, which must be of one length."""
    rows = rows or ()
    if len({len(row) for row in rows}) != 1:
        raise InputError(
            "The rows of a matrix must be of one length", value=f"lengths {[len(row) for row in rows]}"
        )
    return np.array(rows, dtype=np.float64)
