"""How a criterion shows itself: a table for notebooks, and its region in the plane of A and d."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from reliab.criterion.laws import Law
from reliab.criterion.provenance import Provenance
from reliab.html_table import html_table
from reliab.vocabulary import PERCENT, Side

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def table_of_criterion(promise: Mapping[str, str], law: Law, origin: Provenance) -> str:
    """Write what a criterion promises, by name, and where it comes from as a table in HTML."""
    rows = {
        **promise,
        "law": law.name,
        "natural frequency": _range(law.validity.frequency, "Hz"),
        "damping ratio": _range(law.validity.damping_ratio, ""),
        "motions": f"{origin.n_motions} of {origin.n_events} earthquakes",
        "window": origin.window,
    }
    return html_table("Criterion", rows, origin.warnings)


def _range(bounds: tuple[float, float], unit: str) -> str:
    low, high = bounds
    return f"{low:g} {unit}".strip() if low == high else f"{low:g} to {high:g} {unit}".strip()


def draw_region(limits: Mapping[Side, tuple[float, float]], axes: "Axes | None" = None) -> "Axes":
    """Draw the tolerable region of a structure.

    Lags and leads have an ellipse each, the largest inside the boundaries of its side. The boundaries of both
    sides meet on d = 0, their largest ellipses need not: the one for leads is a few per cent wider there. A
    test with d = 0 is judged as a lag.

    Returns with A − 1 [%] across and d [ms] upwards; a half of an ellipse for each side, with its limits
    beside its name.
    """
    from matplotlib import pyplot as plt

    shown = plt.subplots()[1] if axes is None else axes
    turn = np.linspace(0.0, np.pi, 181)
    for side, (a, b) in limits.items():
        name, sign = ("late", 1.0) if side is Side.LAG else ("early", -1.0)
        width, height = PERCENT * np.sqrt(a), np.sqrt(b)
        across, up = width * np.cos(turn), sign * height * np.sin(turn)
        shown.fill(across, up, alpha=0.2)
        shown.plot(across, up, label=f"{name}: up to {width:.2f} % or {height:.2f} ms")
    shown.axhline(0.0, color="0.5", linewidth=0.6)
    shown.set(xlabel="A − 1 [%]", ylabel="delay d [ms], negative for a lead")
    shown.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return shown
