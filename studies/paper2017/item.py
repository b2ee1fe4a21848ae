"""One number of the paper: as printed, as its own tables give it, and as the records give it."""

from dataclasses import dataclass
from typing import Final

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
        'comes back'
        >>> Item(item="Table 1", quantity="a", printed=2.0, from_tables=2.0, from_records=3.0).finding
        'comes back from the tables; from the records +50 %, unexplained'
        """
        if self.remark:
            return self.remark
        if self.difference != self.difference:
            return "cannot be recomputed from tables or records"
        if abs(self.difference) <= CLOSE:
            return "comes back"
        percent = f"{100.0 * self.difference:+.0f} %"
        if abs(self.from_tables / self.printed - 1.0) <= CLOSE:
            return f"comes back from the tables; from the records {percent}, unexplained"
        return f"differs by {percent}, unexplained"
