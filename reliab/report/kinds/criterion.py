"""Report of a criterion: how much amplitude error and delay a test may have, and why."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure as Drawing

from reliab.criterion import Criterion, EllipseSample, sample_of
from reliab.criterion.distributions import Lognormal, LogSkewNormal
from reliab.report.document import Block, Column, Document, Figure, Paragraph, Remark, Section, Table
from reliab.report.figures.criterion_surfaces import criterion_surfaces
from reliab.report.figures.ellipses_and_criterion import ellipses_and_criterion
from reliab.report.figures.event_forest import event_forest
from reliab.report.figures.parameter_correlation import parameter_correlation
from reliab.report.figures.parameter_distributions import parameter_distributions
from reliab.report.figures.parameters_over_structure import (
    ParameterSeries,
    parameters_over_damping_ratio,
    parameters_over_frequency,
)
from reliab.report.figures.posterior_and_predictive import posterior_and_predictive
from reliab.report.figures.quantile_quantile import quantile_quantile
from reliab.report.kinds.method import limits_section, method_section
from reliab.report.kinds.provenance import provenance_of
from reliab.report.kinds.rates import rates_section
from reliab.report.kinds.wording import (
    ERROR_NAMES,
    ERRORS,
    METHODS,
    PERCENT,
    ellipse,
    error_below,
    percent,
    values,
)
from reliab.report.numbers import Fixed, Scientific, Shortest, Significant
from reliab.report.prose import Piece, Prose, prose
from reliab.report.sources import SOURCES
from reliab.vocabulary import Metric

_PAPER_STRUCTURE = (1.0, 0.02)
_MOST_COLUMNS = 9
_MOST_ROWS = 12
_MOST_EVENTS = 40
_LONG_TABLE = 160
_FINE = 41


def criterion_report(
    *,
    title: str,
    ellipses: xr.Dataset,
    criteria: Sequence[Criterion],
    coverage: pd.DataFrame | None = None,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
    purpose: str = "",
) -> Document:
    """Report criteria and the motions behind them.

    Parameters
    ----------
    title : str
        Title of the report.
    ellipses : xarray.Dataset
        `a` [-] and `b` [ms²] over (motion, f, xi, threshold, metric, curve) with the coordinate `event`,
        as `reliab.sweep.trace_ellipses` makes it.
    criteria : sequence of Criterion
        Derived from these ellipses; the verdict, the figures and the tables over structures are those of
        the first, the others are compared with it.
    coverage : pandas.DataFrame, optional
        Shares of held-out motions that criteria contain, one row each: `candidate` (name), `confidence`
        (stated), `f` [Hz] (NaN for all structures together), `rate`, `low`, `high` [-], as
        :func:`reliab.report.kinds.rates.rates_table` makes it.
    provenance : mapping
        What the report can be made again from, by name: the hash of the study, seeds, …
    notes : sequence of Prose, optional
        What the reader should know beside the criterion's own warnings.
    purpose : str, optional
        What the study is for, for the first page.

    Returns
    -------
    Document
        The report.
    """
    told = _Told(ellipses=ellipses, criteria=tuple(criteria))
    chosen = told.criterion
    fraction = float(ellipses.attrs.get("experimental_fraction", 1.0))
    blocks: list[Block] = [_result(told), _motions(told)]
    if coverage is not None and len(coverage):
        blocks.append(rates_section(coverage, confidence=chosen.confidence))
    blocks += [
        method_section(chosen, experimental_fraction=fraction, window=chosen.provenance.window),
        limits_section((*chosen.provenance.warnings, *notes)),
        _appendix(told),
    ]
    return Document(
        kind="Reliability criterion",
        title=title,
        verdict=_verdict(told),
        facts={**_facts(told, coverage), "Purpose": purpose},
        blocks=tuple(blocks),
        provenance=provenance_of(provenance, chosen.provenance),
        sources=SOURCES,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Told:
    """What the report tells of, and the structure by which it does."""

    ellipses: xr.Dataset
    criteria: tuple[Criterion, ...]

    @property
    def criterion(self) -> Criterion:
        return self.criteria[0]

    @cached_property
    def frequencies(self) -> np.ndarray:
        return np.sort(self.ellipses["f"].values.astype(np.float64))

    @cached_property
    def damping_ratios(self) -> np.ndarray:
        return np.sort(self.ellipses["xi"].values.astype(np.float64))

    @cached_property
    def structure(self) -> tuple[float, float]:
        """The structure nearest to the paper's."""
        nearest = (
            float(nodes[np.argmin(np.abs(np.log(nodes / wanted)))])
            for nodes, wanted in zip((self.frequencies, self.damping_ratios), _PAPER_STRUCTURE, strict=True)
        )
        frequency, damping_ratio = nearest
        return frequency, damping_ratio

    @cached_property
    def limits(self) -> tuple[float, float]:
        a, b = self.criterion.limits(*self.structure)
        return float(a), float(b)

    @cached_property
    def sample(self) -> EllipseSample:
        frequency, damping_ratio = self.structure
        chosen = self.criterion
        return sample_of(
            self.ellipses,
            frequency=frequency,
            damping_ratio=damping_ratio,
            threshold=chosen.threshold,
            metric=chosen.metric,
        )

    def over_grid(self, criterion: Criterion) -> tuple[np.ndarray, np.ndarray]:
        """Limits a [-] and b [ms²] over all structures, shape (F, X)."""
        return criterion.limits(self.frequencies[:, None], self.damping_ratios[None, :])


def _verdict(told: _Told) -> Prose:
    chosen, (f, xi), (a, b) = told.criterion, told.structure, told.limits
    return (
        *prose("At {f:g} Hz and $xi = {xi:g}$, a test keeps ", f=f, xi=xi),
        *error_below(chosen.metric, chosen.threshold),
        f" for {percent(chosen.confidence)} of ground motions while ",
        ellipse(a, b),
        *prose(
            " with $d$ in ms: at most {amplitude} of amplitude error, or {delay:.2f} ms of delay.",
            amplitude=percent(np.sqrt(a), 2),
            delay=np.sqrt(b),
        ),
    )


def _facts(told: _Told, coverage: pd.DataFrame | None) -> dict[str, Prose]:
    chosen, source = told.criterion, told.criterion.provenance
    together = "for both limits together" if chosen.joint else "for each limit separately"
    meaning = METHODS.get(chosen.method, chosen.method)
    facts: dict[str, Prose] = {
        "Ground motions": f"{source.n_motions} of {source.n_events} earthquakes",
        "Structures": prose(
            "$f$ = {f}, $xi$ = {xi}",
            f=values(told.frequencies.tolist(), "Hz"),
            xi=values(told.damping_ratios.tolist()),
        ),
        "Error": error_below(chosen.metric, chosen.threshold),
        "Confidence": f"{percent(chosen.confidence)}, {together}: {meaning}",
    }
    if coverage is not None and len(coverage):
        facts["Put to the test"] = _tested(coverage, chosen.confidence)
    return facts


def _tested(coverage: pd.DataFrame, confidence: float) -> Prose:
    overall = coverage[coverage["f"].isna() & np.isclose(coverage["confidence"], confidence)]
    if overall.empty:
        return prose("see @sec:coverage")
    row = overall.iloc[0]
    return (
        f"{percent(row['rate'])} of the motions of held-out earthquakes contain the criterion "
        f"(95 % interval {percent(row['low'])} to {percent(row['high'])})"
    )


def _result(told: _Told) -> Section:
    chosen = told.criterion
    f, xi = told.structure
    blocks: list[Block] = [
        Paragraph(
            text=prose(
                "Evaluate $A$ and $d$ from the command and measured displacements of the test (@eq:index). "
                "The test is reliable in the sense of this report while its point lies inside the ellipse of"
                " its structure (@tab:criteria, @fig:criterion). A test that is accurate in amplitude may "
                "use the whole of the delay, and the other way round; errors in both share the same budget."
            )
        ),
        _criteria_table(told),
        Figure(
            drawing=ellipses_and_criterion(told.sample, _named_limits(told)),
            caption=prose(
                "Boundaries of all ground motions at {f:g} Hz and $xi = {xi:g}$ (grey) and the criterion: "
                "the share of grey ellipses that the coloured one crosses is the share of motions for which"
                " a test on its edge would exceed the error.",
                f=f,
                xi=xi,
            ),
            label="fig:criterion",
        ),
        *_over_structures(told),
    ]
    zero = _without_promise(told)
    if zero:
        blocks.insert(1, Remark(text=zero))
    title = f"Criterion for {percent(chosen.confidence)} of ground motions"
    return Section(title=title, blocks=tuple(blocks), label="sec:result")


def _without_promise(told: _Told) -> str:
    """Say for which criteria the motions are too few."""
    few = [each for each in told.criteria if not all(np.min(limit) > 0.0 for limit in told.over_grid(each))]
    if not few:
        return ""
    shares = ", ".join(sorted({percent(each.confidence) for each in few}))
    return (
        f"The motions are too few for the promise at {shares}; the limits are zero there and no test is "
        "accepted."
    )


def _criteria_table(told: _Told) -> Table:
    f, xi = told.structure
    rows = []
    for each in told.criteria:
        a, b = (float(limit) for limit in each.limits(f, xi))
        row = {"threshold": each.threshold, "metric": str(each.metric), "confidence": each.confidence}
        rows.append({**row, "a": a, "b": b, "amplitude": np.sqrt(a), "delay": np.sqrt(b)})
    frame = pd.DataFrame(rows)
    frame["metric"] = [ERROR_NAMES[Metric(name)] for name in frame["metric"]]
    return Table(
        frame=frame,
        columns=(
            Column(key="metric", heading="Error"),
            Column(key="threshold", heading="Bound", unit="%", number=Shortest(factor=PERCENT)),
            Column(key="confidence", heading="Confidence", unit="%", number=Shortest(factor=PERCENT)),
            Column(key="a", heading=prose("$a$"), unit="-", number=Scientific()),
            Column(key="b", heading=prose("$b$"), unit="ms²", number=Significant()),
            Column(
                key="amplitude", heading=prose("$|A - 1| <= sqrt(a)$"), unit="%", number=Fixed(factor=PERCENT)
            ),
            Column(key="delay", heading=prose("$d <= sqrt(b)$"), unit="ms", number=Fixed()),
        ),
        caption=prose(
            "Limits of the ellipse at {f:g} Hz and $xi = {xi:g}$; the first line is the criterion of this "
            "report. Small errors and high confidences leave less room.",
            f=f,
            xi=xi,
        ),
        label="tab:criteria",
    )


def _named_limits(told: _Told) -> dict[str, tuple[float, float]]:
    chosen = told.criterion
    alike = [
        each for each in told.criteria if (each.threshold, each.metric) == (chosen.threshold, chosen.metric)
    ]
    named = {}
    for each in alike:
        a, b = (float(limit) for limit in each.limits(*told.structure))
        if a > 0.0 and b > 0.0:
            named[f"{percent(each.confidence)} of motions"] = (a, b)
    return named


def _over_structures(told: _Told) -> Iterator[Block]:
    a, b = told.over_grid(told.criterion)
    several_f, several_xi = a.shape[0] > 1, a.shape[1] > 1
    if several_f and several_xi:
        yield from _over_both(told, PERCENT * np.sqrt(a), np.sqrt(b))
    elif several_f or several_xi:
        yield _over_one(told, along_f=several_f)


def _over_both(told: _Told, amplitude: np.ndarray, delay: np.ndarray) -> Iterator[Block]:
    yield Figure(
        drawing=_surfaces(told),
        caption=prose(
            "Limits over natural frequency and damping ratio: the room for amplitude error hardly depends on"
            " the frequency and grows with damping; the room for delay shrinks as the frequency grows."
        ),
        label="fig:surfaces",
    )
    yield _pivot(
        told, delay, Fixed(), "Greatest delay $sqrt(b)$ [ms] of a test without amplitude error", "tab:delay"
    )
    text = "Greatest amplitude error $sqrt(a)$ [%] of a test without delay"
    yield _pivot(told, amplitude, Fixed(), text, "tab:amplitude")


def _surfaces(told: _Told) -> Drawing:
    """Draw the limits between the simulated structures too, as the law has them."""
    f, xi = (
        np.geomspace(nodes[0], nodes[-1], _FINE).clip(nodes[0], nodes[-1])
        for nodes in (told.frequencies, told.damping_ratios)
    )
    a, b = told.criterion.limits(f[:, None], xi[None, :])
    simulated = (told.frequencies, told.damping_ratios)
    return criterion_surfaces(f, xi, PERCENT * np.sqrt(a), np.sqrt(b), simulated=simulated)


def _pivot(told: _Told, limit: np.ndarray, number: Fixed, text: str, label: str) -> Table:
    rows = _chosen(told.damping_ratios.size, _MOST_ROWS)
    across = _chosen(told.frequencies.size, _MOST_COLUMNS)
    frame = pd.DataFrame(limit[np.ix_(across, rows)].T, columns=[str(k) for k in across])
    frame.insert(0, "xi", told.damping_ratios[rows])
    columns = tuple(
        Column(key=str(k), heading=f"{told.frequencies[k]:g}", number=number, group=prose("$f$ [Hz]"))
        for k in across
    )
    return Table(
        frame=frame,
        columns=(Column(key="xi", heading=prose("$xi$ [-]"), number=Shortest()), *columns),
        caption=prose(f"{text}, by damping ratio and natural frequency."),
        label=label,
    )


def _chosen(count: int, most: int) -> list[int]:
    """Positions spread evenly over those that there are."""
    return sorted({int(k) for k in np.linspace(0, count - 1, min(count, most)).round()})


def _over_one(told: _Told, *, along_f: bool) -> Figure:
    nodes = told.frequencies if along_f else told.damping_ratios
    series = []
    for each in told.criteria:
        a, b = (limit.ravel() for limit in told.over_grid(each))
        error = f"{percent(each.threshold)} {ERROR_NAMES[Metric(each.metric)]}"
        name = f"{error}, {percent(each.confidence)} of motions"
        series.append(ParameterSeries(name=name, x=nodes, a=a, b=b, law=True))
    draw = parameters_over_frequency if along_f else parameters_over_damping_ratio
    what = "natural frequency" if along_f else "damping ratio"
    return Figure(
        drawing=draw(series),
        caption=prose("Limits $a$ and $b$ of the criteria over the {what} of the structure.", what=what),
        label="fig:surfaces",
    )


def _motions(told: _Told) -> Section:
    sample, chosen, (f, xi) = told.sample, told.criterion, told.structure
    figures: list[Block] = [
        Figure(
            drawing=parameter_correlation(sample),
            caption=prose(
                "Every motion has its own ellipse. $a$ and $b$ rise together: a motion that forgives "
                "amplitude errors forgives delays too, since near resonance both are one complex error."
            ),
            label="fig:correlation",
        ),
        Figure(
            drawing=parameter_distributions(
                sample,
                {
                    "lognormal": (Lognormal.fit(sample.a), Lognormal.fit(sample.b)),
                    "log-skew-normal": (LogSkewNormal.fit(sample.a), LogSkewNormal.fit(sample.b)),
                },
                limits=told.limits,
                confidence=chosen.confidence,
            ),
            caption=(
                "Distribution of the ellipse parameters over the motions; the criterion cuts the lower tail."
            ),
            label="fig:distributions",
        ),
        Figure(
            drawing=quantile_quantile(sample),
            caption=(
                "Where points leave the band, the lognormal distribution of the paper does not describe the "
                "motions."
            ),
            label="fig:quantiles",
        ),
        Figure(
            drawing=posterior_and_predictive(sample, limits=told.limits, confidence=chosen.confidence),
            caption=prose(
                "What the motions leave open. Above: how well the quantile is known, if motions were "
                "independent and lognormal (bar: 95 %). Below: the chance that a further motion lies below "
                "a value; the criterion stands where the predictive curve meets {share}, or lower where $a$"
                " and $b$ must hold together.",
                share=percent(1.0 - chosen.confidence, 2),
            ),
            label="fig:predictive",
        ),
    ]
    if 1 < sample.n_events < min(sample.n_motions, _MOST_EVENTS):
        figures.append(
            Figure(
                drawing=event_forest(sample, limits=told.limits),
                caption=prose(
                    "Motions of one earthquake are alike @searle1992; this many motions are therefore worth "
                    "fewer independent ones, and whole earthquakes are held out when the criterion is put to"
                    " the test."
                ),
                label="fig:forest",
            )
        )
    opening = Paragraph(
        text=prose(
            "{n} motions of {events} earthquakes have an ellipse at {f:g} Hz and $xi = {xi:g}$; their "
            "parameters are listed in @tab:motions.",
            n=sample.n_motions,
            events=sample.n_events,
            f=f,
            xi=xi,
        )
    )
    return Section(title="The motions behind it", blocks=(opening, *figures), label="sec:motions")


def _appendix(told: _Told) -> Section:
    sample, (f, xi) = told.sample, told.structure
    frame = pd.DataFrame({"motion": sample.motions, "event": sample.events, "a": sample.a, "b": sample.b})
    for name in ("duration", "pga"):
        if name in told.ellipses.coords:
            frame[name] = told.ellipses[name].sel(motion=sample.motions).values
    shown = frame.sort_values("a").head(_LONG_TABLE) if len(frame) > _LONG_TABLE else frame
    optional = {
        "duration": Column(key="duration", heading="Duration", unit="s", number=Fixed(decimals=1)),
        "pga": Column(key="pga", heading="Peak", unit="m/s²", number=Fixed()),
    }
    which = "" if len(shown) == len(frame) else f" The {_LONG_TABLE} least forgiving of {len(frame)} motions."
    caption: tuple[Piece, ...] = (
        *prose("Ellipses of the motions at {f:g} Hz and $xi = {xi:g}$ for ", f=f, xi=xi),
        ERRORS[Metric(sample.metric)],
        f" of {percent(sample.threshold)}.{which}",
    )
    table = Table(
        frame=shown,
        columns=(
            Column(key="motion", heading="Motion"),
            Column(key="event", heading="Earthquake"),
            *(column for name, column in optional.items() if name in shown),
            Column(key="a", heading=prose("$a$"), unit="-", number=Scientific()),
            Column(key="b", heading=prose("$b$"), unit="ms²", number=Significant()),
        ),
        caption=caption,
        label="tab:motions",
    )
    return Section(title="Ellipses of the motions", blocks=(table,))
