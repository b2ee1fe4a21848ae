"""The outcome of a diagnosis in sentences: what is missing, what remains, and what to do next."""

from typing import Final, NamedTuple

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import PERCENT
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Verdict
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.gap import NO_CHANGE, Gap, Remainder
from reliab.report.numbers import Significant, write_in_line
from reliab.report.prose import Prose, probability, prose, spell_out, words_of

SIZE: Final = Significant(digits=3, factor=PERCENT)
"""How sizes of errors stand in tables and sentences."""

_NEXT = {
    Verdict.NO_MISSING_EFFECT: "use the calibrated model, model.toml, for the next tests",
    Verdict.NAMED: "use the updated model, model.toml, for the next tests, and compare its prediction with "
    "the first of them",
    Verdict.UNKNOWN_EFFECT: "look at what the calibrated model, model.toml, leaves in that block; add an "
    "effect of your own to the library",
    Verdict.NOT_IDENTIFIABLE: "measure tests of other amplitudes and frequencies, or more channels, before "
    "you use the calibrated model, model.toml",
}


def advise_next_step(diagnosis: Diagnosis) -> str:
    """Advise what to do, which is no use of a model whose parameters are not known."""
    if diagnosis.verdict is Verdict.NAMED and any(b.converged is False for b in diagnosis.blocks):
        return (
            "measure a further test before model.toml is used: the posterior of its parameters has not "
            "converged, so that they are not known as well as they may seem"
        )
    if diagnosis.verdict is Verdict.UNKNOWN_EFFECT and diagnosis.unknown and diagnosis.unknown.formula:
        return "use the updated model, model.toml, which holds this term, and look for its cause"
    return _NEXT[diagnosis.verdict]


def verdict_in_words(diagnosis: Diagnosis) -> Prose:
    """Say what is missing, and how much of the gap it closes."""
    names = ", ".join(spell_out(effect.name) for effect in diagnosis.effects)
    match diagnosis.verdict:
        case Verdict.NO_MISSING_EFFECT:
            return prose("{statement}", statement=diagnosis.statement)
        case Verdict.NAMED:
            return prose(
                "The model lacks *{names}*. {closed}", names=names, closed=_describe_closed_gap(diagnosis)
            )
        case Verdict.UNKNOWN_EFFECT:
            unknown = diagnosis.unknown
            first = "The model lacks *{names}*, and the" if names else "The"
            formula = "" if unknown is None or not unknown.formula else f" ({unknown.formula})"
            closed = f" {_describe_closed_gap(diagnosis)}" if formula else ""
            return prose(
                first
                + " *{where}* has an effect that is none of the known ones: {description}{formula}.{closed}",
                names=names,
                where="" if unknown is None else unknown.block,
                description="" if unknown is None else unknown.description,
                formula=formula,
                closed=closed,
            )
        case Verdict.NOT_IDENTIFIABLE:
            doubtful = " or ".join(spell_out(effect.name) for effect in diagnosis.doubtful)
            return prose(
                "The model lacks an effect, but these tests do not show which one: *{names}*.",
                names=doubtful,
            )


def _describe_closed_gap(diagnosis: Diagnosis) -> str:
    """Say how much is explained, in the block of those with an effect of which least is."""
    gaps = [block.gap for block in diagnosis.blocks if block.effects or block.unknown] or [diagnosis.gap]
    gap = max(gaps, key=lambda one: one.worst_unexplained_share or 0.0)
    is_one = len(diagnosis.effects) + (diagnosis.unknown is not None) == 1
    with_effects = "With it" if is_one else "With them"
    before, after = map(write_share_of_signal, (gap.before, gap.after))
    is_shown = gap.after < (1.0 - NO_CHANGE) * gap.before
    change = f"falls from {before} to" if is_shown else "stays at"
    of_all = (
        f"{'' if is_shown else 'Only the fitted tests show it. '}{with_effects} the error in {gap.channel} "
        f"on held-out tests {change} {after} of the signal{_describe_other_gaps(gap)}: {gap.conclusion}."
    )
    worst = next(iter(gap.by_kind), None)
    if worst is None or len(gap.by_kind) == 1 or not worst.unexplained_share:
        return of_all
    share = percent(worst.unexplained_share, decimals=1)
    return f"{of_all} Least is explained of {worst.kind}: {share} of the gap's energy remains."


def _describe_other_gaps(gap: Gap) -> str:
    """Say what the best linear model and the best rival leave."""
    others = []
    if gap.linear is not None and gap.linear != gap.before:
        others.append(f"the best linear model leaves {write_share_of_signal(gap.linear)}")
    if gap.rival is not None:
        rival = " + ".join(map(spell_out, gap.rival_effects)) or "the model without effects"
        others.append(f"the best rival ({rival}) {write_share_of_signal(gap.rival)}")
    return f" ({', '.join(others)})" if others else ""


def write_share_of_signal(size: float) -> str:
    """Write an error [-] in per cent of the signal, as the tables do."""
    return f"{write_in_line(SIZE(size))} %"


class Outcome(NamedTuple):
    """A diagnosis in sentences."""

    verdict: str
    findings: tuple[str, ...]  # Effects with their parameters, then what remains in the other blocks
    action: str  # What to do next


def outcome_in_words(diagnosis: Diagnosis) -> Outcome:
    """Say what is missing and what to do, for a terminal."""
    effects = (
        f"{spell_out(effect.name)} (probability {probability(effect.probability)}): {effect.parameters}."
        for effect in diagnosis.all_effects
    )
    remainders = (words_of(describe_remainder(block)) for block in diagnosis.blocks if not block.effects)
    return Outcome(
        verdict=words_of(verdict_in_words(diagnosis)),
        findings=(*effects, *remainders),
        action=f"Next step: {advise_next_step(diagnosis)}.",
    )


def describe_remainder(block_diagnosis: BlockDiagnosis) -> Prose:
    """Sentence on what no model could explain, and what is the model's own error."""
    gap = block_diagnosis.gap
    match gap.remainder:
        case Remainder.AT_NOISE:
            text = "{where}: {after} of the signal remains, and {floor} is noise ({source}); {conclusion}."
        case Remainder.ABOVE_NOISE:
            text = (
                "{where}: {floor} of the signal is noise that no model explains ({source}). What remains "
                "above it, {left} of the signal, is an error of the model."
            )
        case Remainder.NOT_KNOWN if gap.floors:
            text = (
                "{where}: how much of the error is noise is not known; the {others} seemed to show more "
                "noise than the model leaves. {after} of the signal remains; {conclusion}."
            )
        case Remainder.NOT_KNOWN:
            text = (
                "{where}: the recordings do not show how much of the error is noise (no repeated tests or "
                "cycles, no rest, no white band above the motion). {after} of the signal remains; "
                "{conclusion}."
            )
    return prose(
        text,
        where=f"{str(block_diagnosis.block.block).capitalize()}, {gap.channel}",
        after=write_share_of_signal(gap.after),
        floor="" if gap.floor is None else write_share_of_signal(gap.floor),
        source=gap.source or "",
        left=write_share_of_signal(gap.model_error),
        others=", ".join(gap.floors),
        conclusion=gap.conclusion,
    )
