"""Cross-validation: criteria on motions from which they were not learned, and stated probabilities.

For each fold, structure and confidence the limits are derived from the learned motions and checked on the
judged ones. Reported are

containment
    share of judged motions under which the true error stays below the threshold along the whole edge of the
    criterion; beside it, the share whose fitted ellipse contains the criterion's (a_i ≥ a and b_i ≥ b)
false-safe rate
    share of accepted tests whose error exceeds the threshold
accepted share
    share of truly good tests that are accepted
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import Side
from reliab.criterion.derivation import Derivation, require_meaning
from reliab.criterion.ellipse_table import drop_copies, names_along
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.registry import FittedLaw
from reliab.criterion.laws.table import TabulatedLimits
from reliab.criterion.methods.method import Method
from reliab.criterion.population import Population
from reliab.validation.counts import COUNTS, DIMENSIONS, CrossValidation, event_bootstrap
from reliab.validation.folds import Fold, folds_of
from reliab.validation.truth import Cell, EllipseTruth, Region, Truth, draw_trials


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits that a candidate arrived at, for all structures."""

    law: Law  # Limits a [-] and b [ms²] of actuators that are late
    # The same of actuators that are early; None where the candidate has no limits for leads
    lead_law: Law | None = None

    def regions(self, cell: Cell) -> list[Region]:
        """List the accepted regions of a structure; empty where the law does not hold or has no limits."""
        regions = []
        for side, law in ((Side.LAG, self.law), (Side.LEAD, self.lead_law)):
            if law is None or not _holds(law, cell):
                continue
            a, b = (float(limit) for limit in law.limits(cell.frequency, cell.damping_ratio))
            if a > 0.0 and b > 0.0:
                regions.append(Region(a=a, b=b, side=side))
        return regions


def _holds(law: Law, cell: Cell) -> bool:
    try:
        law.validity.require(cell.frequency, cell.damping_ratio)
    except InputError:
        return False
    return True


@dataclass(frozen=True, kw_only=True)
class Candidate(ABC):
    """A way to derive the limits a and b."""

    name: str  # What it is called in tables

    @abstractmethod
    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Limits for structures.

        `threshold` [-].
        """


@dataclass(frozen=True, kw_only=True)
class DerivedCandidate(Candidate):
    """Limits derived from ellipses."""

    method: Method  # The method, which defines the meaning of the confidence
    joint: bool | None = None  # Whether a and b hold together; by default as the method means it
    # The law that is fitted to the limits of the structures; by default they are kept as they are
    law: FittedLaw = TabulatedLimits

    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Derive the criterion of all structures at each confidence that the motions carry."""
        derivation = Derivation.from_ellipses(
            drop_copies(ellipses), method=self.method, law=self.law, threshold=threshold, metric=metric
        )
        limits: dict[float, Limits] = {}
        refusals: list[InputError] = []
        for confidence in confidences:
            try:
                criterion = derivation.criterion(confidence, joint=self.joint)
            except InputError as refusal:
                refusals.append(refusal)
            else:
                limits[confidence] = Limits(law=criterion.law, lead_law=criterion.lead_law)
        derivation.warn_unless_converged()
        if refusals and not limits:
            raise refusals[0]
        return limits


@dataclass(frozen=True, kw_only=True)
class PrintedCandidate(Candidate):
    """Printed limits, independent of the motions."""

    law: Law  # The printed law
    lead_law: Law | None = None  # Its limits for leads, where it does not count them as lags
    confidence: float = 0.95  # The share of the motions for which it is said to hold

    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Return the law at the confidence that it states."""
        del ellipses, threshold, metric
        matching_confidences = [confidence for confidence in confidences if self.promises(confidence)]
        return dict.fromkeys(
            matching_confidences,
            Limits(law=self.law, lead_law=self.law if self.law.counts_leads_as_lags else self.lead_law),
        )

    def promises(self, confidence: float) -> bool:
        """Whether this is the share of the motions that the law states."""
        return math.isclose(confidence, self.confidence)


def cross_validate(
    ellipses: xr.Dataset,
    folds: Iterable[Fold],
    candidates: Sequence[Candidate],
    *,
    scheme: str,
    confidences: Sequence[float] = (0.80, 0.90, 0.95, 0.99),
    threshold: float = 0.05,
    metric: str = "rms",
    truth: Truth | None = None,
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
    truth : Truth, optional
        True errors under the same motions; without it only their fitted ellipses are known.
    trials : int, optional
        Number of trials for each structure.
    learn_from : xarray.Dataset, optional
        Ellipses of another suite to learn from; `learned` of the folds then chooses among its motions.
    progress : callable, optional
        Called after each fold has been learned and each structure judged.

    Returns
    -------
    CrossValidation
        Counts and rates.

    Raises
    ------
    InputError
        If an actuator that does not move would pass at the threshold, or no candidate can promise anything
        in any fold; the first reason.
    """
    require_meaning(ellipses, threshold=threshold, metric=metric)
    folds, truth = list(folds), truth or EllipseTruth(ellipses)
    structures = list(
        product(enumerate(ellipses["f"].values.tolist()), enumerate(ellipses["xi"].values.tolist()))
    )
    total = len(folds) + len(structures)
    entries: list[_Entry] = []
    refusals: list[InputError] = []
    for step, fold in enumerate(folds, start=1):
        training_ellipses = _training_ellipses(ellipses if learn_from is None else learn_from, fold)
        for number, candidate in enumerate(candidates):
            try:
                candidate_limits = candidate.learn(training_ellipses, threshold, metric, confidences)
            except InputError as refusal:
                refusals.append(refusal)
                continue
            entries += [
                _Entry(number, list(confidences).index(confidence), fold, limits)
                for confidence, limits in candidate_limits.items()
            ]
        progress(step, total)
    if refusals and not entries:
        raise refusals[0]
    sizes = (ellipses.sizes[name] for name in ("f", "xi", "motion"))
    shape = (len(candidates), len(confidences), len(Side), *sizes)
    counts = np.zeros((len(COUNTS), *shape), dtype=np.int64)
    for step, ((i, f), (j, xi)) in enumerate(structures, start=len(folds) + 1):
        cell = Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)
        for place, side in enumerate(Side):
            if str(side) in names_along(ellipses, "side"):
                cell_counts = counts[:, :, :, place, i, j]
                _judge(cell_counts, cell, side, entries, ellipses, truth, trials)
        progress(step, total)
    return CrossValidation(
        counts=_label_counts(counts, ellipses, candidates, confidences),
        scheme=scheme,
        threshold=threshold,
        metric=metric,
        truth=truth.name,
    )


class _Entry(NamedTuple):
    """Limits that were learned in a fold, with the places of their candidate and confidence."""

    candidate: int
    confidence: int
    fold: Fold
    limits: Limits


def _training_ellipses(ellipses: xr.Dataset, fold: Fold) -> xr.Dataset:
    """Ellipses that a fold learns from."""
    training = ellipses.isel(motion=fold.learned)
    if fold.left_out is None:
        return training
    dimension, value = fold.left_out
    return training.sel({dimension: training[dimension].values[training[dimension].values != value]})


def _judge(
    counts: NDArray[np.int64],
    cell: Cell,
    side: Side,
    entries: Sequence[_Entry],
    ellipses: xr.Dataset,
    truth: Truth,
    trials: int,
) -> None:
    """Count what happens at one structure and side; shape (names, candidate, confidence, motion)."""
    judging = [
        (entry, region)
        for entry in entries
        if entry.fold.judges(cell.frequency, cell.damping_ratio)
        for region in entry.limits.regions(cell)
        if region.side is side
    ]
    if not judging:
        return
    tests = draw_trials(ellipses, cell, trials, side=side)
    is_accepted = np.array([region.accepts(tests) for _, region in judging])
    edges = [region.edge() for _, region in judging]
    places = np.array([(entry.candidate, entry.confidence) for entry, _ in judging])
    is_judged = np.array([entry.fold.judged for entry, _ in judging])
    axes = np.stack(cell.parameters(ellipses, side=side), axis=-1)
    limits = np.array([(region.a, region.b) for _, region in judging])
    for motion in range(is_judged.shape[1]):
        rows = np.flatnonzero(is_judged[:, motion])
        if not rows.size:
            continue
        actuators = [tests, *(edges[k] for k in rows)]
        gains = np.concatenate([part.gain for part in actuators])
        delays = np.concatenate([part.delay for part in actuators])
        errors = truth.errors(cell, motion, gains, delays)
        trial_errors, edge_errors = errors[:trials], errors[trials:].reshape(rows.size, -1)
        outcomes = np.concatenate(
            [_containment(edge_errors, axes[motion], limits[rows]), _fates(trial_errors, is_accepted[rows])]
        )
        np.add.at(counts[..., motion].transpose(1, 2, 0), tuple(places[rows].T), outcomes.T)


def _containment(
    errors: NDArray[np.float64], axes: NDArray[np.float64], limits: NDArray[np.float64]
) -> NDArray[np.int64]:
    """First five counts of each region, from errors (regions, points) over the threshold along its edge."""
    is_exceeded = (errors > 1.0).any(axis=1)
    is_judged = is_exceeded | np.isfinite(errors).all(axis=1)
    has_ellipse = np.full(is_judged.size, np.isfinite(axes).all())
    is_within = has_ellipse & (limits <= axes).all(axis=1)
    return np.array([is_judged & ~is_exceeded, is_judged, ~is_judged, is_within, has_ellipse], dtype=np.int64)


def _fates(errors: NDArray[np.float64], is_accepted: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Last five counts of each region, from errors (trials,) over the threshold and what it accepts."""
    is_finite, good = np.isfinite(errors), errors <= 1.0
    is_accepted = is_accepted & is_finite
    accepted_good = (is_accepted & good).sum(axis=1)
    everywhere = np.ones(len(is_accepted), dtype=np.int64)
    return np.array(
        [
            is_finite.sum() * everywhere,
            is_accepted.sum(axis=1),
            is_accepted.sum(axis=1) - accepted_good,
            accepted_good,
            good.sum() * everywhere,
        ],
        dtype=np.int64,
    )


def _label_counts(
    counts: NDArray[np.int64],
    ellipses: xr.Dataset,
    candidates: Sequence[Candidate],
    confidences: Sequence[float],
) -> xr.Dataset:
    return xr.Dataset(
        {name: (DIMENSIONS, values) for name, values in zip(COUNTS, counts, strict=True)},
        coords={
            "candidate": [candidate.name for candidate in candidates],
            "confidence": list(confidences),
            "side": [str(side) for side in Side],
            "f": ellipses["f"].values,
            "xi": ellipses["xi"].values,
            "motion": ellipses["motion"].values,
            "event": ("motion", ellipses["event"].values),
        },
    )


EDGES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Edges of the bins of stated probability."""


def probability_calibration(
    ellipses: xr.Dataset,
    *,
    scheme: str = "leave_one_event_out",
    edges: Sequence[float] = EDGES,
    threshold: float = 0.05,
    metric: str = "rms",
    truth: Truth | None = None,
    trials: int = 256,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Compare probabilities stated for tests with the share of good tests under unseen motions.

    `threshold` [-].
    Returns one row a bin: mean `stated` probability, share `observed` of good tests with `low` and `high`
    ends of its 95 % interval over earthquakes, and number of `tests`.
    """
    events, truth = ellipses["event"].values, truth or EllipseTruth(ellipses)
    folds = folds_of(scheme, events, ellipses["duration"].values if "duration" in ellipses.coords else None)
    structures = list(product(ellipses["f"].values.tolist(), ellipses["xi"].values.tolist()))
    shape = (events.size, len(edges) - 1)
    stated_sums, good, count = (np.zeros(shape) for _ in range(3))
    for step, (f, xi) in enumerate(structures, start=1):
        structure_ellipses = ellipses.sel(f=[f], xi=[xi])
        cell = Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)
        tests = draw_trials(ellipses, cell, trials)
        errors = np.array([truth.errors(cell, k, tests.gain, tests.delay) for k in range(events.size)])
        for fold in folds:
            population = Population.from_ellipses(
                structure_ellipses.isel(motion=fold.learned), threshold=threshold, metric=metric
            )
            probability = population.probability(tests.gain, tests.delay, f, xi)
            bins = np.clip(np.digitize(probability, edges) - 1, 0, shape[1] - 1)
            for motion in np.flatnonzero(fold.judged):
                is_finite = np.isfinite(errors[motion])
                stated_sums[motion] += np.bincount(bins[is_finite], probability[is_finite], shape[1])
                good[motion] += np.bincount(bins[is_finite], errors[motion][is_finite] <= 1.0, shape[1])
                count[motion] += np.bincount(bins[is_finite], minlength=shape[1])
        progress(step, len(structures))
    return _table(stated_sums, good, count, events)


def _table(
    stated_sums: NDArray[np.float64],
    good: NDArray[np.float64],
    count: NDArray[np.float64],
    events: NDArray[np.str_],
) -> pd.DataFrame:
    is_filled = count.sum(axis=0) > 0.0
    low, high = event_bootstrap(good[:, is_filled], count[:, is_filled], events)
    total = count[:, is_filled].sum(axis=0)
    return pd.DataFrame(
        {
            "stated": stated_sums[:, is_filled].sum(axis=0) / total,
            "observed": good[:, is_filled].sum(axis=0) / total,
            "low": low,
            "high": high,
            "tests": total.astype(np.int64),
        }
    )
