"""The verdict: reliable, undecided or not reliable, with its reasons and what would decide it."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.significant import percent, significant

CERTAIN: Final = 0.95
"""Probability from which on a test is called reliable; below 1 − this, not reliable."""


class Word(StrEnum):
    """What a verdict says."""

    RELIABLE = "reliable"
    UNDECIDED = "undecided"
    NOT_RELIABLE = "not_reliable"

    @property
    def shout(self) -> str:
        """The word as a headline."""
        return self.value.replace("_", " ").upper()


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """A verdict."""

    word: Word  # What it says
    reasons: tuple[str, ...]  # Why, in sentences
    would_decide: tuple[str, ...] = ()  # What would decide an undecided test, in sentences

    def doubted(self, reasons: Sequence[str], would_decide: Sequence[str]) -> "Verdict":
        """Return the verdict as undecided for further reasons; unchanged where there are none."""
        if not reasons:
            return self
        return Verdict(
            word=Word.UNDECIDED,
            reasons=(*reasons, *self.reasons),
            would_decide=(*would_decide, *self.would_decide),
        )


def word_of_probability(probability: float) -> Word:
    """Turn the probability that the error stays below the threshold into a verdict.

    >>> [str(word_of_probability(p)) for p in (0.99, 0.78, 0.01)]
    ['reliable', 'undecided', 'not_reliable']
    """
    if probability >= CERTAIN:
        return Word.RELIABLE
    return Word.NOT_RELIABLE if probability <= 1.0 - CERTAIN else Word.UNDECIDED


def verdict_by_index(
    *,
    index: float | None,
    interval: tuple[float, float] | None,
    probability: float | None,
    confidence: float,
    own_motion: bool,
    outside: Sequence[str] = (),
) -> Verdict:
    """Judge a test by its index.

    `outside` says why no motion behind the criterion is like the test's; the index then decides nothing.

    Returns undecided where the interval holds 1, and where too many ground motions would keep the error below
    the threshold to call the test bad, and too few to call it good.
    """
    if index is None or interval is None:
        return Verdict(
            word=Word.UNDECIDED,
            reasons=("The measured displacement leads, and the criterion has no limits for leads.",),
            would_decide=("Give its ground motion, or a criterion that has limits for leads.",),
        )
    if outside:
        return Verdict(
            word=Word.UNDECIDED,
            reasons=(*outside, "The criterion does not cover such a test."),
            would_decide=("Give the test's ground motion; the index is then judged by its boundary.",),
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
                "The error of such a test stays below the threshold under "
                f"{percent(probability, decimals=0)} of the population's ground motions: fewer than the "
                f"{percent(confidence, decimals=0)} that were asked for, and too many to call the test bad."
            ),
        ),
        would_decide=("Give the test's ground motion; the index is then judged by its boundary.",),
    )
