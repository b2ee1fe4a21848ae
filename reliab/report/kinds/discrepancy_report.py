"""Report of a measured campaign: where the model fails, what is missing, and the proof."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Final

import numpy as np
import pandas as pd

from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import PERCENT
from reliab.discrepancy.campaign.campaign import describe_held_out
from reliab.discrepancy.fitting.problem import MOST_OF_A_TEST
from reliab.discrepancy.naming.unexplained import LARGEST_REMAINDER
from reliab.discrepancy.posterior import Posterior
from reliab.discrepancy.result.block_diagnosis import Verdict
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.gap import Gap, GapOfKind
from reliab.discrepancy.result.missing_effect import MissingEffect, Unknown
from reliab.report.document import Block, Column, Document, Points, Section, Table, provenance_of
from reliab.report.kinds import discrepancy_figures as figures
from reliab.report.kinds.discrepancy_outcome import (
    SIZE,
    advise_next_step,
    describe_remainder,
    verdict_in_words,
    write_share_of_signal,
)
from reliab.report.numbers import Fixed
from reliab.report.prose import Math, Prose, number, probability, prose, spell_out

_SHARE = Fixed(decimals=1, factor=PERCENT)

_WHERE: Final = "Where the model fails"
_PROOF: Final = "The proof on held-out tests"


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
    convergence = (f"{block.capitalize()}: {one.statement}" for block, one in sampled.items())
    remarks = (*diagnosis.remarks, *convergence, *notes)
    return Document(
        kind="Diagnosis of a measured campaign",
        title=diagnosis.campaign.name,
        verdict=verdict_in_words(diagnosis),
        tone="good" if diagnosis.verdict is Verdict.NO_MISSING_EFFECT and diagnosis.is_explained else "plain",
        facts={**_facts(diagnosis), "To do next": advise_next_step(diagnosis)},
        blocks=(*sections, _method(remarks)),
        provenance=provenance_of(provenance),
    )


def _facts(diagnosis: Diagnosis) -> dict[str, Prose]:
    campaign = diagnosis.campaign
    facts: dict[str, Prose] = {
        "Tests": f"{len(campaign.tests)} at {campaign.rate:g} Hz, held out: {campaign.held_out}",
        "Channels": ", ".join(sorted(campaign.channels)),
        "Blocks observed": ", ".join(
            str(block_diagnosis.block.block) for block_diagnosis in diagnosis.blocks
        ),
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
            "frame of {size} degrees of freedom, $f_1 = {lowest}$ Hz",
            size=campaign.partition.frame.size,
            lowest=Math(source=number(float(frequencies[0]))),
        )
    return facts


def _shift(ratios: Mapping[str, float]) -> Section:
    text = prose(
        "With the effects, an error of 5 % allows {gain:.2f} times the amplitude error and {delay:.2f} "
        "times the delay of the actuator that it allowed without them (the half axes of the criterion's "
        "ellipse; its parameters $a$ and $b$ are their squares, {a:.2f} and {b:.2f} times). Gain and "
        "delay are those of the actuator alone; what the specimen does belongs to the behaviour under "
        "test.",
        gain=np.sqrt(ratios["a"]),
        delay=np.sqrt(ratios["b"]),
        a=ratios["a"],
        b=ratios["b"],
    )
    return Section(title="What it means for the criterion", blocks=(text,))


def _method(remarks: Sequence[Prose]) -> Section:
    text = (
        "Each observed block is driven with its measured input and simulated freely. Calibration and "
        "offsets are fitted with every candidate. The noise is described by a smooth spectrum that is "
        "fitted to the residual of a model, so that the peaks of a structure's response are not mistaken "
        "for noise. Where the residual of the best model looks like noise, candidates are compared by "
        "their evidence, which counts against every further effect. Where it follows the motion, it is an "
        "error of the model: candidates are then compared by their error on tests that are left out one at "
        "a time, in the unit of the channel; a test counts as at most {most:.0f} observations. A further "
        "effect has a name if it explains more of the residual than it leaves, and stays in the model "
        "without one if it explains less. Held-out tests take no part in any fit; of models that explain "
        "the fitted tests they have the last word. The verdict is “named” if at most {share} of the energy "
        "of the gap remains in the kind of held-out test (sine, sweep, irregular motion) that is explained "
        "least."
    )
    described = prose(text, most=MOST_OF_A_TEST, share=percent(LARGEST_REMAINDER))
    blocks: list[Block] = [described]
    if remarks:
        blocks.append(Points(items=tuple(remarks)))
    return Section(title="How it was found, and what to know", blocks=tuple(blocks))


def location_section(diagnosis: Diagnosis) -> Section:
    """Show the block that fails, what its residuals vary with, and residuals over frequency and state."""
    loop = figures.draw_or_skip("the loop", partial(figures.block_figure, diagnosis))
    blocks: list[Block] = [*loop, _places(diagnosis)]
    for block_diagnosis in diagnosis.blocks:
        if block_diagnosis.findings:
            for content, draw in (
                ("residuals over frequency", figures.time_frequency_figure),
                ("residuals over the state plane", figures.state_plane_figure),
            ):
                blocks += figures.draw_or_skip(content, partial(draw, block_diagnosis))
    return Section(title=_WHERE, blocks=tuple(blocks))


def findings_in_words(diagnosis: Diagnosis) -> tuple[Block, ...]:
    """Give what the report says without its figures, for a terminal."""
    return (
        Section(title=_WHERE, blocks=(_places(diagnosis),)),
        missing_effects_section(diagnosis, {}),
        Section(title=_PROOF, blocks=_proof(diagnosis)),
        Points(items=tuple(diagnosis.remarks)),
    )


def _places(diagnosis: Diagnosis) -> Table | Prose:
    if diagnosis.where:
        rows = [
            {
                **finding.to_dict(),
                "block": str(finding.block),
                "p": finding.chance,
                "band": " to ".join(map(significant, finding.band_hz)),
                "time": " to ".join(map(significant, finding.time_s)),
                "begin": finding.begin,
            }
            for finding in diagnosis.where
        ]
        columns = (
            Column(key="block", heading="Block"),
            Column(key="kind", heading="Varies with"),
            Column(key="test", heading="Most in"),
            Column(
                key="share_of_residual", heading="Share", unit="%", number=Fixed(decimals=0, factor=100.0)
            ),
            Column(key="p", heading="p"),
            Column(key="band", heading="Frequency", unit="Hz"),
            Column(key="time", heading="Time", unit="s"),
            Column(key="begin", heading="Begins at"),
        )
        frame = pd.DataFrame(rows).assign(kind=lambda table: table["kind"].map(spell_out))
        caption = "What the residual of the calibrated model varies with; p is corrected for all trials."
        return Table(frame=frame, columns=columns, caption=caption, label="tab:where")
    noise = "The residual of the calibrated model does not differ from noise."
    open_question = (
        "The residual of the calibrated model varies with no quantity of the motion that was tried."
    )
    return noise if diagnosis.is_explained else open_question


def missing_effects_section(diagnosis: Diagnosis, sampled: Mapping[str, Posterior]) -> Section:
    """Name the effects that the model lacks.

    Returns parameters of the effects, their rivals, what no known effect explains, and the calibration.
    """
    effects = (*diagnosis.effects, *diagnosis.doubtful)
    blocks: list[Block] = []
    if effects:
        blocks.append(_parameters(diagnosis))
        blocks += [_sentence(effect) for effect in effects]
        blocks += _draw_posteriors(diagnosis, sampled) if sampled else ()
    blocks += [
        _unknown(block_diagnosis.unknown)
        for block_diagnosis in diagnosis.blocks
        if block_diagnosis.unknown is not None
    ]
    if any(block_diagnosis.calibration for block_diagnosis in diagnosis.blocks):
        blocks.append(_calibration(diagnosis))
    return Section(title="What is missing", blocks=tuple(blocks) or ("Nothing.",))


def _draw_posteriors(diagnosis: Diagnosis, sampled: Mapping[str, Posterior]) -> Iterator[Block]:
    for name, posterior in sampled.items():
        draw = partial(figures.posterior_figure, diagnosis, name, posterior)
        yield from figures.draw_or_skip("the posterior", draw)


def _parameters(diagnosis: Diagnosis) -> Table:
    """Tabulate the effects, each in one row with all its parameters."""
    rows = [
        {
            "effect": spell_out(effect.name),
            "probability": effect.probability,
            "parameters": effect.parameters,
        }
        for effect in diagnosis.all_effects
    ]
    columns = (
        Column(key="effect", heading="Effect"),
        Column(key="probability", heading="Probability", number=Fixed(decimals=3)),
        Column(key="parameters", heading="Parameters (90 % intervals)"),
    )
    return Table(
        frame=pd.DataFrame(rows),
        columns=columns,
        caption="Effects with the most probable values of their parameters.",
    )


def _sentence(effect: MissingEffect) -> Prose:
    name, description = spell_out(effect.name), effect.description
    listed = "; ".join(
        f"{spell_out(rival.name)} (probability {probability(rival.probability)}, error "
        f"{write_share_of_signal(rival.held_out_nrmse)})"
        for rival in effect.rivals
    )
    alternatives = f"Alternatives, with their errors on held-out tests: {listed}."
    others = alternatives if listed else "No alternative remains."
    shown = "" if effect.changes_held_out else " These hardly show it; the fitted ones do."
    return prose(
        "*{name}*{position}: {description}. With it {after} of the signal remains on held-out tests, without "
        "it {before}.{shown} {others}",
        shown=shown,
        name=name,
        position=f" ({effect.effect.position})" if effect.effect.position else "",
        description=description,
        after=write_share_of_signal(effect.error_with),
        before=write_share_of_signal(effect.error_without),
        others=others,
    )


def _unknown(unknown: Unknown) -> Prose:
    text = "In the {block}: {description}. "
    if unknown.expression:
        text += (
            "An expression for it is {expression}; with it {error} of the signal remains on held-out tests."
        )
    else:
        text += "It is {error} of the signal on held-out tests."
    return prose(
        text,
        block=unknown.block,
        description=unknown.description,
        expression=unknown.formula or unknown.expression,
        error=write_share_of_signal(unknown.held_out_nrmse),
    )


def _calibration(diagnosis: Diagnosis) -> Table:
    rows = [
        (str(block_diagnosis.block.block), e.meaning, e.size)
        for block_diagnosis in diagnosis.blocks
        for e in block_diagnosis.calibration
    ]
    columns = (
        Column(key="block", heading="Block"),
        Column(key="parameter", heading="Calibrated"),
        Column(key="value", heading="Value (90 % interval)"),
    )
    return Table(
        frame=pd.DataFrame(rows, columns=[column.key for column in columns]),
        columns=columns,
        caption="Parameters of the model that were calibrated together with the effects.",
    )


def proof_section(diagnosis: Diagnosis) -> Section:
    """Show how much of the gap between model and measurement closes on held-out tests."""
    gap = figures.draw_or_skip("the gap", partial(figures.gap_figure, diagnosis))
    blocks: list[Block] = [*_proof(diagnosis), *gap]
    for block_diagnosis in diagnosis.blocks:
        if block_diagnosis.gap.missing:
            draw = partial(figures.histories_figure, block_diagnosis)
            blocks += figures.draw_or_skip("histories and loops", draw)
    return Section(title=_PROOF, blocks=tuple(blocks))


def _proof(diagnosis: Diagnosis) -> tuple[Block, ...]:
    floors = (describe_remainder(block_diagnosis) for block_diagnosis in diagnosis.blocks)
    return *floors, _errors(diagnosis), *_candidates(diagnosis)


def _errors(diagnosis: Diagnosis) -> Table:
    """Tabulate the errors on held-out tests, of several the least explained first."""
    rows = [
        {
            "block": str(block_diagnosis.block.block),
            "channel": block_diagnosis.gap.channel,
            "tests": describe_held_out(block_diagnosis.block.tests, files),
            **errors,
        }
        for block_diagnosis in diagnosis.blocks
        for files, errors in _errors_on(block_diagnosis.gap)
    ]
    columns = (
        Column(key="block", heading="Block"),
        Column(key="channel", heading="Channel"),
        Column(key="tests", heading="Held out"),
        Column(key="kind", heading="Motion"),
        Column(key="before", heading="Before", unit="%", number=SIZE),
        Column(key="after", heading="After", unit="%", number=SIZE),
        Column(key="noise", heading="Noise", unit="%", number=SIZE),
        Column(key="left", heading="Unexplained", unit="%", number=_SHARE),
    )
    caption = (
        "Difference between model and measurement on held-out tests, RMS over that of the signal. "
        "Unexplained is the share of the gap's energy that remains; – if nothing is missing."
    )
    return Table(frame=pd.DataFrame(rows), columns=columns, caption=caption)


def _errors_on(gap: Gap) -> Iterator[tuple[Sequence[str], dict[str, object]]]:
    """Files and errors of all held-out tests together, and of each of several by itself."""
    by_test = gap.by_test
    is_one, kinds = len(by_test) == 1, " and ".join(dict.fromkeys(test.kind for test in gap.tests))
    left = by_test[0].unexplained_share if is_one else gap.unexplained_share
    yield gap.held_out, _sizes(gap, kinds, gap.floor, left)
    for one in () if is_one else by_test:
        yield one.files, _sizes(one, one.kind, one.noise or None, one.unexplained_share)


def _sizes(gap: Gap | GapOfKind, kind: str, noise: float | None, left: float | None) -> dict[str, object]:
    return {
        "kind": kind,
        "before": gap.before,
        "after": gap.after,
        "noise": np.nan if noise is None else noise,
        "left": np.nan if left is None else left,
    }


def _candidates(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """Tabulate the models that were tried, the believed one marked."""
    rows = [
        {
            "block": str(block_diagnosis.block.block),
            "model": " + ".join(map(spell_out, row.names)) or "calibration alone",
            "believed": "yes" if row.fit is block_diagnosis.best else "",
            "left_out": row.left_out,
            "held_out": row.held_out,
        }
        for block_diagnosis in diagnosis.blocks
        if len(block_diagnosis.candidates) > 1
        for row in block_diagnosis.main_candidates
    ]
    columns = (
        Column(key="block", heading="Block"),
        Column(key="model", heading="Model"),
        Column(key="believed", heading="Believed"),
        Column(key="left_out", heading="Left-out parts", unit="%", number=SIZE),
        Column(key="held_out", heading="Held out", unit="%", number=SIZE),
    )
    caption = (
        "Models that were tried, with their errors on parts of the fitted tests that were left out one at a "
        "time, and on held-out tests, RMS over that of the signal. All models are in diagnosis.json."
    )
    return (Table(frame=pd.DataFrame(rows), columns=columns, caption=caption),) if rows else ()
