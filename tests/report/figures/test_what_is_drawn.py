# mypy: disable-error-code="attr-defined,index"
"""What stands in a figure is what was given: curves, bands, limits, names of axes, panels and legends."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection
from matplotlib.container import ErrorbarContainer
from matplotlib.legend import Legend
from matplotlib.text import Text

from reliab.assessment.design import TolerableErrors
from reliab.assessment.tracking_index import Windows
from reliab.core.vocabulary import Block
from reliab.criterion.distributions import Lognormal
from reliab.criterion.population import EllipseSample
from reliab.report.figures import discrepancy
from reliab.report.figures.measured_test import (
    error_over_time,
    tolerable_errors_over_frequency,
    tracking_overview,
)
from reliab.report.figures.parameter_distributions import (
    ParameterSeries,
    ellipses_and_criterion,
    pairs,
    parameter_correlation,
    parameter_distributions,
    parameters_over_damping_ratio,
    parameters_over_frequency,
    posterior_and_predictive,
    quantile_quantile,
    ranks,
    traces,
)
from reliab.report.kinds.assessment.frame import amplitude_and_delay_over_frequency
from reliab.report.kinds.criterion.report import event_forest
from reliab.report.kinds.criterion.result import criterion_surfaces
from reliab.report.sections import calibration_curve, coverage_by_frequency
from reliab.report.style import ellipse_line, svg
from reliab.sampling.posterior_sample import PosteriorSample
from reliab.tracking.indices.tracking import TrackingOverFrequency

MILLIMETRES = 25.4


def curve(place, label):
    """Points (x, y) of the line, or of the points with bars, of a name."""
    (result,) = [
        thing.lines[0] if isinstance(thing, ErrorbarContainer) else thing
        for thing in (*place.lines, *place.containers)
        if thing.get_label() == label
    ]
    return np.asarray(result.get_xdata(), float), np.asarray(result.get_ydata(), float)


def bars(place, label):
    """Ends of the bars of points of a name, across and up where both are drawn."""
    (result,) = [thing for thing in place.containers if thing.get_label() == label]
    return np.array([row.get_segments() for row in result.lines[2]])


def band(place, label):
    """Lowest and highest value of a filled band of a name at each x."""
    (result,) = [thing for thing in place.collections if thing.get_label() == label]
    points = result.get_paths()[0].vertices
    return {
        float(x): (points[points[:, 0] == x, 1].min(), points[points[:, 0] == x, 1].max())
        for x in points[:, 0]
    }


def upright(place):
    """Where upright lines through the whole panel stand, in their order."""
    return [line.get_xdata()[0] for line in place.lines if list(line.get_ydata()) == [0, 1]]


def level(place):
    """Where level lines through the whole panel stand, in their order."""
    return [line.get_ydata()[0] for line in place.lines if list(line.get_xdata()) == [0, 1]]


def legend(thing):
    """Names in the only legend of a figure or a panel."""
    (result,) = thing.findobj(Legend)
    return [text.get_text() for text in result.get_texts()]


def titles(figure):
    return [place.get_title(loc="left") for place in figure.axes]


def names(figure):
    return [(place.get_xlabel(), place.get_ylabel()) for place in figure.axes]


def size(figure):
    return tuple(MILLIMETRES * figure.get_size_inches())


def texts_of(place):
    """Every text that stands inside a panel."""
    return [text.get_text() for text in place.texts]


@pytest.fixture(scope="module")
def sample():
    random = np.random.default_rng(5)
    shared = random.normal(size=(2, 8))[:, np.repeat(np.arange(8), 4)]
    individual = random.normal(size=(2, 32))
    a, b = np.exp([[-8.0], [1.0]] + 0.4 * shared + 0.2 * individual)
    events = np.repeat([f"event {k}" for k in range(8)], 4)
    return EllipseSample(
        a=a,
        b=b,
        events=events,
        motions=events,
        frequency=1.0,
        damping_ratio=0.02,
        threshold=0.05,
        metric="rms",
    )


def test_the_boundary_of_every_motion_and_each_criterion(sample):
    figure = ellipses_and_criterion(sample, {"ours": (2e-4, 2.0), "theirs": (4e-4, 3.0)})
    (place,) = figure.axes
    grey, ours = place.lines[:32], curve(place, "ours")
    assert legend(figure) == ["32 motions of 8 earthquakes", "ours", "theirs"]
    for line, a, b in zip(grey, sample.a, sample.b, strict=True):
        x, y = line.get_xydata().T
        np.testing.assert_allclose((x - 1.0) ** 2 / a + y**2 / b, 1.0)
        assert y.min() > -1e-12
    np.testing.assert_allclose((ours[0] - 1.0) ** 2 / 2e-4 + ours[1] ** 2 / 2.0, 1.0)
    assert max(curve(place, "theirs")[1]) == pytest.approx(np.sqrt(3.0))
    widest = np.sqrt([np.quantile(sample.a, 0.98), np.quantile(sample.b, 0.98)])
    assert place.get_xlim() == pytest.approx((1.0 - widest[0], 1.0 + widest[0]))
    assert place.get_ylim() == pytest.approx((0.0, 1.05 * widest[1]))
    assert names(figure) == [("Amplitude $A$ [-]", "Equivalent delay $d$ [ms]")]
    assert size(figure) == pytest.approx((160.0, 84.0))
    assert {line.get_linewidth() for line in grey} < {0.5} | {place.lines[32].get_linewidth()}


def test_tracking_over_frequency_and_its_band():
    f = np.linspace(0.5, 5.0, 10)
    tracking = TrackingOverFrequency(
        frequency=f,
        amplitude=1.0 + 0.01 * f,
        delay=1e-3 * (1.0 + f),
        amplitude_deviation=1e-3 * f,
        delay_deviation=1e-4 * f,
        coherence=np.ones(10),
    )
    figure = amplitude_and_delay_over_frequency(tracking, amplitude=1.02, delay=2.5e-3, modes=[1.0, 9.0])
    assert names(figure) == [("Frequency $f$ [Hz]", "$A - 1$ [%]"), ("Frequency $f$ [Hz]", "$d$ [ms]")]
    assert legend(figure) == ["90 % band", "over frequency", "index of the test"]
    assert size(figure)[1] == pytest.approx(58.0)
    complete = {0: (f, 0.1 * f, 2.0), 1: (1.0 + f, 0.1 * f, 2.5)}
    for k, place in enumerate(figure.axes):
        values, deviations, index = complete[k]
        np.testing.assert_allclose(curve(place, "over frequency"), (f, values))
        for x, (low, high) in band(place, "90 % band").items():
            position = int(np.argmin(abs(f - x)))
            assert (low, high) == pytest.approx(
                (
                    values[position] - 1.645 * deviations[position],
                    values[position] + 1.645 * deviations[position],
                )
            )
        assert level(place) == pytest.approx([index])
        assert upright(place) == [1.0]
        reach = 0.25 * 4.5
        assert place.get_ylim() == pytest.approx((values[0] - reach, values[-1] + reach))
        assert place.get_xlim() == (0.5, 5.0)


def test_tolerable_errors_have_a_line_for_each_confidence():
    def tolerance(f, confidence):
        a, b = confidence * f * 1e-4, 4.0 * confidence / f
        return TolerableErrors(
            frequency=f,
            damping_ratio=0.02,
            threshold=0.05,
            confidence=confidence,
            a=a,
            b=b,
            critical_delay=0.1,
            outside_validity=False,
        )

    figure = tolerable_errors_over_frequency([tolerance(f, c) for c in (0.99, 0.9) for f in (2.0, 0.5, 1.0)])
    assert titles(figure) == [r"(a) $\sqrt{a}$, no delay", r"(b) $\sqrt{b}$, no amplitude error"]
    assert names(figure) == [
        ("Natural frequency $f$ [Hz]", r"Amplitude error $\sqrt{a}$ [-]"),
        ("Natural frequency $f$ [Hz]", r"Delay $\sqrt{b}$ [ms]"),
    ]
    assert legend(figure) == [
        "90 % of comparable ground motions",
        "99 % of comparable ground motions",
    ]
    amplitude, delay = figure.axes
    f = np.array([0.5, 1.0, 2.0])
    for name, confidence in (
        ("90 % of comparable ground motions", 0.9),
        ("99 % of comparable ground motions", 0.99),
    ):
        np.testing.assert_allclose(curve(amplitude, name), (f, np.sqrt(1e-4 * confidence * f)))
        np.testing.assert_allclose(curve(delay, name), (f, np.sqrt(4.0 * confidence / f)))
    assert amplitude.get_ylim()[0] == 0.0
    assert (amplitude.get_yscale(), delay.get_yscale()) == ("linear", "log")
    assert [delay.yaxis.get_major_formatter()(2.0), list(delay.yaxis.get_minor_locator()())] == ["2", []]


@pytest.mark.parametrize(
    ("draw", "name", "scale"),
    [
        (parameters_over_frequency, "Natural frequency $f$ [Hz]", "linear"),
        (parameters_over_damping_ratio, r"Damping ratio $\xi$ [-]", "log"),
    ],
)
def test_laws_are_lines_and_values_are_points(draw, name, scale):
    x = np.array([0.5, 1.0, 2.0])
    values = ParameterSeries(name="$1 values", x=x, a=1e-4 * x, b=3.0 / x)
    law = ParameterSeries(name="law", x=x, a=2e-4 * x, b=4.0 / x, law=True)
    figure = draw([values, law])
    assert titles(figure) == ["(a) $a$", "(b) $b$"]
    assert names(figure) == [(name, "Ellipse parameter $a$ [-]"), (name, "Ellipse parameter $b$ [ms²]")]
    assert legend(figure) == [r"\$1 values", "law"]
    for place, key in zip(figure.axes, ("a", "b"), strict=True):
        points, line = place.lines
        np.testing.assert_allclose(points.get_xydata().T, (x, getattr(values, key)))
        np.testing.assert_allclose(line.get_xydata().T, (x, getattr(law, key)))
        assert (points.get_linestyle(), points.get_marker() != "None", points.get_fillstyle()) == (
            "None",
            True,
            "none",
        )
        assert (line.get_linestyle() != "None", line.get_marker()) == (True, "None")
        assert (place.get_xscale(), place.get_yscale()) == (scale, "log")


@pytest.fixture(scope="module")
def rates():
    rows = [
        {
            "candidate": name,
            "confidence": c,
            "f": f,
            "rate": c - shift,
            "low": c - shift - 0.02,
            "high": c - shift + 0.01,
        }
        for name, shift in (("ours", 0.0), ("theirs", 0.05))
        for f, c in zip((2.0, 0.5, 1.0), (0.8, 0.9, 0.95), strict=True)
    ]
    return pd.DataFrame(rows)


def test_observed_over_stated_confidence(rates):
    figure = calibration_curve(rates)
    (place,) = figure.axes
    assert names(figure) == [("Stated confidence [%]", "Observed containment [%]")]
    assert legend(figure) == ["observed as stated", "ours", "theirs"]
    ends = (70.0, 101.0)
    assert place.get_xlim() == pytest.approx(ends)
    assert place.get_ylim() == pytest.approx(ends)
    assert place.get_aspect() == 1.0
    np.testing.assert_allclose(curve(place, "observed as stated"), (ends, ends))
    for name, shift in (("ours", 0.0), ("theirs", 5.0)):
        x, y = curve(place, name)
        np.testing.assert_allclose((x, y), ([80, 90, 95], np.array([80, 90, 95]) - shift))
        np.testing.assert_allclose(bars(place, name)[0, :, :, 1] - y[:, None], [[-2.0, 1.0]] * 3)
    assert size(figure) == pytest.approx((102.0, 76.0))


def test_containment_by_frequency_side_by_side(rates):
    figure = coverage_by_frequency(rates, confidence=0.95)
    (place,) = figure.axes
    assert names(figure) == [("Natural frequency $f$ [Hz]", "Contained [%]")]
    for name, shift, side in (("ours", 0.0, -1.0), ("theirs", 5.0, 1.0)):
        x, y = curve(place, name)
        np.testing.assert_allclose(x, np.array([0.5, 1.0, 2.0]) * np.exp(0.006 * side))
        np.testing.assert_allclose(y, np.array([90.0, 95.0, 80.0]) - shift)
    assert level(place) == [95.0]
    low, high = 73.0, 96.0
    assert place.get_ylim() == pytest.approx((low - 0.06 * (high - low), high + 0.06 * (high - low)))
    assert [text.get_text() for text in place.get_xticklabels()] == ["0.5", "1", "2"]
    assert place.get_xscale() == "log"
    assert list(place.xaxis.get_minorticklocs()) == []


def test_motions_stand_in_the_row_of_their_earthquake(sample):
    figure = event_forest(sample, limits=(2e-4, 0.0))
    left, right = figure.axes
    rows = [text.get_text() for text in left.get_yticklabels()]
    means = {event: np.log(sample.a[sample.events == event]).mean() for event in np.unique(sample.events)}
    assert rows == sorted(means, key=lambda event: -means[event])
    x, y = curve(left, "motion")
    for event, a, row in zip(sample.events, sample.a, y, strict=True):
        assert rows[int(row)] == event
        assert a in x
    squares = next(line for line in left.lines if line.get_marker() == "s")
    np.testing.assert_allclose(np.log(squares.get_xdata()), [means[event] for event in rows])
    (intervals,) = [item for item in left.collections if isinstance(item, LineCollection)]
    ends = np.log(np.array(intervals.get_segments())[:, :, 0])
    variance_within = np.mean([sample.log_a[sample.events == event].var(ddof=1) for event in rows])
    np.testing.assert_allclose(ends.mean(axis=1), [means[event] for event in rows])
    np.testing.assert_allclose(np.ptp(ends, axis=1), 2 * 1.96 * np.sqrt(variance_within / 4), rtol=1e-6)
    assert upright(left) == pytest.approx([np.exp(sample.log_a.mean()), 2e-4])
    assert upright(right) == pytest.approx([np.exp(sample.log_b.mean())])
    assert names(figure) == [("Ellipse parameter $a$ [-]", ""), ("Ellipse parameter $b$ [ms²]", "")]
    assert legend(figure) == ["motion", "mean of the earthquake, 95 %", "all motions", "criterion"]
    assert left.get_ylim() == (-0.7, 7.7)
    assert size(figure)[1] == pytest.approx(28.0 + 3.7 * 8)
    assert all(title.endswith(" % between earthquakes") for title in titles(figure))
    assert {place.get_xscale() for place in figure.axes} == {"log"}
    assert np.unique([text.get_fontsize() for text in left.get_yticklabels()]).size == 1


def test_names_of_many_earthquakes_are_small(sample):
    events = np.array([f"event {k:03d}" for k in range(56)])
    a, b = (np.resize(values, 56) * np.linspace(1.0, 1.1, 56) for values in (sample.a, sample.b))
    many = EllipseSample(
        a=np.append(a, a[::-1]), b=np.append(b, b[::-1]), events=np.tile(events, 2),
        motions=np.arange(112).astype(str), frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms",
    )  # fmt: skip
    figure = event_forest(many, limits=(1e-4, 1.0))
    assert size(figure)[1] == pytest.approx(205.0)
    assert {text.get_fontsize() for text in figure.axes[0].get_yticklabels()} == {5.0}
    subset = event_forest(sample, limits=(1e-4, 1.0))
    assert subset.axes[0].get_yticklabels()[0].get_fontsize() > 5.0


def test_surfaces_of_limits_are_labelled_with_their_levels():
    f, xi = np.geomspace(0.5, 4.0, 12), np.geomspace(0.01, 0.1, 9)
    amplitude = np.broadcast_to(f[:, None], (12, 9))
    delay = np.broadcast_to(100.0 * xi[None, :], (12, 9))
    nodes = (np.array([0.5, 0.51, 1.0, 4.0]), np.array([0.01, 0.05, 0.1]))
    figure = criterion_surfaces(f, xi, amplitude, delay, grid_nodes=nodes)
    left, right = figure.axes
    assert titles(figure) == [r"(a) amplitude error $\sqrt{a}$ [%]", r"(b) delay $\sqrt{b}$ [ms]"]
    assert names(figure) == [
        ("Natural frequency $f$ [Hz]", r"Damping ratio $\xi$ [-]"),
        ("Natural frequency $f$ [Hz]", ""),
    ]
    for place in figure.axes:
        assert (place.get_xscale(), place.get_yscale()) == ("log", "log")
        assert list(place.xaxis.get_majorticklocs()) == [0.5, 1.0, 4.0]
        assert list(place.yaxis.get_majorticklocs()) == [0.01, 0.05, 0.1]
        assert place.get_xlim() == pytest.approx((0.5, 4.0))
        assert place.get_ylim() == pytest.approx((0.01, 0.1))
        assert len(place.collections) == 2
        assert set(texts_of(place)) <= {f"{level:g}" for level in place.collections[1].levels}
    lines = left.collections[1]
    for value, path in zip(lines.levels, lines.get_paths(), strict=True):
        np.testing.assert_allclose(path.vertices[:, 0], value, rtol=2e-2)
    lines = right.collections[1]
    for value, path in zip(lines.levels, lines.get_paths(), strict=True):
        np.testing.assert_allclose(100.0 * path.vertices[:, 1], value, rtol=5e-2)
    assert left.collections[1].levels.max() < 4.0
    assert 2.0 in left.collections[1].levels
    assert np.asarray(left.collections[0].get_facecolor())[:, :3].min() > 0.55


def test_distributions_of_parameters_and_the_limits(sample):
    fits = {"lognormal": (Lognormal.fit(sample.a), Lognormal.fit(sample.b))}
    figure = parameter_distributions(sample, fits, limits=(2e-4, 1.5), confidence=0.95)
    assert titles(figure) == ["(a) amplitude", "(b) delay"]
    assert names(figure) == [
        ("Ellipse parameter $a$ [-]", "Probability density of $a$ [-]"),
        ("Ellipse parameter $b$ [ms²]", "Probability density of $b$ [1/ms²]"),
    ]
    assert set(legend(figure)) == {"motions", "lognormal", "criterion at 95 %"}
    for place, values, limit, fit in zip(
        figure.axes, (sample.a, sample.b), (2e-4, 1.5), fits["lognormal"], strict=True
    ):
        assert upright(place) == [limit]
        x, density = curve(place, "lognormal")
        np.testing.assert_allclose(density, np.exp(fit.log_density(x)))
        edges = [(row.get_x(), row.get_x() + row.get_width(), row.get_height()) for row in place.patches]
        for left, right, height in edges:
            share = np.mean((values >= left) & (values < right))
            assert height * (right - left) == pytest.approx(share, abs=1e-9)
        count_beyond = int((values > 1.15 * np.quantile(values, 0.97)).sum())
        assert texts_of(place) == ([f"{count_beyond} of 32 beyond"] if count_beyond else [])
        assert place.get_xlim() == pytest.approx((0.0, edges[-1][1]))
        iqr = np.subtract(*np.quantile(values, [0.75, 0.25]))
        assert edges[0][1] - edges[0][0] == pytest.approx(2.0 * iqr / 32 ** (1 / 3))


def test_quantiles_of_the_motions_over_those_of_a_distribution(sample):
    figure = quantile_quantile(sample)
    assert titles(figure) == ["(a) $a$", "(b) $b$"]
    assert names(figure) == [
        ("Lognormal quantile of $a$ [-]", "$a$ of motions [-]"),
        ("Lognormal quantile of $b$ [ms²]", "$b$ of motions [ms²]"),
    ]
    assert legend(figure) == ["95 % band", "as the distribution", "motions"]
    for place, values in zip(figure.axes, (sample.a, sample.b), strict=True):
        x, y = curve(place, "motions")
        np.testing.assert_allclose(y, np.sort(values))
        np.testing.assert_allclose(curve(place, "as the distribution"), (x, x))
        assert all(low < high for low, high in band(place, "95 % band").values())
        assert (place.get_xscale(), place.get_yscale()) == ("log", "log")


def test_correlation_of_the_panels(sample):
    figure = parameter_correlation(sample)
    linear, logarithmic = figure.axes
    assert titles(figure) == ["(a) linear", "(b) logarithmic"]
    assert set(names(figure)) == {("Ellipse parameter $a$ [-]", "Ellipse parameter $b$ [ms²]")}
    correlations = (
        np.corrcoef(sample.a, sample.b)[0, 1],
        np.corrcoef(np.log(sample.a), np.log(sample.b))[0, 1],
    )
    assert texts_of(linear) == [f"correlation {correlations[0]:.3f}"]
    assert texts_of(logarithmic) == [f"correlation of the logarithms {correlations[1]:.3f}"]
    for place in figure.axes:
        np.testing.assert_allclose(curve(place, "one motion"), (sample.a, sample.b))
    assert (logarithmic.get_xscale(), logarithmic.get_yscale()) == ("log", "log")
    assert linear.get_xlim() == pytest.approx((0.0, 1.05 * sample.a.max()))
    assert linear.get_ylim() == pytest.approx((0.0, 1.05 * sample.b.max()))
    slope, intercept = np.polyfit(sample.a, sample.b, 1)
    (line,) = [row for row in linear.lines if len(row.get_xdata()) == 100]
    np.testing.assert_allclose(line.get_ydata(), slope * line.get_xdata() + intercept)
    assert f"{abs(intercept):.2f} ms²" in legend(linear)[1]


def test_posterior_of_a_quantile_and_a_further_motion(sample):
    figure = posterior_and_predictive(sample, limits=(2e-4, 1.5), confidence=0.95)
    assert titles(figure) == [
        "(a) 5 % quantile of $a$", "(b) 5 % quantile of $b$",
        "(c) a further motion: $a$", "(d) a further motion: $b$",
    ]  # fmt: skip
    a, b = "Ellipse parameter $a$ [-]", "Ellipse parameter $b$ [ms²]"
    assert names(figure) == [(a, "Density [-]"), (b, ""), (a, "Share below [-]"), (b, "")]
    assert legend(figure) == ["motions", "predictive", "lognormal", "0.05", "criterion"]
    for k, (values, limit) in enumerate(((sample.a, 2e-4), (sample.b, 1.5))):
        upper, lower = figure.axes[k], figure.axes[2 + k]
        assert upright(upper) == [limit]
        assert level(lower) == pytest.approx([0.05])
        assert upright(lower) == [limit]
        x, shares = curve(lower, "predictive")
        assert np.all(np.diff(shares) >= 0.0)
        assert abs(np.interp(np.median(values), x, shares) - 0.5) < 0.15
        x, shares = curve(lower, "lognormal")
        assert np.log(np.interp(0.5, shares, x)) == pytest.approx(np.log(values).mean(), abs=1e-3)
        x, shares = curve(lower, "motions")
        np.testing.assert_allclose(x[1:], np.sort(values))
        density = upper.lines[0]
        place = np.log(density.get_xdata())
        assert np.trapezoid(density.get_ydata(), place) == pytest.approx(1.0, abs=0.01)
        low, high = upper.collections[1].get_segments()[0][:, 0]
        is_inside = (place >= np.log(low)) & (place <= np.log(high))
        assert np.trapezoid(density.get_ydata()[is_inside], place[is_inside]) == pytest.approx(0.95, abs=0.02)
        assert upper.get_ylim()[0] == 0.0
        ends = np.log([min(values.min(), limit), values.max()]) + 0.15 * np.ptp(np.log(values)) * np.array(
            [-1, 1]
        )
        assert np.log(lower.get_xlim()) == pytest.approx(ends)


def test_a_limit_of_nothing_is_not_drawn(sample):
    lower = posterior_and_predictive(sample, limits=(0.0, 0.0), confidence=0.95).axes[2]
    assert upright(lower) == []
    assert np.log(lower.get_xlim()[0]) == pytest.approx(
        np.log(sample.a.min()) - 0.15 * np.ptp(np.log(sample.a))
    )


@pytest.fixture(scope="module")
def windows():
    centre = np.arange(5.0)
    return Windows(
        centre=centre, amplitude=1.0 + 0.01 * centre, delay=1e-3 * centre,
        amplitude_sd=np.full(5, 1e-3), delay_sd=np.full(5, 1e-4), length=2.0,
    )  # fmt: skip


@pytest.mark.parametrize("delay", [2e-3, -2e-3])
def test_a_test_in_the_plane_of_amplitude_and_delay(windows, delay):
    random = np.random.default_rng(2)
    draws = np.stack([random.normal(0.99, 1e-3, 400), random.normal(delay, 1e-4, 400)])
    boundaries = {"$5 %": (4e-4, 9.0), "none": (0.0, 9.0), "neither": (4e-4, 0.0)}
    index = SimpleNamespace(amplitude=0.99, delay=delay, draws=draws)
    figure = tracking_overview(index, boundaries=boundaries, windows=windows)
    plane, upper, lower = figure.axes
    assert size(figure)[1] == pytest.approx(46.0)
    assert legend(figure) == [r"\$5 %", "test, 95 % intervals"]
    x, y = curve(plane, r"\$5 %")
    np.testing.assert_allclose((x / 100.0) ** 2 / 4e-4 + y**2 / 9.0, 1.0)
    assert np.sign(y[len(y) // 2]) == np.sign(delay)
    np.testing.assert_allclose(curve(plane, "test, 95 % intervals"), ([-1.0], [1e3 * delay]))
    cloud = next(line for line in plane.lines if line.get_marker() == ".")
    np.testing.assert_allclose(cloud.get_xydata().T, (100.0 * (draws[0] - 1.0), 1e3 * draws[1]))
    x_interval, up = bars(plane, "test, 95 % intervals")[:, 0]
    np.testing.assert_allclose(x_interval[:, 0], 100.0 * (np.quantile(draws[0], [0.025, 0.975]) - 1.0))
    np.testing.assert_allclose(up[:, 1], 1e3 * np.quantile(draws[1], [0.025, 0.975]))
    assert names(figure)[0] == ("Amplitude error $A - 1$ [%]", "Delay $d$ [ms]")
    assert (upper.get_ylabel(), lower.get_ylabel(), lower.get_xlabel()) == (
        "$A - 1$ [%]",
        "$d$ [ms]",
        "Time $t$ [s]",
    )
    for place, values, reach in ((upper, windows.centre, 0.2), (lower, windows.centre, 0.2)):
        (container,) = place.containers
        np.testing.assert_allclose(container.lines[0].get_xydata().T, (windows.centre, values))
        ends = np.array(container.lines[2][0].get_segments())[:, :, 1]
        np.testing.assert_allclose(ends - values[:, None], [[-reach, reach]] * 5, atol=1e-12)
        assert level(place) == [0.0]
    assert (level(plane), upright(plane)) == ([0.0], [0.0])
    assert not any(label.get_visible() for label in upper.get_xticklabels())
    assert upper.get_shared_x_axes().joined(upper, lower)
    assert plane.margins() == pytest.approx((0.12, 0.12))


def test_without_windows_the_plane_stands_alone():
    draws = np.array([[1.0, 1.01], [1e-3, 2e-3]])
    index = SimpleNamespace(amplitude=1.0, delay=1e-3, draws=draws)
    figure = tracking_overview(index, boundaries={"5 %": (1e-4, 1.0)}, windows=None)
    assert len(figure.axes) == 1


def test_the_error_of_a_test_and_its_parts_over_the_peak():
    times = np.arange(0.0, 10.0, 0.01)
    exact = 0.02 * np.sin(times)
    error = 1e-3 * np.cos(times)
    parts = {"$delay": np.array([1e-3, 2e-3]), "amplitude": np.array([2e-3, 1e-3])}
    figure = error_over_time(
        times=times, reference=exact, measured_values=exact + error, error=error,
        band=(error - 1e-4, error + 2e-4), parts=parts,
    )  # fmt: skip
    histories, errors, ratio = figure.axes
    peak = np.abs(exact).max()
    np.testing.assert_allclose(curve(histories, "exact $x_I$"), (times, exact / peak))
    np.testing.assert_allclose(curve(histories, "measured $x_m$"), (times, (exact + error) / peak))
    np.testing.assert_allclose(curve(errors, "$x_m - x_I$"), (times, 100.0 * error / peak))
    for x, (low, high) in band(errors, "90 % band").items():
        position = int(np.argmin(abs(times - x)))
        assert high - low == pytest.approx(100.0 * 3e-4 / peak)
        assert low == pytest.approx(100.0 * (error[position] - 1e-4) / peak)
    for steps, values in zip(ratio.patches, parts.values(), strict=True):
        np.testing.assert_allclose(steps.get_data().values, 100.0 * values / peak)
        np.testing.assert_allclose(steps.get_data().edges, np.linspace(times[0], times[-1], 3))
        assert steps.get_data().baseline is None
    assert [place.get_ylabel() for place in figure.axes] == [
        "Displacement\nover peak [-]", "Error\nover peak [%]", "RMS of parts\nover peak [%]"
    ]  # fmt: skip
    assert ratio.get_xlabel() == "Time $t$ [s]"
    assert [legend(place) for place in figure.axes] == [
        ["exact $x_I$", "measured $x_m$"], ["90 % band", "$x_m - x_I$"], [r"\$delay", "amplitude"]
    ]  # fmt: skip
    assert size(figure)[1] == pytest.approx(64.0)
    assert {place.get_xlim() for place in figure.axes} == {(times[0], times[-1])}


def test_a_long_test_is_drawn_by_some_thousand_points():
    times = np.arange(20000) / 100.0
    zero = np.sin(times)
    figure = error_over_time(
        times=times,
        reference=zero,
        measured_values=zero,
        error=zero,
        band=(zero, zero),
        parts={"all": np.ones(2)},
    )
    x, _ = curve(figure.axes[0], "exact $x_I$")
    assert (x.size, x[0], x[-1]) == (4000, times[0], times[-1])


def channel(noise, **changes):
    random = np.random.default_rng(4)
    original, updated = 3.0 * random.normal(size=7000), random.normal(size=7000)
    values = {
        "title": "specimen: $force",
        "label": "Residual [N]",
        "rate": 100.0,
        "before": original,
        "after": updated,
    }
    errors = {"before": 0.3, "after": 0.1} | ({} if noise is None else {"noise": 0.05})
    return discrepancy.GapPanel(**{**values, "noise": noise, "errors": errors, **changes})


def test_residual_of_each_channel():
    output = [channel(0.5), channel(None, title="second")]
    figure = discrepancy.discrepancy_gap(output)
    first, size_of_first, second, size_of_second = figure.axes
    assert size(figure)[1] == pytest.approx(2 * 37.0 + 12.0)
    assert titles(figure) == [r"specimen: \$force", "", "second", ""]
    assert names(figure) == [
        ("", "Residual [N]"), ("RMS over signal's RMS [%]", ""),
        ("Time $t$ [s]", "Residual [N]"), ("RMS over signal's RMS [%]", ""),
    ]  # fmt: skip
    for label in ("before", "after"):
        x, y = curve(first, label)
        np.testing.assert_allclose(y, getattr(output[0], label)[::2])
        np.testing.assert_allclose(x, np.arange(0, 7000, 2) / 100.0)
    assert level(first) == [-1.0, 1.0]
    assert level(second) == []
    assert legend(first) == ["before", "after", "± 2 RMS of noise"]
    assert second.findobj(Legend) == []
    peak = np.abs(output[0].before).max()
    assert first.get_ylim() == pytest.approx((-1.1 * peak, 1.7 * peak))
    for place, errors in ((size_of_first, (30.0, 10.0, 5.0)), (size_of_second, (30.0, 10.0))):
        assert [bar.get_width() for bar in place.patches] == pytest.approx(errors)
        assert texts_of(place) == ["30.0", "10.0", "5.00"][: len(errors)]
        assert [text.get_position() for text in place.texts] == [
            (pytest.approx(error + 0.02 * max(errors)), rank) for rank, error in enumerate(errors)
        ]
        assert place.get_xlim() == pytest.approx((0.0, 1.3 * errors[0]))
        assert place.get_xscale() == "linear"
        assert place.yaxis_inverted()
        assert [text.get_text() for text in place.get_yticklabels()] == ["before", "after", "noise"][
            : len(errors)
        ]


def test_the_loop_names_missing_and_unobserved_blocks():
    figure = discrepancy.discrepancy_blocks(
        lacking={Block.SPECIMEN: "dry $friction"}, observed=[Block.ACTUATOR]
    )
    (place,) = figure.axes
    boxes = place.patches
    texts = {text.get_text(): text for text in place.findobj(Text) if text.get_text()}
    assert {
        r"dry \$friction",
        "specimen",
        "actuator",
        "sensors",
        "numerical substructure",
        "excitation",
    } <= set(texts)
    assert {"missing effect", "observed, no missing effect", "not observed"} <= set(texts)
    assert {"$a_g$", "$x_c$", "$x$", "$r$"} <= set(texts)
    looks = [(box.get_edgecolor(), box.get_linestyle()) for box in boxes if box.get_zorder() == 2.0]
    assert len(looks) == 5
    assert len(set(looks)) == 3
    key = [(box.get_edgecolor(), box.get_linestyle()) for box in boxes if box.get_zorder() != 2.0]
    assert len(key) == 3
    axes_by_place = {
        name: min(
            (box for box in boxes if box.get_zorder() == 2.0),
            key=lambda box: np.hypot(
                *(np.array(box.get_path().vertices).mean(axis=0) - texts[name].get_position())
            ),
        )
        for name in ("specimen", "actuator", "sensors")
    }
    assert [
        (axes_by_place[name].get_edgecolor(), axes_by_place[name].get_linestyle())
        for name in ("specimen", "actuator", "sensors")
    ] == key
    assert texts["specimen"].get_position()[1] > texts[r"dry \$friction"].get_position()[1]
    assert texts["sensors"].get_position()[1] == pytest.approx(1.6)
    assert not place.axison
    assert len(place.lines) == 5


def test_measured_history_stands_above_both_residuals():
    time = np.arange(7000) / 100.0
    values = {name: np.sin(time + k) for k, name in enumerate(("driven", "measured", "before", "after"))}
    labels = {"input_label": "command [mm]", "label": "force [N]", "residual_label": "Residual [N]"}
    figure = discrepancy.discrepancy_histories(discrepancy.ModelledHistory(time=time, **values, **labels))
    upper, middle, lower, last = figure.axes
    assert legend(figure) == ["measured", "residual before", "after"]
    for x, measured, left in ((time, upper, lower), (values["driven"], middle, last)):
        np.testing.assert_allclose(curve(measured, "measured"), (x[::2], values["measured"][::2]))
        np.testing.assert_allclose(curve(left, "residual before"), (x[::2], values["before"][::2]))
        np.testing.assert_allclose(curve(left, "after"), (x[::2], values["after"][::2]))
    assert names(figure) == [("", "force [N]"), ("", ""), ("Time [s]", "Residual [N]"), ("command [mm]", "")]
    assert not any(label.get_visible() for place in (upper, middle) for label in place.get_xticklabels())


def test_densities_and_contours_of_a_posterior():
    draws = np.random.default_rng(3).normal([5.0, -3.0], size=(4000, 2))
    figure = discrepancy.discrepancy_posterior(["stiffness [N/m]", "damping $c [N s/m]"], draws)
    first, hidden, pair, second = figure.axes
    assert not hidden.axison
    ends = np.quantile(draws, [0.05, 0.95], axis=0)
    assert upright(first) == pytest.approx(list(ends[:, 0]))
    assert upright(second) == pytest.approx(list(ends[:, 1]))
    np.testing.assert_allclose(pair.lines[0].get_xydata(), draws[::4])
    assert first.get_title("left") == "stiffness [N/m]"
    assert second.get_title("right") == r"damping \$c [N s/m]"
    levels = pair.collections[-1].levels
    counts, *_ = np.histogram2d(*draws.T, bins=15)
    for result, share in zip(levels, (0.9, 0.5), strict=True):
        assert counts[counts >= result].sum() >= share * 4000
        assert counts[counts > result].sum() <= share * 4000
    contours = np.concatenate([path.vertices for path in pair.collections[-1].get_paths()])
    np.testing.assert_allclose(contours.mean(axis=0), [5.0, -3.0], atol=0.5)
    assert size(figure) == pytest.approx((92.0, 92.0))
    area = sum(np.diff(path[:, 0]) @ (path[:-1, 1]) for path in [first.patches[0].get_path().vertices])
    assert abs(area) == pytest.approx(1.0, abs=0.05)
    assert all(list(place.get_yticks()) == [] for place in (first, second))


def test_residuals_over_the_state_of_the_specimen():
    random = np.random.default_rng(6)
    displacement, velocity = random.uniform(-0.01, 0.01, 40000), random.uniform(-0.1, 0.1, 40000)
    original, updated = 1e3 * displacement, 50.0 * velocity
    figure = discrepancy.discrepancy_state_plane(
        displacement, velocity, original, updated, unit="N", factor=2.0
    )
    left, right, bar = figure.axes
    assert titles(figure)[:2] == ["(a) calibrated model", "(b) with the effects"]
    assert names(figure)[:2] == [("Displacement [mm]", "Velocity [mm/s]"), ("Displacement [mm]", "")]
    assert bar.get_ylabel() == "Mean residual [N]"
    x, y = (np.quantile(np.abs(values), 0.995) * 1e3 for values in (displacement, velocity))
    path_points = np.linspace(-x, x, 26)[:-1] + x / 25.0
    up = np.linspace(-y, y, 26)[:-1] + y / 25.0
    for place, values in (
        (left, np.tile(2.0 * path_points, (25, 1))),
        (right, np.tile(0.1 * up[:, None], (1, 25))),
    ):
        (image,) = place.images
        np.testing.assert_allclose(image.get_array(), values, atol=0.4)
        assert image.get_extent() == pytest.approx([-x, x, -y, y])
        assert image.origin == "lower"
        assert image.get_clim() == pytest.approx((-19.0, 19.0), rel=0.04)
    sparse = discrepancy.discrepancy_state_plane(
        displacement[:500], velocity[:500], original[:500], updated[:500], unit="N"
    )
    assert np.isnan(np.ma.filled(sparse.axes[0].images[0].get_array().astype(float), np.nan)).mean() > 0.8


def test_power_of_a_residual_over_the_noise():
    rate, n = 200.0, 24000
    time = np.arange(n) / rate
    noise = np.random.default_rng(7).normal(size=n)
    tone = 2.0 * np.sin(2.0 * np.pi * 20.0 * time) * (time > 60.0)
    figure = discrepancy.discrepancy_time_frequency(
        noise + tone, noise, density=np.full(65, 1.0), rate=rate, highest=40.0
    )
    left, right, bar = figure.axes
    assert titles(figure)[:2] == ["(a) calibrated model", "(b) with the effects"]
    assert names(figure)[:2] == [("Time $t$ [s]", "Frequency [Hz]"), ("Time $t$ [s]", "")]
    assert bar.get_ylabel() == "Residual over noise [dB]"
    quiet = np.asarray(right.collections[0].get_array())
    assert 10.0 * np.log10(np.mean(10.0 ** (quiet / 10.0))) == pytest.approx(0.0, abs=0.3)
    loud = np.asarray(left.collections[0].get_array()) - quiet
    rows = np.linspace(0.0, 40.0, loud.shape[0])
    row, late = int(np.argmin(abs(rows - 20.0))), loud.shape[1] * 3 // 4
    reference = 10.0 * np.log10(2.0**2 / 4.0 * (np.hanning(1001).sum() ** 2 / (np.hanning(1001) ** 2).sum()))
    assert np.asarray(left.collections[0].get_array())[row, late] == pytest.approx(reference, abs=1.0)
    assert abs(loud[row, : loud.shape[1] // 3]).max() < 1.0
    assert left.get_ylim() == pytest.approx((0.0, 40.0), abs=0.2)
    assert left.get_xlim() == pytest.approx((0.0, 120.0), abs=1.0)
    assert left.collections[0].get_clim() == (-10.0, 40.0)


def test_pairs_and_courses_of_a_posterior():
    draws = np.random.default_rng(1).normal([0.0, 10.0, 20.0], size=(2, 60, 4, 3))
    posterior = PosteriorSample(names=("mean", "spread", "third"), draws=draws, thin=1, accepted=0.3)
    figure = pairs(posterior, ("spread", "mean"))
    cells = [place for place in figure.axes if place.lines]
    assert [(place.get_xlabel(), place.get_ylabel()) for place in cells] == [
        ("", ""),
        ("spread [-]", "mean [-]"),
        ("mean [-]", ""),
    ]
    x, y = cells[1].lines[0].get_xydata().T
    assert (round(x.mean()), round(y.mean())) == (10, 0)
    assert size(figure)[1] < 160.0
    course = traces(posterior, ("third", "spread"))
    assert names(course) == [
        ("", "Density [-]"), ("", "Value [-]"),
        ("Value [-]", "Density [-]"), ("Draw of the ensemble [-]", "Value [-]"),
    ]  # fmt: skip
    for place, mean in ((course.axes[1], 20), (course.axes[3], 10)):
        assert all(round(line.get_ydata().mean()) == mean for line in place.lines)
        assert all(list(line.get_xdata()) == list(range(240)) for line in place.lines)
    assert course.axes[0].get_yticks().size == 0
    panels_of_ranks = ranks(posterior)
    assert [place.get_ylabel() for place in panels_of_ranks.axes] == ["Draws over expected [-]", "", ""]
    for place in panels_of_ranks.axes:
        assert place.get_xlabel() == "Rank among all draws [-]"
        assert level(place) == [1.0]
        assert all(steps.get_data().edges[-1] == 480 for steps in place.patches)


def test_an_ellipse_is_drawn_by_its_upper_half():
    x, y = ellipse_line(4e-4, 9.0)
    np.testing.assert_allclose((x - 1.0) ** 2 / 4e-4 + y**2 / 9.0, 1.0)
    assert (y.min() > -1e-12, x[0] > 1.0, x.shape) == (True, True, (121,))
    sizes = np.array([[1.0, 4.0, 9.0], [2.0, 3.0, 5.0]])
    x, y = ellipse_line(1e-4 * sizes, sizes, points=7)
    assert x.shape == y.shape == (7, 2, 3)
    np.testing.assert_allclose(((x - 1.0) ** 2 / 1e-4 + y**2) / sizes, 1.0)


def test_every_figure_of_this_page_can_be_drawn(windows):
    draws = np.array([[1.0, 1.01], [1e-3, 2e-3]])
    index = SimpleNamespace(amplitude=1.0, delay=1e-3, draws=draws)
    figure = tracking_overview(index, boundaries={}, windows=windows)
    assert svg(figure).startswith(b"<?xml")
