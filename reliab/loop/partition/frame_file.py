"""A structure as a laboratory describes it in a file: `frame.toml`.

One set of tables describes every structure::

    name = "three storeys, a brace in the laboratory"

    [frame]                                  # either a shear frame …
    masses_kg = [1000.0, 1000.0, 1000.0]
    storey_stiffnesses_n_per_m = [2e6, 2e6, 2e6]
    # … or matrices: mass_matrix_kg (or masses_kg) and stiffness_matrix_n_per_m
    # … or [frame.planar] with storeys, bays, elastic_modulus_pa, column_inertia_m4, beam_inertia_m4,
    #   storey_height_m, bay_width_m and fixed_base, beside masses_kg
    names = ["1", "2", "3"]                  # optional
    influence = [1.0, 1.0, 1.0]              # optional

    [damping]                                # one of
    ratio = 0.02                             # the same for all modes, or ratios = [0.02, 0.03, 0.05]
    # rayleigh_ratios = [0.02, 0.02] with rayleigh_frequencies_hz = [1.0, 8.0]
    # matrix_n_s_per_m = [[…], …]

    [specimen]
    degree_of_freedom = "1"                  # between ground and floor; with below = "2" between two floors;
    # or direction = [1.0, 0.0, 0.0]
    stiffness_n_per_m = 5e5
    damping_n_s_per_m = 100.0                # optional, or damping_ratio of the specimen alone
    mass_kg = 20.0                           # optional
    part_of_structure = true                 # false: the specimen is added to the matrices above

    [[specimen.effects]]                     # optional: what it does beyond its linear part
    name = "coulomb_friction"
    force_n = 50.0                           # parameters by the names of the library

    [error]                                  # optional: whose error counts
    of = "interface"                         # or a degree of freedom, or "drift"
    between = ["2", "1"]                     # of a drift
"""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from reliab.errors import InputError
from reliab.loop.effects import Effect, find_effect
from reliab.loop.hybrid_test.specimen import Specimen
from reliab.loop.partition.partition import Partition, drift_interface, floor_interface, with_specimen
from reliab.loop.structures import Frame, PlanarFrame, modal_damping, rayleigh_damping, shear_frame

Array = NDArray[np.float64]
Row = tuple[float, ...]
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class PlanarTable(_Table):
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


class FrameTable(_Table):
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


class DampingTable(_Table):
    """`[damping]`: one way of saying it."""

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


class SpecimenTable(_Table):
    """`[specimen]`: what stands in the laboratory and where."""

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


class ErrorTable(_Table):
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


class FrameDescription(_Table):
    """The whole file."""

    name: str = "frame"
    kind: Literal["frame"] = "frame"
    frame: FrameTable
    damping: DampingTable
    specimen: SpecimenTable
    error: ErrorTable = ErrorTable()


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameUnderTest:
    """A partitioned frame and the response whose error counts.

    Attributes
    ----------
    name : str
        What the file calls it.
    partition : Partition
        Frame, interface and specimen.
    output : numpy.ndarray or None
        Weights of the degrees of freedom [-], shape (degrees of freedom,); None for the measured interface
        displacement.
    error_of : str
        The same in words.
    """

    name: str
    partition: Partition
    output: Array | None
    error_of: str


def frame_of_tables(content: dict[str, Any], where: str) -> FrameUnderTest:
    """Build a tested frame from the tables of a file.

    Parameters
    ----------
    content : dict
        Tables of the TOML file.
    where : str
        The file, for messages.

    Returns
    -------
    FrameUnderTest
        The frame with its partition.

    Raises
    ------
    InputError
        If a key is unknown, a value is not allowed, or the structure is not sound.
    """
    try:
        description = FrameDescription.model_validate(content)
    except ValidationError as error:
        raise InputError(
            "A description of a frame holds known keys with allowed values",
            value="; ".join(_fault(dict(fault)) for fault in error.errors()),
            remedy="Compare with the frames that ship in datasets/frames",
            where=where,
        ) from None
    try:
        return _built(description)
    except InputError as error:
        raise InputError(error.rule, value=error.value, remedy=error.remedy, where=where) from None


def read_frame(path: str | Path) -> FrameUnderTest:
    """Read a tested frame from its TOML file.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.

    Returns
    -------
    FrameUnderTest
        The frame with its partition.

    Raises
    ------
    InputError
        If the file is missing or no TOML, a key is unknown or the structure is not sound; the message says
        where.
    """
    try:
        content = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            "A frame is described in a TOML file", value=error.strerror, where=str(path)
        ) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(
            "A description of a frame must be valid TOML", value=error, where=str(path)
        ) from None
    return frame_of_tables(content, str(path))


def _built(description: FrameDescription) -> FrameUnderTest:
    table = description.frame
    mass, stiffness = table.matrices
    plain = Frame(
        mass=mass,
        stiffness=stiffness,
        damping=np.zeros_like(np.asarray(stiffness)),
        influence=table.influence,  # type: ignore[arg-type]  # made an array by Frame
        names=table.names,
    )
    frame = Frame(
        mass=mass,
        stiffness=stiffness,
        damping=description.damping.matrix(plain.mass, plain.stiffness),
        influence=plain.influence,
        names=plain.names,
    )
    interface = description.specimen.interface(frame)
    specimen = description.specimen.specimen
    if not description.specimen.part_of_structure:
        if interface.shape != (frame.size,):
            raise InputError(f"The direction needs {frame.size} numbers", value=interface.size)
        frame = with_specimen(frame, interface, specimen)
    partition = Partition(
        frame=frame,
        interface=interface,
        specimen=specimen,
        effects=tuple(table.effect for table in description.specimen.effects),
    )
    of = description.error
    words = {"interface": "the measured interface displacement", "drift": f"the drift between {of.between}"}
    return FrameUnderTest(
        name=description.name,
        partition=partition,
        output=of.output(frame),
        error_of=words.get(of.of, f"degree of freedom {of.of}"),
    )


def _matrix(rows: tuple[Row, ...] | None) -> Array:
    """Matrix of rows, which must be of one length."""
    rows = rows or ()
    if len({len(row) for row in rows}) != 1:
        raise InputError(
            "The rows of a matrix must be of one length", value=f"lengths {[len(row) for row in rows]}"
        )
    return np.array(rows, dtype=np.float64)


def _fault(fault: dict[str, Any]) -> str:
    """One fault with the place of its key."""
    place = ".".join(str(part) for part in fault["loc"]) or "the file"
    if fault["type"] == "extra_forbidden":
        return f"{place} is not a known key"
    if fault["type"] == "missing":
        return f"{place} is missing"
    message = str(fault["msg"]).removeprefix("Value error, ")
    return f"{place}: {message[0].lower()}{message[1:]}"
