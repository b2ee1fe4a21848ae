"""Unstated conditions that would change a verdict: specimens that yield or harden, filters of one channel.

A specimen of which nobody recorded the force is stiff as stated up to the largest displacement over a
ductility, and softer beyond. The error with each ductility follows from the test's own displacements.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, TypeAlias

import numpy as np

from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.inference.rebuilt import error_of_command
from reliab.assessment.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.error_statistics import relative_error
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.yielding_sweep import (
    errors_with_specimens,
    yielding_specimen,
)
from reliab.assessment.verdict import CERTAIN, Doubt, Verdict, Word, word_of_probability
from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import Metric
from reliab.effects.cubic_stiffness import CubicStiffness
from reliab.effects.effect import SteppedEffect
from reliab.recordings.recording import Recording
from reliab.signals.filters import LowPass

CORNERS: Final = (500.0, 400.0, 300.0, 200.0, 150.0, 120.0, 100.0, 80.0, 60.0, 50.0, 40.0, 30.0, 20.0)
"""Corners of a filter of second order on one channel [Hz], from the weakest filter that is tried."""

_UNKNOWN = "No force was recorded. If the specimen yielded"
_YIELDING = "Record the force of the specimen, or give `specimen` as linear if it stayed elastic."


@dataclass(frozen=True, kw_only=True)
class Turning(PlainResult):
    """What would change the verdict on a test, though it was not stated; None where nothing tried does."""

    keys: ClassVar[Keys] = {
        **same_names("smallest_ductility", "error_if_yielding", "smallest_hardening", "error_if_hardening"),
        "highest_filter_hz": "highest_filter",
    }

    # Smallest of `DUCTILITIES` with which the error lies on the other side of the threshold [-]
    smallest_ductility: float | None = None
    # Smallest and largest error with one of `DUCTILITIES` [-]; None where a force was recorded, or the
    # specimen is stated as linear
    error_if_yielding: tuple[float, float] | None = None
    # Smallest of `HARDENINGS` with which it does, and smallest and largest error with one of these [-]
    smallest_hardening: float | None = None
    error_if_hardening: tuple[float, float] | None = None
    # Highest of `CORNERS` with which it does, on command or measured displacement alone [Hz]
    highest_filter: float | None = None
    # What is assumed of the skew of a slow recording; empty where it was stated
    doubt_of_skew: str = ""
    # Odds of specimens that yielded or hardened so that the verdict would turn, over that of a linear one
    odds: float = np.inf

    def doubts(self, verdict: Verdict, probability: float) -> Iterator[Doubt]:
        """Say where a reliable test may not be if its specimen yielded or hardened.

        `probability`: that the error stays below the threshold if the specimen is linear.
        """
        nothing_turns = self.smallest_ductility is None and self.smallest_hardening is None
        if nothing_turns or verdict.word is not Word.RELIABLE or probability / (1.0 + self.odds) >= CERTAIN:
            return
        for sentence in self._specimen_sentences:
            yield Doubt(finding=sentence, remedy=_YIELDING)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Say what would change the verdict."""
        return tuple(self._sentences())

    def warnings(self, verdict: Verdict) -> tuple[str, ...]:
        """Say what the reasons of the verdict do not say already."""
        return tuple(sentence for sentence in self.sentences if sentence not in verdict.reasons)

    @property
    def _specimen_sentences(self) -> tuple[str, ...]:
        """What another specimen would do, in a sentence; none where it is known."""
        if self.error_if_yielding is None or self.error_if_hardening is None:
            return ()
        sentence = (
            f"{_UNKNOWN} (ductility up to {significant(DUCTILITIES[-1])}), the error would be "
            f"{_error_range(self.error_if_yielding)}"
            f"{_turning_value('ductility', self.smallest_ductility)}; if it "
            f"hardened (by up to {percent(HARDENINGS[-1])} of its force), "
            f"{_error_range(self.error_if_hardening)}{_turning_value('hardening', self.smallest_hardening)}."
        )
        return (sentence,)

    def _sentences(self) -> Iterator[str]:
        yield from self._specimen_sentences
        if self.highest_filter is not None:
            yield (
                "No filters stated. A low-pass filter of second order at "
                f"{significant(self.highest_filter)} Hz or lower on one channel alone would change the "
                "verdict: give `filter`."
            )
        if self.doubt_of_skew:
            yield self.doubt_of_skew


def _error_range(errors: tuple[float, float]) -> str:
    return f"{percent(errors[0], 2)} to {percent(errors[1], 2)}"


def _turning_value(quantity: str, smallest: float | None) -> str:
    """Say with how much of it the verdict would turn."""
    if smallest is None:
        return " (same verdict)"
    size = significant(smallest) if quantity == "ductility" else percent(smallest)
    return f" (another verdict from a {quantity} of {size} on)"


def examine_turning(error: ErrorOfTest, recording: Recording, question: Question) -> Turning:
    """Find what would turn the verdict; nothing is asked of a model, or where all is taken as exact."""
    if question.equipment.is_exact or question.model is not None:
        return Turning()
    step = recording.time_step
    doubt_of_skew = "" if "skew" in question.stated else question.equipment.doubt_of_skew(step)
    is_known = recording.force is not None or question.ignores_force or question.linear_specimen
    yielding = {} if is_known else errors_with(error.rebuilt, question.metric, yielded, DUCTILITIES)
    hardening = {} if is_known else errors_with(error.rebuilt, question.metric, hardened, HARDENINGS)
    filters = _errors_if_filtered(error) if "filter_delay" not in question.stated else {}
    return Turning(
        smallest_ductility=_first(yielding, error),
        error_if_yielding=None if is_known else (min(yielding.values()), max(yielding.values())),
        smallest_hardening=_first(hardening, error),
        error_if_hardening=None if is_known else (min(hardening.values()), max(hardening.values())),
        highest_filter=_first(filters, error),
        doubt_of_skew=doubt_of_skew,
        odds=_odds(error, yielding, hardening, question.equipment.yielding),
    )


def _odds(
    error: ErrorOfTest, yielding: Mapping[float, float], hardening: Mapping[float, float], share: float
) -> float:
    """Odds of specimens that yielded or hardened so that a reliable test is not, over that of a linear one.

    Each of them has the same part of the probability a priori that the specimen was not linear; the channels
    say how much likelier they are with it.
    """
    if error.inferred is None or word_of_probability(error.probability) is not Word.RELIABLE:
        return np.inf
    peaks = _peaks(error.rebuilt)
    specimens = [
        *(yielded(peaks, ductility) for ductility, size in yielding.items() if size >= error.threshold),
        *(hardened(peaks, part) for part, size in hardening.items() if size >= error.threshold),
    ]
    prior_odds = share / (1.0 - share) / max(len(yielding) + len(hardening), 1) if share < 1.0 else np.inf
    ratios = [error.inferred.log_evidence_ratio(specimen, error.rebuilt.histories) for specimen in specimens]
    return float(prior_odds * np.sum(np.exp(np.minimum(ratios, _LARGEST_LOGARITHM)))) if ratios else 0.0


_LARGEST_LOGARITHM = 50.0


def _first(errors: Mapping[float, float], error: ErrorOfTest) -> float | None:
    """First value whose error lies on the other side of the threshold; None for an undecided verdict."""
    if word_of_probability(error.probability) is Word.UNDECIDED:
        return None
    is_below = error.estimate(error.metric).value < error.threshold
    return next((value for value, size in errors.items() if (size < error.threshold) != is_below), None)


def _errors_if_filtered(error: ErrorOfTest) -> dict[float, float]:
    """Errors if one channel had passed a filter with each corner: the one nearer to the other side.

    A filter delays the motions of a test; on the command it acts against one on the measured channel.
    """
    rebuilt, histories = error.rebuilt, error.rebuilt.histories
    rates = np.gradient(histories.carry @ histories.measured, histories.time_step, axis=1)
    responses = error_of_command(rebuilt.structure, rebuilt.inferred.band, rates)
    nearer = max if error.estimate(error.metric).value < error.threshold else min

    def size(late: float) -> float:
        sizes = (
            relative_error(
                degree.smooth_error + late * (rate - response),
                degree.reference + late * response,
                error.metric,
            )
            for degree, rate, response in zip(error.displacements, rates, responses, strict=True)
            if degree.judged
        )
        return max(sizes, default=0.0)

    delays = {corner: LowPass(corner=corner).delay for corner in CORNERS}
    return {corner: nearer(size(late), size(-late)) for corner, late in delays.items()}


DUCTILITIES: Final = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
"""Largest displacement over the yield displacement, from the smallest that is tried."""

HARDENINGS: Final = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
"""Force beyond the linear one at the largest displacement over that, from the smallest that is tried."""

_HARDENING = 0.03  # stiffness after yielding over that before
_SHARPNESS = 8.0  # exponent of the hysteresis


SpecimenOfSize: TypeAlias = Callable[[Array, float], list[SteppedEffect]]


def yielded(peaks: Array, ductility: float) -> list[SteppedEffect]:
    """Return a specimen that yields at its largest displacements [m], shape (p,), over a ductility."""
    return [yielding_specimen(peak / ductility, _HARDENING, _SHARPNESS) for peak in peaks.tolist()]


def hardened(peaks: Array, hardening: float) -> list[SteppedEffect]:
    """Return a specimen whose force at its largest displacements [m] exceeds the linear one by a share."""
    return [CubicStiffness(cubic_n_per_m3=hardening / peak**2) for peak in peaks.tolist()]


def _peaks(rebuilt: RebuiltError) -> Array:
    """Largest interface displacements [m], shape (p,); 1 m of one that stands still, which never yields."""
    histories = rebuilt.histories
    peaks = np.abs(histories.carry @ histories.measured).max(axis=1)
    return np.where(peaks > 0.0, peaks, 1.0)


def errors_with(
    rebuilt: RebuiltError, metric: Metric, specimen: SpecimenOfSize, sizes: Sequence[float]
) -> dict[float, float]:
    """Largest errors of the judged displacements if the specimen yielded or hardened by each size."""
    specimens = [specimen(_peaks(rebuilt), size) for size in sizes]
    thin = rebuilt.histories.thin(samples_in_step_of_structure(rebuilt.structure, rebuilt.time_step))
    judged = [place for place, degree in enumerate(rebuilt.displacements) if degree.judged]
    statistics = errors_with_specimens(specimens, thin, rebuilt.structure)[:, judged]
    square, largest, ideal = np.moveaxis(statistics, -1, 0)
    errors = (np.sqrt(square) if metric is Metric.RMS else largest) / ideal
    return dict(zip(sizes, errors.max(axis=1, initial=0.0).tolist(), strict=True))
