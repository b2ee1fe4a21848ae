"""The criterion itself: limits at one structure and over all."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator, FormatStrFormatter, NullLocator
from numpy.typing import NDArray

from reliab.core.significant_digits import percent, share_in_words
from reliab.core.vocabulary import ERROR_NAMES, PERCENT, CurveName, Metric, Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.population import EllipseSample, sample_of
from reliab.report.document import Block, Column, Figure, Remark, Section, Table
from reliab.report.figures.parameter_distributions import (
    ParameterSeries,
    ellipses_and_criterion,
    parameters_over_damping_ratio,
    parameters_over_frequency,
)
from reliab.report.numbers import Fixed, Scientific, Shortest, Significant
from reliab.report.prose import prose
from reliab.report.style import (
    DAMPING_RATIO,
    FREQUENCY,
    INK,
    SEQUENTIAL,
    apply_style,
    letters,
    name_axes,
    panels,
)

_PAPER_STRUCTURE = (1.0, 0.02)


@dataclass(frozen=True, kw_only=True, eq=False)
class ReportedCriteria:
    """Criteria with the ellipses behind them, and the structure at which a report shows them."""

    ellipses: xr.Dataset
    criteria: tuple[Criterion, ...]

    @property
    def criterion(self) -> Criterion:
        """The criterion of the verdict."""
        return self.criteria[0]

    @cached_property
    def frequencies(self) -> np.ndarray:
        """Frequencies of the ellipses [Hz], increasing."""
        return np.sort(self.ellipses["f"].values.astype(np.float64))

    @cached_property
    def damping_ratios(self) -> np.ndarray:
        """Damping ratios of the ellipses [-], increasing."""
        return np.sort(self.ellipses["xi"].values.astype(np.float64))

    @cached_property
    def structure(self) -> tuple[float, float]:
        """The structure nearest to the paper's."""
        nearest = (
            float(nodes[np.argmin(np.abs(np.log(nodes / target)))])
            for nodes, target in zip((self.frequencies, self.damping_ratios), _PAPER_STRUCTURE, strict=True)
        )
        frequency, damping_ratio = nearest
        return frequency, damping_ratio

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Limits a [-] and b [ms²] at the structure."""
        a, b = self.criterion.limits(*self.structure)
        return float(a), float(b)

    @cached_property
    def sample(self) -> EllipseSample:
        """Ellipses of all motions at the structure."""
        frequency, damping_ratio = self.structure
        criterion = self.criterion
        return sample_of(
            self.ellipses,
            frequency=frequency,
            damping_ratio=damping_ratio,
            threshold=criterion.threshold,
            metric=criterion.metric,
            curve=criterion.provenance.curve,
        )

    def lead(self, criterion: Criterion) -> float:
        """Limit of an early actuator without amplitude error at the structure [ms]; NaN where unknown."""
        if criterion.lead_law is None:
            return float("nan")
        _, b = criterion.limits(*self.structure, side=Side.LEAD)
        return float(np.sqrt(b))

    def evaluate_on_grid(self, criterion: Criterion) -> tuple[np.ndarray, np.ndarray]:
        """Limits a [-] and b [ms²] of late actuators over all structures, shape (F, X)."""
        return criterion.limits(self.frequencies[:, None], self.damping_ratios[None, :])


_MOST_COLUMNS = 9

_MOST_ROWS = 12

_FINE = 41

_EACH_LIMIT = "each alone, without the other error"

_CONVERGENCE_WARNING = (
    "THE POSTERIOR HAS NOT CONVERGED. The limits of this report must not be relied on; sample longer and "
    "derive them again."
)


def result_section(result: ReportedCriteria, population: str = "ground motions") -> Section:
    """State the criterion at one structure, then over all."""
    main_criterion = result.criterion
    (f, xi), (a, b) = result.structure, result.limits
    blocks: list[Block] = [
        prose(
            "Evaluate $A$ and $d$ from the command and measured displacements of the test (@eq:index). "
            "The test is reliable in the sense of this report while its point lies inside the ellipse of"
            " its structure (@tab:criteria, @fig:criterion). Each limit of the table holds alone: a test "
            "without amplitude error may use the whole of the delay, and the other way round; errors in "
            "both share the same budget."
        ),
        _criteria_table(result),
        Figure(
            drawing=ellipses_and_criterion(result.sample, _name_limits(result)),
            caption=prose(
                "Ellipses {how} the boundaries of all ground motions at {f:g} Hz and $xi = {xi:g}$ (grey; "
                "late actuators) and the criterion, which lies inside {inside} of these {drawn}: where the "
                "coloured ellipse crosses a grey one, a test on its edge would exceed the error under that "
                "motion, as far as the ellipse represents the boundary.",
                inside=int(((result.sample.a >= a) & (result.sample.b >= b)).sum()),
                drawn=result.sample.n_motions,
                how="inscribed in"
                if result.criterion.provenance.curve == CurveName.INSCRIBED
                else "fitted by least squares to",
                f=f,
                xi=xi,
            ),
            label="fig:criterion",
            leads=True,
        ),
        *_structure_blocks(result),
    ]
    zero = _criteria_without_promise(result)
    if zero:
        blocks.insert(1, Remark(text=zero))
    if any(criterion.provenance.settings.get("converged") is False for criterion in result.criteria):
        blocks.insert(0, Remark(text=_CONVERGENCE_WARNING))
    title = f"Criterion for {share_in_words(main_criterion.promise)} of {population} like those behind it"
    return Section(title=title, blocks=tuple(blocks), label="sec:result")


def _criteria_without_promise(result: ReportedCriteria) -> str:
    """Say for which criteria the motions are too few."""
    empty_criteria = [
        criterion
        for criterion in result.criteria
        if not all(np.min(limit) > 0.0 for limit in result.evaluate_on_grid(criterion))
    ]
    if not empty_criteria:
        return ""
    shares = ", ".join(sorted({percent(criterion.confidence) for criterion in empty_criteria}))
    return (
        f"The motions are too few for the promise at {shares}; the limits are zero there and no test is "
        "accepted."
    )


def _criteria_table(result: ReportedCriteria) -> Table:
    f, xi = result.structure
    frame = _limits_of_criteria(result)
    lead = Column(key="lead", heading=prose("early: $-d <=$"), unit="ms", number=Fixed(), group=_EACH_LIMIT)
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
            Column(key="amplitude", heading=amplitude, unit="%", number=share, group=_EACH_LIMIT),
            Column(key="delay", heading=delay, unit="ms", number=Fixed(), group=_EACH_LIMIT),
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


def _limits_of_criteria(result: ReportedCriteria) -> pd.DataFrame:
    """One row for each criterion: what it promises, and its limits at the structure."""
    rows = []
    for criterion in result.criteria:
        a, b = (float(limit) for limit in criterion.limits(*result.structure))
        rows.append(
            {
                "metric": ERROR_NAMES[Metric(criterion.metric)],
                "threshold": criterion.threshold,
                "confidence": criterion.promise,
                "a": a,
                "b": b,
                "amplitude": np.sqrt(a),
                "delay": np.sqrt(b),
                "lead": result.lead(criterion),
            }
        )
    return pd.DataFrame(rows)


def _name_limits(result: ReportedCriteria) -> dict[str, tuple[float, float]]:
    main_criterion = result.criterion
    same_limits = [
        criterion
        for criterion in result.criteria
        if (criterion.threshold, criterion.metric) == (main_criterion.threshold, main_criterion.metric)
    ]
    limits = {}
    for criterion in same_limits:
        a, b = (float(limit) for limit in criterion.limits(*result.structure))
        if a > 0.0 and b > 0.0:
            limits[f"{share_in_words(criterion.promise)} of motions"] = (a, b)
    return limits


def _structure_blocks(result: ReportedCriteria) -> Iterator[Block]:
    a, b = result.evaluate_on_grid(result.criterion)
    several_f, several_xi = a.shape[0] > 1, a.shape[1] > 1
    if several_f and several_xi:
        yield from _blocks_over_both_properties(result, PERCENT * np.sqrt(a), np.sqrt(b))
    elif several_f or several_xi:
        yield _figure_over_one_property(result, over_frequency=several_f)


def _blocks_over_both_properties(
    result: ReportedCriteria, amplitude: np.ndarray, delay: np.ndarray
) -> Iterator[Block]:
    yield Figure(
        drawing=_surfaces(result),
        caption=prose(
            "Limits over natural frequency and damping ratio: the room for amplitude error hardly depends on"
            " the frequency and grows with damping; the room for delay shrinks as the frequency grows."
        ),
        label="fig:surfaces",
    )
    yield _pivot(
        result,
        delay,
        Fixed(),
        "Greatest delay $sqrt(b)$ [ms] of a test without amplitude error",
        "tab:delay",
    )
    text = "Greatest amplitude error $sqrt(a)$ [%] of a test without delay"
    yield _pivot(result, amplitude, Fixed(), text, "tab:amplitude")


def _surfaces(result: ReportedCriteria) -> Drawing:
    """Draw the limits between the simulated structures too, as the law has them."""
    f, xi = (
        np.geomspace(nodes[0], nodes[-1], _FINE).clip(nodes[0], nodes[-1])
        for nodes in (result.frequencies, result.damping_ratios)
    )
    a, b = result.criterion.limits(f[:, None], xi[None, :])
    grid_nodes = (result.frequencies, result.damping_ratios)
    return criterion_surfaces(f, xi, PERCENT * np.sqrt(a), np.sqrt(b), grid_nodes=grid_nodes)


def _pivot(result: ReportedCriteria, limit: np.ndarray, number: Fixed, text: str, label: str) -> Table:
    rows = _spread_places(result.damping_ratios.size, _MOST_ROWS)
    places = _spread_places(result.frequencies.size, _MOST_COLUMNS)
    frame = pd.DataFrame(limit[np.ix_(places, rows)].T, columns=[str(k) for k in places])
    frame.insert(0, "xi", result.damping_ratios[rows])
    columns = tuple(
        Column(key=str(k), heading=f"{result.frequencies[k]:g}", number=number, group=prose("$f$ [Hz]"))
        for k in places
    )
    return Table(
        frame=frame,
        columns=(Column(key="xi", heading=prose("$xi$ [-]"), number=Shortest()), *columns),
        caption=prose(f"{text}, by damping ratio and natural frequency."),
        label=label,
    )


def _spread_places(count: int, largest_count: int) -> list[int]:
    """Positions spread evenly over those that there are."""
    return sorted({int(k) for k in np.linspace(0, count - 1, min(count, largest_count)).round()})


def _figure_over_one_property(result: ReportedCriteria, *, over_frequency: bool) -> Figure:
    nodes = result.frequencies if over_frequency else result.damping_ratios
    series = []
    for criterion in result.criteria:
        a, b = (limit.ravel() for limit in result.evaluate_on_grid(criterion))
        error = f"{percent(criterion.threshold)} {ERROR_NAMES[Metric(criterion.metric)]}"
        name = f"{error}, {share_in_words(criterion.promise)} of motions"
        series.append(ParameterSeries(name=name, x=nodes, a=a, b=b, law=True))
    draw = parameters_over_frequency if over_frequency else parameters_over_damping_ratio
    quantity = "natural frequency" if over_frequency else "damping ratio"
    return Figure(
        drawing=draw(series),
        caption=prose("Limits $a$ and $b$ of the criteria over the {what} of the structure.", what=quantity),
        label="fig:surfaces",
    )


_HEIGHT = 58.0
_MOST_LEVELS = 9
_EDGE = 0.06
_ROUND_STEPS = ((1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8), (1, 1.5, 2.5, 4, 6), (1, 2, 5), (1, 3), (1,))
_SHADES = 25
_PALENESS = 0.42
_LEAST_SPACE = 0.085


@apply_style
def criterion_surfaces(
    frequencies: NDArray[np.float64],
    damping_ratios: NDArray[np.float64],
    amplitude_limit: NDArray[np.float64],
    delay_limit: NDArray[np.float64],
    *,
    grid_nodes: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> Drawing:
    """Draw lines of equal limits over the structures, both axes logarithmic.

    `frequencies` (F,) [Hz]; `damping_ratios` (X,) [-]; `amplitude_limit` (F, X) [%]; `delay_limit` (F, X)
    [ms].
    """
    figure, axes = panels(1, 2, height=_HEIGHT, share_y=True)
    letters(axes, (r"amplitude error $\sqrt{a}$ [%]", r"delay $\sqrt{b}$ [ms]"))
    for place, values in zip(axes[0], (amplitude_limit, delay_limit), strict=True):
        _draw(place, frequencies, damping_ratios, values.T)
        for axis, nodes in zip((place.xaxis, place.yaxis), grid_nodes, strict=True):
            axis.set_major_locator(FixedLocator(_spread(nodes)))
            axis.set_minor_locator(NullLocator())
            axis.set_major_formatter(FormatStrFormatter("%g"))
    name_axes(axes[0, 0], FREQUENCY, DAMPING_RATIO)
    axes[0, 1].set_xlabel(FREQUENCY)
    return figure


def _draw(
    axes: Axes,
    frequencies: NDArray[np.float64],
    damping_ratios: NDArray[np.float64],
    values: NDArray[np.float64],
) -> None:
    positive = np.where(values > 0.0, values, np.nan)
    low, high = float(np.nanmin(positive)), float(np.nanmax(positive))
    axes.set(xscale="log", yscale="log")
    axes.set(xlim=(frequencies[0], frequencies[-1]), ylim=(damping_ratios[0], damping_ratios[-1]))
    shades = np.geomspace(low, high, _SHADES) if high > low else np.array([low, low * 1.01])
    axes.contourf(
        frequencies, damping_ratios, positive, levels=shades, colors=_colours(shades.size - 1), norm=LogNorm()
    )
    levels = _levels(low, high)
    if levels.size:
        lines = axes.contour(frequencies, damping_ratios, positive, levels=levels, colors=INK, linewidths=0.8)
        _label(axes, lines)
    axes.grid(visible=False)


def _levels(low: float, high: float) -> NDArray[np.float64]:
    """Preferred numbers between two limits, about evenly spaced on a logarithmic scale."""
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    levels = np.empty(0)
    for steps in _ROUND_STEPS:
        numbers = np.outer(decades, steps).ravel()
        levels = numbers[(numbers > low) & (numbers < high)]
        if levels.size <= _MOST_LEVELS:
            break
    return levels


def _label(axes: Axes, lines: QuadContourSet) -> None:
    """Write the level on each line, except where the frame would cut it."""
    transform = axes.transData + axes.transAxes.inverted()
    for text in axes.clabel(lines, inline=False, fontsize=8.0, fmt="%g"):
        x, y = transform.transform(text.get_position())
        if min(x, 1.0 - x, y, 1.0 - y) < _EDGE:
            text.remove()
        else:
            text.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6})


def _colours(count: int) -> list[tuple[float, ...]]:
    """Colours of rising lightness, pale enough for lines and numbers to stand on them."""
    shades = colormaps[SEQUENTIAL](np.linspace(0.0, 1.0, count))
    return [tuple(colour) for colour in (1.0 - _PALENESS * (1.0 - shades)).tolist()]


def _spread(nodes: NDArray[np.float64]) -> list[float]:
    """Nodes whose labels do not touch on a logarithmic axis; the first and the last always."""
    least = _LEAST_SPACE * np.log(nodes[-1] / nodes[0])
    nodes_apart = [float(nodes[0])]
    for node in nodes[1:-1].tolist():
        if np.log(node / nodes_apart[-1]) >= least and np.log(nodes[-1] / node) >= least:
            nodes_apart.append(node)
    return [*nodes_apart, float(nodes[-1])]
