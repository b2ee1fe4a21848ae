"""The table `[tolerances]` of `frame.toml`: how exactly a structure is known."""

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import Physical
from reliab.structures.parts_of_structure import least_of, name_of_entries

_FAR = 3.0  # standard deviations that an entry may be off


class DescribedTable(BaseModel):
    """A table that holds its own keys and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


def require(sound: bool, message: str) -> None:  # noqa: FBT001 - what must hold, as in an assertion
    """Refuse a table whose keys do not go together."""
    if not sound:
        raise ValueError(message)


Deviation = Annotated[float, Physical("relative standard deviation", zero=True)]

Deviations = Deviation | tuple[Deviation, ...]


class EntriesTable(DescribedTable):
    """Relative standard deviation of entries of a matrix, and of those opposite to them."""

    matrix: Literal["mass", "damping", "stiffness"] = Field(description="Matrix of the whole structure")
    places: tuple[tuple[str | int, str | int], ...] = Field(
        description="Degrees of freedom of the row and the column of each entry"
    )
    deviation: Deviation = Field(description="Deviation of each of these entries")
    correlation: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="Correlation between these entries; 1 for entries that deviate together"
    )

    @property
    def part_deviations(self) -> dict[str, float]:
        """Deviations of all together and of each by itself, by name; places are numbers."""
        places = [(int(row) - 1, int(column) - 1) for row, column in self.places]
        common = math.sqrt(self.correlation) if len(places) > 1 else 0.0
        own_deviation = self.deviation * math.sqrt(1.0 - common**2)
        parts = {name_of_entries(self.matrix, [place]): own_deviation for place in places}
        return parts | ({name_of_entries(self.matrix, places): self.deviation * common} if common else {})

    def check_structure(self, names: tuple[str, ...], matrix: Array) -> Self:
        """Return the table with numbers for names; the entries must be those of a structure."""
        numbers = []
        for place in self.places:
            row, column = (_number(name, names) for name in place)
            self._require_structure(matrix, row, column)
            numbers.append((row + 1, column + 1))
        return self.model_copy(update={"places": tuple(numbers)})

    def _require_structure(self, matrix: Array, row: int, column: int) -> None:
        location = f"row {row + 1}, column {column + 1} of the {self.matrix} matrix"
        if matrix[row, column] == 0.0:
            raise InputError(
                "The tolerance of an entry is relative to it",
                value=f"zero in {location}",
                remedy="State an entry that is not zero, or a storey or mode",
            )
        for far in (-_FAR * self.deviation, _FAR * self.deviation):
            changed_matrix = np.array(matrix)
            changed_matrix[row, column] = changed_matrix[column, row] = (1.0 + far) * matrix[row, column]
            if np.linalg.eigvalsh(changed_matrix)[0] < least_of(matrix):
                raise InputError(
                    "The standard deviation of an entry is too large",
                    value=f"{self.deviation:g} for {location}",
                    remedy="State a smaller deviation, or those of storeys or modes",
                )


def _number(name: str | int, names: tuple[str, ...]) -> int:
    if str(name) not in names:
        raise InputError(
            "An entry must be named by the degrees of freedom of its row and column",
            value=repr(name),
            remedy=f"Name two of {', '.join(names)}",
        )
    return names.index(str(name))


class TolerancesTable(DescribedTable):
    """Relative standard deviations of factors of the whole structure, and of its parts."""

    mass: Deviation = Field(default=0.0, description="Deviation of a factor on the mass matrix")
    stiffness: Deviation = Field(
        default=0.0,
        description="Deviation of a factor on the stiffness matrix and the specimen’s stiffness",
    )
    frequency: Deviation | None = Field(
        default=None,
        description="Deviation of the measured natural frequencies, in place of `mass` and `stiffness`",
    )
    damping: Deviation | None = Field(
        default=None, description="Deviation of a factor on the damping matrix, in place of `damping_ratio`"
    )
    damping_ratio: Deviation = Field(default=0.0, description="Deviation of a factor on all damping ratios")
    specimen_stiffness: Deviation = Field(
        default=0.0,
        description="Deviation of the specimen’s share of the stiffness, in addition to the factors above",
    )
    specimen_changes_structure: bool = Field(
        default=False,
        description="Whether a deviation of the specimen changes the matrices, since the computed part is "
        "as stated",
    )
    floor_masses: Deviations = Field(
        default=(),
        description="Deviation of the mass of each floor, each by itself: one number or one for each",
    )
    storey_stiffnesses: Deviations = Field(
        default=(), description="Deviation of the stiffness of each storey, likewise"
    )
    storey_dampings: Deviations = Field(
        default=(), description="Deviation of the damping of each storey, likewise"
    )
    storey_correlation: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="Correlation between floors or storeys whose deviation is one number"
    )
    mode_frequencies: Deviations = Field(
        default=(),
        description="Deviation of the natural frequency of each mode, in place of masses and stiffnesses",
    )
    mode_damping_ratios: Deviations = Field(
        default=(),
        description="Deviation of the damping ratio of each mode, in place of other tolerances of damping",
    )

    entries: tuple[EntriesTable, ...] = Field(
        default=(), description="Deviations of single entries of matrices"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        matrices = self.mass or self.stiffness
        storeys = self.floor_masses or self.storey_stiffnesses or self.entries
        require(self.frequency is None or not matrices, "give frequency, or mass and stiffness")
        require(
            not self.mode_frequencies or not (self.frequency is not None or matrices or storeys),
            "give mode_frequencies, or tolerances of mass, stiffness and frequency",
        )
        ways = self.damping is not None, bool(self.damping_ratio), bool(self.mode_damping_ratios)
        require(
            sum(ways) <= 1 and not (self.mode_damping_ratios and (self.storey_dampings or self.entries)),
            "give one of damping, damping_ratio and mode_damping_ratios",
        )
        storey_tables = (self.floor_masses, self.storey_stiffnesses, self.storey_dampings)
        require(
            not self.storey_correlation or any(isinstance(values, float) for values in storey_tables),
            "storey_correlation needs floors or storeys whose deviation is one number",
        )
        return self

    @property
    def frequency_deviation(self) -> float:
        """Relative standard deviation of the natural frequencies, ω² = k/m [-]."""
        return 0.5 * math.hypot(self.mass, self.stiffness) if self.frequency is None else self.frequency

    @property
    def specimen_deviation(self) -> float:
        """That of the specimen where the structure stays as it is [-]."""
        return 0.0 if self.specimen_changes_structure else self.specimen_stiffness

    def check_structure(self, names: tuple[str, ...], mass: Array, damping: Array, stiffness: Array) -> Self:
        """Return the table with numbers for the names of degrees of freedom."""
        matrices = {"mass": mass, "damping": damping, "stiffness": stiffness}
        entries = (table.check_structure(names, matrices[table.matrix]) for table in self.entries)
        return self.model_copy(update={"entries": tuple(entries)})

    def part_deviations(self, size: int) -> dict[str, float]:
        """Relative standard deviations of parts of a structure of so many degrees of freedom, by name."""
        common_share = math.sqrt(self.storey_correlation)
        specimen_deviation = self.specimen_stiffness if self.specimen_changes_structure else 0.0
        deviations = {
            "damping": self.damping or 0.0,
            "specimen_stiffness": specimen_deviation,
            **_number_deviations("floor_mass", self.floor_masses, common_share, size),
            **_number_deviations("storey_stiffness", self.storey_stiffnesses, common_share, size),
            **_number_deviations("storey_damping", self.storey_dampings, common_share, size),
            **_number_deviations("mode_frequency", self.mode_frequencies, 0.0, size),
            **_number_deviations("mode_damping_ratio", self.mode_damping_ratios, 0.0, size),
        }
        for table in self.entries:
            for name, deviation in table.part_deviations.items():
                deviations[name] = math.hypot(deviations.get(name, 0.0), deviation)
        return {name: deviation for name, deviation in deviations.items() if deviation}


def _number_deviations(name: str, values: Deviations, common: float, size: int) -> dict[str, float]:
    """Deviations of all alike, without a number, and of floors, storeys or modes by theirs."""
    if isinstance(values, float):
        own = values * math.sqrt(1.0 - common**2)
        return {name: common * values} | {f"{name}_{place + 1}": own for place in range(size)}
    if len(values) not in (0, size):
        raise InputError(
            f"Tolerances of parts are one number, or one for each of {size} floors, storeys or modes",
            value=f"{len(values)} of {name.replace('_', ' ')}",
            remedy="Give one number, or as many as the structure has degrees of freedom",
        )
    return {f"{name}_{place}": value for place, value in enumerate(values, start=1)}
