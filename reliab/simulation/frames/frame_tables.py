"""The tables of `frame.toml`: allowed keys, and the matrices of the structure that they describe."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from reliab.core.arrays import Array
from reliab.core.physical_range import Physical
from reliab.simulation.frames.matrix_files import Matrix, Row, matrix_of_rows
from reliab.simulation.frames.specimen_table import KinematicsTable, SpecimenTable
from reliab.simulation.frames.tolerances_table import DescribedTable, TolerancesTable, require
from reliab.simulation.frames.transfer_table import TransferTable
from reliab.structures.frames.frame import Frame, massless, modal_damping, rayleigh_damping, static_shapes
from reliab.structures.frames.planar_frame import PlanarFrame, shear_frame
from reliab.structures.specimen import drift_interface, floor_interface

_Inertia = Annotated[float, Physical("second moment of area")]
_Length = Annotated[float, Physical("length")]
_Ratio = Annotated[float, Physical("damping ratio", zero=True)]
_Frequency = Annotated[float, Physical("natural frequency")]


class PlanarTable(DescribedTable):
    """A regular moment frame of columns and beams, whose floors are degrees of freedom."""

    storeys: Annotated[int, Field(ge=1)] = Field(description="Number of storeys")
    bays: Annotated[int, Field(ge=1)] = Field(description="Number of bays")
    elastic_modulus_pa: Annotated[float, Physical("elastic modulus")] = Field(description="Elastic modulus")
    column_inertia_m4: _Inertia = Field(description="Second moment of area of a column")
    beam_inertia_m4: _Inertia = Field(description="Second moment of area of a beam")
    storey_height_m: _Length = Field(description="Height of a storey")
    bay_width_m: _Length = Field(description="Width of a bay")
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

    masses_kg: tuple[Annotated[float, Physical("mass", zero=True)], ...] | None = Field(
        default=None, description="Masses of the floors, from the ground up"
    )
    mass_matrix_kg: Matrix | None = Field(
        default=None, description="Mass matrix, with the specimen's, by rows"
    )
    storey_stiffnesses_n_per_m: tuple[Annotated[float, Physical("stiffness")], ...] | None = Field(
        default=None,
        description="Stiffnesses of the storeys of a shear frame, with the specimen's, from the ground up",
    )
    stiffness_matrix_n_per_m: Matrix | None = Field(
        default=None, description="Stiffness matrix, with the specimen's, by rows"
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
        require(sum(value is not None for value in masses) == 1, "give masses_kg or mass_matrix_kg")
        require(
            sum(value is not None for value in stiffnesses) == 1,
            "give storey_stiffnesses_n_per_m, stiffness_matrix_n_per_m or the table planar",
        )
        return self

    @property
    def matrices(self) -> tuple[Array, Array]:
        """M [kg] and K [N/m]."""
        if self.masses_kg is not None and self.storey_stiffnesses_n_per_m is not None:
            return shear_frame(self.masses_kg, self.storey_stiffnesses_n_per_m)
        mass = np.diag(self.masses_kg) if self.masses_kg is not None else matrix_of_rows(self.mass_matrix_kg)
        if self.planar is not None:
            return mass, self.planar.stiffness
        if self.stiffness_matrix_n_per_m is not None:
            return mass, matrix_of_rows(self.stiffness_matrix_n_per_m)
        storeys = self.storey_stiffnesses_n_per_m or ()
        return mass, shear_frame([1.0] * len(storeys), storeys)[1]


class DampingTable(DescribedTable):
    """Damping of the whole structure: `ratio`, `ratios`, `rayleigh_ratios` or `matrix_n_s_per_m`."""

    ratio: _Ratio | None = Field(default=None, description="Damping ratio of all modes")
    ratios: tuple[_Ratio, ...] | None = Field(
        default=None, description="Damping ratio of each mode, the slowest first"
    )
    rayleigh_ratios: tuple[_Ratio, _Ratio] | None = Field(
        default=None, description="Damping ratios of Rayleigh damping at two frequencies"
    )
    rayleigh_frequencies_hz: tuple[_Frequency, _Frequency] | None = Field(
        default=None, description="The two frequencies of `rayleigh_ratios`"
    )
    matrix_n_s_per_m: Matrix | None = Field(default=None, description="Damping matrix, by rows")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        ways = (self.ratio, self.ratios, self.rayleigh_ratios, self.matrix_n_s_per_m)
        require(
            sum(value is not None for value in ways) == 1,
            "give one of ratio, ratios, rayleigh_ratios and matrix_n_s_per_m",
        )
        require(
            (self.rayleigh_ratios is None) == (self.rayleigh_frequencies_hz is None),
            "rayleigh_ratios and rayleigh_frequencies_hz belong together",
        )
        return self

    def matrix(self, mass: Array, stiffness: Array) -> Array:
        """C [N·s/m] of a structure some of whose degrees of freedom may be without mass."""
        if self.matrix_n_s_per_m is not None:
            return matrix_of_rows(self.matrix_n_s_per_m)
        if self.rayleigh_ratios is not None and self.rayleigh_frequencies_hz is not None:
            return rayleigh_damping(mass, stiffness, self.rayleigh_ratios, self.rayleigh_frequencies_hz)
        ratios = self.ratio if self.ratio is not None else self.ratios or ()
        bare = massless(mass)
        massed, shapes = ~bare, static_shapes(stiffness, bare)
        damping = np.zeros_like(mass)
        damping[np.ix_(massed, massed)] = modal_damping(
            shapes.T @ mass @ shapes, shapes.T @ stiffness @ shapes, ratios
        )
        return damping


class ErrorTable(DescribedTable):
    """The response whose error counts."""

    of: str = Field(
        default="interface", description="The interface, a degree of freedom by its name, or “drift”"
    )
    between: tuple[str, str] | None = Field(default=None, description="Upper and lower floor of a drift")

    @model_validator(mode="after")
    def _drift(self) -> Self:
        require((self.of == "drift") == (self.between is not None), 'between belongs to of = "drift"')
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
    frame: FrameTable = Field(description="Mass and stiffness of the whole structure, with its specimen")
    damping: DampingTable = Field(description="Damping of the whole structure, with its specimen")
    specimen: SpecimenTable = Field(description="Specimen and interface")
    error: ErrorTable = Field(default=ErrorTable(), description="Response whose error is judged")
    tolerances: TolerancesTable = Field(
        default=TolerancesTable(), description="How exactly the structure is known, for `reliab assess`"
    )
    kinematics: KinematicsTable | None = Field(
        default=None,
        description="Kinematics of several actuators; without it each degree of freedom has "
        "an actuator of its own",
    )
    transfer_system: TransferTable | None = Field(
        default=None, description="Transfer system of the rig, whose error `reliab criterion` states"
    )

    @property
    def of_several(self) -> bool:
        """Whether the specimen is described as driven by several actuators."""
        return self.specimen.several or self.kinematics is not None
