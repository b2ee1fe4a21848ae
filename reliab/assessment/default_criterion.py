"""The criterion that ships with the package: real ground motions, the recommended method."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.assessment.criterion_window import RECORD, CriterionWindow, window_for
from reliab.boundary import FirstOrderEllipse
from reliab.criterion import (
    Criterion,
    carry_to_response,
    derive_criterion,
    protect_over_lengths,
    range_of,
)
from reliab.criterion.methods import RECOMMENDED, method_of
from reliab.errors import InputError
from reliab.shipped import shipped
from reliab.structures import Structure
from reliab.sweep import open_windows, read_netcdf
from reliab.vocabulary import CurveName, Metric

_TABLE = "real_suite/ellipses.nc"
SOURCE = "the ellipses that ship with the package, of the motions of FEMA P-695"


def default_criterion(
    frequency: float,
    damping_ratio: float,
    threshold: float = 0.05,
    confidence: float = 0.95,
    *,
    metric: str = "rms",
    without: str | None = None,
    duration: float | None = None,
) -> Criterion:
    """Derive the recommended criterion of one structure from the ellipses that ship with the package.

    Parameters
    ----------
    frequency, damping_ratio : float
        The structure [Hz, -]; beyond the shipped ones the criterion is that of the nearest.
    threshold : float, optional
        Error of the whole test [-]; between shipped thresholds, ellipses are interpolated.
    confidence : float, optional
        Share of the population's ground motions, in (0, 1).
    metric : str, optional
        Which error, "rms" or "mte".
    without : str, optional
        Earthquake to leave out of the derivation, because its motions are to be judged.
    duration : float, optional
        Length of the tests that are to be judged [s]; by default errors are those over whole records.

    Returns
    -------
    Criterion
        Valid at the structure and between its neighbours among the shipped ones.

    Raises
    ------
    InputError
        If the threshold lies outside of the shipped ones, or the metric is unknown.
    """
    window = window_for(duration, shipped_windows())
    if metric not in _shipped_ellipses()["metric"].values.tolist():
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    population = _population(window, without, metric)
    near = population.sel(
        f=_neighbours(population["f"].values, frequency),
        xi=_neighbours(population["xi"].values, damping_ratio),
        metric=[metric],
    )
    criterion = derive_criterion(
        _at_threshold(near, threshold),
        method=method_of(RECOMMENDED),
        joint=True,
        threshold=threshold,
        metric=metric,
        confidence=confidence,
        source=SOURCE,
    )
    durations = _measures()["effective_duration"].sel(f=frequency, xi=damping_ratio, method="nearest")
    scope = {**criterion.provenance.scope, "effective_duration": range_of(durations.values)}
    return replace(criterion, provenance=replace(criterion.provenance, scope=scope))


def criterion_of_response(
    response: FirstOrderEllipse,
    structure: Structure,
    *,
    threshold: float,
    confidence: float,
    without: Sequence[str] = (),
) -> Criterion | None:
    """Derive the criterion of RMS^R for motions under which a structure responds as it did in a test.

    `without` names earthquakes to leave out. None for a structure that is partly numerical or lies beyond the
    shipped ones, where responses of the motions are not known.
    """
    ellipses, measures = _shipped_ellipses(), _measures()
    own = {"f": structure.frequency, "xi": structure.damping_ratio}
    beyond = any(not measures[name].min() <= value <= measures[name].max() for name, value in own.items())
    if beyond or structure.experimental_fraction != 1.0:
        return None
    learned = ~np.isin(ellipses["event"].values, without)
    population = _at_threshold(ellipses.sel(metric=[str(Metric.RMS)]), threshold).isel(motion=learned)
    values = response.amplitude, response.delay, response.effective_duration
    names = "a_first", "b_first", "effective_duration"
    of_test = xr.Dataset(
        {
            name: (("motion", "f", "xi"), np.full((1, 1, 1), value))
            for name, value in zip(names, values, strict=True)
        },
        coords={
            "motion": ["this test"],
            "duration": ("motion", [response.duration]),
            **{name: [value] for name, value in own.items()},
        },
    )
    carried = carry_to_response(
        population.sel(curve=[str(CurveName.INSCRIBED)]), measures.isel(motion=learned), of_test
    )
    return derive_criterion(carried, joint=True, threshold=threshold, confidence=confidence, source=SOURCE)


def typical_ellipse(structure: Structure) -> tuple[float, float]:
    """Ellipse parameters a [-] and b [ms²] over the squared error, for the median motion of those that ship.

    Between and beyond the shipped structures a ξ⁻² and b ω₀² ξ⁻² are those of the nearest; both grow with the
    inverse square of the share in the laboratory.
    """
    measures = _measures()
    near = measures.sel(f=structure.frequency, xi=structure.damping_ratio, method="nearest")
    damping = structure.damping_ratio / float(near["xi"])
    frequency = structure.frequency / float(near["f"])
    share = structure.experimental_fraction
    a, b = (float(np.median(near[name])) for name in ("a_first", "b_first"))
    return a * (damping / share) ** 2, b * (damping / frequency / share) ** 2


def ellipses_of_motions(structure: Structure) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return as :func:`typical_ellipse` does, one pair for each motion that ships, shape (motions,) each."""
    near = _measures().sel(f=structure.frequency, xi=structure.damping_ratio, method="nearest")
    of_a, of_b = typical_ellipse(structure)
    a, b = (near[name].values.astype(np.float64) for name in ("a_first", "b_first"))
    return a * of_a / np.median(a), b * of_b / np.median(b)


def shipped_frequencies() -> list[float]:
    """Natural frequencies [Hz] of the shipped ellipses, increasing."""
    return [float(frequency) for frequency in np.sort(_shipped_ellipses()["f"].values)]


def shipped_windows() -> tuple[str, ...]:
    """Windows for which ellipses ship with the package."""
    return tuple(_by_window())


def _shipped_ellipses(window: str = RECORD) -> xr.Dataset:
    return _by_window()[window]


@lru_cache(maxsize=8)
def _population(window: CriterionWindow, without: str | None, metric: str) -> xr.Dataset:
    """Ellipses of a window, without an earthquake; of whole records those that protect every length."""
    ellipses = _shipped_ellipses(window.below)
    if without is not None:
        ellipses = ellipses.isel(motion=ellipses["event"].values != without)
    if window.weight > 0.0:
        ellipses = _between(ellipses, _shipped_ellipses(window.above), window.weight)
    return protect_over_lengths(ellipses.assign_attrs(window=window.label), metric=metric)


@lru_cache(maxsize=1)
def _measures() -> xr.Dataset:
    """Measures of the responses under the motions of the shipped ellipses."""
    rule, remedy = "Measures of responses must be a NetCDF file", "Install the package again"
    return read_netcdf(shipped("datasets", "real_suite/first_order.nc"), rule, remedy)


@lru_cache(maxsize=1)
def _by_window() -> dict[str, xr.Dataset]:
    return open_windows(shipped("datasets", _TABLE), curve=CurveName.INSCRIBED)


def _between(below: xr.Dataset, above: xr.Dataset, weight: float) -> xr.Dataset:
    """Ellipses of a window between two, ln a and ln b being linear in the logarithm of its length."""
    low, high = (
        np.log(table[["a", "b"]].where((table["a"] > 0.0) & (table["b"] > 0.0))) for table in (below, above)
    )
    interpolated = np.exp((1.0 - weight) * low + weight * high)
    return above.assign({name: interpolated[name] for name in ("a", "b")})


def _neighbours(values: NDArray[np.float64], wanted: float) -> list[float]:
    """One stored value, or the two on either side."""
    ordered = np.sort(values.astype(np.float64))
    place = int(np.clip(np.searchsorted(ordered, wanted * (1.0 - 1e-9)), 0, ordered.size - 1))
    if np.isclose(ordered[place], wanted, rtol=1e-9) or wanted < ordered[0] or wanted > ordered[-1]:
        return [float(ordered[place])]
    return [float(value) for value in ordered[place - 1 : place + 1]]


def _at_threshold(ellipses: xr.Dataset, threshold: float) -> xr.Dataset:
    """Ellipses at any threshold, ln a and ln b being linear in its logarithm between stored ones."""
    stored = ellipses["threshold"].values
    if not stored.min() * (1.0 - 1e-9) <= threshold <= stored.max() * (1.0 + 1e-9):
        raise InputError(
            f"The shipped ellipses are for errors from {stored.min():g} to {stored.max():g}",
            value=threshold,
            remedy="Derive a criterion with `reliab criterion --out`, and give it as `criterion`",
        )
    pair = ellipses[["a", "b"]].sel(threshold=_neighbours(stored, threshold))
    if pair.sizes["threshold"] > 1:
        low, high = np.log(pair["threshold"].values)
        weight = (np.log(threshold) - low) / (high - low)
        sound = pair.where((pair["a"] > 0.0) & (pair["b"] > 0.0))
        below, above = (np.log(sound.isel(threshold=place)) for place in (0, 1))
        pair = np.exp((1.0 - weight) * below + weight * above).expand_dims("threshold")
    rest = {name: ellipses[name] for name in ("error_at_rest",) if name in ellipses}
    return pair.assign_coords(threshold=[threshold]).assign(rest).assign_attrs(ellipses.attrs)
