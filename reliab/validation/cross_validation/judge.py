"""Cross-validation: what criteria do on motions from which they were not learned.

For each fold, structure and confidence the limits are derived from the learned motions and held
against the judged ones. Reported are

containment
    share of judged motions whose own boundary contains the criterion's ellipse (a_i ≥ a and b_i ≥ b)
false-safe rate
    share of accepted tests whose error exceeds the threshold
accepted share
    share of truly good tests that are accepted
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.laws import Law
from reliab.errors import InputError
from reliab.progress import Progress, silent
from reliab.validation.cross_validation.candidates import Candidate
from reliab.validation.cross_validation.folds import Fold
from reliab.validation.cross_validation.intervals import event_bootstrap
from reliab.validation.cross_validation.trials import Cell, Trials, draw_trials

_COUNTS = ("contained", "judged", "tried", "accepted", "accepted_bad", "accepted_good", "good")
_DIMENSIONS = ("candidate", "confidence", "f", "xi", "motion")


@dataclass(frozen=True, kw_only=True, eq=False)
class CrossValidation:
    """Counts of what happened to each judged motion, and the rates that follow.

    Attributes
    ----------
    counts : xarray.Dataset
        Over (candidate, confidence, f, xi, motion): times `judged` and `contained`; trials `tried`,
        `accepted`, `accepted_bad`, `accepted_good`, and `good`.
    scheme : str
        How the motions were divided.
    threshold : float
        Error on the boundary [-].
    metric : str
        Which error.
    """

    counts: xr.Dataset
    scheme: str
    threshold: float
    metric: str

    def containment(self, over: Sequence[str] = ("f", "xi")) -> xr.Dataset:
        """Share of judged motions whose boundary contains the criterion's ellipse.

        Parameters
        ----------
        over : sequence of str, optional
            Dimensions that are averaged over beside the motions.

        Returns
        -------
        xarray.Dataset
            `rate`, `low` and `high` (95 % interval that respects the earthquakes).
        """
        return self._rate("contained", "judged", over)

    def false_safe(self, over: Sequence[str] = ("f", "xi")) -> xr.Dataset:
        """Share of accepted tests whose error exceeds the threshold; as :meth:`containment`."""
        return self._rate("accepted_bad", "accepted", over)

    def accepted_share(self, over: Sequence[str] = ("f", "xi")) -> xr.Dataset:
        """Share of truly good tests that are accepted; as :meth:`containment`."""
        return self._rate("accepted_good", "good", over)

    def confusion(self, over: Sequence[str] = ("f", "xi", "motion")) -> xr.Dataset:
        """Confusion matrix of the verdicts on trials.

        Parameters
        ----------
        over : sequence of str, optional
            Dimensions that are added up.

        Returns
        -------
        xarray.Dataset
            Trials `good_accepted`, `good_rejected`, `bad_accepted` and `bad_rejected`, the error of good
            ones staying below the threshold.
        """
        total = self.counts.sum(list(over))
        good_rejected = total["good"] - total["accepted_good"]
        return xr.Dataset(
            {
                "good_accepted": total["accepted_good"],
                "good_rejected": good_rejected,
                "bad_accepted": total["accepted_bad"],
                "bad_rejected": total["tried"] - total["accepted"] - good_rejected,
            }
        )

    def _rate(self, numerator: str, denominator: str, over: Sequence[str]) -> xr.Dataset:
        top, bottom = (self.counts[name].sum(list(over)) for name in (numerator, denominator))
        low, high = event_bootstrap(
            top.transpose("motion", ...).values.astype(np.float64),
            bottom.transpose("motion", ...).values.astype(np.float64),
            self.counts["event"].values,
        )
        total = bottom.sum("motion")
        rate = top.sum("motion") / total.where(total > 0)  # NaN where nothing was judged
        return xr.Dataset({"rate": rate, "low": rate.copy(data=low), "high": rate.copy(data=high)})


def cross_validate(
    ellipses: xr.Dataset,
    folds: Iterable[Fold],
    candidates: Sequence[Candidate],
    *,
    scheme: str,
    confidences: Sequence[float] = (0.80, 0.90, 0.95, 0.99),
    threshold: float = 0.05,
    metric: str = "rms",
    results: xr.Dataset | None = None,
    trials: int = 512,
    learn_from: xr.Dataset | None = None,
    progress: Progress = silent,
) -> CrossValidation:
    """Judge criteria on motions from which they were not learned.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses over (motion, f, xi, threshold, metric, curve).
    folds : iterable of Fold
        Divisions of the motions.
    candidates : sequence of Candidate
        Criteria on trial.
    scheme : str
        What the division is called.
    confidences : sequence of float, optional
        Nominal confidences.
    threshold : float, optional
        Error on the boundary [-].
    metric : str, optional
        Which error.
    results : xarray.Dataset, optional
        Simulated results of the same motions, from which the fate of trials is read.
    trials : int, optional
        Number of trials for each structure.
    learn_from : xarray.Dataset, optional
        Ellipses of another suite from which all is learned; the folds then say what is judged.
    progress : callable, optional
        Called after each fold.

    Returns
    -------
    CrossValidation
        Counts and rates.
    """
    folds = list(folds)
    structures = list(
        product(enumerate(ellipses["f"].values.tolist()), enumerate(ellipses["xi"].values.tolist()))
    )
    cells = {
        (i, j): Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)
        for (i, f), (j, xi) in structures
    }
    fates = {
        at: (_parameters(ellipses, cell), draw_trials(ellipses, cell, trials, results=results))
        for at, cell in cells.items()
    }
    sizes = (ellipses.sizes[name] for name in ("f", "xi", "motion"))
    shape = (len(candidates), len(confidences), *sizes)
    counts = {name: np.zeros(shape, dtype=np.int64) for name in _COUNTS}
    for done, fold in enumerate(folds, start=1):
        known = _known(ellipses, fold) if learn_from is None else learn_from
        for (c, candidate), (k, confidence) in product(enumerate(candidates), enumerate(confidences)):
            if not candidate.promises(confidence):
                continue
            law = candidate.learn(known, threshold, metric, confidence)
            for (i, j), cell in cells.items():
                if not (fold.judges(cell.frequency, cell.damping_ratio) and _holds(law, cell)):
                    continue
                a, b = law.limits(cell.frequency, cell.damping_ratio)
                found = _judge((float(a), float(b)), *fates[i, j], fold.judged)
                for name, values in zip(_COUNTS, found, strict=True):
                    counts[name][c, k, i, j, fold.judged] += values
        progress(done, len(folds))
    return CrossValidation(
        counts=_labelled(counts, ellipses, candidates, confidences),
        scheme=scheme,
        threshold=threshold,
        metric=metric,
    )


def _known(ellipses: xr.Dataset, fold: Fold) -> xr.Dataset:
    """Ellipses that a fold learns from."""
    known = ellipses.isel(motion=fold.learned)
    if fold.left_out is None:
        return known
    dimension, value = fold.left_out
    return known.sel({dimension: known[dimension].values[known[dimension].values != value]})


def _holds(law: Law, cell: Cell) -> bool:
    """Whether a law holds for a structure; where it does not, nothing is judged."""
    try:
        law.validity.require(cell.frequency, cell.damping_ratio)
    except InputError:
        return False
    return True


def _parameters(ellipses: xr.Dataset, cell: Cell) -> NDArray[np.float64]:
    """Own a and b of each motion, infinite where it has no ellipse to be left; shape (2, motions)."""
    at = ellipses.sel(
        f=cell.frequency, xi=cell.damping_ratio, threshold=cell.threshold, metric=cell.metric, curve="ellipse"
    )
    own = np.stack([at["a"].values, at["b"].values])
    return np.where(np.isfinite(own) & (own > 0.0), own, np.inf)


def _judge(
    limits: tuple[float, float], own: NDArray[np.float64], trials: Trials, judged: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], ...]:
    """Count what happens in one fold, in the order of the names."""
    accepted, good = trials.accepted(*limits), trials.good[judged]
    contained = (own[:, judged] >= np.asarray(limits)[:, np.newaxis]).all(axis=0)
    accepted_good = (good & accepted).sum(axis=1)
    found = (
        contained,
        np.ones_like(contained),
        np.full_like(accepted_good, accepted.size),
        np.full_like(accepted_good, accepted.sum()),
        accepted.sum() - accepted_good,
        accepted_good,
        good.sum(axis=1),
    )
    return tuple(np.asarray(values, dtype=np.int64) for values in found)


def _labelled(
    counts: dict[str, NDArray[np.int64]],
    ellipses: xr.Dataset,
    candidates: Sequence[Candidate],
    confidences: Sequence[float],
) -> xr.Dataset:
    return xr.Dataset(
        {name: (_DIMENSIONS, values) for name, values in counts.items()},
        coords={
            "candidate": [candidate.name for candidate in candidates],
            "confidence": list(confidences),
            "f": ellipses["f"].values,
            "xi": ellipses["xi"].values,
            "motion": ellipses["motion"].values,
            "event": ("motion", ellipses["event"].values),
        },
    )
