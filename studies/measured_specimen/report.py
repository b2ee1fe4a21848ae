"""Report of how well a specimen is learned from its own force."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.core.significant_digits import counted, percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Block, Column, Document, Figure as RpFigure, Section, Table, provenance_of
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose
from reliab.report.style import GREY, apply_style, legend_below, line, name_axes, panels, plain

from .judging import ALL, compare_with_stated

_SHARE = Fixed(decimals=0, factor=PERCENT)
_SMALL_SHARE = Fixed(decimals=1, factor=PERCENT)


def report_measured_specimen(
    *,
    title: str,
    tests: pd.DataFrame,
    rates: pd.DataFrame,
    threshold: float,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report errors of tests whose specimen is known by its force only.

    `threshold`: error up to which a test is good [-].
    """
    overall = rates[rates["family"] == ALL].iloc[0]
    return Document(
        kind="Specimens known by their force",
        title=title,
        verdict=prose(
            "Of {tests} the computed error lies within 10 % of the true one in {near}, and within 25 % "
            "in {wide}; the 90 % interval holds it in {held}.",
            tests=counted(int(overall["tests"]), "test"),
            near=percent(float(overall["near"]), decimals=0),
            wide=percent(float(overall["wide"]), decimals=0),
            held=percent(float(overall["held"]), decimals=0),
        ),
        facts={
            "Families": str(len(rates) - 1),
            "Tests of each": " to ".join(
                str(int(n)) for n in sorted({rates["tests"].iloc[:-1].min(), rates["tests"].iloc[:-1].max()})
            ),
            "Good test": f"error of at most {percent(threshold)} RMS",
            "Purpose": purpose,
        },
        blocks=(
            _method(),
            _errors(tests, rates),
            _verdicts(rates),
            _report_corrections(rates),
            *_linear(tests),
        ),
        provenance=provenance_of(provenance),
    )


def _method() -> Section:
    text = prose(
        "Structures of 0.5 to 2 Hz with 2 to 5 % damping, of whose stiffness the specimen bears 20 to 100 % "
        "before it yields; actuators with a gain, a lag, a delay and in some tests play; white noise on "
        "displacement and force; 40 s at 1024 Hz. Everything that is stated is exact, and the peak of the "
        "linear response is 1.5 to 5 yield displacements. The specimens share no code with the elements "
        "that learn them. Where the interval is called a 90 % interval, it is meant for such tests: the "
        "scatter that stands for what a representation misses was settled on other tests of these families."
    )
    return Section(title="What is simulated", blocks=(text,))


def _errors(tests: pd.DataFrame, rates: pd.DataFrame) -> Section:
    judged = tests.dropna(subset=["value"])
    blocks: tuple[Block, ...] = (
        RpFigure(
            drawing=ratios_by_family(judged),
            caption="Computed over true error of each test, with its 90 % interval: look far from 1.",
            label="fig:ratios",
            leads=True,
        ),
        Table(
            frame=rates,
            columns=(
                Column(key="family", heading="Specimen", wide=True),
                Column(key="tests", heading="Tests", number=Fixed(decimals=0)),
                Column(key="near", heading="10 %", unit="%", number=_SHARE, group="within"),
                Column(key="wide", heading="25 %", unit="%", number=_SHARE, group="within"),
                Column(key="held", heading="Interval holds", unit="%", number=_SHARE),
            ),
            caption="Tests whose computed error comes near the true one, and whose interval holds it.",
            label="tab:errors",
        ),
    )
    return Section(title="Computed and true errors", blocks=blocks)


def _verdicts(rates: pd.DataFrame) -> Section:
    columns = (
        Column(key="family", heading="Specimen", wide=True),
        Column(key="bad", heading="Bad tests", number=Fixed(decimals=0)),
        Column(key="false_safe", heading="Bad and accepted", unit="%", number=_SMALL_SHARE),
        Column(key="accepted", heading="accepted", unit="%", number=_SHARE, group="good tests"),
        Column(key="refused_good", heading="refused", unit="%", number=_SHARE, group="good tests"),
        Column(key="undecided", heading="Undecided", unit="%", number=_SHARE),
    )
    caption = "Verdicts: accepted bad tests and undecided ones among all, the others among good tests."
    return Section(
        title="Verdicts",
        blocks=(Table(frame=rates, columns=columns, caption=caption, label="tab:verdicts"),),
    )


def _report_corrections(rates: pd.DataFrame) -> Section:
    columns = (
        Column(key="family", heading="Specimen", wide=True),
        Column(key="left", heading="Error that is left", unit="%", number=_SHARE),
        Column(key="inside", heading="Samples in the band", unit="%", number=_SHARE),
    )
    caption = (
        "RMS error of the corrected response over that of the measured one, median of the tests, and samples "
        "of the exact response within the 90 % band."
    )
    return Section(
        title="The corrected response",
        blocks=(Table(frame=rates, columns=columns, caption=caption, label="tab:corrected"),),
    )


def _linear(tests: pd.DataFrame) -> tuple[Section, ...]:
    """Say what tests of linear specimens lose; nothing where none was judged."""
    lost = compare_with_stated(tests)
    if not lost:
        return ()
    number = int(lost["tests"])
    text: Prose = prose(
        "{tests} judged as if the specimen were stated as linear, too: {agree} of the verdicts are the same, "
        "{opposed} opposite ones; the interval of the error is {width:.2f} times as wide in the median, and "
        "{widest:.2f} times or more in 5 %.",
        tests="One test of a linear specimen was"
        if number == 1
        else f"{number} tests of linear specimens were",
        agree=percent(lost["agree"], decimals=0),
        opposed=percent(lost["opposed"], decimals=0),
        width=lost["width"],
        widest=lost["widest"],
    )
    return (Section(title="What a linear specimen loses", blocks=(text,)),)


_HEIGHT = 122.0
_LEAST, _MOST = 0.3, 3.0
_SPREAD = 0.7  # between marks of the tests of a family
_BESIDE = 0.13  # between marks of tests with less and with more noise


@apply_style
def ratios_by_family(tests: pd.DataFrame) -> Figure:
    """Draw the computed error over the true one with its interval, one mark a test.

    `tests`: columns `family`, `decibels`, `true`, `value`, `low` and `high`, one row a test. Result: ratios
    [-] on a logarithmic scale, the band of 10 % shaded; what lies outside is drawn at the edge.
    """
    figure, axes = panels(height=_HEIGHT)
    place = axes[0, 0]
    families = list(dict.fromkeys(tests["family"]))
    place.axvspan(0.9, 1.1, color=GREY, alpha=0.15, linewidth=0.0)
    for rank, (decibels, rows) in enumerate(tests.groupby(tests["decibels"].astype(int), sort=False)):
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none", "markersize": 3.0}
        of_family = rows.groupby("family")
        number = of_family.cumcount() / of_family["family"].transform("size")
        height = rows["family"].map(families.index) + _SPREAD * (number - 0.5) + _BESIDE * rank
        ratio, low, high = (
            np.clip(rows[name] / rows["true"], _LEAST, _MOST) for name in ("value", "low", "high")
        )
        place.hlines(height, low, high, color=look["color"], linewidth=0.6)
        place.plot(ratio, height, label=plain(f"noise of {decibels} dB"), **look)
    ticks = [0.3, 0.5, 0.75, 1.0, 1.25, 2.0, 3.0]
    place.set(xscale="log", xlim=(_LEAST, _MOST), ylim=(len(families) - 0.4, -0.6))
    place.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    place.minorticks_off()
    place.set_yticks(range(len(families)), [plain(name) for name in families])
    name_axes(place, "Computed over true error [-]", "")
    legend_below(figure, place, columns=2)
    return figure
