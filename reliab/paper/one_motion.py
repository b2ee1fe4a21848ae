"""KOBE/NIS000 alone: Tables 1 and 4, equations (11), (14), (16) and (17)."""

from collections.abc import Iterator

import numpy as np

from reliab.paper.fits import exponential, proportional
from reliab.paper.item import AuditItem
from reliab.paper.printed import ONE_HERTZ, ONE_MOTION, TWO_PERCENT, Printed, Recomputed

_TABLE_1 = {
    ("ellipse", "a"): (1.3e-4, "1"),
    ("ellipse", "b"): (2.3, "ms2"),
    ("ellipse", "error"): (0.12, "ms4"),
    ("cosine", "a"): (1.6, "ms"),
    ("cosine", "b"): (118.5, "1"),
    ("cosine", "error"): (0.65, "ms4"),
    ("parabola", "a"): (-1.0e4, "ms"),
    ("parabola", "b"): (1.6, "ms"),
    ("parabola", "error"): (0.42, "ms4"),
}


def table_1(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Curve fits, of which the ellipse stands in Table 2 too; and equation (11), which repeats them."""
    for (curve, parameter), (number, unit) in _TABLE_1.items():
        own = curve == "ellipse"
        known = own and parameter != "error"
        yield AuditItem(
            item="Table 1",
            quantity=f"{curve}: {parameter}",
            printed=number,
            from_tables=printed.of_table_2(parameter) if own else float("nan"),
            from_records=(
                records.of_motion(parameter, ONE_MOTION, ONE_HERTZ, TWO_PERCENT) if known else float("nan")
            ),
            unit=unit,
        )
    for parameter, number, unit in (("a", 1.3e-4, "1"), ("b", 2.3, "ms2")):
        yield AuditItem(
            item="Equation (11)",
            quantity=parameter,
            printed=number,
            from_tables=printed.of_table_2(parameter),
            from_records=records.of_motion(parameter, ONE_MOTION, ONE_HERTZ, TWO_PERCENT),
            unit=unit,
        )


def equation_14(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Figure 14 and equation (14): least a and an exponential b over the frequencies of Table 3."""
    frequencies = printed.table3["f_hz"].to_numpy()
    a, b = (
        np.array([records.of_motion(each, ONE_MOTION, f, TWO_PERCENT) for f in frequencies.tolist()])
        for each in "ab"
    )
    known = bool(np.isfinite(b).all())
    k1, k2 = exponential(frequencies, b) if known else (float("nan"), float("nan"))
    for item, quantity, number, found, unit in (
        ("Figure 14", "least a", 5.8e-5, a.min(), "1"),
        ("Figure 14", "greatest a", 7e-4, a.max(), "1"),
        ("Figure 14", "least b", 0.8, b.min(), "ms2"),
        ("Figure 14", "greatest b", 40.4, b.max(), "ms2"),
        ("Equation (14)", "a", 5.8e-5, a.min(), "1"),
        ("Equation (14)", "k1", 97.0, k1, "ms2"),
        ("Equation (14)", "k2", 3.4, k2, "s"),
    ):
        yield AuditItem(item=item, quantity=quantity, printed=number, from_records=float(found), unit=unit)


def table_4(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Both columns of Table 4 over damping; the second is the root of b."""
    for xi, a, b in printed.table4[["xi", "a", "b"]].itertuples(index=False):
        of_a, of_b = (records.of_motion(each, ONE_MOTION, ONE_HERTZ, xi) for each in "ab")
        yield AuditItem(item="Table 4", quantity=f"a at ξ = {xi:g}", printed=a, from_records=of_a)
        yield AuditItem(
            item="Table 4",
            quantity=f"b at ξ = {xi:g}",
            printed=b,
            from_records=float(np.sqrt(of_b)),
            unit="ms",
            erratum="√b printed as b",
        )


def equations_16_17(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Slopes of Table 4, and what a straight line makes of a and b at 2 %."""
    table = printed.table4
    slopes = {each: proportional(table["xi"], table[each]) for each in "ab"}
    for equation in ("Equation (16)", "Equation (17)"):
        yield AuditItem(item=equation, quantity="k3", printed=0.046, from_tables=slopes["a"])
        yield AuditItem(
            item=equation,
            quantity="k4",
            printed=100.0,
            from_tables=slopes["b"],
            unit="ms2",
            erratum="the slope of √b [ms] printed as that of b; b grows with ξ²",
        )
    for parameter, line, unit in (("a", 0.046, "1"), ("b", 100.0, "ms2")):
        yield AuditItem(
            item="Equation (17)",
            quantity=f"{parameter} at ξ = 0.02",
            printed=line * TWO_PERCENT,
            from_tables=printed.of_table_2(parameter),
            from_records=records.of_motion(parameter, ONE_MOTION, ONE_HERTZ, TWO_PERCENT),
            unit=unit,
            erratum=(
                "the straight line through zero misses the first row of Table 4: a grows with ξ²"
                if parameter == "a"
                else "agrees only because √b and b of this motion are both near 2 at ξ = 0.02"
            ),
        )
