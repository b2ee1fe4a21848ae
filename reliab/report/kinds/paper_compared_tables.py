"""Numbers of the paper's tables beside what was found."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr

from reliab.criterion.laws import OF_MANY_MOTIONS
from reliab.report.kinds.comparison import NAN, Comparison
from reliab.report.kinds.paper_fits import PaperFits
from reliab.report.printed import PrintedTables

_PERCENT, _MILLI = 100.0, 1e3
_E4, _E5 = 1e4, 1e5
_CLOSE = 0.10


def compare_table_1(fits: PaperFits) -> Iterator[Comparison]:
    """Compare the curves fitted to the contour."""
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


def compare_table_2(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    """Compare the ellipses of all motions, in sum."""
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


def compare_table_3(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    """Compare the limits by frequency."""
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


def compare_table_4(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    """Compare the parameters by damping ratio."""
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


def compare_tables_5_6(cases: xr.Dataset, printed: PrintedTables) -> Iterator[Comparison]:
    """Compare the four cases."""
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
