"""Every table, figure and numbered equation of the paper: printed, reproduced, difference."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
import xarray as xr

from reliab.criterion.distributions import Lognormal
from reliab.criterion.laws import OF_MANY_MOTIONS
from reliab.report.kinds.paper_fits import SHARE, PaperFits, exponential, proportional
from reliab.report.printed import PrintedTables

_PERCENT, _MILLI = 100.0, 1e3
_E4, _E5 = 1e4, 1e5
_CLOSE = 0.10
NAN: Final = float("nan")


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One number of the paper, or one thing that has none.

    Parameters
    ----------
    item : str
        Table, figure or equation.
    quantity : str
        What is compared.
    unit : str, optional
        Its unit.
    printed, reproduced : float, optional
        Both numbers in that unit; NaN where there is none.
    remark : str, optional
        What to know.
    """

    item: str
    quantity: str
    unit: str = ""
    printed: float = NAN
    reproduced: float = NAN
    remark: str = ""


def comparisons(fits: PaperFits, cases: xr.Dataset, printed: PrintedTables) -> pd.DataFrame:
    """Compare all numbers that the paper prints with what was found.

    Parameters
    ----------
    fits : PaperFits
        The paper's steps on simulated ellipses.
    cases : xarray.Dataset
        As :func:`reliab.report.kinds.paper_cases.cases_dataset` makes it.
    printed : PrintedTables
        The printed tables.

    Returns
    -------
    pandas.DataFrame
        Columns item, quantity, unit, printed, reproduced, difference (reproduced over printed minus
        one [-]) and remark; tables, figures and equations in the order of their numbers.
    """
    found = [
        *_table_1(fits),
        *_table_2(fits, printed),
        *_table_3(fits, printed),
        *_table_4(fits, printed),
        *_tables_5_6(cases, printed),
        *_figures(fits, cases, printed),
        *_equations(fits, cases, printed),
    ]
    frame = pd.DataFrame([vars(each) for each in sorted(found, key=_place)])
    return frame.assign(difference=frame["reproduced"] / frame["printed"] - 1.0)


def _place(comparison: Comparison) -> tuple[int, int]:
    """Place of an item: tables, figures, equations, each by number; letters keep their order."""
    kind, number = comparison.item.split()
    return ("Table", "Figure", "Equation").index(kind), int("".join(filter(str.isdigit, number)))


def _table_1(fits: PaperFits) -> Iterator[Comparison]:
    ellipse, cosine, parabola = fits.curves
    rows = (
        ("ellipse", ellipse, _E4, "10⁻⁴", (1.3, 2.3, 0.12)),
        ("cosine", cosine, 1.0, "ms", (1.6, 118.5, 0.65)),
        ("parabola", parabola, 1e-4, "10⁴ ms", (-1.0, 1.6, 0.42)),
    )
    units_of_b = {"ellipse": "ms²", "cosine": "rad", "parabola": "ms"}
    for name, curve, factor, unit, (a, b, error) in rows:
        yield Comparison(
            item="Table 1", quantity=f"{name}: a", unit=unit, printed=a, reproduced=factor * curve.a
        )
        yield Comparison(
            item="Table 1", quantity=f"{name}: b", unit=units_of_b[name], printed=b, reproduced=curve.b
        )
        yield Comparison(
            item="Table 1",
            quantity=f"{name}: error",
            unit="ms⁴",
            printed=error,
            reproduced=curve.sse,
            remark=f"{curve.n} points; the paper has 25" if curve is ellipse else "",
        )


def _table_2(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    table = table_2(fits, printed)
    for name in ("a", "b"):
        yield Comparison(
            item="Table 2",
            quantity=f"median ratio of {name}",
            unit="-",
            printed=1.0,
            reproduced=float(table[f"ratio_{name}"].median()),
            remark="simulated over printed; rows in the appendix",
        )
    close = (np.abs(table[["ratio_a", "ratio_b"]] - 1.0) <= _CLOSE).all(axis=1)
    yield Comparison(
        item="Table 2",
        quantity="rows within 10 % in a and b",
        unit="-",
        printed=float(len(table)),
        reproduced=float(close.sum()),
        remark="the caption says MTEᴿ, the numbers are RMSᴿ",
    )


def table_2(fits: PaperFits, printed: PrintedTables) -> pd.DataFrame:
    """Table 2 row by row.

    Parameters
    ----------
    fits : PaperFits
        The paper's steps.
    printed : PrintedTables
        The printed tables.

    Returns
    -------
    pandas.DataFrame
        Columns no, record, a_printed, a, ratio_a, b_printed, b, ratio_b; NaN where a motion is missing.
    """
    sample = fits.sample
    found = pd.DataFrame({"record": sample.motions, "a": sample.a, "b": sample.b})
    table = printed.motions.rename(columns={"a": "a_printed", "b": "b_printed"}).drop(columns="error")
    merged = table.merge(found, on="record", how="left")
    return merged.assign(ratio_a=merged["a"] / merged["a_printed"], ratio_b=merged["b"] / merged["b_printed"])


def _table_3(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    a, b = fits.guaranteed
    for row in printed.frequencies.to_dict("records"):
        at = np.flatnonzero(np.isclose(fits.frequencies, row["f_hz"]))
        for name, values, unit, factor in (("a", a, "10⁻⁵", _E5), ("b", b, "ms²", 1.0)):
            yield Comparison(
                item="Table 3",
                quantity=f"{name} at {row['f_hz']:g} Hz",
                unit=unit,
                printed=factor * row[name],
                reproduced=factor * float(values[at[0]]) if at.size else NAN,
            )


def _table_4(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    a, root_b = fits.of_example("a", "xi"), np.sqrt(fits.of_example("b", "xi"))
    damping = printed.damping_ratios["xi"].to_numpy()
    for row in printed.damping_ratios.to_dict("records"):
        at = np.flatnonzero(np.isclose(fits.damping_ratios, row["xi"]))
        for name, values, unit, factor in (("a", a, "10⁻⁴", _E4), ("b", root_b, "ms", 1.0)):
            yield Comparison(
                item="Table 4",
                quantity=f"{'a' if name == 'a' else '√b'} at ξ = {row['xi']:g}",
                unit=unit,
                printed=factor * row[name],
                reproduced=factor * float(values[at[0]]) if at.size else NAN,
                remark="printed as b" if name == "b" and row["xi"] == damping[0] else "",
            )


def _tables_5_6(cases: xr.Dataset, printed: PrintedTables) -> Iterator[Comparison]:
    masses = (0.09, 0.25, 0.09, 0.09)  # Table 5, column m
    for case, mass in zip(cases["case"].values.tolist(), masses, strict=False):
        reproduced = float(cases["mass"].sel(case=case))
        yield Comparison(
            item="Table 5", quantity=f"case {case}: m", unit="kg", printed=mass, reproduced=reproduced
        )
    law = OF_MANY_MOTIONS["guo_2017_18"]
    for row in printed.cases.to_dict("records"):
        if row["case"] not in cases["case"]:
            continue
        found = cases.sel(case=row["case"])
        a, b = law.limits(float(found["f"]), float(found["xi"]))
        index = (float(found["A"]) - 1.0) ** 2 / float(a) + (_MILLI * float(found["d"])) ** 2 / float(b)
        for name, unit, value, reproduced in (
            ("A − 1", "10⁻³", _MILLI * (row["A"] - 1.0), _MILLI * (float(found["A"]) - 1.0)),
            ("d", "ms", row["d_ms"], _MILLI * float(found["d"])),
            ("index of (18)", "-", row["index_eq18"], index),
            ("RMSᴿ", "%", row["rms_percent"], _PERCENT * float(found["rms"])),
        ):
            yield Comparison(
                item="Table 6",
                quantity=f"case {row['case']}: {name}",
                unit=unit,
                printed=value,
                reproduced=reproduced,
            )


def _figures(fits: PaperFits, cases: xr.Dataset, printed: PrintedTables) -> Iterator[Comparison]:
    yield Comparison(item="Figure 1", quantity="block diagram", remark="drawn; the loop of equation (6)")
    yield from _figures_of_histories(fits.example)
    yield from _figures_of_errors(fits)
    yield from _figures_of_motions(fits, printed)
    yield from _figures_over_structure(fits)
    yield Comparison(item="Figure 16", quantity="frame with spring", remark="drawn")
    for case in cases["case"].values.tolist():
        peaks = [float(abs(cases[name].sel(case=case)).max()) for name in ("ideal", "measured")]
        yield Comparison(
            item="Figure 17",
            quantity=f"case {case}: measured over exact peak",
            unit="-",
            reproduced=peaks[1] / peaks[0],
            remark="drawn",
        )


def _figures_of_histories(example: xr.Dataset) -> Iterator[Comparison]:
    moved = _MILLI * abs(example["displacement"])
    strong, late = moved.sel(time=slice(14.0, 30.0)), moved.sel(time=slice(39.0, 41.0))
    errors = example["error_of_gain"].sel(gain=0.99, method="nearest")
    yield Comparison(
        item="Figure 2",
        quantity="displacement, 14 to 30 s",
        unit="mm",
        printed=50.0,
        reproduced=float(strong.isel(test=0).max()),
        remark="from the text",
    )
    yield Comparison(
        item="Figure 3",
        quantity="displacement at 40 s, delay 5 ms",
        unit="mm",
        printed=50.0,
        reproduced=float(late.isel(test=1).max()),
        remark="from the text",
    )
    yield Comparison(
        item="Figure 5",
        quantity="RMSᴿ at an amplitude of 0.99",
        unit="%",
        printed=4.2,
        reproduced=_PERCENT * float(errors.sel(metric="rms")),
        remark="“almost exactly the same”",
    )
    yield Comparison(
        item="Figure 7",
        quantity="peak over that of Figure 2",
        unit="-",
        printed=1.1,
        reproduced=float(moved.isel(test=3).max() / moved.isel(test=0).max()),
        remark="from the text",
    )


def _figures_of_errors(fits: PaperFits) -> Iterator[Comparison]:
    example = fits.example
    critical = _MILLI * float(example.attrs["critical_delay"])
    yield Comparison(item="Figure 4", quantity="critical delay", unit="ms", printed=6.4, reproduced=critical)
    at_limit = example["error_of_delay"].sel(long_delay=6.4e-3, method="nearest")
    below = example["error_of_gain"].sel(gain=0.99, method="nearest")
    for name, metric, unstable, accurate in (("MTEᴿ", "mte", 280.0, 9.2), ("RMSᴿ", "rms", 96.0, 4.2)):
        yield Comparison(
            item="Figure 4",
            quantity=f"{name} at 6.4 ms",
            unit="%",
            printed=unstable,
            reproduced=_PERCENT * float(at_limit.sel(metric=metric)),
            remark="the exact loop gives less",
        )
        yield Comparison(
            item="Figure 6",
            quantity=f"{name} at an amplitude of 0.99",
            unit="%",
            printed=accurate,
            reproduced=_PERCENT * float(below.sel(metric=metric)),
        )
    yield Comparison(
        item="Figure 8",
        quantity="simulations",
        unit="-",
        printed=800.0,
        reproduced=float(example["error"].isel(metric=0).size),
        remark="41 amplitudes × 21 delays",
    )
    yield Comparison(
        item="Figure 9",
        quantity="delay at 5 %, MTEᴿ over RMSᴿ",
        unit="-",
        reproduced=float(example["delay_mte"].max() / example["delay_rms"].max()),
        remark="MTEᴿ is the more stringent",
    )
    yield Comparison(
        item="Figure 10",
        quantity="least fitting error",
        remark=f"{min(fits.curves, key=lambda curve: curve.sse).name}, as in the paper",
    )


def _figures_of_motions(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    sample, table = fits.sample, printed.motions
    remark = f"printed Table 2 gives {np.corrcoef(table['a'], table['b'])[0, 1]:.4f}"
    yield Comparison(
        item="Figure 11",
        quantity="correlation of a and b",
        unit="-",
        printed=0.9774,
        reproduced=sample.correlation,
        remark=remark,
    )
    yield Comparison(
        item="Figure 11",
        quantity="b over a, slope of the line",
        unit="10⁴ ms²",
        printed=1.65,
        reproduced=float(np.polyfit(sample.a, sample.b, 1)[0]) / _E4,
    )
    for name, value, unit, factor in (("a", 5.3, "10⁻⁵", _E5), ("b", 1.04, "ms²", 1.0)):
        as_printed = factor * float(Lognormal.fit(table[name]).quantile(SHARE))
        yield Comparison(
            item="Figure 12",
            quantity=f"5 % quantile of {name}",
            unit=unit,
            printed=value,
            reproduced=factor * float(Lognormal.fit(getattr(sample, name)).quantile(SHARE)),
            remark=f"printed Table 2 gives {as_printed:.3g}",
        )
    law = OF_MANY_MOTIONS["guo_2017_12"]
    a, b = law.limits(sample.frequency, sample.damping_ratio)
    contained = (sample.a >= a) & (sample.b >= b)
    yield Comparison(
        item="Figure 13",
        quantity="motions that contain (12)",
        unit="%",
        printed=95.0,
        reproduced=_PERCENT * float(contained.mean()),
    )


def _figures_over_structure(fits: PaperFits) -> Iterator[Comparison]:
    a, b = fits.of_example("a", "f"), fits.of_example("b", "f")
    yield Comparison(
        item="Figure 14", quantity="least a", unit="10⁻⁵", printed=5.8, reproduced=_E5 * float(a.min())
    )
    yield Comparison(
        item="Figure 14", quantity="greatest a", unit="10⁻⁴", printed=7.0, reproduced=_E4 * float(a.max())
    )
    yield Comparison(
        item="Figure 14", quantity="greatest b", unit="ms²", printed=40.4, reproduced=float(b.max())
    )
    yield Comparison(item="Figure 14", quantity="least b", unit="ms²", printed=0.8, reproduced=float(b.min()))
    yield Comparison(
        item="Figure 15",
        quantity="5 % quantile of a, pooled",
        unit="10⁻⁵",
        printed=5.6,
        reproduced=_E5 * fits.pooled_a,
    )


def _equations(fits: PaperFits, cases: xr.Dataset, printed: PrintedTables) -> Iterator[Comparison]:
    definitions = {
        "Equation (1)": "weights w",
        "Equation (2)": "FEI",
        "Equation (3a)": "amplitude A",
        "Equation (3b)": "phase φ",
        "Equation (4)": "equivalent frequency",
        "Equation (5)": "equivalent delay d",
    }
    error = float(abs(cases["A"] - cases["gain"]).max())
    for item, quantity in definitions.items():
        remark = f"used; within {error:.1g} of the gains of Table 5" if item == "Equation (3a)" else "used"
        yield Comparison(item=item, quantity=quantity, remark=remark)
    yield Comparison(item="Equation (6)", quantity="the loop", remark="used")
    for letter, curve in zip("abc", fits.curves, strict=True):
        yield Comparison(item=f"Equation (7{letter})", quantity=curve.name, remark="see Table 1")
    yield Comparison(item="Equation (8)", quantity="ellipse solved for d", remark="b′² should be b′")
    yield Comparison(item="Equation (9)", quantity="straight line of the fit", remark="used")
    yield Comparison(item="Equation (10)", quantity="fitting error", remark="see Table 1")
    yield from _fitted_equations(fits, printed)


def _fitted_equations(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    ellipse, (k1_example, k2_example), (k1, k2) = (
        fits.curves[0],
        fits.exponential_of_example,
        fits.exponential_guaranteed,
    )
    a_12, b_12 = (float(Lognormal.fit(values).quantile(SHARE)) for values in (fits.sample.a, fits.sample.b))
    table = printed.frequencies
    again = exponential(table["f_hz"].to_numpy(), table["b"].to_numpy())
    from_table = [f"printed Table 3 gives {value:.4g}" for value in again]
    at_2_hz = f"at 2 Hz {again[0] * np.exp(-2.0 * again[1]):.1g} ms² where Table 3 has 0.33"
    (k3, k4), (factor_a, factor_b) = fits.linear_in_damping, fits.combined
    damping = printed.damping_ratios
    k3_table = proportional(damping["xi"].to_numpy(), damping["a"].to_numpy())
    k4_table = proportional(damping["xi"].to_numpy(), damping["b"].to_numpy())
    quadratic = "a and b grow as ξ²"
    rows = (
        ("(11)", "a", "10⁻⁴", 1.3, _E4 * ellipse.a, ""),
        ("(11)", "b", "ms²", 2.3, ellipse.b, ""),
        ("(12)", "a", "10⁻⁵", 5.3, _E5 * a_12, ""),
        ("(12)", "b", "ms²", 1.04, b_12, ""),
        ("(13)", "exponential of f", "", NAN, NAN, at_2_hz),
        (
            "(14)",
            "a",
            "10⁻⁵",
            5.8,
            _E5 * float(fits.of_example("a", "f").min()),
            "least over the frequencies",
        ),
        ("(14)", "k₁", "ms²", 97.0, k1_example, ""),
        ("(14)", "k₂", "1/Hz", 3.4, k2_example, ""),
        ("(15)", "a", "10⁻⁵", 5.6, _E5 * fits.pooled_a, ""),
        ("(15)", "k₁", "ms²", 121.6, k1, from_table[0]),
        ("(15)", "k₂", "1/Hz", 6.6, k2, from_table[1]),
        ("(16a)", "k₃", "-", 0.046, k3, f"printed Table 4 gives {k3_table:.3g}; {quadratic}"),
        ("(16b)", "k₄", "ms", 100.0, k4, f"printed Table 4 gives {k4_table:.0f}; {quadratic}"),
        ("(17)", "a at ξ = 0.02", "10⁻⁴", _E4 * 0.046 * 0.02, _E4 * k3 * 0.02, "from (16a)"),
        ("(17)", "b at ξ = 0.02", "ms²", 2.0, k4 * 0.02, "from (16b)"),
        (
            "(18)",
            "factor of ξ in a",
            "-",
            0.021,
            factor_a,
            f"at ξ = 0.02 it is {0.021 * 0.02 / 5.6e-5:.1f} times a of (15)",
        ),
        (
            "(18)",
            "factor of ξ in b",
            "ms²",
            6080.0,
            factor_b,
            "from (11), (15) and (17) as in the text",
        ),
    )
    for number, quantity, unit, value, reproduced, remark in rows:
        yield Comparison(
            item=f"Equation {number}",
            quantity=quantity,
            unit=unit,
            printed=value,
            reproduced=reproduced,
            remark=remark,
        )
