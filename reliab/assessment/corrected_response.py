"""The response that a perfect actuator would have produced, with its band: a spoiled test, corrected."""

from typing import TYPE_CHECKING

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.assessment.findings import Findings
from reliab.significant import percent
from reliab.vocabulary import Metric

if TYPE_CHECKING:
    import xarray as xr

_SPECIMENS = {
    "stated": "stated as linear",
    "modelled": "a calibrated model",
    "measured": "learned from its force",
}
_SMALL = 0.1  # of the peak of the exact response, up to which the largest correction is small


def corrected_response(findings: Findings) -> "xr.Dataset":
    """Put the response that a perfect actuator would have produced into a dataset.

    Parameters
    ----------
    findings : Assessment
        What was found about a test.

    Returns
    -------
    xarray.Dataset
        Over `time_s`: `measured_m` without the sensor's offset and noise, `exact_m` with the ends of its 90 %
        band `exact_low_m` and `exact_high_m` [m], `acceleration_m_s2`, the absolute acceleration of the mass
        [m/s²], and `specimen_force_n` [N] where the specimen was measured or the mass is stated; neither is
        given for a calibrated model. Attributes:
        the peaks of both displacements [m], the energy that the specimen dissipates [J], and `note`, which
        says how large the correction is.

    Examples
    --------
    >>> from reliab import assess
    >>> corrected = corrected_response(assess("sample_test", f=1, xi=0.02))
    >>> sorted(corrected.data_vars)
    ['acceleration_m_s2', 'exact_high_m', 'exact_low_m', 'exact_m', 'measured_m']
    >>> bool(abs(corrected.attrs["exact_peak_m"] / corrected.attrs["measured_peak_m"] - 1.0) < 0.1)
    True
    """
    import xarray as xr

    rebuilt = findings.error.rebuilt
    measured, exact, step = rebuilt.histories.measured, rebuilt.reference, rebuilt.time_step
    force = _force(findings)
    histories = {
        "measured_m": measured,
        "exact_m": exact,
        "exact_low_m": np.minimum(measured - rebuilt.high, exact),
        "exact_high_m": np.maximum(measured - rebuilt.low, exact),
        **({} if findings.error.modelled else {"acceleration_m_s2": _acceleration(findings)}),
        **({} if force is None else {"specimen_force_n": force}),
    }
    peak = float(np.abs(exact).max())
    attributes = {
        "test": findings.recording.name,
        "specimen": _SPECIMENS[findings.error.specimen_known],
        "measured_peak_m": float(np.abs(measured).max()),
        "exact_peak_m": peak,
        "note": _note(findings),
    }
    if force is not None:
        attributes["specimen_energy_j"] = float(scipy.integrate.trapezoid(force, exact))
    times = np.arange(exact.size) * step
    return xr.Dataset(
        {name: ("time_s", values) for name, values in histories.items()},
        coords={"time_s": times},
        attrs=attributes,
    )


def _stiffness_over_mass(findings: Findings) -> tuple[float, float]:
    """Stiffness of the whole structure and of the specimen over the mass [1/s²]."""
    whole = findings.structure.circular_frequency**2
    return whole, findings.structure.experimental_fraction * whole


def _force(findings: Findings) -> Array | None:
    """Force of the specimen along the exact response [N]; None where no mass says how large it is."""
    if findings.error.specimen is not None:
        return findings.error.specimen.force
    if findings.error.modelled or "mass" not in findings.stated:
        return None
    _, specimen = _stiffness_over_mass(findings)
    return findings.stated["mass"].value * specimen * findings.error.reference


def _acceleration(findings: Findings) -> Array:
    """Absolute acceleration of the mass [m/s²]: what spring, dashpot and specimen exert on it."""
    exact, step = findings.error.reference, findings.error.rebuilt.time_step
    whole, specimen = _stiffness_over_mass(findings)
    velocity = np.gradient(exact, step)
    damping = 2.0 * findings.structure.damping_ratio * findings.structure.circular_frequency
    if findings.error.specimen is None:
        return -(damping * velocity + whole * exact)
    resisted = findings.error.specimen.force / findings.stated["mass"].value
    return -(damping * velocity + (whole - specimen) * exact + resisted)


def _note(findings: Findings) -> str:
    """Say how large the correction is, and where it is no longer small."""
    largest = findings.error.estimate(Metric.MTE).value
    sentence = f"The largest correction is {percent(largest, decimals=1)} of the exact response's peak."
    if largest <= _SMALL:
        return sentence
    return f"{sentence} That is no longer a small correction: rely on the band, not on the line."
