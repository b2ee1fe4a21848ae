"""From a dataset of ellipses to a criterion."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.bayes.posterior_criterion import fit_hierarchical
from reliab.criterion.cautions import caution_of, cautions_of, without_promise
from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_sample import EllipseSample, position, sample_of
from reliab.criterion.joint import limits
from reliab.criterion.laws import FITTED, FittedLaw, Law, Table, known
from reliab.criterion.methods import HIERARCHICAL, RECOMMENDED, HierarchicalPosterior, Method, any_method_of
from reliab.criterion.population import Population
from reliab.criterion.provenance import Provenance, records_checksum
from reliab.errors import InputError
from reliab.progress import Progress, silent
from reliab.vocabulary import Metric


def derive_criterion(
    ellipses: xr.Dataset,
    *,
    method: Method | HierarchicalPosterior | str = RECOMMENDED,
    assurance: float | None = None,
    distribution: str | None = None,
    steps: int | None = None,
    chains: str | Path | None = None,
    frequency: float | None = None,
    damping_ratio: float | None = None,
    joint: bool = True,
    law: FittedLaw | str = Table,
    threshold: float = 0.05,
    metric: str = Metric.RMS,
    confidence: float = 0.95,
    source: str = "ellipses of ground motions",
    progress: Progress = silent,
) -> Criterion:
    """Derive a criterion from the ellipses of many ground motions.

    Limits are derived for every structure of the dataset, and a law is fitted to them. A fitted law
    misses some of them a little; all its limits are therefore scaled by one factor, so that on average
    over the structures as many of the motions are contained as by the limits themselves.

    Parameters
    ----------
    ellipses : xarray.Dataset
        As `reliab.sweep.trace_ellipses` or `reliab.criterion.read_ellipses` make it.
    method : Method or HierarchicalPosterior or str, optional
        What the confidence means, or its name; the recommended one by default.
    assurance, distribution, steps : optional
        Settings of a method that is given by its name, where it has them.
    chains : str or pathlib.Path, optional
        For the hierarchical methods, the HDF5 file of the chains; a run that stopped, or was too short, goes
        on where it ended.
    frequency, damping_ratio : float, optional
        The only structure to derive it for [Hz, -], one of the dataset's; all of them by default.
    joint : bool, optional
        Whether a and b hold together, or each for itself.
    law : type of Law or str, optional
        How the limits depend on the structure, or its name; by default they are kept as a table.
    threshold : float, optional
        Error on the boundaries [-], one of the dataset's.
    metric : str, optional
        Which error.
    confidence : float, optional
        Share of ground motions, in (0, 1).
    source : str, optional
        Where the ellipses came from, in words.
    progress : callable, optional
        Called with finished and all steps of the hierarchical methods.

    Returns
    -------
    Criterion
        Valid for the structures of the dataset and between them.

    Warns
    -----
    ConvergenceWarning
        If the posterior of a hierarchical method has not converged.

    Raises
    ------
    InputError
        If the dataset has no such threshold or metric, or too few motions, the method has no such
        setting, or can promise nothing with so few that a law could be fitted to.

    Examples
    --------
    The paper's criterion, from its printed table:

    >>> from reliab.criterion import read_ellipses
    >>> from reliab.shipped import shipped
    >>> ellipses = read_ellipses(shipped("datasets", "paper/table2.csv"))
    >>> criterion = derive_criterion(ellipses, method="quantile", joint=False)
    >>> a, b = criterion.limits(1.0, 0.02)
    >>> print(f"{a:.2e} {b:.3f}")
    5.29e-05 1.048
    """
    settings = {"assurance": assurance, "distribution": distribution, "steps": steps}
    method = any_method_of(method, **settings) if isinstance(method, str) else method
    law = known(FITTED, law) if isinstance(law, str) else law
    ordered = _only(ellipses, "f", frequency).pipe(_only, "xi", damping_ratio)
    if isinstance(method, HierarchicalPosterior):
        fit = fit_hierarchical(
            ordered,
            method,
            threshold=threshold,
            metric=str(metric),
            law=law,
            chains=chains,
            progress=progress,
        )
        fit.posterior.warn_unless_converged()
        return fit.criterion(confidence, joint=joint, source=source)
    require_no_chains(chains, method.name)
    samples = _samples(ordered, threshold, str(metric))
    found = np.array([[limits(each, method, confidence, joint=joint) for each in row] for row in samples])
    empty = int((found <= 0.0).any(axis=-1).sum())
    if empty and law is not Table:
        raise InputError(
            "A law is fitted where the method can promise something at every structure",
            value=f"too few motions for {method.name} at {confidence:g} at {empty} structures",
            remedy="Give more motions or a lower confidence, or choose another method",
        )
    fitted: Law = law.fit(ordered["f"].values, ordered["xi"].values, found[..., 0], found[..., 1])
    if law is not Table:
        fitted = _contained_alike(law, fitted, samples, found)
    return Criterion(
        law=fitted,
        threshold=threshold,
        metric=str(metric),
        confidence=confidence,
        method=method.name,
        joint=joint,
        population=Population.of(ordered, threshold=threshold, metric=str(metric)),
        provenance=Provenance(
            source=source,
            n_motions=ellipses.sizes["motion"],
            n_events=int(np.unique(ellipses["event"]).size),
            records_checksum=records_checksum(ellipses),
            window=str(ellipses.attrs.get("window", "unknown")),
            settings=method.settings,
            warnings=(
                *without_promise(method.name, confidence, empty),
                *caution_of(ellipses),
                *cautions_of(samples, ellipses.sizes["motion"], method),
            ),
        ),
    )


def require_no_chains(chains: str | Path | None, method: str) -> None:
    """Refuse a file of chains for a method that samples none."""
    if chains is not None:
        raise InputError(
            "Only the hierarchical methods sample chains",
            value=f"chains for {method}",
            remedy=f"Leave them out, or choose {' or '.join(HIERARCHICAL)}",
        )


def _only(ellipses: xr.Dataset, name: str, value: float | None) -> xr.Dataset:
    """Keep one value of a dimension, or all in increasing order."""
    if value is None:
        return ellipses.sortby(name)
    return ellipses.isel({name: [position(ellipses, name, value)]})


def _samples(ellipses: xr.Dataset, threshold: float, metric: str) -> list[list[EllipseSample]]:
    return [
        [
            sample_of(ellipses, frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)
            for xi in ellipses["xi"].values.tolist()
        ]
        for f in ellipses["f"].values.tolist()
    ]


def _contained_alike(
    law: FittedLaw, fitted: Law, samples: Sequence[Sequence[EllipseSample]], found: NDArray[np.float64]
) -> Law:
    """Scale a law so that it contains as many motions as the limits that it was fitted to."""
    cells = [each for row in samples for each in row]
    contained = [np.mean(room(s, *pair) >= 1.0) for s, pair in zip(cells, found.reshape(-1, 2), strict=True)]
    rooms = [room(s, *(float(limit) for limit in fitted.limits(s.frequency, s.damping_ratio))) for s in cells]
    factor = np.quantile(np.concatenate(rooms), 1.0 - np.mean(contained), method="lower")
    frequencies = [row[0].frequency for row in samples]
    damping_ratios = [each.damping_ratio for each in samples[0]]
    a, b = fitted.limits(np.asarray(frequencies)[:, None], np.asarray(damping_ratios)[None, :])
    return law.fit(frequencies, damping_ratios, factor * a, factor * b)


def room(sample: EllipseSample, a: float, b: float) -> NDArray[np.float64]:
    """Factor by which limits could grow before a motion's own ellipse no longer contains theirs.

    Parameters
    ----------
    sample : EllipseSample
        The motions.
    a, b : float
        The limits [-] and [ms²], positive.

    Returns
    -------
    array of float, shape (motions,)
        Factors on a and b; a motion contains the limits where its factor is at least 1.
    """
    return np.minimum(sample.a / a, sample.b / b)
