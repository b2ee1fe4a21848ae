"""How far criteria carry: to other sets of motions, to structures that were not simulated.

Each question is one cross-validation with folds of its own; the answers are tables of rates with
intervals that respect the earthquakes.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.laws import FITTED
from reliab.criterion.methods import RECOMMENDED, method_of
from reliab.errors import InputError
from reliab.progress import Progress, silent
from reliab.validation.cross_validation import (
    Candidate,
    CrossValidation,
    Derived,
    cross_validate,
    folds_of,
    leave_structures_out,
    transfer,
)

_MEASURES = ("containment", "false_safe", "accepted_share")


def pooled(suites: Mapping[str, xr.Dataset]) -> tuple[xr.Dataset, NDArray[np.str_]]:
    """Put the ellipses of several suites into one dataset.

    Parameters
    ----------
    suites : mapping of str to xarray.Dataset
        Ellipses by the name of the suite; structures, thresholds and metrics that all have are kept.

    Returns
    -------
    ellipses : xarray.Dataset
        `a` and `b` of all motions, which are named after their suite, and so are their earthquakes.
    sets : numpy.ndarray
        Suite of each motion, shape (motions,).

    Raises
    ------
    InputError
        If the suites have no structure, threshold or metric in common.
    """
    renamed = [_renamed(name, ellipses) for name, ellipses in suites.items()]
    together = xr.concat(renamed, dim="motion", join="inner", coords="minimal", compat="override")
    if 0 in together.sizes.values():
        raise InputError(
            "Suites that are put together must share structures, thresholds and metrics",
            value=", ".join(str(name) for name, size in together.sizes.items() if size == 0),
            remedy="Trace their ellipses for the same structures and errors",
        )
    sets = np.repeat(list(suites), [ellipses.sizes["motion"] for ellipses in suites.values()])
    return together, sets


def _renamed(name: str, ellipses: xr.Dataset) -> xr.Dataset:
    names = {each: [f"{name}: {value}" for value in ellipses[each].values] for each in ("motion", "event")}
    plain = ellipses[["a", "b"]].reset_coords(drop=True)
    return plain.assign_coords(motion=names["motion"]).assign_coords(event=("motion", names["event"]))


def transfers(
    ellipses: xr.Dataset,
    sets: NDArray[np.str_],
    pairs: Iterable[tuple[str, str]],
    candidates: Sequence[Candidate],
    *,
    confidences: Sequence[float] = (0.80, 0.90, 0.95, 0.99),
    threshold: float = 0.05,
    metric: str = "rms",
    results: xr.Dataset | None = None,
) -> pd.DataFrame:
    """Learn criteria from one set of motions and judge them on another.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses of all motions.
    sets : array of str, shape (motions,)
        Set of each motion.
    pairs : iterable of (str, str)
        What is learned from, and what is judged; an earthquake in both is not learned from while it is
        judged.
    candidates : sequence of Candidate
        Criteria on trial.
    confidences : sequence of float, optional
        Stated shares of the motions.
    threshold : float, optional
        Error on the boundary [-].
    metric : str, optional
        Which error.
    results : xarray.Dataset, optional
        Simulated results of the same motions, from which the fate of tests is read.

    Returns
    -------
    pandas.DataFrame
        Columns `learned`, `judged` and those of :func:`tabulate`.
    """
    tables = []
    for learned, judged in pairs:
        found = cross_validate(
            ellipses,
            transfer(sets, ellipses["event"].values, learned=[learned], judged=[judged]),
            candidates,
            scheme=f"{learned} to {judged}",
            confidences=confidences,
            threshold=threshold,
            metric=metric,
            results=results,
        )
        tables.append(tabulate(found).assign(learned=learned, judged=judged))
    return pd.concat(tables, ignore_index=True)


def law_generalisation(
    ellipses: xr.Dataset,
    *,
    laws: Sequence[str] = tuple(FITTED),
    method: str = RECOMMENDED,
    scheme: str = "k_fold",
    confidences: Sequence[float] = (0.95,),
    threshold: float = 0.05,
    metric: str = "rms",
    results: xr.Dataset | None = None,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Judge laws at structures, and on earthquakes, that they were not fitted to.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses over a grid of frequencies and damping ratios.
    laws : sequence of str, optional
        Names of fitted laws.
    method : str, optional
        What the confidence means; jointly for a and b.
    scheme : str, optional
        How the earthquakes are divided.
    confidences : sequence of float, optional
        Stated shares of the motions.
    threshold : float, optional
        Error on the boundary [-].
    metric : str, optional
        Which error.
    results : xarray.Dataset, optional
        Simulated results of the same motions, from which the fate of tests is read.
    progress : callable, optional
        Called after each of the three parts.

    Returns
    -------
    pandas.DataFrame
        Columns `left_out` ("nothing", "f" or "xi") and those of :func:`tabulate`. The least and the
        greatest value of a dimension cannot be left out: a law does not extrapolate.
    """
    candidates = [Derived(name=name, method=method_of(method), law=FITTED[name]) for name in laws]
    tables = []
    for done, left_out in enumerate(("nothing", "f", "xi"), start=1):
        folds = folds_of(scheme, ellipses["event"].values)
        if left_out != "nothing":
            inner = np.sort(ellipses[left_out].values)[1:-1].tolist()
            folds = list(leave_structures_out(folds, left_out, inner))
        if folds:
            found = cross_validate(
                ellipses,
                folds,
                candidates,
                scheme=f"{scheme}, without {left_out}",
                confidences=confidences,
                threshold=threshold,
                metric=metric,
                results=results,
            )
            tables.append(tabulate(found).assign(left_out=left_out))
        progress(done, 3)
    return pd.concat(tables, ignore_index=True)


def tabulate(found: CrossValidation, over: Sequence[str] = ("f", "xi")) -> pd.DataFrame:
    """Tabulate what a cross-validation found.

    Parameters
    ----------
    found : CrossValidation
        Its counts.
    over : sequence of str, optional
        Dimensions that are averaged over beside the motions.

    Returns
    -------
    pandas.DataFrame
        One row for each candidate, confidence and structure that is left: `containment`, `false_safe`
        and `accepted_share` [-] with `_low` and `_high` ends of 95 % intervals, and the confusion matrix
        `good_accepted`, `good_rejected`, `bad_accepted`, `bad_rejected` [trials].
    """
    parts = [
        getattr(found, name)(over).rename({"rate": name, "low": f"{name}_low", "high": f"{name}_high"})
        for name in _MEASURES
    ]
    merged = xr.merge([*parts, found.confusion((*over, "motion"))])
    table = merged.to_dataframe().reset_index().dropna(subset="containment")
    return table.reset_index(drop=True)
