"""What the paper says between its tables: numbers that follow from others, and slips that need none."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from .printed import (
    AMPLITUDE_LIMIT_BELOW_EQUATION_15,
    CLOSE,
    DELAY_LIMITS_BELOW_EQUATION_15,
    EQUATION_15,
    EQUATION_16,
    EQUATION_18,
    FACTOR_ABOVE_EQUATION_18,
    MULTIPLE_ABOVE_EQUATION_18,
    RANGES_OF_TEXT,
    ROOTS_OF_TEXT,
    SETS_OF_MOTIONS,
    Item,
    PrintedTables,
)

SLIPS: Final[tuple[tuple[str, str], ...]] = (
    ("Equation (8)", "b′² should be b′."),
    ("Caption of Table 2", "It says MTEᴿ where the numbers are RMSᴿ."),
    ("Text above equation (12)", "It refers to Figure 10 for a and b, which Figure 11 shows."),
    ("Section on frequency", "The list of frequencies has 1 Hz twice."),
    ("Section on frequency", "“Wallace et al. [7]” cites the CR integration algorithm; Wallace is [9]."),
    ("Section on many ground motions", "The PEER database is cited as [24], Zhu et al.; it is [29]."),
    ("Table 5", "EA is given in N m²; an axial stiffness EA is in N."),
)
"""Place and slip, as far as no number of :func:`numbers_of_text` shows it."""


def numbers_of_text(printed: PrintedTables) -> Iterator[Item]:
    """Numbers of the running text that follow from others."""
    yield from _around_table_2(printed)
    yield from _write_below_equation_15()
    yield from _write_above_equation_18()


def _around_table_2(printed: PrintedTables) -> Iterator[Item]:
    yield Item(
        item="Text above Table 2",
        quantity="components of 24 far-field and 28 near-field sets",
        printed=float(len(printed.table2)),
        from_tables=2.0 * sum(SETS_OF_MOTIONS),
        remark="two components each of 24 + 28 sets are 104; Table 2 has 100",
    )
    for quantity, value, square, unit in (
        ("amplitude error of the least a", ROOTS_OF_TEXT["a"][0], RANGES_OF_TEXT["a"][0], "1"),
        ("amplitude error of the greatest a", ROOTS_OF_TEXT["a"][1], RANGES_OF_TEXT["a"][1], "1"),
        ("delay of the least b", ROOTS_OF_TEXT["b"][0], RANGES_OF_TEXT["b"][0], "ms"),
        ("delay of the greatest b", ROOTS_OF_TEXT["b"][1], RANGES_OF_TEXT["b"][1], "ms"),
    ):
        root = float(np.sqrt(square))
        wrong = abs(root / value - 1.0) > CLOSE
        yield Item(
            item="Text below Table 2",
            quantity=quantity,
            printed=value,
            from_tables=root,
            unit=unit,
            remark=f"√{square:.1e} is {root:.1e}" if wrong else "",
        )


def _write_below_equation_15() -> Iterator[Item]:
    a, k1, k2 = EQUATION_15
    yield Item(
        item="Text below equation (15)",
        quantity="amplitude limit",
        printed=AMPLITUDE_LIMIT_BELOW_EQUATION_15,
        from_tables=float(np.sqrt(a)),
        remark="√a of equation (12); equation (15) gives 0.0075",
    )
    for at, value in DELAY_LIMITS_BELOW_EQUATION_15:
        limit = float(np.sqrt(k1 * np.exp(-k2 * at)))
        yield Item(
            item="Text below equation (15)",
            quantity=f"delay limit at {at:g} Hz",
            printed=value,
            from_tables=limit,
            unit="ms",
            remark=""
            if abs(limit / value - 1.0) <= CLOSE
            else "0.6 ms is √b of Table 3; equation (15) gives 0.015 ms",
        )


def _write_above_equation_18() -> Iterator[Item]:
    for quantity, value, meant, remark in (
        (
            "multiple of ξ that is 2.3",
            MULTIPLE_ABOVE_EQUATION_18,
            EQUATION_16[1],
            "1000ξ should be 100ξ, as in equation (17)",
        ),
        (
            "factor of ξ e^(−6.6f)",
            FACTOR_ABOVE_EQUATION_18,
            EQUATION_18[1],
            "46080 should be 6080, as in equation (18)",
        ),
    ):
        yield Item(
            item="Text above equation (18)",
            quantity=quantity,
            printed=value,
            from_tables=meant,
            unit="ms2",
            remark=remark,
        )
