"""Every number that the paper prints: its tables as typed out, and what its equations, figures and text say.

Reliability assessment of real-time hybrid simulation under worst-case scenarios using frequency-domain
evaluation indices (2017), published online 13 February 2017.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, Self

import numpy as np
import pandas as pd

from reliab.core.errors import InputError
from reliab.core.shipped import shipped

EXAMPLE: Final = "KOBE/NIS000"
"""The motion of the paper's example."""

APPLICATION: Final = "KOBE/KJM000"
"""The motion of the paper's four cases, which is not among the hundred."""

ONE_HERTZ: Final = 1.0
TWO_PERCENT: Final = 0.02
FIVE_PERCENT: Final = 0.05
"""The threshold of RMS^R throughout the paper [-]."""

SHARE: Final = 0.05
"""The quantile that the paper calls 95 % confidence."""

SHOWN_TESTS: Final = ((1.0, 0.0), (1.0, 5e-3), (0.99, 0.0), (1.02, 2e-3))
"""Gain [-] and delay [s] of Figures 2, 3, 5 and 7."""

INTERVAL_OF_FIGURE_2: Final = (14.0, 30.0)
DISPLACEMENT_OF_FIGURE_2: Final = 50.0
"""Greatest displacement [mm] in an interval [s]."""

INSTANT_OF_FIGURE_3: Final = 40.0
DISPLACEMENT_OF_FIGURE_3: Final = 50.0
"""Greatest displacement [mm] around an instant [s], with a delay of 5 ms."""

RAISED_PEAK_OF_FIGURE_7: Final = 1.1
"""Peak of Figure 7 over that of Figure 2 [-]."""

CRITICAL_DELAY: Final = 6.4e-3
"""Delay from which the example is unstable [s], with Figure 4."""

ERRORS_AT_CRITICAL_DELAY: Final[Mapping[str, float]] = MappingProxyType({"mte": 280.0, "rms": 96.0})
"""MTE^R and RMS^R of Figure 4 [%]."""

ERRORS_OF_AMPLITUDE: Final[Mapping[str, float]] = MappingProxyType({"mte": 9.2, "rms": 4.2})
"""MTE^R of Figure 6 and RMS^R of Figure 5 at an amplitude of 0.99 [%]."""

SIMULATIONS_OF_FIGURE_8: Final = 800.0
"""Simulations of the grid of Figure 8, as the text counts them."""

AMPLITUDES: Final = np.linspace(0.98, 1.02, 41)
"""Gains [-] of Figures 5, 6 and 8."""

DELAYS_OF_FIGURE_4: Final = np.linspace(0.0, 8e-3, 81)
DELAYS_OF_FIGURE_8: Final = np.linspace(0.0, 2e-3, 21)
"""Delays [s]; the paper's begin at 0.1 ms in Figure 4."""

TOO_LARGE: Final = ("IMPVALL/H-E11230", "LOMAP/CAP000", "SUPERST/B-ICC000")
"""Rows of Table 2 that are five to twenty times as large as their records give."""

TABLE_1: Final[Mapping[str, tuple[float, float, float]]] = MappingProxyType(
    {"ellipse": (1.3e-4, 2.3, 0.12), "cosine": (1.6, 118.5, 0.65), "parabola": (-1.0e4, 1.6, 0.42)}
)
"""a, b and fitting error [ms⁴] of each curve; units of a and b are the curve's own, delays in ms."""

POINTS_OF_FIT: Final = 25
"""Points of the contour to which the curves of Table 1 are fitted."""

MASSES: Final = (0.09, 0.25, 0.09, 0.09)
"""Table 5, m [kg] of the four cases."""

SPECIMEN_STIFFNESS: Final = 3.50
FRAME_STIFFNESS: Final = 1e-6
"""Table 5, k_e and k_n [N/m]."""

BENDING_STIFFNESS: Final = 4.17e-8
"""Table 5, EI [N m²]."""

AXIAL_STIFFNESS: Final = 4.17e-3
"""Table 5, EA, printed in N m²."""

APPLICATION_PEAK: Final = 0.707
"""Peak acceleration of KOBE/KJM000 [g], as the text says."""

RATE_HZ: Final = 1024.0
"""Rate at which the four cases are run."""

EQUATION_11: Final = (1.3e-4, 2.3)
EQUATION_12: Final = (5.3e-5, 1.04)
"""a [-] and b [ms²]."""

ROOTS_ABOVE_EQUATION_12: Final[Mapping[str, float]] = MappingProxyType({"a": 0.0073, "b": 1.02})
"""√a [-] and √b [ms] of the text above equation (12)."""

CORRELATION_OF_FIGURE_11: Final = 0.9774
SLOPE_OF_FIGURE_11: Final = 1.65e4
"""Correlation of a and b [-], and b over a [ms²]."""

RANGES_OF_FIGURE_14: Final[Mapping[str, tuple[float, float]]] = MappingProxyType(
    {"a": (5.8e-5, 7e-4), "b": (0.8, 40.4)}
)
"""Least and greatest a [-] and b [ms²]."""

EQUATION_14: Final = (5.8e-5, 97.0, 3.4)
EQUATION_15: Final = (5.6e-5, 121.6, 6.6)
"""a [-], k₁ [ms²] and k₂ [1/Hz]."""

AMPLITUDE_LIMIT_BELOW_EQUATION_15: Final = 0.0073
DELAY_LIMITS_BELOW_EQUATION_15: Final = ((0.25, 4.8), (2.0, 0.6))
"""√a [-]; frequency [Hz] and √b [ms]."""

EQUATION_16: Final = (0.046, 100.0)
"""k₃ [-] and k₄ [ms²], also of equation (17)."""

EQUATION_18: Final = (0.021, 6080.0)
"""Factors of ξ in a [-] and of ξ e^(−6.6 f) in b [ms²]."""

MULTIPLE_ABOVE_EQUATION_18: Final = 1000.0
FACTOR_ABOVE_EQUATION_18: Final = 46080.0
"""Multiple of ξ that is 2.3 [ms²], and factor of ξ e^(−6.6 f) [ms²], in the text above equation (18)."""

SETS_OF_MOTIONS: Final = (24, 28)
"""Far-field and near-field sets of two components, from which the text takes Table 2."""

RANGES_OF_TEXT: Final[Mapping[str, tuple[float, float]]] = MappingProxyType(
    {"a": (5.5e-5, 6.6e-4), "b": (1.1, 7.6)}
)
"""Least and greatest a [-] and b [ms²] that the text quotes from Table 2."""

ROOTS_OF_TEXT: Final[Mapping[str, tuple[float, float]]] = MappingProxyType(
    {"a": (7.4e-3, 2.3e-2), "b": (1.05, 2.76)}
)
"""Amplitude errors √a [-] and delays √b [ms] that the text gives for these."""

_FILES: Final = {
    "table2": "table2.csv",
    "table3": "table3.csv",
    "table4": "table4.csv",
    "cases": "tables5_6.csv",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class PrintedTables:
    """The paper's tables as typed out.

    `table2`: no, record, a [-], b [ms²], error [ms⁴]; `table3`: f_hz, a [-], b [ms²]; `table4`: xi, a [-], b
    (which is √b [ms]).
    """

    table2: pd.DataFrame
    table3: pd.DataFrame
    table4: pd.DataFrame
    cases: pd.DataFrame

    @classmethod
    def read(cls, folder: Path | None = None) -> Self:
        """Read the CSV files of a folder.

        >>> tables = PrintedTables.read()
        >>> len(tables.table2), len(tables.table3), len(tables.table4), len(tables.cases)
        (100, 8, 9, 4)
        """
        folder = shipped("datasets", "paper") if folder is None else folder
        missing = [name for name in _FILES.values() if not (folder / name).is_file()]
        if missing:
            raise InputError(
                "The folder must hold the paper's printed tables",
                value=f"no {', '.join(missing)}",
                remedy="Use datasets/paper, which ships with reliab",
                where=str(folder),
            )
        return cls(**{key: pd.read_csv(folder / name) for key, name in _FILES.items()})

    def value_of_table_2(self, parameter: str) -> float:
        """Value of KOBE/NIS000 in Table 2: "a" [-], "b" [ms²] or "error" [ms⁴]."""
        rows = self.table2["record"].to_numpy() == EXAMPLE
        return float(self.table2[parameter].to_numpy(dtype=np.float64)[rows][0])


CLOSE: Final = 0.10
"""Relative difference up to which two numbers agree; the paper prints two or three digits."""

MISSING: Final = float("nan")


@dataclass(frozen=True, kw_only=True)
class Item:
    """One number of the paper, or one thing without a number."""

    item: str
    quantity: str
    printed: float = MISSING
    from_tables: float = MISSING
    from_records: float = MISSING
    unit: str = "1"
    remark: str = ""

    @property
    def difference(self) -> float:
        """Relative difference of what the records give, or else of what the tables give."""
        recomputed = self.from_tables if self.from_records != self.from_records else self.from_records
        return recomputed / self.printed - 1.0

    @property
    def finding(self) -> str:
        """The finding on the number, in a clause.

        >>> Item(item="Equation (12)", quantity="a", printed=5.3e-5, from_tables=5.29e-5).finding
        'reproduced'
        >>> Item(item="Table 1", quantity="a", printed=2.0, from_tables=2.0, from_records=3.0).finding
        'reproduced from the tables; from the records +50 %, unexplained'
        """
        if self.remark:
            return self.remark
        if self.difference != self.difference:
            return "cannot be recomputed from tables or records"
        if abs(self.difference) <= CLOSE:
            return "reproduced"
        percent = f"{100.0 * self.difference:+.0f} %".replace("-", "−")
        if abs(self.from_tables / self.printed - 1.0) <= CLOSE:
            return f"reproduced from the tables; from the records {percent}, unexplained"
        return f"differs by {percent}, unexplained"
