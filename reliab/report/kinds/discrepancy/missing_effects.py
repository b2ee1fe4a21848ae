"""What is missing from the model: effects, their parameters, and what no known effect explains."""

from collections.abc import Mapping
from functools import partial

import numpy as np
import pandas as pd

from reliab.discrepancy.adding import Posterior
from reliab.discrepancy.result import Diagnosis, MissingEffect, Unknown
from reliab.report.document import Block, Column, Paragraph, Section, Table
from reliab.report.kinds.discrepancy.figures import drawn, posterior_figure
from reliab.report.numbers import Fixed, Significant
from reliab.report.prose import Prose, prose
from reliab.report.wording import percent, spelled_out
from reliab.significant import significant


def missing_effects_section(diagnosis: Diagnosis, sampled: Mapping[str, Posterior]) -> Section:
    """Name the effects that the model lacks.

    Returns parameters of the effects, their rivals, what no known effect explains, and the calibration.
    """
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
                        "effect": spelled_out(effect.name),
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


def _sentence(effect: MissingEffect) -> Prose:
    name, description = spelled_out(effect.name), effect.effect.description
    listed = "; ".join(
        f"{spelled_out(rival.name)} (probability {significant(rival.probability, 2)}, error "
        f"{significant(rival.held_out_nrmse)})"
        for rival in effect.rivals
    )
    alternatives = f"Alternatives, with their errors on held-out tests: {listed}."
    others = alternatives if listed else "No alternative remains."
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
    return Table(
        frame=pd.DataFrame(rows),
        columns=columns,
        caption="Parameters of the model that were calibrated together with the effects.",
    )
