"""Report of a measured campaign: where the model fails, what is missing, and the proof."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import pandas as pd

from reliab.discrepancy import BlockDiagnosis, Diagnosis, MissingEffect, Verdict
from reliab.discrepancy.adding.posterior import Posterior
from reliab.discrepancy.fitting.observations import MOST_OF_A_TEST
from reliab.discrepancy.naming.naming import LARGEST_REMAINDER
from reliab.discrepancy.result import Unknown
from reliab.report.document import Block, Column, Document, Paragraph, Points, Section, Table
from reliab.report.kinds.discrepancy_figures import (
    block_figure,
    drawn,
    gap_figure,
    histories_figure,
    posterior_figure,
    state_plane_figure,
    time_frequency_figure,
)
from reliab.report.kinds.provenance import provenance_of
from reliab.report.kinds.wording import percent
from reliab.report.numbers import Fixed, Significant
from reliab.report.prose import Prose, prose

_CLOSED, _WHOLLY = 0.9, 0.995


def discrepancy_report(
    diagnosis: Diagnosis,
    *,
    posteriors: Mapping[str, Posterior] | None = None,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
) -> Document:
    """Report a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis
        What was found, from :func:`reliab.discrepancy.diagnose`.
    posteriors : mapping of str to Posterior, optional
        Sampled posteriors by the name of the block; without them parameters stand with their approximate
        standard deviations only.
    provenance : mapping
        What the report can be made again from, by name.
    notes : sequence of Prose, optional
        What the reader should know beside the diagnosis' own remarks.

    Returns
    -------
    Document
        The report.
    """
    sampled = posteriors or {}
    sections = [_where(diagnosis), _what(diagnosis, sampled), _proof(diagnosis)]
    if diagnosis.criterion_shift is not None:
        sections.append(_shift(diagnosis.criterion_shift))
    remarks = (*diagnosis.remarks, *(posterior.statement for posterior in sampled.values()), *notes)
    return Document(
        kind="Diagnosis of a measured campaign",
        title=diagnosis.campaign.name,
        verdict=_verdict(diagnosis),
        tone="good" if diagnosis.verdict is Verdict.NO_MISSING_EFFECT else "plain",
        facts=_facts(diagnosis),
        blocks=(*sections, _method(remarks)),
        provenance=provenance_of(provenance),
    )


def _verdict(diagnosis: Diagnosis) -> Prose:
    names = ", ".join(_words(effect.name) for effect in diagnosis.effects)
    match diagnosis.verdict:
        case Verdict.NO_MISSING_EFFECT:
            return "Nothing is missing: calibration alone explains the tests."
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
            doubtful = " or ".join(_words(effect.name) for effect in diagnosis.doubtful)
            return prose("Something is missing, and these tests do not tell what: *{names}*.", names=doubtful)


def _closed(diagnosis: Diagnosis) -> str:
    share = diagnosis.gap.closed_fraction
    if share is None:
        before, after = percent(diagnosis.gap.before), percent(diagnosis.gap.after)
        return f"On held-out tests the error falls from {before} to {after}."
    if share >= _WHOLLY:
        return "With it the gap on held-out tests closes to the noise."
    remainder = "" if share >= _CLOSED else " Something is left."
    return f"With it {percent(share)} of the gap on held-out tests is closed.{remainder}"


def _words(name: str) -> str:
    return name.replace("_", " ")


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
    return facts


def _where(diagnosis: Diagnosis) -> Section:
    blocks: list[Block] = [*drawn("the loop", partial(block_figure, diagnosis))]
    if diagnosis.where:
        blocks.append(Points(items=tuple(dict.fromkeys(finding.detail for finding in diagnosis.where))))
        rows = [{**finding.as_dict(), "block": str(finding.block)} for finding in diagnosis.where]
        columns = (
            Column(key="block", heading="Block"),
            Column(key="kind", heading="Goes with"),
            Column(key="test", heading="Most in"),
            Column(
                key="share_of_residual", heading="Share", unit="%", number=Fixed(decimals=0, factor=100.0)
            ),
            Column(key="p_value", heading="p", number=Significant(digits=2)),
        )
        frame = pd.DataFrame(rows).assign(kind=lambda table: table["kind"].map(_words))
        caption = "What the residual of the calibrated model goes along with; p is corrected for all trials."
        blocks.append(Table(frame=frame, columns=columns, caption=caption, label="tab:where"))
    else:
        blocks.append(Paragraph(text="The calibrated model leaves nothing that differs from noise."))
    for diagnosed in diagnosis.blocks:
        if diagnosed.findings:
            blocks += drawn("residuals over frequency", partial(time_frequency_figure, diagnosed))
            blocks += drawn("residuals over the state plane", partial(state_plane_figure, diagnosed))
    return Section(title="Where the model fails", blocks=tuple(blocks))


def _what(diagnosis: Diagnosis, sampled: Mapping[str, Posterior]) -> Section:
    effects = (*diagnosis.effects, *diagnosis.doubtful)
    blocks: list[Block] = []
    if effects:
        blocks.append(_parameters(diagnosis))
        blocks += [Paragraph(text=_sentence(effect)) for effect in effects]
        for name, posterior in sampled.items():
            blocks += drawn("the posterior", partial(posterior_figure, diagnosis, name, posterior))
    blocks += [
        Paragraph(text=_unknown(diagnosed.unknown))
        for diagnosed in diagnosis.blocks
        if diagnosed.unknown is not None
    ]
    if any(diagnosed.calibration for diagnosed in diagnosis.blocks):
        blocks.append(_calibration(diagnosis))
    return Section(title="What is missing", blocks=tuple(blocks) or (Paragraph(text="Nothing."),))


def _parameters(diagnosis: Diagnosis) -> Table:
    rows = []
    for diagnosed in diagnosis.blocks:
        for effect in (*diagnosed.effects, *diagnosed.doubtful):
            for estimate in effect.estimates:
                low, high = estimate.interval or (np.nan, np.nan)
                mark = " (on a bound)" if estimate.name in effect.on_bounds else ""
                rows.append(
                    {
                        "effect": _words(effect.name),
                        "probability": effect.probability,
                        "parameter": f"{estimate.name} [{estimate.units}]{mark}",
                        "value": estimate.value,
                        "sd": estimate.sd,
                        "low": low,
                        "high": high,
                    }
                )
    digits = Significant(digits=4)
    columns = (
        Column(key="effect", heading="Effect"),
        Column(key="probability", heading="Probability", number=Fixed(decimals=3)),
        Column(key="parameter", heading="Parameter"),
        Column(key="value", heading="Value", number=digits),
        Column(key="sd", heading="± sd", number=Significant(digits=2)),
        Column(key="low", heading="from", number=digits, group="90 % interval"),
        Column(key="high", heading="to", number=digits, group="90 % interval"),
    )
    return Table(
        frame=pd.DataFrame(rows),
        columns=columns,
        caption="Effects with the most probable values of their parameters.",
    )


def _unknown(unknown: Unknown) -> Prose:
    text = "In the {block}: {description}. "
    if unknown.expression:
        text += (
            "An expression for it is {expression}; with it {error} of the signal remain on held-out tests."
        )
    else:
        text += "It is {error} of the signal on held-out tests."
    return prose(
        text,
        block=unknown.block,
        description=unknown.description,
        expression=unknown.expression,
        error=percent(unknown.held_out_nrmse),
    )


def _calibration(diagnosis: Diagnosis) -> Table:
    rows = [
        {
            "block": str(diagnosed.block.block),
            "parameter": e.name,
            "value": e.value,
            "sd": e.sd,
            "units": e.units,
        }
        for diagnosed in diagnosis.blocks
        for e in diagnosed.calibration
    ]
    columns = (
        Column(key="block", heading="Block"),
        Column(key="parameter", heading="Calibrated"),
        Column(key="value", heading="Value", number=Significant(digits=4)),
        Column(key="sd", heading="± sd", number=Significant(digits=2)),
        Column(key="units", heading="Unit"),
    )
    return Table(frame=pd.DataFrame(rows), columns=columns, caption="What was calibrated along with them.")


def _sentence(effect: MissingEffect) -> Prose:
    name, description = _words(effect.name), effect.effect.description
    listed = "; ".join(
        f"{_words(rival.name)} (probability {rival.probability:.2g}, error {rival.held_out_nrmse:.3g})"
        for rival in effect.rivals
    )
    others = f"In its place, with errors on held-out tests: {listed}." if listed else "It has no rival."
    return prose(
        "*{name}*{position}: {description}. With it {after} of the signal remain on held-out tests, without "
        "it {before}. {others}",
        name=name,
        position=f" ({effect.effect.position})" if effect.effect.position else "",
        description=description,
        after=percent(effect.error_with),
        before=percent(effect.error_without),
        others=others,
    )


def _proof(diagnosis: Diagnosis) -> Section:
    rows = [
        {
            **diagnosed.gap.as_dict(),
            "closed": np.nan if diagnosed.gap.closed_fraction is None else diagnosed.gap.closed_fraction,
            "noise_floor": np.nan if diagnosed.gap.floor is None else diagnosed.gap.floor,
        }
        for diagnosed in diagnosis.blocks
    ]
    size = Significant(digits=3)
    columns = (
        Column(key="channel", heading="Channel"),
        Column(key="nrmse_before", heading="Before", number=size),
        Column(key="nrmse_after", heading="After", number=size),
        Column(key="noise_floor", heading="Noise", number=size),
        Column(key="closed", heading="Gap closed", unit="%", number=Fixed(decimals=1, factor=100.0)),
    )
    caption = "Difference between model and measurement on held-out tests, RMS over that of the signal."
    table = Table(frame=pd.DataFrame(rows), columns=columns, caption=caption)
    blocks: list[Block] = [Paragraph(text=_floor(diagnosed)) for diagnosed in diagnosis.blocks]
    blocks += [table, _errors_by_test(diagnosis), *drawn("the gap", partial(gap_figure, diagnosis))]
    for diagnosed in diagnosis.blocks:
        blocks += drawn("histories and loops", partial(histories_figure, diagnosed))
    return Section(title="The proof on held-out tests", blocks=tuple(blocks))


def _floor(diagnosed: BlockDiagnosis) -> Prose:
    """Sentence on what no model could explain, and what is the model's own error."""
    gap = diagnosed.gap
    if gap.floor is None:
        return prose(
            "{channel}: the recordings do not tell how much of it is noise (no repeated tests or cycles, no "
            "rest, no white band above the motion). What remains is {left} of the signal.",
            channel=gap.channel,
            left=percent(gap.after),
        )
    return prose(
        "{channel}: by the {source} {floor} of the signal cannot be explained by any model. What remains "
        "above it, {left} of the signal, is an error of the model.",
        channel=gap.channel,
        source=gap.source or "",
        floor=percent(gap.floor),
        left=percent(gap.model_error),
    )


def _errors_by_test(diagnosis: Diagnosis) -> Table:
    rows = [
        {
            "channel": diagnosed.gap.channel,
            "test": file,
            "before": diagnosed.gap.tests_before[file],
            "after": after,
        }
        for diagnosed in diagnosis.blocks
        for file, after in diagnosed.gap.tests_after.items()
    ]
    size = Significant(digits=3)
    columns = (
        Column(key="channel", heading="Channel"),
        Column(key="test", heading="Held-out test"),
        Column(key="before", heading="Before", number=size),
        Column(key="after", heading="After", number=size),
    )
    caption = "The same for each held-out test by itself."
    return Table(frame=pd.DataFrame(rows), columns=columns, caption=caption)


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
        "Each observed block is driven with its measured input and simulated freely. Calibration and offsets "
        "are fitted with every candidate. Noise is a smooth spectrum that is fitted to what a model leaves, "
        "so that the lines of a structure's response do not pass for noise. Where what the best model leaves "
        "passes for noise, candidates are compared by their evidence, and each effect pays for being added. "
        "Where it follows the motion, it is an error of the model instead: candidates are then compared by "
        "their error on tests that are left out one at a time, in the channel's own unit, a test counts as "
        "no more than {most:.0f} observations, and an effect beside others must take a tenth off that error. "
        "Held-out tests take no part in the choice. The verdict is named where at most {share} of the energy "
        "that the effects took away remains."
    )
    described = prose(text, most=MOST_OF_A_TEST, share=percent(LARGEST_REMAINDER))
    blocks: list[Block] = [Paragraph(text=described)]
    if remarks:
        blocks.append(Points(items=tuple(remarks)))
    return Section(title="How it was found, and what to know", blocks=tuple(blocks))
