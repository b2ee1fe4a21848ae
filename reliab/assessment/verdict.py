"""The verdict: reliable, undecided or not reliable, with its reasons, the next steps, and their words."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.significant_digits import percent, percent_and_interval, significant

CERTAIN: Final = 0.95
"""Probability from which on a test is called reliable; below 1 − this, not reliable."""
_ALMOST_CERTAIN: Final = 0.99
"""The largest probability that is stated: rarer cases are not known well enough."""


class Word(StrEnum):
    """What a verdict says."""

    RELIABLE = "reliable"
    UNDECIDED = "undecided"
    NOT_RELIABLE = "not_reliable"

    @property
    def phrase(self) -> str:
        """The word in a sentence."""
        return self.value.replace("_", " ")

    @property
    def shout(self) -> str:
        """The word as a headline."""
        return self.phrase.upper()


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """A verdict."""

    word: Word  # What it says
    reasons: tuple[str, ...]  # Why, in sentences
    # What to do about an undecided test, in sentences; what narrows the interval may not decide it
    would_decide: tuple[str, ...] = ()

    @property
    def reliable(self) -> bool:
        """Whether it is "reliable"."""
        return self.word is Word.RELIABLE

    def limit(self, doubts: Sequence["Doubt"]) -> "Verdict":
        """Return the verdict as undecided where there are doubts; unchanged where there are none."""
        bad = self.word is Word.NOT_RELIABLE
        limiting = [doubt for doubt in doubts if doubt.of_structure or not bad]
        if not limiting:
            return self
        return Verdict(
            word=Word.UNDECIDED,
            reasons=(*(doubt.finding for doubt in limiting), *self.reasons),
            would_decide=(*(doubt.remedy for doubt in limiting), *self.would_decide),
        )


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """What leaves the verdict on a test undecided."""

    finding: str  # Why, a sentence
    remedy: str  # What would resolve it, a sentence
    of_structure: bool = False  # Whether the test may be of another structure: no bad one is surely bad then


@dataclass(frozen=True, kw_only=True)
class Contradiction(Doubt):
    """A stated quantity that the recording contradicts."""

    option: str = ""  # Under which it is stated; empty of what has none


def word_of_probability(probability: float) -> Word:
    """Turn the probability that the error stays below the threshold into a verdict.

    >>> [str(word_of_probability(p)) for p in (0.99, 0.78, 0.01)]
    ['reliable', 'undecided', 'not_reliable']
    """
    if probability >= CERTAIN:
        return Word.RELIABLE
    return Word.NOT_RELIABLE if probability <= 1.0 - CERTAIN else Word.UNDECIDED


def error_in_words(
    name: str, size: Estimate, threshold: float, probability: float, *, show_interval: bool = False
) -> str:
    """Say how large an error is [-], and how likely it is to stay below a threshold [-].

    The value is said where it and the probability decide alike, else the 90 % interval. `show_interval`:
    whether the interval is said in any case.

    >>> size = Estimate(value=0.0576, low=0.0051, high=0.0847)
    >>> error_in_words("RMS error", size, 0.05, 0.61)
    'RMS error 0.5 to 8.5 %, 61 % likely to be below 5 %'
    >>> error_in_words("RMS error", size, 0.05, 0.004, show_interval=True)
    'RMS error 5.8 % (90 % interval 0.5 to 8.5 %), less than 1 % likely to be below 5 %'
    """
    word = Word.RELIABLE if size.value < threshold else Word.NOT_RELIABLE
    value, interval = percent_and_interval(size.value, size.low, size.high)
    if word_of_probability(probability) is word:
        size_text = f"{value} (90 % interval {interval})" if show_interval else value
    else:
        size_text = f"{interval} (90 % interval)" if show_interval else interval
    return f"{name} {size_text}, {_likely(probability)} to be below {percent(threshold)}"


def _likely(probability: float) -> str:
    """Say how likely something is, without claiming more than 99 %."""
    if probability > _ALMOST_CERTAIN:
        return f"more than {percent(_ALMOST_CERTAIN)} likely"
    if probability < 1.0 - _ALMOST_CERTAIN:
        return f"less than {percent(1.0 - _ALMOST_CERTAIN)} likely"
    return f"{percent(probability, decimals=0)} likely"


def probability_text(probability: float) -> str:
    """Write a probability, without claiming more than 0.99.

    >>> probability_text(0.784), probability_text(0.9995), probability_text(0.0001)
    ('0.78', '> 0.99', '< 0.01')
    """
    if probability > _ALMOST_CERTAIN:
        return f"> {_ALMOST_CERTAIN:g}"
    if probability < 1.0 - _ALMOST_CERTAIN:
        return f"< {significant(1.0 - _ALMOST_CERTAIN, 2)}"
    return f"{probability:.2f}"


def next_steps(steps: Sequence[str], narrowing: Collection[str]) -> Iterator[str]:
    """Say what to do about a verdict beside what narrows the interval of the error, which may not decide it.

    >>> list(next_steps(["Cut the test.", "Measure the skew."], ["Measure the skew."]))
    ['Next step: Cut the test.']
    """
    yield from (f"Next step: {step}" for step in steps if step not in narrowing)


def verdict_by_index(
    *,
    index: float | None,
    interval: tuple[float, float] | None,
    probability: float | None,
    confidence: float,
    own_motion: bool,
    outside_reasons: Sequence[str] = (),
) -> Verdict:
    """Judge a test by its index.

    `outside_reasons` says why no motion behind the criterion is like the test's; the index then decides
    nothing.

    Returns undecided where the interval holds 1, and where too many ground motions would keep the error below
    the threshold to call the test bad, and too few to call it good.
    """
    if index is None or interval is None:
        return Verdict(
            word=Word.UNDECIDED,
            reasons=("The measured displacement leads, and the criterion has no limits for leads.",),
            would_decide=("Give the `motion` of the test, or a criterion that has limits for leads.",),
        )
    if outside_reasons:
        return Verdict(
            word=Word.UNDECIDED,
            reasons=(*outside_reasons, "The criterion does not cover such a test."),
            would_decide=("Give the `motion` of the test, by whose boundary the index is then judged.",),
        )
    low, high = interval
    if high <= 1.0:
        return Verdict(
            word=Word.RELIABLE, reasons=(f"The index {significant(index)} and its interval stay below 1.",)
        )
    if low <= 1.0:
        return Verdict(
            word=Word.UNDECIDED,
            reasons=(f"The interval of the index, {significant(low)} to {significant(high)}, contains 1.",),
            would_decide=("Less noise, or a longer test, narrows the interval of A and d.",),
        )
    if own_motion or probability is None or probability <= 1.0 - confidence:
        return Verdict(word=Word.NOT_RELIABLE, reasons=(f"The index {significant(index)} exceeds 1.",))
    return Verdict(
        word=Word.UNDECIDED,
        reasons=(
            (
                f"The index {significant(index)} exceeds 1, yet under {percent(probability, decimals=0)} of "
                "comparable ground motions the error of such a test stays below the threshold: too "
                "many to call it bad."
            ),
        ),
        would_decide=("Give the `motion` of the test, by whose boundary the index is then judged.",),
    )
