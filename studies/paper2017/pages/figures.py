"""The figures of the paper from simulated results, in its order."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.criterion.distributions import Lognormal
from reliab.criterion.laws.guo_2017 import (
    Equation12,
    Equation14,
    Equation15,
    Equation15Corrected,
    Equation17,
    Equation17Corrected,
)
from reliab.criterion.laws.law import Law
from reliab.report.document import Block, Figure, Section
from reliab.report.figures.parameter_distributions import (
    ParameterSeries,
    ellipses_and_criterion,
    parameter_correlation,
    parameter_distributions,
    parameters_over_damping_ratio,
    parameters_over_frequency,
)
from reliab.report.prose import prose
from reliab.tracking.boundary.contour import Contour

from ..fits import exponential
from ..pages.displacement_histories import HistoryPanel, displacement_histories
from ..printed import EXAMPLE, FIVE_PERCENT, ONE_HERTZ, SHARE, TWO_PERCENT, PrintedTables
from ..records import Records, contour_with_ends
from .displacement_histories import case_histories
from .drawings import block_diagram, frame
from .error_figures import curve_fits, error_contours, error_curves, error_maps

_METRICS = (Metric.MTE, Metric.RMS)
_FINE = 101


def loop_section(example: xr.Dataset) -> Section:
    """Figures 1 to 7: the loop, one ground motion, errors of delay and of amplitude."""
    caption = (
        "Figure 1 of the paper: the loop. All stiffness stands in the laboratory, the paper's worst case."
    )
    loop = Figure(drawing=block_diagram(), caption=caption, label="fig:paper-1")
    return Section(
        title="One ground motion: errors of delay and of amplitude",
        blocks=(loop, _histories(example), _error_curves(example)),
    )


def _histories(example: xr.Dataset) -> Figure:
    """Figures 2, 3, 5 and 7."""
    tests = ("exact response (Figure 2)", "delay of 5 ms (Figure 3)", "amplitude of 0.99 (Figure 5)")
    titles = (*tests, "amplitude of 1.02, delay of 2 ms (Figure 7)")
    histories, times = example["displacement"].values, example["time"].values
    panels = [
        HistoryPanel(title=title, times=times, ideal=histories[0], measured=None if k == 0 else histories[k])
        for k, title in enumerate(titles)
    ]
    return Figure(
        drawing=displacement_histories(panels),
        caption=prose(
            "Figures 2, 3, 5 and 7 of the paper ({motion}, 1 Hz, $xi = 0.02$): a delay of 5 ms, stable "
            "though it is, leaves the structure ringing at the end; an amplitude error of 1 % can "
            "hardly be seen.",
            motion=example.attrs["motion"],
        ),
        label="fig:paper-2",
    )


def _error_curves(example: xr.Dataset) -> Figure:
    """Figures 4 and 6."""
    by_delay, by_amplitude = (
        {metric: example[name].sel(metric=str(metric)).values for metric in _METRICS}
        for name in ("error_of_delay", "error_of_gain")
    )
    return Figure(
        drawing=error_curves(
            (example["long_delay"].values, by_delay),
            (example["gain"].values, by_amplitude),
            critical_delay=float(example.attrs["critical_delay"]),
            threshold=FIVE_PERCENT,
        ),
        caption=(
            "Figures 4 and 6 of the paper: 5 % is exceeded at a quarter of the critical delay, stable is not "
            "accurate; both errors grow in proportion to the amplitude error."
        ),
        label="fig:paper-4",
    )


def boundary_section(records: Records, example: xr.Dataset) -> Section:
    """Figures 8 to 10: both errors at once, the contour of 5 %, the curves fitted to it."""
    maps = {metric: example["error"].sel(metric=str(metric)).values for metric in _METRICS}
    contours = {
        metric: {
            FIVE_PERCENT: Contour(
                amplitude=example[f"amplitude_{metric}"].values, delay=example[f"delay_{metric}"].values
            )
        }
        for metric in _METRICS
    }
    blocks: tuple[Block, ...] = (
        Figure(
            drawing=error_maps(example["gain"].values, example["delay"].values, maps, threshold=FIVE_PERCENT),
            caption=(
                "Figure 8 of the paper: error of the whole test over amplitude and delay, with the contour "
                "of 5 %."
            ),
            label="fig:paper-8",
        ),
        Figure(
            drawing=error_contours(contours),
            caption=prose(
                "Figure 9 of the paper: tests inside the contour keep their error below 5 %. "
                '$"MTE"^R$ is the more stringent error.'
            ),
            label="fig:paper-9",
        ),
        Figure(
            drawing=curve_fits(contour_with_ends(example), tuple(records.curves.values())),
            caption="Figure 10 of the paper: the ellipse lies closest to the contour of 5 %.",
            label="fig:paper-10",
        ),
    )
    return Section(title="Both errors at once: the boundary and its ellipse", blocks=blocks)


def motions_section(records: Records) -> Section:
    """Figures 11 to 13: the ellipses of all ground motions."""
    sample = records.sample()
    lognormal = (Lognormal.fit(sample.a), Lognormal.fit(sample.b))
    limits = (float(lognormal[0].quantile(SHARE)), float(lognormal[1].quantile(SHARE)))
    blocks: tuple[Block, ...] = (
        Figure(
            drawing=parameter_correlation(sample),
            caption=prose(
                "Figure 11 of the paper: $a$ and $b$ of the motions rise together. Band: 95 % of the lines "
                "of resampled earthquakes."
            ),
            label="fig:paper-11",
        ),
        Figure(
            drawing=parameter_distributions(
                sample, {"lognormal": lognormal}, limits=limits, confidence=1.0 - SHARE
            ),
            caption=(
                "Figure 12 of the paper: lognormal distributions and their 5 % quantiles, the paper's "
                "criterion."
            ),
            label="fig:paper-12",
        ),
        Figure(
            drawing=ellipses_and_criterion(
                sample, {"simulated, 95 %": limits, "equation (12)": _limits_of_equation_12()}
            ),
            caption=(
                "Figure 13 of the paper: the ellipses of all motions and the criterion, simulated and as "
                "printed."
            ),
            label="fig:paper-13",
            leads=True,
        ),
    )
    return Section(title="Many ground motions: a criterion", blocks=blocks)


def structures_section(records: Records, printed: PrintedTables) -> Section:
    """Figures 14 and 15, and Table 4 as a figure."""
    return Section(
        title="Other structures",
        blocks=(
            Figure(
                drawing=parameters_over_frequency(tuple(_example_over_frequency(records))),
                caption=prose(
                    "Figure 14 of the paper: the parameters of {motion} over the frequency. $a$ scatters; "
                    "the exponential (14) lets $b$ fall too fast above 1 Hz.",
                    motion=EXAMPLE,
                ),
                label="fig:paper-14",
            ),
            Figure(
                drawing=parameters_over_frequency(tuple(_quantiles_over_frequency(records, printed))),
                caption=prose(
                    "Figure 15 of the paper: limits for 95 % of the motions. The exponential (15) meets "
                    "Table 3 at 0.25 Hz only; $b$ falls as $1 \\/ f^2$."
                ),
                label="fig:paper-15",
            ),
            Figure(
                drawing=parameters_over_damping_ratio(tuple(_values_over_damping(records, printed))),
                caption=prose(
                    "Table 4 of the paper over the damping ratio: both parameters grow as $xi^(2.3)$, not as "
                    "$xi$; the printed column $b$, drawn here as printed, is $sqrt(b)$."
                ),
                label="fig:paper-table-4",
            ),
        ),
    )


def cases_section(cases: xr.Dataset) -> Section:
    """Figures 16 and 17: the application."""
    caption = "Figure 17 of the paper: exact response and measured displacement of the four cases."
    blocks = (
        Figure(
            drawing=frame(),
            caption=(
                "Figure 16 of the paper: frame (numerical substructure) and spring (experimental "
                "substructure)."
            ),
            label="fig:paper-16",
        ),
        case_histories(cases, caption=caption, label="fig:paper-17", errors=True),
    )
    return Section(title="Application", blocks=blocks)


def _limits_of_equation_12() -> tuple[float, float]:
    a, b = Equation12().limits(ONE_HERTZ, TWO_PERCENT)
    return float(a), float(b)


def _example_over_frequency(records: Records) -> Iterator[ParameterSeries]:
    f, fine = records.frequencies, _between(records.frequencies)
    a, b = (records.values_over_frequencies(parameter) for parameter in "ab")
    k1, k2 = exponential(f, b)
    yield ParameterSeries(name="simulated", x=f, a=a, b=b)
    least = np.full_like(fine, a.min())
    yield ParameterSeries(name="fitted as in the paper", x=fine, a=least, b=k1 * np.exp(-k2 * fine), law=True)
    yield _law(Equation14(), "equation (14), printed", fine, TWO_PERCENT, along=fine)


def _quantiles_over_frequency(records: Records, printed: PrintedTables) -> Iterator[ParameterSeries]:
    table, fine = printed.table3, _between(records.frequencies)
    a, b = (records.guaranteed(parameter) for parameter in "ab")
    yield ParameterSeries(name="simulated", x=records.frequencies, a=a, b=b)
    yield ParameterSeries(
        name="Table 3, printed", x=table["f_hz"].to_numpy(), a=table["a"].to_numpy(), b=table["b"].to_numpy()
    )
    yield _law(Equation15(), "equation (15)", fine, TWO_PERCENT, along=fine)
    yield _law(Equation15Corrected(), "(15) corrected", fine, TWO_PERCENT, along=fine)


def _values_over_damping(records: Records, printed: PrintedTables) -> Iterator[ParameterSeries]:
    table, xi = printed.table4, records.damping_ratios
    fine = _between(xi)
    a, b = (records.values_over_damping_ratios(parameter) for parameter in "ab")
    yield ParameterSeries(name="simulated", x=xi, a=a, b=b)
    yield ParameterSeries(
        name="Table 4, printed", x=table["xi"].to_numpy(), a=table["a"].to_numpy(), b=table["b"].to_numpy()
    )
    yield _law(Equation17(), "equation (17)", ONE_HERTZ, fine, along=fine)
    yield _law(Equation17Corrected(), "(17) corrected", ONE_HERTZ, fine, along=fine)


def _law(
    law: Law, name: str, frequency: Array | float, damping_ratio: Array | float, *, along: Array
) -> ParameterSeries:
    a, b = law.limits(frequency, damping_ratio)
    a, b = (np.broadcast_to(limit, along.shape) for limit in (a, b))
    return ParameterSeries(name=name, x=along, a=a, b=b, law=True)


def _between(nodes: Array) -> Array:
    return np.linspace(nodes[0], nodes[-1], _FINE)
