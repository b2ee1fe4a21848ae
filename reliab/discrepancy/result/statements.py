"""Sentences on a diagnosis, each of which is said only where the numbers beside it carry it."""

from collections.abc import Iterable

from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Verdict
from reliab.discrepancy.result.gap import Gap, Remainder
from reliab.significant import significant

_VERDICTS = {
    Verdict.NAMED: "The model lacks what is listed below.",
    Verdict.UNKNOWN_EFFECT: "Something is missing that is none of the known effects.",
    Verdict.NOT_IDENTIFIABLE: "Something is missing, but these tests do not show which effect it is.",
}


def is_explained(block: BlockDiagnosis) -> bool:
    """Whether what the model of a block leaves can be taken for noise."""
    return block.gap.remainder is Remainder.AT_NOISE or (
        block.gap.remainder is Remainder.NOT_KNOWN and block.leaves_noise
    )


def statement(verdict: Verdict, blocks: Iterable[BlockDiagnosis]) -> str:
    """Say what a verdict means.

    Returns one sentence. That nothing is missing is said only where every block is explained.
    """
    if verdict is not Verdict.NO_MISSING_EFFECT:
        return _VERDICTS[verdict]
    open_ones = [str(block.block.channel) for block in blocks if not is_explained(block)]
    if not open_ones:
        return "Calibration alone explains the tests: nothing is missing."
    return (
        f"Calibration explains the tests but for a remainder in {', '.join(open_ones)} that may not be noise."
    )


def remainder_statement(name: str, gap: Gap, structured_share: float) -> str:
    """Say what remains of a block whose residual does not pass for noise."""
    after = significant(gap.after)
    floor = "unknown" if gap.floor is None else f"{significant(gap.floor)} by the {gap.source}"
    subject = f"What the model of the {name} leaves of held-out tests, {after} of the signal's RMS,"
    match gap.remainder:
        case Remainder.AT_NOISE:
            size = f"is at the noise floor of {floor}"
        case Remainder.ABOVE_NOISE:
            size = (
                f"is not noise alone: {significant(gap.model_error)} of it is an error of the model above the"
                f" noise floor of {floor}"
            )
        case Remainder.NOT_KNOWN:
            size = "is an error of the model, noise, or both: the noise floor is unknown"
    return (
        f"{subject} {size}. {structured_share:.0%} of the energy of its residual follows the motion, so that"
        " no probability above 0.99 is stated."
    )
