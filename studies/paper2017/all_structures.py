"""Any frequency and damping ratio: equation (18), Tables 5 and 6, Figure 17."""

from collections.abc import Iterator

import numpy as np

from reliab.core.vocabulary import MILLI, PERCENT, STANDARD_GRAVITY
from reliab.criterion.laws.registry import MANY_MOTION_LAWS

from .cases import DELAY_STEPS
from .printed import (
    APPLICATION_PEAK,
    AXIAL_STIFFNESS,
    BENDING_STIFFNESS,
    EQUATION_11,
    EQUATION_15,
    EQUATION_16,
    EQUATION_18,
    FRAME_STIFFNESS,
    MASSES,
    MISSING,
    ONE_HERTZ,
    RATE_HZ,
    SPECIMEN_STIFFNESS,
    TWO_PERCENT,
    Item,
    PrintedTables,
)
from .records import Records


def equation_18() -> Iterator[Item]:
    """How (18) follows from (11), (15) and (17), and what it says at 2 %."""
    yield from _factors_of_18()
    yield from _limits_of_18()


def _factors_of_18() -> Iterator[Item]:
    (a_11, b_11), (a_15, k1, _), (k3, k4) = EQUATION_11, EQUATION_15, EQUATION_16
    factor_a, factor_b = EQUATION_18
    yield Item(
        item="Equation (18)", quantity="factor of ξ in a", printed=factor_a, from_tables=a_15 * k3 / a_11
    )
    yield Item(
        item="Equation (18)",
        quantity="factor of ξ e^(−6.6f) in b",
        printed=factor_b,
        from_tables=k1 * k4 / b_11,
        unit="ms2",
        remark="6080 is 121.6 · 100/2.0, with the b that (17) gives at ξ = 0.02 in place of 2.3",
    )


def _limits_of_18() -> Iterator[Item]:
    """Compare the limits at 2 % and 1 Hz with those of equation (15)."""
    (a_15, k1, k2), (factor_a, factor_b) = EQUATION_15, EQUATION_18
    a, decay = factor_a * TWO_PERCENT, np.exp(-k2 * ONE_HERTZ)
    linear = f"{a / a_15:.1f} times equation (15), since (16a) takes a as linear in ξ"
    for parameter, value, followed, unit, remark in (
        ("a", a, a_15, "1", linear),
        ("b at 1 Hz", factor_b * TWO_PERCENT * decay, k1 * decay, "ms2", ""),
    ):
        yield Item(
            item="Equation (18)",
            quantity=f"{parameter} at ξ = 0.02",
            printed=float(value),
            from_tables=float(followed),
            unit=unit,
            remark=remark,
        )


def table_5(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Masses and stiffnesses of the four cases."""
    frequencies = printed.cases["f_hz"].to_numpy(dtype=np.float64)
    total = SPECIMEN_STIFFNESS + FRAME_STIFFNESS
    for number, (frequency, mass) in enumerate(zip(frequencies.tolist(), MASSES, strict=True), start=1):
        yield Item(
            item="Table 5",
            quantity=f"m of case {number}",
            printed=mass,
            from_tables=total / (2.0 * np.pi * frequency) ** 2,
            from_records=_value_of_case(records, "mass", number),
            unit="kg",
        )
    yield Item(
        item="Table 5",
        quantity="EI",
        printed=BENDING_STIFFNESS,
        from_tables=FRAME_STIFFNESS / 24.0,
        unit="N m2",
        remark="k_n h³/24 with a height h of 1 m, which the paper does not state",
    )
    yield Item(
        item="Table 5",
        quantity="EA",
        printed=AXIAL_STIFFNESS,
        unit="N",
        remark="no formula is given; printed in N m², which EA does not have; 10⁵ times the number of EI",
    )


def table_6(printed: PrintedTables, records: Records) -> Iterator[Item]:
    """Compare A, d, the index of equation (18) and RMS^R of the four cases."""
    law = MANY_MOTION_LAWS["guo_2017_18"]
    for case in printed.cases.drop(columns="fulfils_eq18").astype(float).to_dict("records"):
        number = int(case["case"])
        a, b = (float(limit) for limit in law.limits(case["f_hz"], case["xi"]))
        amplitude, delay = (_value_of_case(records, name, number) for name in "Ad")
        simulated = (amplitude - 1.0) ** 2 / a + (MILLI * delay) ** 2 / b
        of_table = (case["A"] - 1.0) ** 2 / a + case["d_ms"] ** 2 / b
        late = MILLI * (DELAY_STEPS - case["alpha_es"]) / RATE_HZ
        for quantity, value, tables, recomputed, unit in (
            ("A − 1", case["A"] - 1.0, case["amplitude_error"] - 1.0, amplitude - 1.0, "1"),
            ("d", case["d_ms"], late, MILLI * delay, "ms"),
            ("index of equation (18)", case["index_eq18"], of_table, simulated, "1"),
            ("RMS^R", case["rms_percent"], MISSING, PERCENT * _value_of_case(records, "rms", number), "%"),
        ):
            yield Item(
                item="Table 6",
                quantity=f"{quantity} of case {number}",
                printed=value,
                from_tables=tables,
                from_records=recomputed,
                unit=unit,
            )


def figure_17(records: Records) -> Iterator[Item]:
    """Peaks of the histories that the paper draws, and the peak of the motion behind them."""
    for number in range(1, len(MASSES) + 1):
        ideal, measured = (_peak(records, name, number) for name in ("ideal", "measured"))
        yield Item(
            item="Figure 17",
            quantity=f"measured over exact peak of case {number} (none printed)",
            from_records=measured / ideal,
            remark="drawn",
        )
    peak = MISSING if records.cases is None else float(records.cases.attrs.get("peak_acceleration", MISSING))
    yield Item(
        item="Text above Table 5",
        quantity="peak acceleration of KOBE/KJM000",
        printed=APPLICATION_PEAK,
        from_records=peak / STANDARD_GRAVITY,
        unit="g",
        remark="the record has another peak than the text says" if np.isfinite(peak) else "",
    )


def _value_of_case(records: Records, name: str, number: int) -> float:
    cases = records.cases
    return MISSING if cases is None or number not in cases["case"] else float(cases[name].sel(case=number))


def _peak(records: Records, name: str, number: int) -> float:
    cases = records.cases
    if cases is None or number not in cases["case"]:
        return MISSING
    return float(abs(cases[name].sel(case=number)).max())
