"""From a dataset of ellipses to the criterion of one structure."""

import xarray as xr

from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_sample import EllipseSample, sample_of
from reliab.criterion.joint import limits
from reliab.criterion.laws import OneStructure
from reliab.criterion.methods import Method
from reliab.criterion.provenance import Provenance, records_checksum
from reliab.vocabulary import Metric

_FEW_EVENTS = 30


def derive_criterion(
    ellipses: xr.Dataset,
    *,
    frequency: float,
    damping_ratio: float,
    threshold: float = 0.05,
    metric: str = Metric.RMS,
    confidence: float = 0.95,
    method: Method,
    joint: bool = False,
) -> Criterion:
    """Derive the criterion of one structure from the ellipses of many ground motions.

    Parameters
    ----------
    ellipses : xarray.Dataset
        As `reliab.sweep.trace_ellipses` or `reliab.criterion.read_ellipses` make it.
    frequency, damping_ratio : float
        The structure [Hz, -], one of the dataset's.
    threshold : float, optional
        Error on the boundaries [-], one of the dataset's.
    metric : str, optional
        Which error.
    confidence : float, optional
        Share of ground motions, in (0, 1).
    method : Method
        What the confidence means.
    joint : bool, optional
        Whether a and b hold together.

    Returns
    -------
    Criterion
        Valid for that structure only.

    Raises
    ------
    InputError
        If the dataset has no such cell, or too few motions.
    """
    sample = sample_of(
        ellipses, frequency=frequency, damping_ratio=damping_ratio, threshold=threshold, metric=metric
    )
    a, b = limits(sample, method, confidence, joint=joint)
    return Criterion(
        law=OneStructure(a=a, b=b, frequency=frequency, damping_ratio=damping_ratio),
        threshold=threshold,
        metric=str(metric),
        confidence=confidence,
        method=method.name,
        joint=joint,
        provenance=Provenance(
            source="ellipses of ground motions",
            n_motions=sample.n_motions,
            n_events=sample.n_events,
            records_checksum=records_checksum(ellipses),
            window=str(ellipses.attrs.get("window", "unknown")),
            warnings=_warnings(sample, ellipses.sizes["motion"]),
        ),
    )


def _warnings(sample: EllipseSample, offered: int) -> tuple[str, ...]:
    found = []
    if offered > sample.n_motions:
        found.append(
            f"{offered - sample.n_motions} of {offered} motions have no ellipse here and were left out: "
            "their boundaries reach beyond half or twice the amplitude, so that this is on the safe side."
        )
    if sample.n_events < _FEW_EVENTS:
        found.append(
            f"The motions come from {sample.n_events} earthquakes only, "
            "and motions of one earthquake are alike."
        )
    return tuple(found)
