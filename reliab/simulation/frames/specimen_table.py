"""The tables `[specimen]` and `[kinematics]` of `frame.toml`: what is tested, and how actuators move it."""

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.physical_range import Physical
from reliab.effects.effect import Effect
from reliab.effects.registry import find_effect
from reliab.simulation.frames.matrix_files import Matrix, Row, matrix_of_rows
from reliab.simulation.frames.planar_geometry import PlanarGeometry
from reliab.simulation.frames.tolerances_table import DescribedTable, require
from reliab.structures.frames.frame import condensed, place_of

_OF_ONE = {"stiffness_n_per_m", "damping_n_s_per_m", "damping_ratio", "mass_kg", "effects", "below"}
_OF_SEVERAL = {"names", "stiffness_matrix_n_per_m", "damping_matrix_n_s_per_m", "mass_matrix_kg"}


class EffectTable(BaseModel):
    """What the specimen does beyond its linear part: an effect of the library with its parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, defer_build=True)

    name: str = Field(description="Name of the effect; its parameters are further keys of the same table")

    @property
    def effect(self) -> Effect:
        """The effect."""
        kind: type[Effect] = find_effect(self.name)
        values = dict(self.model_extra or {})
        names = [parameter.name for parameter in kind.parameters]
        unknown = sorted(set(values) - set(names))
        if unknown:
            raise InputError(
                f"The parameters of {self.name} are {', '.join(names)}",
                value=", ".join(unknown),
                remedy="Give these, in SI units",
            )
        try:
            return kind(**values)
        except TypeError:
            missing = [name for name in names if name not in values]
            raise InputError(f"{self.name} needs its parameters", value=f"no {', '.join(missing)}") from None


class SpecimenTable(DescribedTable):
    """The specimen, and the interface at which it is attached: one driven degree of freedom, or several."""

    degree_of_freedom: str | int | None = Field(
        default=None, description="Floor that the specimen connects with the ground, or with `below`"
    )
    below: str | int | None = Field(default=None, description="Floor at its other end; without it the ground")
    direction: Row | None = Field(
        default=None,
        description="Interface displacement by degree of freedom, in place of `degree_of_freedom`",
    )
    stiffness_n_per_m: Annotated[float, Physical("stiffness", zero=True)] = Field(
        default=0.0, description="Stiffness of the specimen"
    )
    damping_n_s_per_m: Annotated[float, Physical("damping coefficient", zero=True, signed=True)] | None = (
        Field(default=None, description="Damping coefficient of the specimen")
    )
    damping_ratio: Annotated[float, Physical("damping ratio", zero=True)] | None = Field(
        default=None, description="Damping ratio of the specimen by itself, in place of its coefficient"
    )
    mass_kg: Annotated[float, Physical("mass", zero=True)] = Field(
        default=0.0, description="Mass of the specimen"
    )
    effects: tuple[EffectTable, ...] = Field(
        default=(), description="Effects of the specimen in addition to its linear force"
    )
    degrees_of_freedom: Annotated[tuple[str | int, ...], Field(min_length=1)] | None = Field(
        default=None, description="Driven degrees of freedom of the frame, where there are several"
    )
    directions: Matrix | None = Field(
        default=None,
        description="Each interface displacement by degree of freedom of the frame, in place of "
        "`degrees_of_freedom`",
    )
    names: tuple[str, ...] = Field(default=(), description="Names of several interface displacements")
    stiffness_matrix_n_per_m: Matrix | None = Field(
        default=None,
        description="Stiffness matrix of a specimen that is driven at several degrees of freedom, or its "
        "file; further rows are inner degrees of freedom, which are condensed statically",
    )
    damping_matrix_n_s_per_m: Matrix | None = Field(default=None, description="Damping matrix, likewise")
    mass_matrix_kg: Matrix | None = Field(default=None, description="Mass matrix, likewise")
    part_of_structure: bool = Field(
        default=True, description="Whether the matrices include the specimen; if not, it is added to them"
    )

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        places = (self.degree_of_freedom, self.direction, self.degrees_of_freedom, self.directions)
        require(
            sum(place is not None for place in places) == 1,
            "give degree_of_freedom or direction; of several degrees_of_freedom or directions",
        )
        foreign = sorted((_OF_ONE if self.several else _OF_SEVERAL) & self.model_fields_set)
        number = "several driven degrees" if self.several else "one driven degree"
        require(not foreign, f"a specimen of {number} of freedom takes no {', '.join(foreign)}")
        require(
            not self.several or self.stiffness_matrix_n_per_m is not None,
            "several driven degrees of freedom need stiffness_matrix_n_per_m",
        )
        require(self.below is None or self.degree_of_freedom is not None, "below needs degree_of_freedom")
        require(
            self.damping_n_s_per_m is None or self.damping_ratio is None,
            "give damping_n_s_per_m or damping_ratio",
        )
        return self

    @property
    def several(self) -> bool:
        """Whether it is described by matrices of its driven degrees of freedom."""
        return self.degrees_of_freedom is not None or self.directions is not None

    def interface(self, names: tuple[str, ...]) -> tuple[Array, tuple[str, ...]]:
        """Γ and the names of the interface displacements, of a frame with named degrees of freedom."""
        if self.direction is not None:
            return np.array(self.direction, dtype=np.float64)[:, np.newaxis], ()
        if self.directions is not None:
            return matrix_of_rows(self.directions).T, self.names
        driven = self.degrees_of_freedom or (self.degree_of_freedom or "",)
        interface = np.zeros((len(names), len(driven)))
        for place, name in enumerate(driven):
            interface[place_of(names, name), place] = 1.0
        if self.below is not None:
            interface[place_of(names, self.below), 0] -= 1.0
        return interface, self.names or tuple(map(str, self.degrees_of_freedom or ()))

    def matrices(self, degrees: int) -> tuple[Array, Array, Array]:
        """K_e, C_e and M_e of the driven degrees of freedom."""
        if self.several:
            return self._condensed(degrees)
        damping = self.damping_n_s_per_m or 0.0
        if self.damping_ratio is not None:
            damping = 2.0 * self.damping_ratio * math.sqrt(self.stiffness_n_per_m * self.mass_kg)
        stiffness, viscous, mass = np.array([self.stiffness_n_per_m, damping, self.mass_kg]).reshape(3, 1, 1)
        return stiffness, viscous, mass

    def _condensed(self, degrees: int) -> tuple[Array, Array, Array]:
        """Matrices without inner degrees of freedom."""
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
        description="Kind of each degree of freedom of the specimen: displacement of the node along x or y, "
        "or rotation from x to y"
    )
    pins_m: Matrix = Field(description="Pin of each actuator on the body, as seen from its node: x, y")
    directions: Matrix = Field(description="Direction in which each actuator extends, at rest: x, y")
    lengths_m: Row | None = Field(
        default=None, description="Distance between the pins of each actuator at rest; very long by default"
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
        require((self.matrix is None) != (self.geometry is None), "give matrix or geometry")
        return self

    @property
    def described(self) -> tuple[Array, PlanarGeometry | None]:
        """T, and the geometry of which it is the linear part."""
        if self.geometry is None:
            return matrix_of_rows(self.matrix), None
        geometry = self.geometry.geometry
        return geometry.matrix, geometry
