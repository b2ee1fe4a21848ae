"""The response that a perfect actuator would have produced, with its band: a spoiled test, corrected."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.exact_response import (
    ExactResponse,
    ExactTest,
    exact_test,
)
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.assessment.frame_responses import weights_of_storeys
from reliab.assessment.rebuilt_error.spread import HALF_WIDTH
from reliab.core.arrays import Array
from reliab.core.significant_digits import percent

if TYPE_CHECKING:
    import xarray as xr

_SPECIMENS = {
    "stated": "stated as linear",
    "modelled": "a calibrated model",
    "measured": "learned from its force",
}
_SMALL = 0.1  # of the peak of the exact response, up to which the largest correction is small
_TINY = np.finfo(float).tiny
_LEVELS = (0.05, 0.95)
_UNITS = {
    **dict.fromkeys(("measured", "measured_peak", "exact", "exact_peak", "drift_peak"), "m"),
    "acceleration": "m_s2",
    "specimen_force": "n",
}
_Key = tuple[str, str]  # quantity and name of a degree of freedom
_OTHER_COLUMNS = (
    "Displacements and accelerations of degrees of freedom other than those of the interface need the ground "
    "acceleration as a channel of the test."
)
_NOT_ITS_MOTION = (
    "The recorded ground acceleration does not explain the force at the interface: it is assumed to "
    "belong to another test, and no response is given for degrees of freedom other than those of the "
    "interface."
)


def correct_response(assessment: Assessment | FrameAssessment) -> "xr.Dataset":
    """Put the response that a perfect actuator would have produced into a dataset.

    Parameters
    ----------
    assessment : Assessment or FrameAssessment
        What was found about a test.

    Returns
    -------
    xarray.Dataset
        Over `time_s`: `measured_m` without the sensor's offset and noise, `exact_m`, `acceleration_m_s2`, the
        absolute acceleration of the mass [m/s²], and `specimen_force_n` [N] where the specimen was measured
        or masses are stated; of a calibrated model only displacements. Each but the first with the ends of
        its 90 % band, `exact_low_m`, `exact_high_m` and so on. Of a frame whose ground acceleration is a
        channel of the test also those of every degree of freedom, `exact_NAME_m` and `acceleration_NAME_m_s2`
        with `exact_low_NAME_m` and so on. With several actuators interface displacements and forces have
        names too, and names no units: they are in SI units, of rotations in rad and N·m. Attributes, with
        `_low` and `_high`: peaks of the displacements and of drifts of storeys, the energy that the specimen
        dissipates [J], and `note`, which says how large the correction is and what is not known.

    Examples
    --------
    >>> from reliab import assess
    >>> corrected = correct_response(assess("sample_test", f=1, xi=0.02))
    >>> [name for name in sorted(corrected.data_vars) if "low" not in name and "high" not in name]
    ['acceleration_m_s2', 'exact_m', 'measured_m']
    >>> bool(abs(corrected.attrs["exact_peak_m"] / corrected.attrs["measured_peak_m"] - 1.0) < 0.1)
    True
    """
    import xarray as xr

    test = _exact_test(assessment)
    table = _ResponseTable(
        test=test,
        has_names=assessment.error.has_several,
        only_displacements=assessment.error.modelled,
        has_forces=not isinstance(assessment, Assessment) or "mass" in assessment.stated,
    )
    columns, sizes = table.columns_with_bands()
    return xr.Dataset(
        {name: ("time_s", values) for name, values in columns.items()},
        coords={"time_s": np.arange(test.measured.shape[1]) * test.time_step},
        attrs={
            "test": assessment.recording.name,
            "specimen": _SPECIMENS[assessment.error.specimen_known],
            "note": " ".join(_notes(test)),
            **sizes,
        },
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _ResponseTable:
    """Columns and sizes of a corrected test."""

    test: ExactTest
    has_names: bool  # Whether interface displacements have names, and no units
    only_displacements: bool
    has_forces: bool

    def columns_with_bands(self) -> tuple[dict[str, Array], dict[str, float]]:
        """Columns over the samples, and sizes, each with the ends of its 90 % band."""
        test = self.test
        exact, sizes = self._evaluate(test.stated, test.time_step, test.ground)
        columns, attributes = {}, {}
        for name, row in zip(test.interface, test.measured, strict=True):
            columns[self._column("measured", name)] = row
            attributes[self._column("measured_peak", name)] = float(np.abs(row).max())
        mean, deviation, draws = self._spread()
        width = self._width_of_draws(deviation)
        for (quantity, name), row in exact.items():
            factor = 1.0 if quantity == "specimen_force" else width
            low, high = (
                self._band_of_draws(mean[quantity, name], factor * deviation[quantity, name])
                if (quantity, name) not in self._interface_columns
                else [end[test.interface.index(name)] for end in test.band]
            )
            columns[self._column(quantity, name)] = row
            columns[self._column(quantity, name, "low")] = np.minimum(low, row)
            columns[self._column(quantity, name, "high")] = np.maximum(high, row)
        for (quantity, name), size in sizes.items():
            factor = width if quantity.endswith("peak") else 1.0
            low, high = size + factor * (np.quantile(draws[quantity, name], _LEVELS) - size)
            attributes[self._column(quantity, name)] = size
            attributes[self._column(quantity, name, "low")] = min(float(low), size)
            attributes[self._column(quantity, name, "high")] = max(float(high), size)
        return columns, attributes

    def _width_of_draws(self, deviation: dict[_Key, Array]) -> float:
        """Width of the interface's band over that of the draws alone, which is too narrow elsewhere, too."""
        low, high = self.test.band
        half = HALF_WIDTH * np.stack([deviation["exact", name] for name in self.test.interface])
        return float(np.sqrt(np.mean(((high - low) / 2.0) ** 2) / (np.mean(half**2) + _TINY)))

    @property
    def _interface_columns(self) -> set[_Key]:
        """Columns whose band is that of the error."""
        return {("exact", name) for name in self.test.interface}

    def _column(self, quantity: str, name: str, end: str = "") -> str:
        """Name of a column: the unit stands last, but where displacements may be rotations."""
        unit = "j" if quantity.endswith("energy") else "" if self.has_names else _UNITS[quantity]
        return "_".join(part for part in (quantity, end, name, unit) if part)

    def _band_of_draws(self, mean: Array, deviation: Array) -> list[Array]:
        places = np.arange(self.test.measured.shape[1]) / self.test.every
        mean, half = (
            np.interp(places, np.arange(mean.size), values) for values in (mean, HALF_WIDTH * deviation)
        )
        return [mean - half, mean + half]

    def _spread(self) -> tuple[dict[_Key, Array], dict[_Key, Array], dict[_Key, list[float]]]:
        """Mean and deviation of each column over the draws, and the sizes of each draw."""
        test, draws = self.test, dict[_Key, list[float]]()
        sums, squares = dict[_Key, Array](), dict[_Key, Array]()
        ground = None if test.ground is None else test.ground[:: test.every]
        number = 0
        for draw in test.draws():
            number += 1
            rows, sizes = self._evaluate(draw, test.every * test.time_step, ground)
            for key, row in rows.items():
                sums[key] = sums.get(key, np.zeros(row.size)) + row
                squares[key] = squares.get(key, np.zeros(row.size)) + row**2
            for key, size in sizes.items():
                draws.setdefault(key, []).append(size)
        mean = {key: total / number for key, total in sums.items()}
        deviation = {
            key: np.sqrt(np.maximum(total / number - mean[key] ** 2, 0.0)) for key, total in squares.items()
        }
        return mean, deviation, draws

    def _evaluate(
        self, exact: ExactResponse, step: float, ground: Array | None
    ) -> tuple[dict[_Key, Array], dict[_Key, float]]:
        """Columns, by quantity and degree of freedom, and sizes of a response."""
        test, interface_displacements = self.test, exact.at_interface
        rows = {
            ("exact", name): row for name, row in zip(test.interface, interface_displacements, strict=True)
        }
        sizes = {("exact_peak", name): float(np.abs(row).max()) for (_, name), row in rows.items()}
        if self.only_displacements:
            return rows, sizes
        if self.has_forces:
            rows |= {
                ("specimen_force", name): row for name, row in zip(test.interface, exact.felt, strict=True)
            }
            sizes["specimen_energy", ""] = exact.work
        structure = exact.structure
        if ground is None and not structure.all_driven:
            return rows, sizes
        displacements = structure.displacements(interface_displacements, ground, step)
        shaken = structure.accelerations(displacements, exact.force, step)
        rows |= {("acceleration", name): row for name, row in zip(test.degrees or ("",), shaken, strict=True)}
        rows |= {("exact", name): row for name, row in zip(test.degrees, displacements, strict=False)}
        names, weights = weights_of_storeys(test.degrees, structure.influence)
        peaks = np.abs(weights @ displacements).max(axis=1)
        sizes |= {
            ("exact_peak", name): float(np.abs(row).max())
            for name, row in zip(test.degrees, displacements, strict=False)
        }
        sizes |= {("drift_peak", name): peak for name, peak in zip(names, peaks.tolist(), strict=True)}
        return rows, sizes


def _exact_test(assessment: Assessment | FrameAssessment) -> ExactTest:
    """Say what a test should have been."""
    error = assessment.error
    if isinstance(assessment, FrameAssessment):
        ground = error.ground.evidence(assessment.recording.ground)
        return exact_test(error, assessment.frame.partition.degrees_of_freedom, ground)
    mass = assessment.stated.get("mass") if error.specimen is None else None
    return exact_test(error, (), None, None if mass is None else mass.value)


def _notes(test: ExactTest) -> Iterator[str]:
    """Say how large the correction is, where it is no longer small, and what is not known."""
    largest = max(
        float(np.abs(measured_row - exact).max() / np.abs(exact).max())
        for measured_row, exact in zip(test.measured, test.stated.at_interface, strict=True)
        if exact.any()
    )
    yield f"The largest correction is {percent(largest, decimals=1)} of the exact response's peak."
    if largest > _SMALL:
        yield "That is no longer a small correction: rely on the band, not on the line."
    if not test.stated.structure.all_driven and test.ground is None:
        yield _NOT_ITS_MOTION if test.has_other_ground else _OTHER_COLUMNS
