"""A hundred motions: Tables 2 and 3, Figures 11, 12 and 15, equations (12) and (15)."""

from collections.abc import Iterator

import numpy as np
from scipy.stats import gmean, shapiro

from reliab.core.significant_digits import significant
from reliab.criterion.cautions import SIGNIFICANCE

from .fits import exponential, quantile
from .printed import (
    CLOSE,
    CORRELATION_OF_FIGURE_11,
    EQUATION_12,
    EQUATION_15,
    MISSING,
    ONE_HERTZ,
    RANGES_OF_TEXT,
    ROOTS_ABOVE_EQUATION_12,
    SLOPE_OF_FIGURE_11,
    TOO_LARGE,
    TWO_PERCENT,
    Item,
    PrintedTables,
)
from .records import Records

_UNITS = {"a": "1", "b": "ms2", "error": "ms4"}
_ROOT_UNITS = {"a": "1", "b": "ms"}
_VARIABLES = {"a": "a", "b": "b", "error": "sse"}


def table_2(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Every row of Table 2: a, b and the fitting error of equation (10)."""
    for row in printed.table2.itertuples(index=False):
        pairs = {
            name: (getattr(row, name), _value_of(records, variable, str(row.record)))
            for name, variable in _VARIABLES.items()
        }
        ratios = {name: recomputed / value for name, (value, recomputed) in pairs.items()}
        for name, (value, recomputed) in pairs.items():
            yield Item(
                item="Table 2",
                quantity=f"{name} of {row.record}",
                printed=value,
                from_records=recomputed,
                unit=_UNITS[name],
                remark="" if name == "error" else _explanation(ratios["a"], ratios["b"]),
            )


def rows_of_table_2(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """How many rows of Table 2 are reproduced, in a and b and in the fitting error."""
    table = printed.table2
    names = [str(name) for name in table["record"]]
    ratios = {
        column: np.array([_value_of(records, variable, name) for name in names]) / table[column].to_numpy()
        for column, variable in _VARIABLES.items()
    }
    close = {name: np.abs(ratio - 1.0) <= CLOSE for name, ratio in ratios.items()}
    known = bool(np.isfinite(ratios["a"]).any())
    for quantity, rows, remark in (
        (
            "rows within 10 % in a and b",
            close["a"] & close["b"],
            "the others are listed in the audit of Table 2",
        ),
        (
            "rows within 10 % in the fitting error",
            close["error"],
            "unexplained: the two ends of the contour explain the errors of Table 1, but not this column",
        ),
    ):
        yield Item(
            item="Table 2",
            quantity=quantity,
            printed=float(len(names)),
            from_records=float(rows.sum()) if known else MISSING,
            remark=remark,
        )


def _value_of(records: Records, parameter: str, motion: str) -> float:
    return records.value_of_motion(parameter, ONE_HERTZ, TWO_PERCENT, motion)


def _explanation(ratio_a: float, ratio_b: float) -> str:
    """Say what a pair of ratios (records over printed) suggests; nothing for small or missing ones."""
    if not np.isfinite(ratio_a + ratio_b) or max(abs(ratio_a - 1.0), abs(ratio_b - 1.0)) <= CLOSE:
        return ""
    if abs(ratio_a / ratio_b - 1.0) <= CLOSE:
        factor = significant((ratio_a * ratio_b) ** 0.5, 2)
        return f"a and b both off by about {factor}, as another duration might make them"
    return "the row is not reproduced from the record of that name"


def figure_11(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Correlation and straight line of a and b over the rows of Table 2."""
    a, b = (printed.table2[name].to_numpy(dtype=np.float64) for name in "ab")
    of_a, of_b = (records.values_of_motions(name, ONE_HERTZ) for name in "ab")
    known = of_a.size > 1
    yield Item(
        item="Figure 11",
        quantity="correlation of a and b",
        printed=CORRELATION_OF_FIGURE_11,
        from_tables=float(np.corrcoef(a, b)[0, 1]),
        from_records=float(np.corrcoef(of_a, of_b)[0, 1]) if known else MISSING,
    )
    yield Item(
        item="Figure 11",
        quantity="b over a",
        printed=SLOPE_OF_FIGURE_11,
        from_tables=float(np.polyfit(a, b, 1)[0]),
        from_records=float(np.polyfit(of_a, of_b, 1)[0]) if known else MISSING,
        unit="ms2",
    )


def ranges_of_table_2(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Least and greatest a and b, which the text quotes from Table 2."""
    for name in "ab":
        values, of_records = printed.table2[name].to_numpy(), records.values_of_motions(name, ONE_HERTZ)
        for extreme, number, pick in zip(
            ("least", "greatest"), RANGES_OF_TEXT[name], (np.min, np.max), strict=True
        ):
            yield Item(
                item="Text below Table 2",
                quantity=f"{extreme} {name}",
                printed=number,
                from_tables=float(pick(values)),
                from_records=float(pick(of_records)) if of_records.size > 1 else MISSING,
                unit=_UNITS[name],
                remark="the range quoted is not the table's",
            )


def figure_12(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Lognormality over the rows of Table 2."""
    for name in "ab":
        values, of_records = printed.table2[name].to_numpy(), records.values_of_motions(name, ONE_HERTZ)
        p_value = float(shapiro(np.log(values)).pvalue)
        yield Item(
            item="Figure 12",
            quantity=f"Shapiro-Wilk p of ln {name} (none printed)",
            from_tables=p_value,
            from_records=float(shapiro(np.log(of_records)).pvalue) if of_records.size > 1 else MISSING,
            remark="lognormality, which the paper assumes, is rejected by its own table"
            if p_value < SIGNIFICANCE
            else "",
        )


def equation_12(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Recompute the 5 % quantiles of lognormal distributions, and without three rows that are too large."""
    table = printed.table2
    too_large = table["record"].isin(TOO_LARGE).to_numpy()
    for name, number in zip("ab", EQUATION_12, strict=True):
        values = table[name].to_numpy(dtype=np.float64)
        of_tables, of_records = quantile(values), quantile(records.values_of_motions(name, ONE_HERTZ))
        yield Item(
            item="Equation (12)",
            quantity=name,
            printed=number,
            from_tables=of_tables,
            from_records=of_records,
            unit=_UNITS[name],
            remark=""
            if abs(of_records / number - 1.0) <= CLOSE or np.isnan(of_records)
            else "three rows of Table 2 that are too large widen the distribution and lower its quantile",
        )
        yield Item(
            item="Equation (12)",
            quantity=f"{name} without three rows (none printed)",
            from_tables=quantile(values[~too_large]),
            from_records=of_records,
            unit=_UNITS[name],
            remark="without " + ", ".join(TOO_LARGE) + " the printed table gives what the records give",
        )
        yield Item(
            item="Text above equation (12)",
            quantity=f"√{name}",
            printed=ROOTS_ABOVE_EQUATION_12[name],
            from_tables=float(np.sqrt(number)),
            from_records=float(np.sqrt(of_records)),
            unit=_ROOT_UNITS[name],
        )


def table_3(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Quantiles at eight frequencies; that of 1 Hz should be equation (12)."""
    of_table_2 = {name: quantile(printed.table2[name].to_numpy(dtype=np.float64)) for name in "ab"}
    for f, a, b in printed.table3[["f_hz", "a", "b"]].itertuples(index=False):
        for name, number in (("a", a), ("b", b)):
            yield Item(
                item="Table 3",
                quantity=f"{name} at {f:g} Hz",
                printed=number,
                from_tables=of_table_2[name] if f == ONE_HERTZ else MISSING,
                from_records=quantile(records.values_of_motions(name, f)),
                unit=_UNITS[name],
                remark="Table 3 and equation (12) disagree about the same 100 motions"
                if f == ONE_HERTZ
                else "",
            )


def equation_15(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Recompute the mean a and the exponential b of Table 3, and show where the exponential fails."""
    yield from _mean_amplitude_limit(printed, records)
    yield from _exponential_delay_limit(printed, records)
    yield from _delay_limits_of_15(printed, records)


def _mean_amplitude_limit(printed: PrintedTables, records: Records) -> Iterator[Item]:
    a, of_a = EQUATION_15[0], records.guaranteed("a")
    known = bool(of_a.size and np.isfinite(of_a).all())
    yield Item(
        item="Equation (15)",
        quantity="a",
        printed=a,
        from_tables=float(gmean(printed.table3["a"])),
        from_records=float(gmean(of_a)) if known else MISSING,
        remark="reproduced as the geometric mean over Table 3",
    )
    yield Item(
        item="Figure 15",
        quantity="a, all motions and frequencies pooled",
        printed=a,
        from_records=records.pooled("a"),
        remark="the other reading of the text: 5 % quantile of all values at once",
    )


def _exponential_delay_limit(printed: PrintedTables, records: Records) -> Iterator[Item]:
    _, k1, k2 = EQUATION_15
    table = printed.table3
    of_records = exponential(records.frequencies, records.guaranteed("b"))
    of_table = exponential(table["f_hz"], table["b"])
    for place, (quantity, value, unit) in enumerate((("k1", k1, "ms2"), ("k2", k2, "s"))):
        yield Item(
            item="Equation (15)",
            quantity=quantity,
            printed=value,
            from_tables=of_table[place],
            from_records=of_records[place],
            unit=unit,
        )


def _delay_limits_of_15(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Hold the exponential against Table 3, at each of its frequencies."""
    _, k1, k2 = EQUATION_15
    for at, of_table_3 in zip(printed.table3["f_hz"].tolist(), printed.table3["b"], strict=True):
        law = float(k1 * np.exp(-k2 * at))
        yield Item(
            item="Equation (15)",
            quantity=f"b at {at:g} Hz",
            printed=law,
            from_tables=float(of_table_3),
            from_records=quantile(records.values_of_motions("b", at)),
            unit="ms2",
            remark="the exponential misses Table 3, in which b f² is nearly constant"
            if abs(law / of_table_3 - 1.0) > CLOSE
            else "",
        )
