"""Where the model fails: what the residuals of the calibrated model vary with."""

from functools import partial

import pandas as pd

from reliab.discrepancy.result import Diagnosis
from reliab.report.document import Block, Column, Paragraph, Points, Section, Table
from reliab.report.kinds.discrepancy.figures import (
    block_figure,
    drawn,
    state_plane_figure,
    time_frequency_figure,
)
from reliab.report.numbers import Fixed, Significant
from reliab.report.wording import spelled_out


def location_section(diagnosis: Diagnosis) -> Section:
    """Show the block that fails, and what its residuals vary with.

    Returns the loop, the findings as a list and as a table, residuals over frequency and state.
    """
    blocks: list[Block] = [*drawn("the loop", partial(block_figure, diagnosis))]
    if diagnosis.where:
        blocks.append(Points(items=tuple(dict.fromkeys(finding.detail for finding in diagnosis.where))))
        rows = [{**finding.to_dict(), "block": str(finding.block)} for finding in diagnosis.where]
        columns = (
            Column(key="block", heading="Block"),
            Column(key="kind", heading="Varies with"),
            Column(key="test", heading="Most in"),
            Column(
                key="share_of_residual", heading="Share", unit="%", number=Fixed(decimals=0, factor=100.0)
            ),
            Column(key="p_value", heading="p", number=Significant(digits=2)),
        )
        frame = pd.DataFrame(rows).assign(kind=lambda table: table["kind"].map(spelled_out))
        caption = "What the residual of the calibrated model varies with; p is corrected for all trials."
        blocks.append(Table(frame=frame, columns=columns, caption=caption, label="tab:where"))
    else:
        noise = "The residual of the calibrated model does not differ from noise."
        open_question = (
            "The residual of the calibrated model varies with no quantity of the motion that was tried."
        )
        blocks.append(Paragraph(text=noise if diagnosis.is_explained else open_question))
    for diagnosed in diagnosis.blocks:
        if diagnosed.findings:
            blocks += drawn("residuals over frequency", partial(time_frequency_figure, diagnosed))
            blocks += drawn("residuals over the state plane", partial(state_plane_figure, diagnosed))
    return Section(title="Where the model fails", blocks=tuple(blocks))
