"""The proof on held-out tests: how much of the gap closes, and what noise leaves."""

from functools import partial

import numpy as np
import pandas as pd

from reliab.discrepancy.result import BlockDiagnosis, Diagnosis, Remainder
from reliab.report.document import Block, Column, Paragraph, Section, Table
from reliab.report.kinds.discrepancy.figures import drawn, gap_figure, histories_figure
from reliab.report.numbers import Fixed, Significant
from reliab.report.prose import Prose, prose
from reliab.report.wording import percent


def proof_section(diagnosis: Diagnosis) -> Section:
    """Show how much of the gap between model and measurement closes on held-out tests."""
    rows = [
        {
            **diagnosed.gap.to_dict(),
            "closed": np.nan if diagnosed.gap.stated_share is None else diagnosed.gap.stated_share,
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
    match gap.remainder:
        case Remainder.AT_NOISE:
            text = "{channel}: what remains, {after} of the signal, is at the noise, {floor} by the {source}."
        case Remainder.ABOVE_NOISE:
            text = (
                "{channel}: judged by the {source}, {floor} of the signal is noise that no model explains. "
                "What remains above it, {left} of the signal, is an error of the model."
            )
        case Remainder.NOT_KNOWN if gap.floors:
            text = (
                "{channel}: how much of the error is noise is not known; the {others} seemed to show more "
                "noise than the model leaves. What remains is {after} of the signal."
            )
        case Remainder.NOT_KNOWN:
            text = (
                "{channel}: the recordings do not show how much of the error is noise (no repeated tests or "
                "cycles, no rest, no white band above the motion). What remains is {after} of the signal."
            )
    return prose(
        text,
        channel=gap.channel,
        after=percent(gap.after),
        floor="" if gap.floor is None else percent(gap.floor),
        source=gap.source or "",
        left=percent(gap.model_error),
        others=", ".join(gap.floors),
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
