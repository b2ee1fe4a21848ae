"""The tables of `frame.toml`: allowed keys, and the matrices of the structure that they describe."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.core.stated_value import Physical
from reliab.core.untrusted_files import resolve_within
from reliab.effects.effect import Effect
from reliab.effects.registry import find_effect
from reliab.simulation.frames.tolerances_table import DescribedTable, TolerancesTable, require
from reliab.simulation.frames.transfer_table import PlanarGeometry, TransferTable
from reliab.structures.frame import (
    Frame,
    condense_statically,
    drift_interface,
    floor_interface,
    massless,
    modal_damping,
    place_of,
    rayleigh_damping,
    static_shapes,
)
from reliab.structures.planar_frame import PlanarFrame, shear_frame

Row = tuple[float, ...]

Matrix = tuple[Row, ...]

_MATRICES: Final = frozenset(
    [
        "mass_matrix_kg",
        "stiffness_matrix_n_per_m",
        "damping_matrix_n_s_per_m",
        "matrix_n_s_per_m",
    ]
)
_REMEDY: Final = "Write rows of numbers, separated by commas or spaces"


def read_matrices(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Put the rows of a file in the place of its name, wherever a matrix is described."""
    return {key: _read(key, value, folder) for key, value in content.items()}


def _read(key: str, value: Any, folder: Path) -> Any:  # noqa: ANN401 - TOML holds anything
    if isinstance(value, dict):
        if key == "kinematics" and isinstance(value.get("matrix"), str):
            value = {**value, "matrix": _rows(value["matrix"], folder)}
        return read_matrices(value, folder)
    if key in _MATRICES and isinstance(value, str):
        return _rows(value, folder)
    return value


def _rows(name: str, folder: Path) -> list[list[float]]:
    path = resolve_within(folder, name, where="")
    LIMITS["matrix"].require_small(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or "bytes that are not text"
        raise InputError("Cannot read the matrix", value=reason, remedy=_REMEDY, where=name) from None
    return list(_numbers(lines, name))


def _numbers(lines: Iterable[str], name: str) -> Iterable[list[float]]:
    for number, line in enumerate(lines, start=1):
        text = line.split("#")[0].replace(",", " ").replace(";", " ").split()
        try:
            row = [float(word) for word in text]
        except ValueError:
            raise InputError(
                "Not only numbers in the matrix", value=f"a text in line {number}", remedy=_REMEDY, where=name
            ) from None
        if row:
            yield row


def matrix_of_rows(rows: tuple[Row, ...] | None) -> Array:
    """Matrix of rows, which must be of one length."""
    rows = rows or ()
    if len({len(row) for row in rows}) != 1:
        raise InputError(
            "The rows of the matrix have different lengths",
            value=f"lengths {[len(row) for row in rows]}",
            remedy="Give as many numbers in each row",
        )
    return np.array(rows, dtype=np.float64)


_SINGLE_KEYS = {"stiffness_n_per_m", "damping_n_s_per_m", "damping_ratio", "mass_kg", "effects", "below"}
_COUPLED_KEYS = {"names", "stiffness_matrix_n_per_m", "damping_matrix_n_s_per_m", "mass_matrix_kg"}


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
            raise InputError(
                f"{self.name} needs its parameters",
                value=f"no {', '.join(missing)}",
                remedy="Give them in SI units",
            ) from None


class AttachedSpecimenTable(DescribedTable):
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
        foreign = sorted((_SINGLE_KEYS if self.has_several else _COUPLED_KEYS) & self.model_fields_set)
        number = "several driven degrees" if self.has_several else "one driven degree"
        require(not foreign, f"a specimen of {number} of freedom takes no {', '.join(foreign)}")
        require(
            not self.has_several or self.stiffness_matrix_n_per_m is not None,
            "several driven degrees of freedom need stiffness_matrix_n_per_m",
        )
        require(self.below is None or self.degree_of_freedom is not None, "below needs degree_of_freedom")
        require(
            self.damping_n_s_per_m is None or self.damping_ratio is None,
            "give damping_n_s_per_m or damping_ratio",
        )
        return self

    @property
    def has_several(self) -> bool:
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
        if self.has_several:
            return self._condense(degrees)
        damping = self.damping_n_s_per_m or 0.0
        if self.damping_ratio is not None:
            damping = 2.0 * self.damping_ratio * math.sqrt(self.stiffness_n_per_m * self.mass_kg)
        stiffness, viscous, mass = np.array([self.stiffness_n_per_m, damping, self.mass_kg]).reshape(3, 1, 1)
        return stiffness, viscous, mass

    def _condense(self, degrees: int) -> tuple[Array, Array, Array]:
        """Matrices without inner degrees of freedom."""
        stiffness = matrix_of_rows(self.stiffness_matrix_n_per_m)
        other_matrices = self.damping_matrix_n_s_per_m, self.mass_matrix_kg
        damping, mass = (
            np.zeros_like(stiffness) if rows is None else matrix_of_rows(rows) for rows in other_matrices
        )
        for name, matrix in (("stiffness", stiffness), ("damping", damping), ("mass", mass)):
            if matrix.shape != (len(stiffness), len(stiffness)) or len(stiffness) < degrees:
                raise InputError(
                    f"The specimen's {name} matrix must be square, with a row for each of its "
                    f"{degrees} driven degrees of freedom and for its inner ones",
                    value=f"shape {matrix.shape}",
                    remedy="Give the driven degrees of freedom first, then the inner ones",
                )
        if len(stiffness) == degrees:
            return stiffness, damping, mass
        try:
            stiffness, damping, mass = condense_statically(stiffness, (stiffness, damping, mass), degrees)
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
    def describe(self) -> tuple[Array, PlanarGeometry | None]:
        """T, and the geometry of which it is the linear part."""
        if self.geometry is None:
            return matrix_of_rows(self.matrix), None
        geometry = self.geometry.geometry
        return geometry.matrix, geometry


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
        has_mass, shapes = ~bare, static_shapes(stiffness, bare)
        damping = np.zeros_like(mass)
        damping[np.ix_(has_mass, has_mass)] = modal_damping(
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
    specimen: AttachedSpecimenTable = Field(description="Specimen and interface")
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
    def has_several_actuators(self) -> bool:
        """Whether the specimen is described as driven by several actuators."""
        return self.specimen.has_several or self.kinematics is not None
