"""The verdict by the error of the test, with what leaves it open."""

from reliab.validation.assessment.error_of_test import ErrorOfTest, Question
from reliab.validation.assessment.findings import FaultEffect
from reliab.validation.assessment.verdict import Verdict, Word, word_of_probability
from reliab.vocabulary import Metric

ERROR_NAMES = {Metric.RMS: "RMS^R", Metric.MTE: "MTE^R"}


def verdict_of_error(error: ErrorOfTest, effects: tuple[FaultEffect, ...], question: Question) -> Verdict:
    """Judge a test by its own error.

    Parameters
    ----------
    error : ErrorOfTest
        The error with its interval.
    effects : tuple of FaultEffect
        Faults of the recording.
    question : Question
        What was asked.

    Returns
    -------
    Verdict
        Undecided where the interval holds the threshold, where a fault of the recording would turn the
        verdict round, and where the test contradicts what was stated of it.
    """
    size = error.of(question.metric)
    word = word_of_probability(error.probability)
    name = ERROR_NAMES[question.metric]
    reason = (
        f"{name} is {size.value:.2%}, 90 % interval {size.low:.2%} to {size.high:.2%}, against a threshold "
        f"of {question.threshold:.3g}: probability {probability_text(error.probability)} of staying below it."
    )
    verdict = Verdict(
        word=word,
        reasons=(reason,),
        would_decide=error.would_decide if word is Word.UNDECIDED else (),
    )
    reasons, remedies = _doubts(error, effects, word)
    return verdict.doubted(reasons, remedies)


def probability_text(probability: float, *, bound: float = 0.99) -> str:
    """Write a probability, without claiming more than 0.99.

    Examples
    --------
    >>> probability_text(0.784), probability_text(0.9995), probability_text(0.0001)
    ('0.78', '> 0.99', '< 0.01')
    """
    if probability > bound:
        return f"> {bound:g}"
    if probability < 1.0 - bound:
        return f"< {1.0 - bound:.2g}"
    return f"{probability:.2f}"


def _doubts(error: ErrorOfTest, effects: tuple[FaultEffect, ...], word: Word) -> tuple[list[str], list[str]]:
    reasons, remedies = [], []
    for effect in effects:
        if effect.otherwise is None:
            if word is Word.RELIABLE:
                reasons.append(effect.fault.finding)
                remedies.append("Export the test again, each channel from its own sensor.")
            continue
        if effect.fault.in_loop is None and word_of_probability(effect.otherwise.probability) is not word:
            reasons.append(
                f"{effect.fault.finding} It decides the verdict, and whether the structure felt it is not "
                "known."
            )
            remedies.append("Mend the recording, or find out whether the loop felt it, and assess it again.")
    if error.contradictions and word is not Word.NOT_RELIABLE:
        reasons.extend(error.contradictions)
        remedies.append("State the structure as the test shows it, or find out why it differs.")
    return reasons, remedies
