"""Comparison of suites of ground motions: intensity measures and response spectra, motion by motion."""

from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from reliab.motions.motion import Motion, measure
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import spectral
from reliab.structures.structure import Structure

PERIODS: tuple[float, ...] = tuple(np.geomspace(0.1, 4.0, 24).round(3).tolist())
"""Periods at which spectra are compared [s]."""

_SPECTRAL_DAMPING = 0.05


def suite_measures(motions: Iterable[Motion]) -> pd.DataFrame:
    """Measure the intensity of motions.

    One row a motion: `motion`, `event`, `peak_acceleration` [m/s²], `arias_intensity` [m/s],
    `significant_duration` [s] (5 to 95 %) and `mean_period` [s].
    """
    rows = []
    for motion in motions:
        measures = measure(motion)
        rows.append(
            {
                "motion": motion.name,
                "event": motion.event,
                "peak_acceleration": measures.peak_acceleration,
                "arias_intensity": measures.arias_intensity,
                "significant_duration": measures.significant_duration,
                "mean_period": measures.mean_period,
            }
        )
    return pd.DataFrame(rows)


def response_spectra(motions: Sequence[Motion], periods: Sequence[float] = PERIODS) -> xr.DataArray:
    """Pseudo-spectral accelerations of motions at 5 % damping.

    `periods`: natural periods [s]. Result: ω₀² max|x| [m/s²] over (motion, period).

    A structure much stiffer than the motion moves with the ground:

    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> slow = Motion(name="slow", acceleration=np.sin(0.5 * np.pi * t), time_step=0.01)
    >>> round(float(response_spectra([slow], [0.05]).item()), 2)
    1.0
    """
    values = [[_peak(motion, period) for period in periods] for motion in motions]
    return xr.DataArray(
        values,
        dims=("motion", "period"),
        coords={
            "motion": [motion.name for motion in motions],
            "period": ("period", list(periods), {"units": "s", "long_name": "natural period"}),
        },
        attrs={"units": "m/s²", "long_name": "pseudo-spectral acceleration"},
        name="spectral_acceleration",
    )


def _peak(motion: Motion, period: float) -> float:
    structure = Structure(frequency=1.0 / period, damping_ratio=_SPECTRAL_DAMPING)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    history, _ = spectral.response(excitation, structure, 1.0, 0.0)
    return float(structure.circular_frequency**2 * np.abs(history).max())
