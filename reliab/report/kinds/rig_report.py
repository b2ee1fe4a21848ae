"""Report of a rig: what it did, what to expect of its next test, and an appendix of diagnostics."""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from reliab.assessment.verdict import probability_text
from reliab.core.arrays import Array
from reliab.core.significant_digits import counted, percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Block, Document, Figure, Points, Section, Table, provenance_of, text_table
from reliab.report.numbers import Significant, write_in_line
from reliab.report.prose import Prose, prose
from reliab.report.style import BLUE, GREY, INK, PALE, VERMILION, apply_style, legend_below, letters, panels
from reliab.rig.prediction import Prediction
from reliab.rig.rig_folder import RigTable
from reliab.rig.watching import FALSE_ALARMS, DriftChart, drift_chart, read_effects, watch
from reliab.structures.structure import Structure

_LAST = 10
_DAY = 10  # characters of a date
_MOST_CHANGES = 8
_QUANTITIES = {
    "A": "Amplitude A",
    "d_ms": "Equivalent delay d [ms]",
    "remainder": "Remainder, neither gain nor delay [%]",
    "rms": "RMS error of the whole test [%]",
    "ratio": "Logarithm of the error relative to that from A, d and remainder",
}
_PERCENT_COLUMNS = ("remainder", "rms")


def rig_report(
    name: str,
    table: RigTable,
    prediction: Prediction,
    *,
    structure: Structure | None,
    provenance: Mapping[str, object],
) -> Document:
    """Report what a rig does and what to expect of its next test.

    `structure` is None if the last test was of a frame.
    """
    chart = drift_chart(table.rows)
    return Document(
        kind="Report of a rig",
        title=name,
        verdict=_verdict(table, prediction),
        facts=_facts(table, prediction, structure),
        blocks=(
            Section(title="What the rig does", blocks=_behaviour_blocks(table, chart, prediction)),
            Section(title="What to expect of the next test", blocks=next_test_blocks(prediction)),
            Section(title="Appendix: diagnostics", blocks=diagnostics_blocks(prediction)),
        ),
        provenance=provenance_of(provenance),
        sheet=True,
    )


def _verdict(table: RigTable, prediction: Prediction) -> Prose:
    good = sum(bool(row["reliable"]) for row in table.rows)
    share = good / len(table)
    return prose(
        "*{good} of {tests} tests were judged reliable* ({share}): their error was below the threshold "
        "with at least 95 % probability. The next test, under a motion like those of the rig's tests, keeps "
        "its error below {threshold} with probability {probability}{doubt}.",
        good=good,
        tests=len(table),
        share=percent(share),
        threshold=percent(prediction.threshold),
        probability=probability_text(prediction.probability),
        doubt="" if prediction.has_converged else ", which is not to be relied on, as the notes say",
    )


def _facts(table: RigTable, prediction: Prediction, structure: Structure | None) -> dict[str, Prose]:
    days = [day[:_DAY] for day in table.moments]
    sample = f"{counted(prediction.tests, 'test')} of {counted(prediction.earthquakes, 'earthquake')}"
    facts: dict[str, Prose] = {
        "Tests": f"{len(table)}, from {days[0]} to {days[-1]}",
        "Learned from": sample + ("" if table.has_dates else "; dates are not stated for all tests"),
    }
    if structure is not None:
        facts["Next test"] = prose(
            "$f =$ {f:g} Hz, $xi =$ {xi:g}, share of the stiffness in the laboratory $alpha =$ {alpha:g}",
            f=structure.frequency,
            xi=structure.damping_ratio,
            alpha=structure.experimental_fraction,
        )
    if table.faults:
        facts["Left out"] = f"{counted(len(table.faults), 'file')} that could not be read"
    return facts


def _behaviour_blocks(
    table: RigTable, chart: DriftChart, prediction: Prediction
) -> tuple[Table | Points | Figure, ...]:
    rows = []
    for name in ("A", "d_ms", "remainder", "rms"):
        values = table.numbers(name)
        values = values[np.isfinite(values)]
        ends = (*np.quantile(values, [0.05, 0.5, 0.95]), np.median(values[-_LAST:]))
        rows.append((_QUANTITIES[name], *(_write_value(name, float(value)) for value in ends)))
    summary = text_table(
        rows,
        ("Quantity", "5 %", "Median", "95 %", f"Median of the last {min(_LAST, len(table))}"),
        caption="Past tests: 5 %, median and 95 % of what they showed.",
        label="tab:tests",
    )
    figure = Figure(
        drawing=rig_over_time(table, chart, prediction.intervals, prediction.threshold),
        caption=(
            "Look for tests outside of the grey band, the 90 % interval predicted from the tests before. The "
            "prediction begins anew after a change. At the right end: the next test. Broken lines: a "
            "change was noticed; dotted: the next tests did not confirm it."
        ),
        label="fig:time",
    )
    return summary, Points(items=_list_noticed_changes(table, chart)), figure


def _list_noticed_changes(table: RigTable, chart: DriftChart) -> tuple[Prose, ...]:
    latest = chart.changes[-_MOST_CHANGES:]
    if not latest:
        return ("No change of gain, delay or noise was noticed.",)
    remaining_count = len(chart.changes) - len(latest)
    words = "; ".join(
        f"{change}, from test {change.began + 1} on (noticed at test {change.noticed + 1}, "
        f"{table.moments[change.noticed][:_DAY]})"
        for change in latest
    )
    return (f"Noticed: {words}{f'; and {remaining_count} before' if remaining_count else ''}.",)


def _write_value(name: str, value: float) -> str:
    if name in _PERCENT_COLUMNS:
        return f"{PERCENT * value:.2f}"
    return f"{value:.4f}" if name == "A" else f"{value:.2f}"


def next_test_blocks(prediction: Prediction) -> tuple[Block, ...]:
    """Tabulate what the next test will be, and say from what its error comes."""
    rows = [
        (_QUANTITIES[name], *(_write_value(name, interval[end]) for end in ("low", "median", "high")))
        for name, interval in prediction.intervals.items()
    ]
    intervals = text_table(
        rows,
        ("Quantity", "5 %", "Median", "95 %"),
        caption="The next test: nine of ten such tests lie between the 5 % and the 95 % column.",
        label="tab:next",
    )
    first = max(prediction.drivers, key=lambda name: prediction.drivers[name])
    kind = "errors that are neither gain nor delay, " if first == "remainder" else ""
    shares = ", ".join(f"{percent(share, 2)} from {name}" for name, share in prediction.drivers.items())
    says = (
        f"Most of the error comes from {kind}the {first}: of its square, {shares}. "
        f"The prediction follows from {prediction.basis}."
    )
    notes = (Points(items=prediction.notes),) if prediction.notes else ()
    return intervals, says, *notes


def diagnostics_blocks(prediction: Prediction) -> tuple[Block, ...]:
    """Tabulate whether a prediction can be relied on."""
    rows = []
    for name, quantity in prediction.fits.items():
        baselines = quantity.scores_of_baselines.values()
        scores = [_score(value) for value in (quantity.log_score, *baselines)]
        variances = quantity.variances
        rows.append((_QUANTITIES[name], f"{variances.r_hat:.3f}", f"{variances.effective_size:.0f}", *scores))
    names = [name for name in prediction.log_scores if name != "hierarchical model"]
    total = [_score(value) for value in prediction.log_scores.values()]
    rows.append(("Sum", "", "", *total))
    table = text_table(
        rows,
        ("Quantity", "R-hat", "Effective draws", "Score of the model", *(f"Of {name}" for name in names)),
        caption=(
            "Draws of the variances between earthquakes, days, specimens, over time: R-hat is near 1 if "
            "they converged. Mean log scores of tests whose earthquake was left out: higher is better."
        ),
        label="tab:diagnostics",
    )
    alarms = percent(FALSE_ALARMS)
    best = f"Best on left-out earthquakes: {prediction.better}. The hierarchical model makes the predictions."
    noticing = (
        f"Changes are noticed by cumulative sums of each test against its prediction, with at most {alarms} "
        "of false alarms a test in simulated rigs. After five further tests, each change is stated as "
        "confirmed or not confirmed."
    )
    return table, Points(items=(best, noticing))


def _score(value: float | None) -> str:
    return "unknown" if value is None else write_in_line(Significant()(value))


_HEIGHT: Final = 136.0
_AHEAD: Final = 0.035  # of the number of tests, by which the next one stands to the right


@apply_style
def rig_over_time(
    table: RigTable, chart: DriftChart, coming: Mapping[str, Mapping[str, float]], threshold: float
) -> Drawing:
    """Draw each test with its prediction from those before, what was noticed to change, and the next test."""
    figure, axes = panels(4, 1, height=_HEIGHT, share_x=True)
    letters(axes, ("Amplitude", "Equivalent delay", "Remainder", "Error of the whole test"))
    errors = table.numbers("rms")
    is_known = np.isfinite(errors)
    logarithms = np.log(np.maximum(np.where(is_known, errors, np.nanmedian(errors)), 1e-12))
    error_band = _band(logarithms, read_effects(table.rows), chart.segments)
    series: tuple[tuple[str, Array, tuple[Array, Array], str], ...] = (
        ("A", chart.values["gain"], chart.bands["gain"], "$A$ [-]"),
        ("d_ms", chart.values["delay"], chart.bands["delay"], "$d$ [ms]"),
        ("remainder", *_percent(chart.values["noise"], chart.bands["noise"]), "[% of RMS]"),
        ("rms", *_percent(np.where(is_known, logarithms, np.nan), error_band), "$RMS^R$ [%]"),
    )
    good = np.array([bool(row["reliable"]) for row in table.rows], dtype=np.bool_)
    for place, (name, values, band, label) in zip(axes[:, 0], series, strict=True):
        factor = PERCENT if name in ("remainder", "rms") else 1.0
        _draw(place, values, band, good)
        _draw_next(place, {end: factor * value for end, value in coming[name].items()}, values.size)
        _draw_changes(place, chart)
        place.set_ylabel(label)
        low, high = np.nanquantile(values, [0.01, 0.99])
        reach = max(high - low, 1e-3 * abs(high))
        bottom = min(low - 0.4 * reach, factor * coming[name]["low"])
        place.set_ylim(max(bottom, 0.0) if factor != 1.0 else bottom, high + 0.6 * reach)
    axes[-1, 0].axhline(
        PERCENT * threshold, color=VERMILION, linewidth=1.1, linestyle=(0, (1, 2)), label="threshold"
    )
    axes[-1, 0].set_ylim(top=max(axes[-1, 0].get_ylim()[1], 1.1 * PERCENT * threshold))
    axes[-1, 0].set_xlabel("Test, in the order of their dates")
    legend_below(figure, *axes[:, 0], columns=3)
    return figure


def _band(values: Array, effects: Array, segments: Array) -> tuple[Array, Array]:
    """Predict each test from those before it since the last change of the rig."""
    low, high = np.full(values.size, np.nan), np.full(values.size, np.nan)
    for segment in np.unique(segments):
        places = segments == segment
        low[places], high[places] = watch(values[places], effects[places], math.inf).band
    return low, high


def _percent(logarithms: Array, band: tuple[Array, Array]) -> tuple[Array, tuple[Array, Array]]:
    low, high = (PERCENT * np.exp(np.clip(end, -30.0, 30.0)) for end in band)
    return PERCENT * np.exp(logarithms), (low, high)


def _draw(axes: Axes, values: Array, band: tuple[Array, Array], good: NDArray[np.bool_]) -> None:
    numbers = np.arange(1, values.size + 1)
    axes.fill_between(numbers, *band, color=PALE, linewidth=0.0, label="90 % interval from the tests before")
    axes.plot(numbers[good], values[good], "o", color=BLUE, markersize=2.6, label="reliable test")
    axes.plot(numbers[~good], values[~good], "x", color=INK, markersize=3.6, label="other test")


def _draw_next(axes: Axes, interval: Mapping[str, float], count: int) -> None:
    position = count + max(1.0, _AHEAD * count)
    axes.vlines(
        position, interval["low"], interval["high"], color=BLUE, linewidth=2.2, label="next test, 90 %"
    )
    axes.plot([position], [interval["median"]], "s", color=BLUE, markersize=4.0)


def _draw_changes(axes: Axes, chart: DriftChart) -> None:
    for change in chart.changes:
        axes.axvline(
            change.noticed + 1,
            color=VERMILION if change.confirmed else GREY,
            linewidth=0.9,
            linestyle=(0, (5, 1.6)) if change.confirmed else (0, (1, 1.6)),
            label="change noticed" if change.confirmed else "not confirmed by the next tests",
        )
