"""Measured against modelled channel of a held-out test: over time, and as loops over the input."""

from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.arrays import Array
from reliab.report.axes import legend_below, name_axes
from reliab.report.style import BLUE, INK, VERMILION, panels, styled

_HEIGHT = 62.0
_MOST_SAMPLES = 3000


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelledHistory:
    """A stretch of a held-out test, measured and modelled."""

    time: Array  # Time [s], shape (n,)
    driven: Array  # What drives the block, in the unit of `input_label`, shape (n,)
    # The channel as measured, by the calibrated model, and by the model with the effects
    measured: Array
    before: Array
    after: Array
    input_label: str  # input_label, label: Names of both quantities with their units
    label: str


@styled
def discrepancy_histories(shown: ModelledHistory) -> Figure:
    """Draw measured and modelled channel over time and as loops, before and after effects were added.

    Returns above each other the calibrated model and the model with the effects; left over time, right over
    what drives the block.
    """
    figure, axes = panels(2, 2, height=_HEIGHT, ratios=(1.7, 1.0))
    every = max(1, shown.time.size // _MOST_SAMPLES)
    cut = slice(None, None, every)
    for row, (values, colour, name) in enumerate(
        ((shown.before, VERMILION, "calibrated model"), (shown.after, BLUE, "with what was found"))
    ):
        _lines(axes[row, 0], shown.time[cut], shown.measured[cut], values[cut], colour, name)
        _lines(axes[row, 1], shown.driven[cut], shown.measured[cut], values[cut], colour, name)
        name_axes(axes[row, 0], "Time [s]" if row else "", "")
        name_axes(axes[row, 1], shown.input_label if row else "", "")
    figure.supylabel(shown.label, fontsize="medium")
    for place in axes[0]:
        place.tick_params(labelbottom=False)
    legend_below(figure, *axes[:, 0])
    return figure


def _lines(place: Axes, x: Array, measured: Array, modelled: Array, colour: str, name: str) -> None:
    place.plot(x, measured, color=INK, linewidth=1.0, label="measured")
    place.plot(x, modelled, color=colour, linewidth=0.8, linestyle=(0, (4, 1.5)), label=name)
