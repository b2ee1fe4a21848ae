"""Motions on which criteria are judged: their ellipses, their true errors, and how they are divided."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.app.api.sources import EllipseSource, as_list
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import Numbers
from reliab.criterion.ellipse_table import drop_copies, interpolate_threshold
from reliab.criterion.scope import Position, compare_with_scope, magnitudes_of, scope_of
from reliab.motions.suite import MotionSuite
from reliab.sweep.labels import select_share, share_of
from reliab.sweep.results import REAL, find_results, open_results
from reliab.tracking.indices.window import Window
from reliab.validation.folds import (
    Fold,
    earthquakes_among,
    folds_of,
    from_another,
    leave_structures_out,
    transfer,
)
from reliab.validation.truth import EllipseTruth, SimulatedTruth, StoredTruth, Truth

DEFAULT_SCHEME = "leave_one_event_out"
"""How earthquakes are divided where nothing is said."""


def require_one_share(alpha: Numbers | None) -> None:
    """Refuse several shares of the stiffness.

    `alpha` [-].
    """
    shares = as_list(alpha) or []
    if len(shares) > 1:
        raise InputError(
            "Criteria are judged for one share of the stiffness at a time",
            value=f"`alpha={' '.join(f'{share:g}' for share in shares)}`",
            remedy="Give one, and ask again for the others",
        )


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


@dataclass(frozen=True, kw_only=True)
class Division:
    """A division of motions into those that are learned from and those that are judged."""

    folds: list[Fold]  # The pairs of both
    name: str  # What the division is called
    learn_from: xr.Dataset | None = None  # Ellipses of another suite that is learned from
    recognised_motions: int = 0  # Motions whose earthquake that suite holds too


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


def list_kept_shares(
    rows: Sequence[Mapping[str, Any]], side_phrase: str = "", motions_phrase: str = "the motions"
) -> Iterator[str]:
    """Say of each method and law whether the share that it states is kept, and by which motions.

    >>> rate = {"rate": 0.52, "low": 0.41, "high": 0.63}
    >>> rows = [{"candidate": "power", "confidence": 0.95, "containment": rate}]
    >>> print(*list_kept_shares(rows))
    power does not keep what it states: it protects 52.0 % of the motions at 95 %.
    >>> of_one_record = {"rate": 1.0, "low": 0.025, "high": 1.0}
    >>> print(*list_kept_shares([{**rows[0], "containment": of_one_record}]))
    power may keep what it states (too few earthquakes to tell): it protects 100.0 % of the motions at 95 %.
    """
    for candidate in dict.fromkeys(row["candidate"] for row in rows):
        rates = [
            (row["containment"], row["confidence"])
            for row in rows
            if row["candidate"] == candidate and row["containment"]["rate"] is not None
        ]
        if not rates:
            continue
        shares = ", ".join(
            f"{percent(rate['rate'], decimals=1)} at {percent(confidence, decimals=0)}"
            for rate, confidence in rates
        )
        first_share, later_shares = shares.split(" at", 1)
        verdict = f"{candidate} {_keeps(rates)}{side_phrase}"
        yield f"{verdict}: it protects {first_share} of {motions_phrase} at{later_shares}."


def _keeps(rates: Sequence[tuple[Mapping[str, Any], float]]) -> str:
    """Whether shares are kept: their intervals lie above what is stated, below it, or hold it."""
    phrases: dict[str, list[str]] = {
        "does not keep what it states": [],
        "keeps what it states": [],
        "may keep what it states": [],
    }
    broken_promise, kept_promise, open_promise = phrases
    for rate, confidence in rates:
        low, high = (rate[end] if rate[end] is not None else rate["rate"] for end in ("low", "high"))
        phrase = kept_promise if low >= confidence else broken_promise if high < confidence else open_promise
        phrases[phrase].append(percent(confidence, decimals=0))
    filled_phrases = {phrase: shares for phrase, shares in phrases.items() if shares}
    sentences = [
        phrase if len(filled_phrases) == 1 else f"{phrase} at {', '.join(shares)}"
        for phrase, shares in filled_phrases.items()
    ]
    if open_promise in filled_phrases:
        sentences[-1] += " (too few earthquakes to tell)"
    return "; it ".join(sentences)


_UNITS = {"magnitude": "", "length": " s"}


def sentences_of_outside(ellipses: xr.Dataset, division: Division) -> Iterator[str]:
    """Say of each division which of its motions no promise is made for, by their length and magnitude.

    `ellipses`: of the motions that are judged, with their lengths where they are known.
    """
    scopes, quantities = list(_scopes(ellipses, division)), _quantities(ellipses)
    for name, quantity in product(dict.fromkeys(map(_group, division.folds)), quantities):
        judged_values: list[float] = []
        outside_values: list[float] = []
        ends: list[float] = []
        for fold, scope in scopes:
            if _group(fold) == name and quantity in scope and fold.judged.any():
                values = quantities[quantity][fold.judged].tolist()
                judged_values += values
                ends += [scope[quantity][0], scope[quantity][-1]]
                outside_values += [value for value in values if _is_outside(scope, quantity, value)]
        if outside_values:
            unit = _UNITS[quantity]
            yield (
                f"No promise for {len(outside_values)} of the {len(judged_values)} motions of {name}, of "
                f"{quantity} {_range(outside_values)}{unit}: their criterion was learned from motions of "
                f"{_range(ends)}{unit}."
            )


def motions_outside(ellipses: xr.Dataset, division: Division) -> NDArray[np.bool_]:
    """Which motions lie outside of those from which a criterion that judges them is learned, (motions,)."""
    is_outside = np.zeros(ellipses.sizes["motion"], dtype=np.bool_)
    for fold, scope in _scopes(ellipses, division):
        for quantity, values in _quantities(ellipses).items():
            flags = [_is_outside(scope, quantity, float(value)) for value in values]
            is_outside |= fold.judged & np.array(flags, dtype=np.bool_)
    return is_outside


def _scopes(ellipses: xr.Dataset, division: Division) -> Iterator[tuple[Fold, dict[str, list[float]]]]:
    """Give each fold with the scope of the motions from which its criterion is learned."""
    learned_from = ellipses if division.learn_from is None else division.learn_from
    for fold in division.folds:
        yield fold, scope_of(learned_from.isel(motion=fold.learned))


def _group(fold: Fold) -> str:
    """Name of what a division judges, whichever structures or earthquakes it leaves out beside."""
    return fold.name.partition(", ")[0]


def _is_outside(scope: Mapping[str, Sequence[float]], quantity: str, value: float) -> bool:
    return compare_with_scope(scope, {quantity: value}).position is Position.OUTSIDE


def _quantities(ellipses: xr.Dataset) -> dict[str, np.ndarray]:
    """Length [s] and magnitude of each motion, shape (motions,), as far as they are known."""
    quantities = {}
    if "duration" in ellipses.coords:
        quantities["length"] = ellipses["duration"].values.astype(np.float64)
    if (magnitudes := magnitudes_of(ellipses["event"].values.tolist())) is not None:
        quantities["magnitude"] = np.array(magnitudes)
    return quantities


def _range(values: Sequence[float]) -> str:
    ends = [significant(end(values)) for end in (min, max)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)
