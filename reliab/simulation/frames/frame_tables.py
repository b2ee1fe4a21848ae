"""The tables of `frame.toml`: allowed keys, and the matrices, specimen and actuator that they describe."""

import math
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from reliab.arrays import Array
from reliab.effects import Effect, find_effect
from reliab.errors import InputError
from reliab.received import named_within
from reliab.simulation.frames.tolerances_table import DescribedTable, TolerancesTable
from reliab.simulation.transfer_systems import ServoHydraulic, TransferFunction, TransferSystem
from reliab.simulation.transfer_systems.reading import read_matlab
from reliab.structures import drift_interface, floor_interface
from reliab.structures.frames import (
    Frame,
    PlanarFrame,
    modal_damping,
    place_of,
    rayleigh_damping,
    shear_frame,
)
from reliab.vocabulary import MILLI

Positive = Annotated[float, Field(gt=0.0)]

Root = float | tuple[float, float]
"""A real zero or pole [1/s], or real and imaginary part of one that stands for a conjugate pair."""


class ServoHydraulicTable(DescribedTable):
    """The servo-hydraulic plant of the benchmark, with other numbers where given."""

    input_gain: Positive = Field(
        default=ServoHydraulic.input_gain, description="Gain of the command’s way to the valve"
    )
    valve_gain: Positive = Field(
        default=ServoHydraulic.valve_gain, description="Gain of the valve [N/(m·s³)]"
    )
    piston_coupling_n_per_m: Positive = Field(
        default=ServoHydraulic.piston_coupling, description="Coupling of the piston"
    )
    leakage_per_s: Positive = Field(default=ServoHydraulic.leakage, description="Leakage past the piston")
    valve_damping_per_s: Positive = Field(
        default=ServoHydraulic.valve_damping, description="Damping of the valve"
    )
    valve_stiffness_per_s2: Positive = Field(
        default=ServoHydraulic.valve_stiffness, description="Stiffness of the valve"
    )

    @property
    def plant(self) -> ServoHydraulic:
        """The actuator."""
        return ServoHydraulic(
            input_gain=self.input_gain,
            valve_gain=self.valve_gain,
            piston_coupling=self.piston_coupling_n_per_m,
            leakage=self.leakage_per_s,
            valve_damping=self.valve_damping_per_s,
            valve_stiffness=self.valve_stiffness_per_s2,
        )


class TransferTable(DescribedTable):
    """The actuator with its inner control, in one of its ways, and a pure delay beside it."""

    gain: Positive | None = Field(default=None, description="Gain at rest, alone or beside `poles_per_s`")
    numerator: tuple[float, ...] | None = Field(
        default=None, description="Coefficients of the numerator, in descending powers of s"
    )
    denominator: tuple[float, ...] | None = Field(
        default=None, description="Coefficients of the denominator, likewise"
    )
    zeros_per_s: tuple[Root, ...] = Field(default=(), description="Zeros, as `poles_per_s`")
    poles_per_s: tuple[Root, ...] | None = Field(
        default=None, description="Poles; [real, imaginary] stands for a conjugate pair"
    )
    file: str | None = Field(
        default=None, description="MATLAB file beside this one with num and den, z, p and k, or A, B, C and D"
    )
    variable: str | None = Field(default=None, description="Structure in that file which holds them")
    servo_hydraulic: ServoHydraulicTable | None = Field(default=None, description="Plant of the benchmark")
    delay_ms: Annotated[float, Field(ge=0.0)] = Field(
        default=0.0, description="Pure delay beside each of these"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.numerator is None) != (self.denominator is None):
            message = "numerator and denominator belong together"
            raise ValueError(message)
        ways = self.denominator, self.poles_per_s, self.file, self.servo_hydraulic
        count = sum(way is not None for way in ways)
        if count > 1 or (count == 0 and self.gain is None and not self.delay_ms):
            message = (
                "give numerator and denominator, or poles_per_s, file, servo_hydraulic, or gain and delay_ms"
            )
            raise ValueError(message)
        only_with = (
            (
                self.gain is not None,
                self.poles_per_s is not None or count == 0,
                "gain needs poles_per_s or delay_ms",
            ),
            (bool(self.zeros_per_s), self.poles_per_s is not None, "zeros_per_s needs poles_per_s"),
            (self.variable is not None, self.file is not None, "variable needs file"),
            (bool(self.delay_ms), self.servo_hydraulic is None, "servo_hydraulic takes no delay_ms"),
        )
        for present, allowed, message in only_with:
            if present and not allowed:
                raise ValueError(message)
        return self

    def system(self, folder: Path) -> TransferSystem:
        """Transfer system; a file is looked for in the folder of the description."""
        delay = self.delay_ms / MILLI
        gain = 1.0 if self.gain is None else self.gain
        if self.servo_hydraulic is not None:
            return self.servo_hydraulic.plant
        if self.file is not None:
            if Path(self.file).suffix.lower() != ".mat":
                raise InputError(
                    "A transfer system is read from a MATLAB file",
                    value=self.file,
                    remedy="Save num and den with scipy.io.savemat, or give numerator and denominator here",
                )
            return read_matlab(named_within(folder, self.file, where=""), self.variable, delay)
        if self.poles_per_s is not None:
            zeros, poles = _roots(self.zeros_per_s), _roots(self.poles_per_s)
            return TransferFunction.from_poles(zeros, poles, gain, static=True, delay=delay)
        numerator, denominator = self.numerator or (gain,), self.denominator or (1.0,)
        return TransferFunction(numerator=numerator, denominator=denominator, delay=delay)


def _roots(entries: tuple[Root, ...]) -> list[complex]:
    """All zeros or poles, both of each pair."""
    roots: list[complex] = []
    for root in entries:
        if isinstance(root, tuple):
            roots += [complex(*root), complex(root[0], -root[1])] if root[1] else [complex(root[0])]
        else:
            roots.append(complex(root))
    return roots


Row = tuple[float, ...]

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
        mass = np.diag(self.masses_kg) if self.masses_kg is not None else matrix_of_rows(self.mass_matrix_kg)
        if self.planar is not None:
            return mass, self.planar.stiffness
        if self.stiffness_matrix_n_per_m is not None:
            return mass, matrix_of_rows(self.stiffness_matrix_n_per_m)
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
            return matrix_of_rows(self.matrix_n_s_per_m)
        if self.rayleigh_ratios is not None and self.rayleigh_frequencies_hz is not None:
            return rayleigh_damping(mass, stiffness, self.rayleigh_ratios, self.rayleigh_frequencies_hz)
        return modal_damping(mass, stiffness, self.ratio if self.ratio is not None else self.ratios or ())


class EffectTable(BaseModel):
    """What the specimen does beyond its linear part: an effect of the library with its parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, defer_build=True)

    name: str = Field(description="Name of the effect; its parameters stand beside it")

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

    def matrices(self, _: int) -> tuple[Array, Array, Array]:
        """K_e, C_e and M_e of its linear part."""
        damping = self.damping_n_s_per_m or 0.0
        if self.damping_ratio is not None:
            damping = 2.0 * self.damping_ratio * math.sqrt(self.stiffness_n_per_m * self.mass_kg)
        stiffness, viscous, mass = np.array([self.stiffness_n_per_m, damping, self.mass_kg]).reshape(3, 1, 1)
        return stiffness, viscous, mass

    @property
    def acting(self) -> tuple[Effect, ...]:
        """What it does beyond its linear part."""
        return tuple(table.effect for table in self.effects)

    def interface(self, names: tuple[str, ...]) -> tuple[Array, tuple[str, ...]]:
        """Γ and the name of the interface displacement, of a frame with named degrees of freedom."""
        if self.direction is not None:
            return np.array(self.direction, dtype=np.float64)[:, np.newaxis], ("1",)
        interface = np.zeros((len(names), 1))
        interface[place_of(names, self.degree_of_freedom or "")] = 1.0
        if self.below is not None:
            interface[place_of(names, self.below)] -= 1.0
        return interface, ("1",)


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
    tolerances: TolerancesTable = Field(
        default=TolerancesTable(), description="How exactly the structure is known, for `reliab assess`"
    )
    transfer_system: TransferTable | None = Field(
        default=None, description="The rig, whose error `reliab criterion` states"
    )


def matrix_of_rows(rows: tuple[Row, ...] | None) -> Array:
    """Matrix of rows, which must be of one length."""
    rows = rows or ()
    if len({len(row) for row in rows}) != 1:
        raise InputError(
            "The rows of a matrix must be of one length", value=f"lengths {[len(row) for row in rows]}"
        )
    return np.array(rows, dtype=np.float64)
