"""Report of a measured campaign: where the model fails, what is missing, and the proof."""

from collections.abc import Mapping, Sequence

from reliab.discrepancy.adding import Posterior
from reliab.discrepancy.fitting import MOST_OF_A_TEST
from reliab.discrepancy.naming import LARGEST_REMAINDER
from reliab.discrepancy.result import Diagnosis, Remainder, Verdict
from reliab.report.document import Block, Document, Paragraph, Points, Section
from reliab.report.kinds.discrepancy.location import location_section
from reliab.report.kinds.discrepancy.missing_effects import missing_effects_section
from reliab.report.kinds.discrepancy.proof import proof_section
from reliab.report.prose import Prose, prose
from reliab.report.provenance import provenance_of
from reliab.report.wording import percent, spelled_out

_CLOSED, _WHOLLY = 0.9, 0.995

_NEXT = {
    Verdict.NO_MISSING_EFFECT: "keep the calibrated values, which stand in model.toml, for the next tests",
    Verdict.NAMED: "use model.toml, which holds the effects and the calibrated values, for the next "
    "tests, and compare its prediction with the first of them",
    Verdict.UNKNOWN_EFFECT: "look at the residual of the block below; a term of your own can be given to the "
    "diagnosis",
    Verdict.NOT_IDENTIFIABLE: "measure tests of other amplitudes and frequencies, or more channels, and "
    "diagnose again",
}


def discrepancy_report(
    diagnosis: Diagnosis,
    *,
    posteriors: Mapping[str, Posterior] | None = None,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
) -> Document:
    """Report a diagnosis."""
    sampled = posteriors or {}
    sections = [
        location_section(diagnosis),
        missing_effects_section(diagnosis, sampled),
        proof_section(diagnosis),
    ]
    if diagnosis.criterion_shift is not None:
        sections.append(_shift(diagnosis.criterion_shift))
    remarks = (*diagnosis.remarks, *(posterior.statement for posterior in sampled.values()), *notes)
    return Document(
        kind="Diagnosis of a measured campaign",
        title=diagnosis.campaign.name,
        verdict=_verdict(diagnosis),
        tone="good" if diagnosis.verdict is Verdict.NO_MISSING_EFFECT and diagnosis.is_explained else "plain",
        facts={**_facts(diagnosis), "To do next": _NEXT[diagnosis.verdict]},
        blocks=(*sections, _method(remarks)),
        provenance=provenance_of(provenance),
    )


def _verdict(diagnosis: Diagnosis) -> Prose:
    names = ", ".join(spelled_out(effect.name) for effect in diagnosis.effects)
    match diagnosis.verdict:
        case Verdict.NO_MISSING_EFFECT:
            return prose("{statement}", statement=diagnosis.statement)
        case Verdict.NAMED:
            return prose("The model lacks *{names}*. {closed}", names=names, closed=_closed(diagnosis))
        case Verdict.UNKNOWN_EFFECT:
            where = "" if diagnosis.unknown is None else diagnosis.unknown.block
            if not names:
                return prose("The *{where}* has an effect that is none of the known ones.", where=where)
            return prose(
                "The model lacks *{names}*, and the *{where}* has an effect that is none of the known ones.",
                names=names,
                where=where,
            )
        case Verdict.NOT_IDENTIFIABLE:
            doubtful = " or ".join(spelled_out(effect.name) for effect in diagnosis.doubtful)
            return prose(
                "Something is missing, but these tests do not show which effect it is: *{names}*.",
                names=doubtful,
            )


def _closed(diagnosis: Diagnosis) -> str:
    share = diagnosis.gap.stated_share
    if share is None:
        before, after = percent(diagnosis.gap.before), percent(diagnosis.gap.after)
        return f"On held-out tests the error falls from {before} to {after}."
    if share >= _WHOLLY and diagnosis.gap.remainder is Remainder.AT_NOISE:
        return "With it the gap on held-out tests closes to the noise."
    remainder = "" if share >= _CLOSED else " A part of it remains."
    return f"With it {percent(share)} of the gap on held-out tests is closed.{remainder}"


def _facts(diagnosis: Diagnosis) -> dict[str, Prose]:
    campaign = diagnosis.campaign
    held_out = ", ".join(diagnosis.gap.held_out)
    facts: dict[str, Prose] = {
        "Tests": f"{len(campaign.tests)} at {campaign.rate:g} Hz, held out: {held_out}",
        "Channels": ", ".join(sorted(campaign.channels)),
        "Blocks observed": ", ".join(str(diagnosed.block.block) for diagnosed in diagnosis.blocks),
    }
    if campaign.structure is not None:
        facts["Structure"] = prose(
            "$f = {f:g}$ Hz, $xi = {xi:g}$, share of the stiffness in the laboratory $alpha = {alpha:g}$",
            f=campaign.structure.frequency,
            xi=campaign.structure.damping_ratio,
            alpha=campaign.structure.experimental_fraction,
        )
    if campaign.partition is not None:
        frequencies = campaign.partition.frame.modes.frequency
        facts["Structure"] = prose(
            "frame of {size} degrees of freedom, $f_1 = {significant(lowest)}$ Hz",
            size=campaign.partition.frame.size,
            lowest=float(frequencies[0]),
        )
    return facts


def _shift(ratios: Mapping[str, float]) -> Section:
    text = prose(
        "With the effects, the ellipse parameters of the criterion for 5 % error are {a:.2f} ($a$) and "
        "{b:.2f} ($b$) of what they are without. The gain and the delay of the criterion are those of the "
        "actuator alone; what the specimen does belongs to the behaviour under test.",
        a=ratios["a"],
        b=ratios["b"],
    )
    return Section(title="What it means for the criterion", blocks=(Paragraph(text=text),))


def _method(remarks: Sequence[Prose]) -> Section:
    text = (
        "Each observed block is driven with its measured input and simulated freely. Calibration and "
        "offsets are fitted with every candidate. The noise is described by a smooth spectrum that is "
        "fitted to the residual of a model, so that the peaks of a structure's response are not mistaken "
        "for noise. Where the residual of the best model looks like noise, candidates are compared by "
        "their evidence, which counts against every further effect. Where it follows the motion, it is an "
        "error of the model: candidates are then compared by their error on tests that are left out one at "
        "a time, in the unit of the channel; a test counts as at most {most:.0f} observations, and a "
        "further effect must explain more of the residual than it leaves. Held-out tests take no part in "
        "the choice. The verdict is “named” where at most {share} of the energy of the gap remains."
    )
    described = prose(text, most=MOST_OF_A_TEST, share=percent(LARGEST_REMAINDER))
    blocks: list[Block] = [Paragraph(text=described)]
    if remarks:
        blocks.append(Points(items=tuple(remarks)))
    return Section(title="How it was found, and what to know", blocks=tuple(blocks))
