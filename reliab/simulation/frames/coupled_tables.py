"""The tables of `frame.toml` for a specimen of several degrees of freedom, and what they describe."""

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
import scipy
from pydantic import Field, model_validator

from reliab.arrays import Array
from reliab.effects import Effect
from reliab.errors import InputError
from reliab.simulation.frames.frame_tables import (
    DampingTable,
    FrameDescription,
    Row,
    TransferTable,
    matrix_of_rows,
)
from reliab.simulation.frames.planar_geometry import PlanarGeometry
from reliab.simulation.frames.tolerances_table import DescribedTable
from reliab.structures import condensed
from reliab.structures.frames import place_of, rayleigh_damping

Matrix = tuple[Row, ...]


class CoupledSpecimenTable(DescribedTable):
    """A specimen of several driven degrees of freedom."""

    degrees_of_freedom: Annotated[tuple[str | int, ...], Field(min_length=1)] | None = Field(
        default=None, description="Driven degrees of freedom of the frame"
    )
    directions: Matrix | None = Field(
        default=None,
        description="Each interface displacement by degree of freedom of the frame, in place of "
        "`degrees_of_freedom`",
    )
    names: tuple[str, ...] = Field(default=(), description="Names of the interface displacements")
    stiffness_matrix_n_per_m: Matrix = Field(
        description="Stiffness matrix of the specimen, or its file; rows beyond the driven degrees of "
        "freedom are its inner ones, which are condensed statically"
    )
    damping_matrix_n_s_per_m: Matrix | None = Field(default=None, description="Damping matrix, likewise")
    mass_matrix_kg: Matrix | None = Field(default=None, description="Mass matrix, likewise")
    part_of_structure: bool = Field(
        default=True, description="Whether the frame's matrices hold the specimen; if not, it is added"
    )

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if (self.degrees_of_freedom is None) == (self.directions is None):
            message = "give degrees_of_freedom or directions"
            raise ValueError(message)
        return self

    def interface(self, names: tuple[str, ...]) -> tuple[Array, tuple[str, ...]]:
        """Γ and the names of the interface displacements, of a frame with named degrees of freedom."""
        if self.directions is not None:
            return matrix_of_rows(self.directions).T, self.names
        driven = [str(name) for name in self.degrees_of_freedom or ()]
        interface = np.zeros((len(names), len(driven)))
        for place, name in enumerate(driven):
            interface[place_of(names, name), place] = 1.0
        return interface, self.names or tuple(driven)

    acting: ClassVar[tuple[Effect, ...]] = ()  # What it does beyond its matrices

    def matrices(self, degrees: int) -> tuple[Array, Array, Array]:
        """K_e, C_e and M_e of the driven degrees of freedom."""
        stiffness = matrix_of_rows(self.stiffness_matrix_n_per_m)
        others = self.damping_matrix_n_s_per_m, self.mass_matrix_kg
        damping, mass = (
            np.zeros_like(stiffness) if rows is None else matrix_of_rows(rows) for rows in others
        )
        for name, matrix in (("stiffness", stiffness), ("damping", damping), ("mass", mass)):
            if matrix.shape != (len(stiffness), len(stiffness)) or len(stiffness) < degrees:
                raise InputError(
                    f"The specimen's {name} matrix must be square, with a row for each of its "
                    f"{degrees} driven degrees of freedom and for its inner ones",
                    value=f"shape {matrix.shape}",
                )
        if len(stiffness) == degrees:
            return stiffness, damping, mass
        try:
            stiffness, damping, mass = condensed(stiffness, (stiffness, damping, mass), degrees)
        except np.linalg.LinAlgError:
            raise InputError(
                "The inner degrees of freedom of a specimen must not move without a force",
                value="a singular stiffness matrix",
                remedy="Support them, or leave them out",
            ) from None
        return stiffness, damping, mass


class GeometryTable(DescribedTable):
    """Actuators that are pinned to a rigid body in a plane, exact for any rotation."""

    motions: tuple[Literal["x", "y", "rotation"], ...] = Field(
        description="What each degree of freedom of the specimen is: of the node along x or y, or a turn "
        "from x to y"
    )
    pins_m: Matrix = Field(description="Pin of each actuator on the body, as seen from its node: x, y")
    directions: Matrix = Field(description="Direction in which each actuator extends, at rest: x, y")
    lengths_m: Row | None = Field(
        default=None, description="Distance of the pins of each actuator at rest; long by default"
    )

    @property
    def geometry(self) -> PlanarGeometry:
        """Pins and directions."""
        return PlanarGeometry(
            motions=self.motions,
            pins=matrix_of_rows(self.pins_m),
            directions=matrix_of_rows(self.directions),
            lengths=None if self.lengths_m is None else np.array(self.lengths_m),
        )


class KinematicsTable(DescribedTable):
    """How the actuators move the degrees of freedom of the specimen: a matrix or a geometry."""

    matrix: Matrix | None = Field(
        default=None,
        description="Displacement of each actuator, one per row, for a unit of each degree of freedom of "
        "the specimen; rows of numbers, or their file",
    )
    geometry: GeometryTable | None = Field(
        default=None, description="Where the actuators are pinned, in place of `matrix`"
    )
    channels: Literal["actuators", "interface"] = Field(
        default="actuators",
        description="Whether command_1, measured_1, … of a test are displacements of the actuators or of "
        "the interface",
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.matrix is None) == (self.geometry is None):
            message = "give matrix or geometry"
            raise ValueError(message)
        return self

    @property
    def described(self) -> tuple[Array, PlanarGeometry | None]:
        """T, and the geometry of which it is the linear part."""
        if self.geometry is None:
            return matrix_of_rows(self.matrix), None
        geometry = self.geometry.geometry
        return geometry.matrix, geometry


class TransferMatrixTable(DescribedTable):
    """Transfer functions of all actuators, coupled."""

    matrix: tuple[tuple[TransferTable | float, ...], ...] = Field(
        description="Measured over commanded displacement: row i and column j is what the command of "
        "actuator j moves actuator i by; 0 where they are not coupled"
    )


class CoupledDescription(FrameDescription):
    """A structure whose specimen is driven at several degrees of freedom."""

    specimen: CoupledSpecimenTable = Field(  # type: ignore[assignment]  # of a structure with one actuator
        description="Specimen and interface"
    )
    kinematics: KinematicsTable | None = Field(
        default=None, description="Actuators; without it each degree of freedom has its own"
    )
    transfer_system: TransferMatrixTable | TransferTable | None = Field(  # type: ignore[assignment]  # likewise
        default=None, description="The rig: a matrix, or one transfer function that all actuators have"
    )


def damping_of(table: DampingTable, mass: Array, stiffness: Array) -> Array:
    """C [N·s/m] of a structure some of whose degrees of freedom may be without mass."""
    bare = ~mass.any(axis=1)
    if table.matrix_n_s_per_m is not None or not bare.any():
        return table.matrix(mass, stiffness)
    retained = ~bare
    coupling = stiffness[np.ix_(retained, bare)]
    inner = np.linalg.solve(stiffness[np.ix_(bare, bare)], coupling.T)
    followed = stiffness[np.ix_(retained, retained)] - coupling @ inner
    massed = mass[np.ix_(retained, retained)]
    if table.rayleigh_ratios is not None and table.rayleigh_frequencies_hz is not None:
        rayleigh_damping(massed, followed, table.rayleigh_ratios, table.rayleigh_frequencies_hz)
        omega = 2.0 * np.pi * np.array(table.rayleigh_frequencies_hz)
        system = 0.5 * np.stack([1.0 / omega, omega], axis=1)
        on_mass, on_stiffness = scipy.linalg.solve(system, np.array(table.rayleigh_ratios))
        return np.asarray(on_mass * mass + on_stiffness * stiffness)
    whole = np.zeros_like(mass)
    whole[np.ix_(retained, retained)] = table.matrix(massed, followed)
    return whole
