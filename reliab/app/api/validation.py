"""`reliab.validate_criteria`, `reliab.calibrate_probabilities`: whether criteria hold on unseen motions."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Unpack

import numpy as np
import pandas as pd
import xarray as xr

from reliab.app import questions
from reliab.app.api.sources import FIVE_PERCENT, EllipseSource, as_list
from reliab.app.declaration import asks
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.plain_values import ResultWithRows
from reliab.core.progress import show_task
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric, Side
from reliab.criterion.ellipse_table import drop_copies, interpolate_threshold
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, find_law
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.criterion.scope import population_of
from reliab.motions.suite import MotionSuite
from reliab.sweep.labels import select_share, share_of
from reliab.sweep.results import REAL, find_results, open_results
from reliab.tracking.indices.window import Window
from reliab.validation.counts import RATES, CrossValidation, list_kept_shares, tabulate
from reliab.validation.folds import (
    GROUP_SCHEMES,
    Division,
    earthquakes_among,
    folds_of,
    from_another,
    leave_structures_out,
    motions_outside,
    sentences_of_outside,
    transfer,
)
from reliab.validation.judge import (
    Candidate,
    DerivedCandidate,
    PrintedCandidate,
    cross_validate,
    probability_calibration,
)
from reliab.validation.truth import EllipseTruth, SimulatedTruth, StoredTruth, Truth

_CONFIDENCES = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)
_TRIALS = 512
_CONFUSION = ("good_accepted", "good_rejected", "bad_accepted", "bad_rejected")


DEFAULT_SCHEME = "leave_one_event_out"
"""How earthquakes are divided where nothing is said."""


def open_judged_ellipses(source: EllipseSource) -> xr.Dataset:
    """Trace or look up the ellipses of the motions, each record once.

    They must be at the structures that are asked for.
    """
    dataset = select_share(source.dataset())
    for name in ("f", "xi"):
        values = dataset[name].values.tolist()
        for value in as_list(getattr(source, name)) or []:
            if not any(math.isclose(value, existing, rel_tol=1e-9) for existing in values):
                raise InputError(
                    "The source has no boundaries for this structure",
                    value=f"`{name}={value:g}`",
                    remedy=f"Choose among {', '.join(map('{:g}'.format, values))}, or give `motions`",
                )
    for error in as_list(source.threshold) or []:
        dataset = interpolate_threshold(dataset, error)
    return drop_copies(dataset)


def true_errors(source: EllipseSource, dataset: xr.Dataset) -> Truth:
    """Choose where true errors come from: the loop, stored results, or else ellipses."""
    names = dataset["motion"].values.tolist()
    if source.motions is not None:
        suite = source.suite()
        return SimulatedTruth(
            motions=[suite[place] for place in _places(names, suite)],
            window=Window.parse(str(dataset.attrs["window"])),
            experimental_fraction=share_of(dataset),
        )
    results_source = source.results or (source.ellipses if str(source.ellipses) == REAL else None)
    if results_source is None:
        return EllipseTruth(dataset)
    window = str(dataset.attrs.get("window", "record"))
    structures = (dataset[name].values.tolist() for name in ("f", "xi"))
    results = open_results(find_results(Path(results_source), *structures), window=window).sel(motion=names)
    return StoredTruth(select_share(results, share_of(dataset)))


def _places(names: Sequence[str], suite: MotionSuite) -> list[int]:
    """Places of motions in a suite."""
    places = {name: place for place, name in enumerate(suite.names)}
    return [places[name] for name in names]


def divide(dataset: xr.Dataset, source: EllipseSource, question: Mapping[str, Any]) -> Division:
    """Divide motions by a scheme of earthquakes, by sets, or with the shipped suite to learn from."""
    learn, judge, leave_out = as_list(question["learn"]), as_list(question["judge"]), question["leave_out"]
    if learn == [REAL]:
        division = _from_shipped_suite(dataset, source, judge)
    elif learn or judge:
        division = _divide_by_sets(dataset, source, learn, judge)
    else:
        name = question["scheme"] or DEFAULT_SCHEME
        lengths = dataset["duration"].values if "duration" in dataset.coords else None
        division = Division(folds=folds_of(name, dataset["event"].values, lengths), name=name)
    return division if leave_out is None else _leave_out(division, leave_out, dataset)


def _leave_out(division: Division, name: str, dataset: xr.Dataset) -> Division:
    """Leave out each frequency or damping ratio in turn, too."""
    if name not in {"f", "xi"}:
        raise InputError("`leave_out` is f or xi", value=name, remedy="Choose one of these")
    values = dataset[name].values.tolist()
    if len(values) < 2:  # noqa: PLR2004 - one is left out
        raise InputError(
            f"Leaving out each {name} in turn needs at least two",
            value=f"{values[0]:g} alone",
            remedy=f"Give more with `{name}`, or leave `leave_out` out",
        )
    folds = list(leave_structures_out(division.folds, name, values))
    return replace(division, folds=folds, name=f"{division.name}, each {name} left out")


def _from_shipped_suite(dataset: xr.Dataset, source: EllipseSource, judge: Sequence[str] | None) -> Division:
    """Learn from the shipped suite, without the earthquake of the motion that is judged."""
    if judge:
        raise InputError(
            f"`learn={REAL}` judges all motions that are given",
            value=f"`judge={' '.join(judge)}`",
            remedy="Leave `judge` out, or choose among the motions with `sets`",
        )
    shipped_suite = EllipseSource(
        ellipses=REAL,
        f=dataset["f"].values.tolist(),
        xi=dataset["xi"].values.tolist(),
        threshold=source.threshold,
        metric=source.metric,
        window=str(dataset.attrs["window"]),
        alpha=share_of(dataset),
    )
    learn_from = shipped_suite.dataset()
    events, checksums = (dataset[name].values.tolist() for name in ("event", "checksum"))
    outlines = dataset["outline"].values.tolist() if "outline" in dataset.coords else ()
    among = earthquakes_among(events, checksums, learn_from, outlines)
    return Division(
        folds=list(from_another(among, learn_from["event"].values)),
        name=f"learned from {REAL}",
        learn_from=learn_from,
        recognised_motions=sum(name is not None for name in among),
    )


def _divide_by_sets(
    dataset: xr.Dataset, source: EllipseSource, learn: Sequence[str] | None, judge: Sequence[str] | None
) -> Division:
    """Learn from sets of a catalogue and judge others of its sets."""
    if not (learn and judge and source.motions):
        raise InputError(
            "Judging sets by others needs `motions`, `learn` and `judge`",
            remedy=f"Give all three, for example `learn=far_field` `judge=near_field`, or `learn={REAL}`",
        )
    suite = source.suite()
    sets = np.array(suite.set_names, dtype=np.str_)[_places(dataset["motion"].values.tolist(), suite)]
    folds = transfer(sets, dataset["event"].values, learned=learn, judged=judge)
    name = f"learned from {', '.join(learn)}, judged on {', '.join(judge)}"
    return Division(folds=list(folds), name=name)


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
    shares = as_list(request["alpha"]) or []
    if len(shares) > 1:
        raise InputError(
            "Criteria are judged for one share of the stiffness at a time",
            value=f"`alpha={' '.join(f'{share:g}' for share in shares)}`",
            remedy="Give one, and ask again for the others",
        )
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
