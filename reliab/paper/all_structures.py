"""Any frequency and damping ratio: equation (18), Tables 5 and 6, and the text between them."""

from collections.abc import Iterator

import numpy as np

from reliab.criterion.criterion import published_criterion
from reliab.paper.item import CLOSE, AuditItem
from reliab.paper.printed import TWO_PERCENT, Printed

_STIFFNESS = 3.50 + 1e-6  # k_e + k_n of Table 5 [N/m]
_MASSES = (0.09, 0.25, 0.09, 0.09)
_LATE_STEPS, _RATE = 4.0, 1024.0


def equation_18(printed: Printed) -> Iterator[AuditItem]:
    """How (18) follows from (11), (15) and (17), and what it says at 2 %."""
    del printed
    yield AuditItem(
        item="Equation (18)",
        quantity="factor of ξ in a",
        printed=0.021,
        from_tables=5.6e-5 * 0.046 / 1.3e-4,
    )
    yield AuditItem(
        item="Equation (18)",
        quantity="factor of ξ e^(−6.6f) in b",
        printed=6080.0,
        from_tables=121.6 * 100.0 / 2.3,
        unit="ms2",
        erratum="6080 is 121.6 · 100/2.0, with the b that (17) gives at ξ = 0.02 in place of 2.3",
    )
    yield AuditItem(
        item="Text above equation (18)",
        quantity="multiple of ξ that is 2.3",
        printed=1000.0,
        from_tables=100.0,
        unit="ms2",
        erratum="1000ξ should be 100ξ, as in equation (17)",
    )
    yield AuditItem(
        item="Text above equation (18)",
        quantity="factor of ξ e^(−6.6f)",
        printed=46080.0,
        from_tables=6080.0,
        unit="ms2",
        erratum="46080 should be 6080, as in equation (18)",
    )
    for parameter, ours, other, unit in (
        ("a", 0.021 * TWO_PERCENT, 5.6e-5, "1"),
        ("b at 1 Hz", 6080.0 * TWO_PERCENT * np.exp(-6.6), 121.6 * np.exp(-6.6), "ms2"),
    ):
        yield AuditItem(
            item="Equation (18)",
            quantity=f"{parameter} at ξ = 0.02",
            printed=ours,
            from_tables=float(other),
            unit=unit,
            erratum=(
                "7.5 times as generous as equation (15), since (16) takes a as linear in ξ"
                if parameter == "a"
                else ""
            ),
        )
    for at, number in ((0.25, 4.8), (2.0, 0.6)):
        found = float(np.sqrt(121.6 * np.exp(-6.6 * at)))
        yield AuditItem(
            item="Text below equation (15)",
            quantity=f"delay limit at {at:g} Hz",
            printed=number,
            from_tables=found,
            unit="ms",
            erratum=""
            if abs(found / number - 1.0) <= CLOSE
            else "0.6 ms is √b of Table 3; equation (15) gives 0.015 ms",
        )


def table_5(printed: Printed) -> Iterator[AuditItem]:
    """Masses and, from the inverse compensation, the delay that Table 6 should show."""
    cases = printed.cases[["case", "f_hz"]].to_numpy()
    for (number, frequency), mass in zip(cases.tolist(), _MASSES, strict=True):
        yield AuditItem(
            item="Table 5",
            quantity=f"m of case {number:g}",
            printed=mass,
            from_tables=_STIFFNESS / (2.0 * np.pi * frequency) ** 2,
            unit="kg",
        )


def table_6(printed: Printed) -> Iterator[AuditItem]:
    """Recompute indices by equation (18), and A and d as the compensation alone would make them."""
    criterion = published_criterion("guo_2017_18")
    cases = printed.cases.drop(columns="fulfils_eq18").astype(float)
    for case in cases.to_dict("records"):
        amplitude, delay = case["A"], case["d_ms"]
        index = criterion.index(amplitude, 1e-3 * delay, case["f_hz"], case["xi"])
        expected = 1e3 * (_LATE_STEPS - case["alpha_es"]) / _RATE
        for quantity, number, found, unit in (
            ("A", amplitude, case["amplitude_error"], "1"),
            ("d", delay, expected, "ms"),
            ("index of equation (18)", case["index_eq18"], float(index), "1"),
            ("RMS^R", case["rms_percent"], float("nan"), "%"),
        ):
            yield AuditItem(
                item="Table 6",
                quantity=f"{quantity} of case {case['case']:g}",
                printed=number,
                from_tables=found,
                unit=unit,
            )
