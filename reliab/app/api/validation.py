"""`reliab.validate_criteria`, `reliab.calibrate_probabilities`: whether criteria hold on unseen motions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Unpack

import numpy as np
import pandas as pd
import xarray as xr

from reliab.app import questions
from reliab.app.api.judged_motions import (
    DEFAULT_SCHEME,
    Division,
    divide,
    list_kept_shares,
    motions_outside,
    open_judged_ellipses,
    require_one_share,
    sentences_of_outside,
    true_errors,
)
from reliab.app.api.sources import FIVE_PERCENT, EllipseSource, as_list
from reliab.app.declaration import asks
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.plain_values import ResultWithRows
from reliab.core.progress import show_task
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric, Side
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, find_law
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.criterion.scope import population_of
from reliab.sweep.labels import share_of
from reliab.validation.counts import RATES, CrossValidation, tabulate
from reliab.validation.folds import GROUP_SCHEMES
from reliab.validation.judge import (
    Candidate,
    DerivedCandidate,
    PrintedCandidate,
    cross_validate,
    probability_calibration,
)

_CONFIDENCES = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)
_TRIALS = 512
_CONFUSION = ("good_accepted", "good_rejected", "bad_accepted", "bad_rejected")


def _share(value: float | None) -> str:
    return "none" if value is None else percent(value, decimals=1)


def _interval(rate: Mapping[str, float | None]) -> str:
    """Write a rate [-] with its interval, where it has one."""
    value, low, high = rate["rate"], rate["low"], rate["high"]
    if value is None or low is None or high is None:
        return _share(value)
    return f"{_share(value)} ({_share(low)} … {_share(high)})"


@dataclass(frozen=True, kw_only=True, eq=False)
class Validation(ResultWithRows):
    """How often criteria hold on motions from which they were not learned."""

    rows_in = "rows"
    table_columns: ClassVar[Columns] = {
        "criterion": ("candidate", ""),
        "stated": ("confidence", partial(percent, decimals=0)),
        "contained (95 % interval)": ("containment", _interval),
        "by ellipses": ("containment_by_ellipse", lambda rate: _share(rate["rate"])),
        "false-safe": ("false_safe", _interval),
        "good tests accepted": ("accepted_share", _interval),
    }
    plot_columns = ("confidence", "containment_rate")

    counts: CrossValidation
    ellipses: xr.Dataset
    division: Division

    def to_dict(self) -> dict[str, Any]:
        """Rates with their intervals and confusion matrices as plain values with stable keys."""
        # By hand, since sentences need rates that are computed once.
        counts = self.counts.counts
        rows, leads = (_rows(self.counts, ("f", "xi"), side) for side in ("lag", "lead"))
        return {
            "scheme": self.counts.scheme,
            "threshold": self.counts.threshold,
            "metric": self.counts.metric,
            "window": str(self.ellipses.attrs.get("window", "unknown")),
            "alpha": share_of(self.ellipses),
            "n_motions": int(counts.sizes["motion"]),
            "n_events": len(set(counts["event"].values.tolist())),
            "n_of_learned_earthquakes": self.division.recognised_motions,
            "truth": self.counts.truth,
            "unresolved": int(counts["unresolved"].sum()),
            "not_carried": _not_carried(self.counts),
            "judged_on": _describe_judged(self.ellipses, self.counts.scheme),
            "outside": list(sentences_of_outside(self.ellipses, self.division)),
            "rows": rows,
            "sentences": list(_sentences(self, rows, leads)),
            "by_frequency": _rows(self.counts, ("xi",)),
            "by_damping_ratio": _rows(self.counts, ("f",)),
            "rows_lead": leads,
        }


@asks(questions.ValidationQuestion)
def validate_criteria(**request: Unpack[questions.ValidationQuestion]) -> Validation:
    """Test criteria on earthquakes from which they were not learned.

    Raises
    ------
    InputError
        If the source cannot serve what is asked for, or an argument would have no effect.
    """
    if request["scheme"] is not None and (request["learn"] is not None or request["judge"] is not None):
        raise InputError(
            "`scheme` has no effect here: `learn` and `judge` divide the motions",
            value=request["scheme"],
            remedy="Leave it out",
        )
    confidences = list(dict.fromkeys(as_list(request["confidence"]) or _CONFIDENCES))
    candidates = _make_candidates(request, confidences)
    source, dataset, test = _open_test(request)
    division = divide(dataset, source, {**request})
    with show_task("Cross-validating") as progress:
        counts = cross_validate(
            dataset,
            division.folds,
            candidates,
            scheme=division.name,
            confidences=confidences,
            learn_from=division.learn_from,
            progress=progress,
            **test,
        )
    return Validation(counts=counts, ellipses=dataset, division=division)


def _error_of(request: questions.ProbabilityQuestion) -> tuple[float, str]:
    """Threshold [-] and metric of the error that is asked for."""
    threshold, metric = request["threshold"], request["metric"]
    return FIVE_PERCENT if threshold is None else threshold, str(metric or Metric.RMS)


def _open_test(request: questions.ProbabilityQuestion) -> tuple[EllipseSource, xr.Dataset, dict[str, Any]]:
    """Open the motions on which criteria are judged: their source, ellipses, and how errors are judged."""
    require_one_share(request["alpha"])
    threshold, metric = _error_of(request)
    source = EllipseSource.from_question(request, threshold=[threshold])
    dataset = open_judged_ellipses(source)
    return (
        source,
        dataset,
        {
            "threshold": threshold,
            "metric": metric,
            "truth": true_errors(source, dataset),
            "trials": request["trials"] or _TRIALS,
        },
    )


def _make_candidates(request: questions.ValidationQuestion, confidences: Sequence[float]) -> list[Candidate]:
    """Make the criteria of every law and method that is asked for, which are judged at some confidences."""
    laws, methods, joint = as_list(request["law"]), as_list(request["method"]), request["joint"]
    error = _error_of(request)
    has_printed = error == (FIVE_PERCENT, Metric.RMS)
    names = laws or ["table", *(("guo_2017_15", "guo_2017_18") if has_printed else ())]
    candidates: list[Candidate] = []
    for name in names:
        if name in MANY_MOTION_LAWS:
            MANY_MOTION_LAWS[name].validity.require_error(*error)
            published = PrintedCandidate(name=name, law=MANY_MOTION_LAWS[name])
            if laws and not any(published.promises(confidence) for confidence in confidences):
                raise InputError(
                    f"The law {name} has a confidence of {percent(published.confidence, decimals=0)}",
                    value=", ".join(f"{confidence:g}" for confidence in confidences),
                    remedy=f"Ask for `confidence={published.confidence:g}`, or leave the law out",
                )
            candidates.append(published)
            continue
        fitted_law = find_law(FITTED_LAWS, name)
        for method in methods or [RECOMMENDED_METHOD]:
            label = method if name == "table" else f"{method}, {name}"
            candidates.append(
                DerivedCandidate(name=label, method=method_of(method), joint=joint, law=fitted_law)
            )
    idle = "`method`" if methods else "`joint`" if joint is not None else ""
    if idle and not any(isinstance(candidate, DerivedCandidate) for candidate in candidates):
        raise InputError(
            f"{idle} has no effect on published laws", value=", ".join(names), remedy="Leave it out"
        )
    return candidates


def _describe_judged(ellipses: xr.Dataset, scheme: str) -> str:
    """Say which motions are judged, and how they were left out."""
    ways = {
        "leave_one_event_out": "each judged by other earthquakes",
        **{name: f"each {name} judged by the others" for name in GROUP_SCHEMES},
    }
    return f"{population_of(ellipses)} ({ways.get(scheme, scheme.replace('_', ' '))})"


def _sentences(
    validation: Validation, rows: list[dict[str, Any]], leads: list[dict[str, Any]]
) -> Iterator[str]:
    """Say of each criterion whether the share that it states is kept by the motions of which it speaks.

    Printed laws are learned from none of the motions, and speak of all.
    """
    if copies := str(validation.ellipses.attrs.get("copies", "")):
        yield copies
    is_outside, counts = motions_outside(validation.ellipses, validation.division), validation.counts
    motions_phrase = "the motions that do not lie outside" if is_outside.any() else "the motions"
    if is_outside.all():
        yield (
            "All motions lie outside of the populations from which their criteria are learned: no share "
            "is promised."
        )
    for side, side_phrase, all_rows in (("lag", "", rows), ("lead", " for leads", leads)):
        inside_rows = all_rows
        if is_outside.any():
            inner = replace(counts, counts=counts.counts.isel(motion=~is_outside))
            inside_rows = [] if is_outside.all() else _rows(inner, ("f", "xi"), side)
        yield from list_kept_shares(
            [row for row in inside_rows if not _is_printed(row)], side_phrase, motions_phrase
        )
        yield from list_kept_shares([row for row in all_rows if _is_printed(row)], side_phrase)


def _is_printed(row: Mapping[str, Any]) -> bool:
    return row["candidate"] in MANY_MOTION_LAWS


def _rows(
    validation: CrossValidation, dimensions: tuple[str, ...], side: str = "lag"
) -> list[dict[str, Any]]:
    """Rates with intervals and the confusion matrix, one row for each candidate and confidence."""
    rows = []
    for line in tabulate(validation, dimensions, side=Side(side)).to_dict(orient="records"):
        row: dict[str, Any] = {
            str(name): line[name] for name in ("candidate", "confidence", "f", "xi") if name in line
        }
        for name in RATES:
            ends = {"rate": name, "low": f"{name}_low", "high": f"{name}_high"}
            row[name] = {end: None if np.isnan(line[key]) else float(line[key]) for end, key in ends.items()}
        row["confusion"] = {name: int(line[name]) for name in _CONFUSION}
        rows.append(row)
    return rows


def _not_carried(validation: CrossValidation) -> list[dict[str, Any]]:
    """Criteria and confidences for which every fold has too few motions."""
    counts = validation.counts
    judged_counts = (counts["judged"] + counts["unresolved"]).sum(["side", "f", "xi", "motion"])
    return [
        {"candidate": candidate, "confidence": confidence}
        for candidate in counts["candidate"].values.tolist()
        for confidence in counts["confidence"].values.tolist()
        if candidate not in MANY_MOTION_LAWS
        and not int(judged_counts.sel(candidate=candidate, confidence=confidence))
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class ProbabilityCalibration(ResultWithRows):
    """Probabilities that were stated for tests, against how many of the tests are good."""

    rows_in = "bins"
    table_columns: ClassVar[Columns] = {
        "stated probability": ("stated", _share),
        "good tests (95 % interval)": ("", lambda row: _interval({**row, "rate": row["observed"]})),
        "tests": ("tests", "d"),
    }
    keys: ClassVar[Mapping[str, str]] = {"scheme": "scheme", "truth": "truth", "bins": "rows"}

    scheme: str
    truth: str
    bins: pd.DataFrame

    @property
    def rows(self) -> list[dict[Any, Any]]:
        """The bins, one row each."""
        return self.bins.to_dict(orient="records")


@asks(questions.ProbabilityQuestion)
def calibrate_probabilities(**request: Unpack[questions.ProbabilityQuestion]) -> ProbabilityCalibration:
    """Compare the probabilities that are stated for tests with how many of the tests are good.

    Raises
    ------
    InputError
        If the source cannot serve what is asked for.
    """
    scheme = request["scheme"] or DEFAULT_SCHEME
    _, dataset, test = _open_test(request)
    with show_task("Comparing probabilities") as progress:
        bins = probability_calibration(dataset, scheme=scheme, progress=progress, **test)
    return ProbabilityCalibration(scheme=scheme, truth=test["truth"].name, bins=bins)
