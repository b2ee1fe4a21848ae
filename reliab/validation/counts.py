"""Counts of right and wrong verdicts on motions that criteria were not learned from, and their rates."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.core.plain_values import Keys, ResultWithRows, same_names
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Side

COUNTS: Final = (
    *("contained", "judged", "unresolved", "within_ellipse", "fitted"),
    *("tried", "accepted", "accepted_bad", "accepted_good", "good"),
)
"""Kinds of counts."""

DIMENSIONS: Final = ("candidate", "confidence", "side", "f", "xi", "motion")
"""Dimensions of the counts."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CrossValidation(ResultWithRows):
    """Counts for each judged motion, and the rates that follow."""

    rows_in = "rates"
    keys: ClassVar[Keys] = same_names("scheme", "threshold", "metric", "truth", "rates")
    table_columns = ("candidate", "confidence", "containment", "containment_low", "containment_high")
    plot_columns = ("confidence", "containment")

    # Over (candidate, confidence, side, f, xi, motion), for actuators that are late and those that are early:
    # times `judged` and `contained` by the true error, times `unresolved`, where the error along the edge is
    # not known; times `fitted`, where the motion has an ellipse, and `within_ellipse`, where it contains the
    # criterion's; trials `tried`, `accepted`, `accepted_bad`, `accepted_good`, and `good`
    counts: xr.Dataset
    scheme: str  # How the motions were divided
    threshold: float  # Error on the boundary [-]
    metric: str  # Which error
    truth: str  # What the errors rest on: "simulated", or "ellipse" where only fitted ellipses are known

    @property
    def rates(self) -> list[dict[Any, Any]]:
        """Rates of each criterion over all structures."""
        return tabulate(self).to_dict("records")

    def containment(self, over: Sequence[str] = ("f", "xi"), side: Side = Side.LAG) -> xr.Dataset:
        """Share of judged motions under which the error stays below the threshold along the whole edge."""
        return self._rate("contained", "judged", over, side)

    def containment_by_ellipse(self, over: Sequence[str] = ("f", "xi"), side: Side = Side.LAG) -> xr.Dataset:
        """Share of motions whose fitted ellipse contains the criterion's; as :meth:`containment`."""
        return self._rate("within_ellipse", "fitted", over, side)

    def false_safe(self, over: Sequence[str] = ("f", "xi"), side: Side = Side.LAG) -> xr.Dataset:
        """Share of accepted tests whose error exceeds the threshold; as :meth:`containment`."""
        return self._rate("accepted_bad", "accepted", over, side)

    def accepted_share(self, over: Sequence[str] = ("f", "xi"), side: Side = Side.LAG) -> xr.Dataset:
        """Share of truly good tests that are accepted; as :meth:`containment`."""
        return self._rate("accepted_good", "good", over, side)

    def confusion(self, over: Sequence[str] = ("f", "xi", "motion"), side: Side = Side.LAG) -> xr.Dataset:
        """Confusion matrix of the verdicts on trials.

        Returns trials `good_accepted`, `good_rejected`, `bad_accepted` and `bad_rejected`, the error of good
        ones staying below the threshold.
        """
        total = self.counts.sel(side=str(side), drop=True).sum(list(over))
        good_rejected = total["good"] - total["accepted_good"]
        return xr.Dataset(
            {
                "good_accepted": total["accepted_good"],
                "good_rejected": good_rejected,
                "bad_accepted": total["accepted_bad"],
                "bad_rejected": total["tried"] - total["accepted"] - good_rejected,
            }
        )

    def judges(self, side: Side) -> bool:
        """Whether anything was judged of actuators that are late, or early."""
        return bool((self.counts["judged"].sel(side=str(side)) > 0).any())

    def _rate(self, numerator: str, denominator: str, over: Sequence[str], side: Side) -> xr.Dataset:
        counts = self.counts.sel(side=str(side), drop=True)
        top, bottom = (counts[name].sum(list(over)) for name in (numerator, denominator))
        low, high = event_bootstrap(
            top.transpose("motion", ...).values.astype(np.float64),
            bottom.transpose("motion", ...).values.astype(np.float64),
            self.counts["event"].values,
        )
        total = bottom.sum("motion")
        rate = top.sum("motion") / total.where(total > 0)  # NaN where nothing was judged
        return xr.Dataset({"rate": rate, "low": rate.copy(data=low), "high": rate.copy(data=high)})


RATES: Final = ("containment", "containment_by_ellipse", "false_safe", "accepted_share")
"""Rates of a cross-validation, each a method of :class:`CrossValidation`."""


def tabulate(
    validation: CrossValidation, over: Sequence[str] = ("f", "xi"), *, side: Side = Side.LAG
) -> pd.DataFrame:
    """Tabulate the rates of a cross-validation.

    Returns one row for each candidate, confidence and structure that was judged, in this order: each of
    `RATES` [-] with `_low` and `_high` ends of its 95 % interval (NaN where there is nothing to count), and
    the confusion matrix `good_accepted`, `good_rejected`, `bad_accepted`, `bad_rejected` [trials].
    """
    rates = [
        getattr(validation, name)(over, side).rename(
            {"rate": name, "low": f"{name}_low", "high": f"{name}_high"}
        )
        for name in RATES
    ]
    measures = xr.merge([*rates, validation.confusion((*over, "motion"), side)])
    table = measures.to_dataframe(dim_order=measures[RATES[0]].dims).reset_index()
    return table.dropna(subset=RATES[0]).reset_index(drop=True)


_REPETITIONS = 2000


def event_bootstrap(
    numerator: NDArray[np.float64],
    denominator: NDArray[np.float64],
    events: NDArray[np.str_],
    *,
    level: float = 0.95,
    seed: int = 0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interval of Σ numerator / Σ denominator, whole earthquakes being drawn with replacement.

    `events` (motions,).
    Returns `low, high`: ends of the interval, in the trailing shape; NaN where there is nothing to be
    counted. Where none or all were counted, drawing earthquakes again shows no spread: one end is then that
    of Clopper and Pearson, for as many trials as earthquakes.

    Davison, A. C. and Hinkley, D. V. (1997). *Bootstrap Methods and their Application*, section 3.8.
    """
    distinct, group = np.unique(events, return_inverse=True)
    top = np.zeros((distinct.size, *numerator.shape[1:]))
    bottom = np.zeros_like(top)
    np.add.at(top, group, numerator)
    np.add.at(bottom, group, denominator)
    rng = np.random.default_rng(seed)
    event_counts = rng.multinomial(distinct.size, np.full(distinct.size, 1.0 / distinct.size), _REPETITIONS)
    with np.errstate(invalid="ignore", divide="ignore"):  # nothing accepted in a drawing
        rates = np.tensordot(event_counts, top, axes=1) / np.tensordot(event_counts, bottom, axes=1)
    ends = np.full((2, *rates.shape[1:]), np.nan)
    countable = bottom.sum(axis=0) > 0.0
    ends[:, countable] = np.nanquantile(
        rates[:, countable], [0.5 * (1.0 - level), 0.5 * (1.0 + level)], axis=0
    )
    is_zero, is_one = top.sum(axis=0) == 0.0, top.sum(axis=0) == bottom.sum(axis=0)
    least = (0.5 * (1.0 - level)) ** (1.0 / np.maximum((bottom > 0.0).sum(axis=0), 1))
    low = np.where(countable & is_one, least, ends[0])
    return low, np.where(countable & is_zero, 1.0 - least, ends[1])


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
