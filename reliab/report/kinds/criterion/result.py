"""The criterion itself: limits at one structure and over all."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing

from reliab.report.document import Block, Column, Figure, Paragraph, Remark, Section, Table
from reliab.report.figures.criterion_surfaces import criterion_surfaces
from reliab.report.figures.ellipses_and_criterion import ellipses_and_criterion
from reliab.report.figures.parameters_over_structure import (
    ParameterSeries,
    parameters_over_damping_ratio,
    parameters_over_frequency,
)
from reliab.report.kinds.criterion.reported import ReportedCriteria
from reliab.report.numbers import Fixed, Scientific, Shortest, Significant
from reliab.report.prose import prose
from reliab.report.wording import ERROR_NAMES
from reliab.significant import percent, share_in_words
from reliab.vocabulary import PERCENT, Metric

_MOST_COLUMNS = 9

_MOST_ROWS = 12

_FINE = 41

_ALONE = "each alone, without the other error"

_UNCONVERGED = (
    "THE POSTERIOR HAS NOT CONVERGED. The limits of this report must not be relied on; sample longer and "
    "derive them again."
)


def result_section(reported: ReportedCriteria, population: str = "ground motions") -> Section:
    """State the criterion at one structure, then over all."""
    main_criterion = reported.criterion
    f, xi = reported.structure
    blocks: list[Block] = [
        Paragraph(
            text=prose(
                "Evaluate $A$ and $d$ from the command and measured displacements of the test (@eq:index). "
                "The test is reliable in the sense of this report while its point lies inside the ellipse of"
                " its structure (@tab:criteria, @fig:criterion). Each limit of the table holds alone: a test "
                "without amplitude error may use the whole of the delay, and the other way round; errors in "
                "both share the same budget."
            )
        ),
        _criteria_table(reported),
        Figure(
            drawing=ellipses_and_criterion(reported.sample, _named_limits(reported)),
            caption=prose(
                "Ellipses {how} the boundaries of all ground motions at {f:g} Hz and $xi = {xi:g}$ (grey; "
                "late actuators) and the criterion: where the coloured ellipse crosses a grey one, a test on "
                "its edge would exceed the error under that motion, as far as the ellipse represents "
                "the boundary.",
                how="inscribed in" if reported.inscribed else "fitted by least squares to",
                f=f,
                xi=xi,
            ),
            label="fig:criterion",
            leads=True,
        ),
        *_over_structures(reported),
    ]
    zero = _without_promise(reported)
    if zero:
        blocks.insert(1, Remark(text=zero))
    if any(criterion.provenance.settings.get("converged") is False for criterion in reported.criteria):
        blocks.insert(0, Remark(text=_UNCONVERGED))
    title = f"Criterion for {share_in_words(main_criterion.promise)} of {population} like those behind it"
    return Section(title=title, blocks=tuple(blocks), label="sec:result")


def _without_promise(reported: ReportedCriteria) -> str:
    """Say for which criteria the motions are too few."""
    few = [
        criterion
        for criterion in reported.criteria
        if not all(np.min(limit) > 0.0 for limit in reported.over_grid(criterion))
    ]
    if not few:
        return ""
    shares = ", ".join(sorted({percent(criterion.confidence) for criterion in few}))
    return (
        f"The motions are too few for the promise at {shares}; the limits are zero there and no test is "
        "accepted."
    )


def _criteria_table(reported: ReportedCriteria) -> Table:
    f, xi = reported.structure
    frame = _limits_of_criteria(reported)
    lead = Column(key="lead", heading=prose("early: $-d <=$"), unit="ms", number=Fixed(), group=_ALONE)
    early = (lead,) if frame["lead"].notna().any() else ()
    amplitude, delay = prose("$|A - 1| <= sqrt(a)$"), prose("late: $d <= sqrt(b)$")
    share = Fixed(factor=PERCENT)
    return Table(
        frame=frame,
        columns=(
            Column(key="metric", heading="Error"),
            Column(key="threshold", heading="Bound", unit="%", number=Shortest(factor=PERCENT)),
            Column(key="confidence", heading="Confidence", unit="%", number=Shortest(factor=PERCENT)),
            Column(key="a", heading=prose("$a$"), unit="-", number=Scientific()),
            Column(key="b", heading=prose("$b$"), unit="ms²", number=Significant()),
            Column(key="amplitude", heading=amplitude, unit="%", number=share, group=_ALONE),
            Column(key="delay", heading=delay, unit="ms", number=Fixed(), group=_ALONE),
            *early,
        ),
        caption=prose(
            "Limits of the ellipse at {f:g} Hz and $xi = {xi:g}$; the first line is the criterion of this "
            "report. Small errors and high confidences leave less room.",
            f=f,
            xi=xi,
        ),
        label="tab:criteria",
    )


def _limits_of_criteria(reported: ReportedCriteria) -> pd.DataFrame:
    """One row for each criterion: what it promises, and its limits at the structure."""
    rows = []
    for criterion in reported.criteria:
        a, b = (float(limit) for limit in criterion.limits(*reported.structure))
        rows.append(
            {
                "metric": ERROR_NAMES[Metric(criterion.metric)],
                "threshold": criterion.threshold,
                "confidence": criterion.promise,
                "a": a,
                "b": b,
                "amplitude": np.sqrt(a),
                "delay": np.sqrt(b),
                "lead": reported.lead(criterion),
            }
        )
    return pd.DataFrame(rows)


def _named_limits(reported: ReportedCriteria) -> dict[str, tuple[float, float]]:
    main_criterion = reported.criterion
    alike = [
        criterion
        for criterion in reported.criteria
        if (criterion.threshold, criterion.metric) == (main_criterion.threshold, main_criterion.metric)
    ]
    limits = {}
    for criterion in alike:
        a, b = (float(limit) for limit in criterion.limits(*reported.structure))
        if a > 0.0 and b > 0.0:
            limits[f"{share_in_words(criterion.promise)} of motions"] = (a, b)
    return limits


def _over_structures(reported: ReportedCriteria) -> Iterator[Block]:
    a, b = reported.over_grid(reported.criterion)
    several_f, several_xi = a.shape[0] > 1, a.shape[1] > 1
    if several_f and several_xi:
        yield from _over_both_properties(reported, PERCENT * np.sqrt(a), np.sqrt(b))
    elif several_f or several_xi:
        yield _over_frequency_or_damping(reported, along_f=several_f)


def _over_both_properties(
    reported: ReportedCriteria, amplitude: np.ndarray, delay: np.ndarray
) -> Iterator[Block]:
    yield Figure(
        drawing=_surfaces(reported),
        caption=prose(
            "Limits over natural frequency and damping ratio: the room for amplitude error hardly depends on"
            " the frequency and grows with damping; the room for delay shrinks as the frequency grows."
        ),
        label="fig:surfaces",
    )
    yield _pivot(
        reported,
        delay,
        Fixed(),
        "Greatest delay $sqrt(b)$ [ms] of a test without amplitude error",
        "tab:delay",
    )
    text = "Greatest amplitude error $sqrt(a)$ [%] of a test without delay"
    yield _pivot(reported, amplitude, Fixed(), text, "tab:amplitude")


def _surfaces(reported: ReportedCriteria) -> Drawing:
    """Draw the limits between the simulated structures too, as the law has them."""
    f, xi = (
        np.geomspace(nodes[0], nodes[-1], _FINE).clip(nodes[0], nodes[-1])
        for nodes in (reported.frequencies, reported.damping_ratios)
    )
    a, b = reported.criterion.limits(f[:, None], xi[None, :])
    simulated = (reported.frequencies, reported.damping_ratios)
    return criterion_surfaces(f, xi, PERCENT * np.sqrt(a), np.sqrt(b), simulated=simulated)


def _pivot(reported: ReportedCriteria, limit: np.ndarray, number: Fixed, text: str, label: str) -> Table:
    rows = _spread_places(reported.damping_ratios.size, _MOST_ROWS)
    across = _spread_places(reported.frequencies.size, _MOST_COLUMNS)
    frame = pd.DataFrame(limit[np.ix_(across, rows)].T, columns=[str(k) for k in across])
    frame.insert(0, "xi", reported.damping_ratios[rows])
    columns = tuple(
        Column(key=str(k), heading=f"{reported.frequencies[k]:g}", number=number, group=prose("$f$ [Hz]"))
        for k in across
    )
    return Table(
        frame=frame,
        columns=(Column(key="xi", heading=prose("$xi$ [-]"), number=Shortest()), *columns),
        caption=prose(f"{text}, by damping ratio and natural frequency."),
        label=label,
    )


def _spread_places(count: int, most: int) -> list[int]:
    """Positions spread evenly over those that there are."""
    return sorted({int(k) for k in np.linspace(0, count - 1, min(count, most)).round()})


def _over_frequency_or_damping(reported: ReportedCriteria, *, along_f: bool) -> Figure:
    nodes = reported.frequencies if along_f else reported.damping_ratios
    series = []
    for criterion in reported.criteria:
        a, b = (limit.ravel() for limit in reported.over_grid(criterion))
        error = f"{percent(criterion.threshold)} {ERROR_NAMES[Metric(criterion.metric)]}"
        name = f"{error}, {share_in_words(criterion.promise)} of motions"
        series.append(ParameterSeries(name=name, x=nodes, a=a, b=b, law=True))
    draw = parameters_over_frequency if along_f else parameters_over_damping_ratio
    what = "natural frequency" if along_f else "damping ratio"
    return Figure(
        drawing=draw(series),
        caption=prose("Limits $a$ and $b$ of the criteria over the {what} of the structure.", what=what),
        label="fig:surfaces",
    )
