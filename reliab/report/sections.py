"""Sections of reports: how results were computed, what limits their use, what criteria contain.

Figures draw a table of rates with the columns `candidate`, `confidence` (stated), `f` [Hz] (NaN over all
structures), `rate`, `low` and `high` (ends of a 95 % interval that respects the earthquakes), shares [-].
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import PERCENT, CurveName
from reliab.criterion.criterion import Criterion
from reliab.report.document import Block, Column, Equation, Figure, Points, Section, Table
from reliab.report.numbers import Fixed, Shortest
from reliab.report.prose import Prose, join_words, law_in_words, meaning_of_confidence, prose, window_in_words
from reliab.report.style import (
    FREQUENCY,
    GREY,
    INK,
    apply_style,
    legend_below,
    line,
    name_axes,
    panels,
    plain,
)
from reliab.validation.counts import CrossValidation, tabulate
from reliab.validation.yielding import HARDENING, read_yielding

_FITTED_ELLIPSE = (
    "an ellipse is fitted to it by least squares, as a straight line of d² over (A − 1)²; the boundary may "
    "run inside of it"
)
_INSCRIBED_ELLIPSE = "an ellipse is inscribed in it, so that all of the ellipse lies inside the boundary"
_WHOLE_IS_WORST = (
    "All stiffness stands in the laboratory ($alpha = 1$). Under 20 real motions, at 0.5 to 3 Hz and damping "
    "ratios of 1 to 10 %, no smaller share was more demanding; for a stiff and damped structure, of 15 Hz "
    "and 5 % for example, it may be."
)
_SHARE_IS_LARGEST = (
    "The share of the stiffness in the laboratory is {share}; the criterion does not hold for a larger one."
)


def method_section(criterion: Criterion | None, *, experimental_fraction: float, window: str) -> Section:
    """Explain the method of a criterion by the page `method.md`.

    `experimental_fraction` [-].
    """
    is_inscribed = criterion is not None and criterion.provenance.curve == CurveName.INSCRIBED
    values = {
        "alpha": experimental_fraction,
        "length": window_in_words(window),
        "ellipse": _INSCRIBED_ELLIPSE if is_inscribed else _FITTED_ELLIPSE,
        "share": percent(experimental_fraction),
    }
    if criterion is not None:
        values |= {
            "method": criterion.method,
            "together": "for both together" if criterion.joint else "for each of them separately",
            "meaning": meaning_of_confidence(criterion.method),
            "law": criterion.law.name,
            "equation": criterion.law.equation,
        }
    page = Path(__file__).with_name("method.md").read_text(encoding="utf-8")
    page = page.replace("{worst}", _WHOLE_IS_WORST if experimental_fraction == 1.0 else _SHARE_IS_LARGEST)
    sections = tuple(
        _read_section(text, values)
        for text in re.split(r"^# ", page, flags=re.MULTILINE)[1:]
        if criterion is not None or not text.startswith("What the confidence means")
    )
    return Section(title="Method and assumptions", blocks=sections, label="sec:method", appendix=True)


def _read_section(page: str, values: Mapping[str, object]) -> Section:
    """Read a section whose first line is its title, with the marks of `prose`.

    Blank lines part its blocks. One of lines that begin with "- " is a list; one after "$$" and a label an
    equation.
    """
    title, *texts = page.strip().split("\n\n")
    blocks: list[Block] = []
    for text in texts:
        if text.startswith("$$"):
            label, _, formula = text[2:].partition("\n")
            blocks.append(Equation(math=" ".join(formula.split()), label=label.strip()))
        elif text.startswith("- "):
            items = re.split(r"^- ", text, flags=re.MULTILINE)[1:]
            blocks.append(Points(items=tuple(prose(" ".join(item.split()), **values) for item in items)))
        else:
            blocks.append(prose(" ".join(text.split()), **values))
    return Section(title=title, blocks=tuple(blocks))


def limits_section(sentences: Sequence[Prose]) -> Section:
    """List what limits the use of the results."""
    always = (
        prose(
            "The structure has one degree of freedom and stays linear; other systems are not covered. "
            + _yielding()
        ),
        prose(
            "A criterion looks at $A$ and $d$ alone. An actuator whose gain and delay change during the "
            "test, friction, backlash or noise can cause errors that they do not show."
        ),
    )
    return Section(title="Limits", blocks=(Points(items=(*sentences, *always)),), label="sec:limits")


def _yielding() -> str:
    """Say what was measured on specimens that yield."""
    yielding_rates = read_yielding()
    shares = join_words(
        [
            f"{percent(measurement.exceeding, 2)} of {measurement.tests} tests at $R = "
            f"{measurement.reduction:g}$ (up to "
            f"{measurement.largest_ratio:.1f} times)"
            for measurement in yielding_rates
        ]
    )
    return (
        "A specimen that yields is not always less demanding: with an actuator at which the linear structure "
        f"just reaches the error, the error of an elastoplastic one ({percent(HARDENING)} hardening) is "
        "larger "
        f"in {shares}, $R$ being the peak of the linear response over the yield displacement, under "
        f"{yielding_rates[0].motions} real motions."
    )


_MEANINGS = {
    "containment": ("contained", "motions that contain the criterion"),
    "false_safe": (
        "accepted, yet bad",
        "tests that are accepted although their error is too large, of those accepted",
    ),
    "accepted_share": ("good, and accepted", "good tests that are accepted, of those good"),
}
"""Heading and meaning of each rate that reports show."""

MEASURES = tuple(_MEANINGS)
"""Rates that reports show."""


def rates_table(validation: CrossValidation) -> pd.DataFrame:
    """Tabulate what a cross-validation found, over all structures and by frequency.

    Returns columns `measure` ("containment", "false_safe" or "accepted_share"), `candidate`, `confidence`
    (stated), `f` [Hz] (NaN over all structures), `rate`, `low` and `high` [-].
    """
    columns = ["measure", "candidate", "confidence", "f", "rate", "low", "high"]
    parts = []
    for table in (tabulate(validation, dimensions) for dimensions in (("f", "xi"), ("xi",))):
        for measure in MEASURES:
            ends = {"rate": table[measure], "low": table[f"{measure}_low"], "high": table[f"{measure}_high"]}
            parts.append(table.assign(measure=measure, **ends).reindex(columns=columns))
    return pd.concat(parts, ignore_index=True).dropna(subset="rate").reset_index(drop=True)


def rates_section(
    rates: pd.DataFrame, *, confidence: float, division: str = "", leads: bool = False
) -> Section:
    """Show what criteria contain.

    `confidence` [-].
    Returns calibration curve, containment by frequency, and the rates as a table; labelled `sec:coverage`,
    followed by the division where there is one.
    """
    measured_rates = rates if "measure" in rates else rates.assign(measure="containment")
    measured_rates = measured_rates.assign(
        candidate=[law_in_words(str(name)) for name in measured_rates["candidate"]]
    )
    mark = "".join(f"-{word.lower()}" for word in re.findall(r"[A-Za-z0-9]+", division))
    division_phrase = "Whole earthquakes were held out in turn" if not division else f"Division: {division}"
    opening = prose(
        "{explained}; the criterion was derived from other earthquakes than those on which it was "
        "judged. A motion contains a criterion when the simulated error under it stays below the "
        "threshold along the whole edge of the criterion. Intervals resample earthquakes @davison1997.",
        explained=division_phrase,
    )
    containment = measured_rates[measured_rates["measure"] == "containment"]
    return Section(
        title=f"Put to the test: {division}" if division else "Put to the test on held-out earthquakes",
        blocks=(
            opening,
            *_figures(containment, confidence, mark, leads=leads),
            _table(measured_rates[measured_rates["f"].isna()], mark),
        ),
        label=f"sec:coverage{mark}",
    )


def _figures(containment: pd.DataFrame, confidence: float, mark: str, *, leads: bool) -> Iterator[Figure]:
    overall = containment[containment["f"].isna()]
    has_several = overall.groupby("candidate")["confidence"].transform("nunique") > 1
    yield Figure(
        drawing=calibration_curve(overall[has_several] if has_several.any() else overall),
        caption=prose(
            "A criterion keeps its promise for the motions of a study if its line follows the diagonal; "
            "below the diagonal it promises too much.{printed}",
            printed=" Printed laws state one confidence only and are listed in the table."
            if has_several.any() and not has_several.all()
            else "",
        ),
        label=f"fig:calibration{mark}",
        leads=leads,
    )
    confidences = containment["confidence"].to_numpy()
    nearest = float(confidences[np.argmin(np.abs(confidences - confidence))])
    nearest_rates = containment[containment["f"].notna() & np.isclose(containment["confidence"], nearest)]
    if nearest_rates["f"].unique().size > 1:
        yield Figure(
            drawing=coverage_by_frequency(nearest_rates, confidence=nearest),
            caption=prose(
                "Containment by natural frequency at a stated {share}: a point below the dotted line is "
                "unsafe at that frequency, as far as its interval lies below it. Criteria that are contained "
                "by far fewer motions than they state are drawn in separate axes.",
                share=percent(nearest),
            ),
            label=f"fig:by-frequency{mark}",
            floats=True,
        )


def _table(overall: pd.DataFrame, mark: str) -> Table:
    wide = overall.pivot_table(
        index=["candidate", "confidence"], columns="measure", values=["rate", "low", "high"], sort=False
    )
    wide.columns = pd.Index([" ".join(reversed(name)) for name in wide.columns.to_flat_index()])
    frame = wide.reset_index()
    share = Fixed(decimals=1, factor=PERCENT)
    measures = {name: texts for name, texts in _MEANINGS.items() if f"{name} rate" in frame}
    columns = [
        Column(key=f"{measure} {value}", heading=heading, unit="%", number=share, group=group)
        for measure, (group, _) in measures.items()
        for value, heading in (("rate", "share"), ("low", "from"), ("high", "to"))
        if f"{measure} {value}" in frame
    ]
    meanings = "; ".join(meaning for _, meaning in measures.values())
    return Table(
        frame=frame,
        columns=(
            Column(key="candidate", heading="Criterion"),
            Column(key="confidence", heading="Stated", unit="%", number=Shortest(factor=PERCENT)),
            *columns,
        ),
        caption=f"Rates over all structures with their 95 % intervals: {meanings}.",
        label=f"tab:rates{mark}",
    )


_HEIGHT = 76.0
_WIDTH = 102.0
_FREQUENCY_HEIGHT = 78.0
_SPLIT_HEIGHT = 92.0
_SHIFT = 0.006
_FAR = 0.8  # of what is stated; a criterion that contains less everywhere has axes of its own


@apply_style
def calibration_curve(rates: pd.DataFrame) -> Drawing:
    """Draw the observed share of motions that a criterion contains over the stated confidence.

    Returns [%].
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    least = PERCENT * min(rates["confidence"].min(), rates["low"].min())
    ends = (max(0.0, least - 3.0), 101.0)
    place.plot(ends, ends, color=GREY, linewidth=0.9, label="observed as stated")
    for rank, (name, curve) in enumerate(rates.groupby("candidate", sort=False)):
        _curve(place, PERCENT * curve[["confidence", "rate", "low", "high"]], str(name), rank)
    place.set(xlim=ends, ylim=ends, aspect="equal")
    name_axes(place, "Stated confidence [%]", "Observed containment [%]")
    legend_below(figure, place, columns=3)
    return figure


@apply_style
def coverage_by_frequency(rates: pd.DataFrame, *, confidence: float) -> Drawing:
    """Draw the observed containment over the natural frequency at one stated confidence.

    `confidence` [-].
    Returns observed containment [%] with intervals over the frequency [Hz]; criteria that fall far short of
    what is stated are drawn in separate axes, so that the others can be distinguished.
    """
    promise = PERCENT * confidence
    groups = list(rates.groupby("candidate", sort=False))
    far = {str(name) for name, curve in groups if curve["rate"].max() < _FAR * confidence}
    near = rates[~rates["candidate"].isin(far)]
    split = bool(far) and len(near) > 0
    figure, axes = (
        panels(2, height=_SPLIT_HEIGHT, share_x=True, heights=(2.2, 1.0))
        if split
        else panels(height=_FREQUENCY_HEIGHT)
    )
    for rank, (name, curve) in enumerate(groups):
        points = curve.sort_values("f")
        percent = PERCENT * points[["rate", "low", "high"]]
        frequencies = points["f"] * np.exp(_SHIFT * 2.0 * (rank - 0.5 * (len(groups) - 1)))
        row = 1 if split and str(name) in far else 0
        _curve(axes[row, 0], percent.assign(confidence=frequencies), str(name), rank)
    groups_of_axes = (near, rates[rates["candidate"].isin(far)]) if split else (rates,)
    for place, group_axes in zip(axes[:, 0], groups_of_axes, strict=True):
        _scale(place, group_axes, promise)
    axes[0, 0].axhline(
        promise, color=INK, linewidth=0.9, linestyle=(0, (1, 2)), label=f"stated {promise:g} %"
    )
    for place in axes[:, 0]:
        name_axes(place, FREQUENCY if place is axes[-1, 0] else "", "Contained [%]")
    legend_below(figure, axes[0, 0], *axes[1:, 0], columns=3)
    return figure


def _scale(axes: Axes, rates: pd.DataFrame, promise: float) -> None:
    """Spread what is drawn over the whole height; criteria that fall far short have axes of their own."""
    low, high = PERCENT * float(rates["low"].min()), PERCENT * float(rates["high"].max())
    margin = 0.06 * (max(high, promise) - low) if high > _FAR * promise else 0.06 * (high - low) + 1.0
    axes.set(xscale="log", ylim=(max(-margin, low - margin), min(high + margin, PERCENT + margin)))
    ticks = np.unique(rates["f"]).tolist()
    axes.set_xticks(ticks, [f"{frequency:g}" for frequency in ticks], minor=False)
    axes.set_xticks([], minor=True)


def _curve(axes: Axes, percent: pd.DataFrame, name: str, rank: int) -> None:
    x, rate = percent["confidence"].to_numpy(), percent["rate"].to_numpy()
    reach = np.stack([rate - percent["low"].to_numpy(), percent["high"].to_numpy() - rate])
    axes.errorbar(
        x,
        rate,
        yerr=np.maximum(reach, 0.0),
        label=plain(name),
        capsize=2.0,
        elinewidth=0.8,
        **line(rank, marker=True),
    )
