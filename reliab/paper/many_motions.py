"""A hundred motions: Tables 2 and 3, Figures 11 and 12, equations (12) and (15)."""

from collections.abc import Iterator

import numpy as np
from scipy.stats import gmean, shapiro

from reliab.criterion.goodness_of_fit import SIGNIFICANCE
from reliab.paper.fits import exponential, quantile
from reliab.paper.item import CLOSE, AuditItem
from reliab.paper.printed import ONE_HERTZ, TWO_PERCENT, Printed, Recomputed

_UNITS = {"a": "1", "b": "ms2"}


def table_2(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Every row of Table 2."""
    for row in printed.table2.itertuples(index=False):
        pairs = {each: (getattr(row, each), _of(records, each, str(row.record))) for each in "ab"}
        ratios = [found / given for given, found in pairs.values()]
        for parameter, (given, found) in pairs.items():
            yield AuditItem(
                item="Table 2",
                quantity=f"{parameter} of {row.record}",
                printed=given,
                from_records=found,
                unit=_UNITS[parameter],
                erratum=_named(ratios[0], ratios[1]),
            )


def _of(records: Recomputed, parameter: str, motion: str) -> float:
    return records.of_motion(parameter, motion, ONE_HERTZ, TWO_PERCENT)


def _named(ratio_a: float, ratio_b: float) -> str:
    """Say what a pair of ratios (records over printed) suggests; nothing for small or missing ones."""
    if not np.isfinite(ratio_a + ratio_b) or max(abs(ratio_a - 1.0), abs(ratio_b - 1.0)) <= CLOSE:
        return ""
    if abs(ratio_a / ratio_b - 1.0) <= CLOSE:
        return (
            f"a and b both off by about {(ratio_a * ratio_b) ** 0.5:.2g}, as another duration might make them"
        )
    return "the row does not come back from the record of that name"


def figures_11_12(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Correlation, ranges and lognormality over the rows of Table 2."""
    a, b = (printed.table2[each].to_numpy(dtype=np.float64) for each in "ab")
    of_a, of_b = (records.over_motions(each, ONE_HERTZ) for each in "ab")
    known = of_a.size > 1
    yield AuditItem(
        item="Figure 11",
        quantity="correlation of a and b",
        printed=0.9774,
        from_tables=float(np.corrcoef(a, b)[0, 1]),
        from_records=float(np.corrcoef(of_a, of_b)[0, 1]) if known else float("nan"),
    )
    yield AuditItem(
        item="Figure 11",
        quantity="b over a",
        printed=1.65e4,
        from_tables=float(np.polyfit(a, b, 1)[0]),
        from_records=float(np.polyfit(of_a, of_b, 1)[0]) if known else float("nan"),
        unit="ms2",
    )
    ranges = (("a", a, of_a, 5.5e-5, 6.6e-4), ("b", b, of_b, 1.1, 7.6))
    for name, values, found, low, high in ranges:
        for which, number, pick in (("least", low, np.min), ("greatest", high, np.max)):
            yield AuditItem(
                item="Text below Table 2",
                quantity=f"{which} {name}",
                printed=number,
                from_tables=float(pick(values)),
                from_records=float(pick(found)) if known else float("nan"),
                unit=_UNITS[name],
                erratum="the range quoted is not the table's",
            )
    for name, values, found in (("a", a, of_a), ("b", b, of_b)):
        p_value = float(shapiro(np.log(values)).pvalue)
        yield AuditItem(
            item="Figure 12",
            quantity=f"Shapiro-Wilk p of ln {name} (none printed)",
            printed=float("nan"),
            from_tables=p_value,
            from_records=float(shapiro(np.log(found)).pvalue) if known else float("nan"),
            erratum="lognormality, which the paper assumes, is rejected by its own table"
            if p_value < SIGNIFICANCE
            else "",
        )


def equation_12(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Recompute the 5 % quantiles of lognormal distributions."""
    for name, number in (("a", 5.3e-5), ("b", 1.04)):
        found = quantile(printed.table2[name].to_numpy(dtype=np.float64))
        of_records = quantile(records.over_motions(name, ONE_HERTZ))
        yield AuditItem(
            item="Equation (12)",
            quantity=name,
            printed=number,
            from_tables=found,
            from_records=of_records,
            unit=_UNITS[name],
        )
        root, unit = (0.0073, "1") if name == "a" else (1.02, "ms")
        yield AuditItem(
            item="Text above equation (12)",
            quantity=f"√{name}",
            printed=root,
            from_tables=float(np.sqrt(found)),
            from_records=float(np.sqrt(of_records)),
            unit=unit,
        )


def table_3(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Quantiles at eight frequencies; that of 1 Hz should be equation (12)."""
    own = {name: quantile(printed.table2[name].to_numpy(dtype=np.float64)) for name in "ab"}
    for f, a, b in printed.table3[["f_hz", "a", "b"]].itertuples(index=False):
        for name, number in (("a", a), ("b", b)):
            yield AuditItem(
                item="Table 3",
                quantity=f"{name} at {f:g} Hz",
                printed=number,
                from_tables=own[name] if f == ONE_HERTZ else float("nan"),
                from_records=quantile(records.over_motions(name, f)),
                unit=_UNITS[name],
                erratum="Table 3 and equation (12) disagree about the same 100 motions"
                if f == ONE_HERTZ
                else "",
            )


def equation_15(printed: Printed, records: Recomputed) -> Iterator[AuditItem]:
    """Recompute the mean a and the exponential b of Table 3, and show where the exponential fails."""
    table = printed.table3
    f = table["f_hz"].to_numpy()
    of_a, of_b = (np.array([quantile(records.over_motions(each, x)) for x in f.tolist()]) for each in "ab")
    known = bool(np.isfinite(of_b).all())
    from_tables, from_records = (
        exponential(f, table["b"]),
        exponential(f, of_b) if known else (float("nan"), float("nan")),
    )
    yield AuditItem(
        item="Equation (15)",
        quantity="a",
        printed=5.6e-5,
        from_tables=float(gmean(table["a"])),
        from_records=float(gmean(of_a)),
    )
    for k, (name, number, unit) in enumerate((("k1", 121.6, "ms2"), ("k2", 6.6, "s"))):
        yield AuditItem(
            item="Equation (15)",
            quantity=name,
            printed=number,
            from_tables=from_tables[k],
            from_records=from_records[k],
            unit=unit,
        )
    for k, (at, printed_b) in enumerate(zip(f.tolist(), table["b"], strict=True)):
        misses = abs(121.6 * np.exp(-6.6 * at) / printed_b - 1.0) > CLOSE
        yield AuditItem(
            item="Equation (15)",
            quantity=f"b at {at:g} Hz",
            printed=float(121.6 * np.exp(-6.6 * at)),
            from_tables=float(printed_b),
            from_records=float(of_b[k]),
            unit="ms2",
            erratum="the exponential misses Table 3, in which b f² is nearly constant" if misses else "",
        )
