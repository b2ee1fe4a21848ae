"""How a diagnosis shows itself: a table for notebooks, and the gap before and after the effects."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Verdict
from reliab.discrepancy.result.gap import Gap
from reliab.discrepancy.result.missing_effect import MissingEffect
from reliab.html_table import html_table
from reliab.significant import significant
from reliab.vocabulary import PERCENT

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def table_of_diagnosis(
    name: str, verdict: Verdict, effects: Iterable[MissingEffect], gap: Gap, remarks: Iterable[str]
) -> str:
    """Write the verdict on a campaign, the effects with their parameters, and the gap as a table in HTML."""
    described = {
        effect.name: "; ".join(
            [
                f"probability {significant(effect.probability)}",
                *(
                    f"{estimate.name} {estimate.value:.4g} ± {significant(estimate.sd, 1)} "
                    f"{estimate.units}".strip()
                    for estimate in effect.estimates
                ),
            ]
        )
        for effect in effects
    }
    rows = {
        "verdict": str(verdict).replace("_", " "),
        **described,
        f"error on held-out tests, {gap.channel}": f"{significant(gap.before)} before, "
        f"{significant(gap.after)} after",
    }
    return html_table(name, rows, remarks)


def draw_gap(name: str, blocks: Sequence[BlockDiagnosis], axes: "Axes | None" = None) -> "Axes":
    """Draw the error of the model on held-out tests before and after the effects are added."""
    from matplotlib import pyplot as plt
    from matplotlib.ticker import LogLocator

    shown = plt.subplots(figsize=(6.0, 3.0))[1] if axes is None else axes
    names = [f"{block.block.block}: {block.gap.channel}" for block in blocks]
    for shift, label in ((-0.2, "before"), (0.2, "after")):
        shares = [PERCENT * float(getattr(block.gap, label)) for block in blocks]
        shown.bar([place + shift for place in range(len(names))], shares, width=0.4, label=label)
    shown.set_xticks(range(len(names)), names)
    shown.set(ylabel="error [% of RMS]", yscale="log", title=name)
    shown.yaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    shown.yaxis.set_major_formatter("{x:g}")
    shown.yaxis.set_minor_formatter("{x:g}")
    shown.legend(frameon=False)
    return shown
