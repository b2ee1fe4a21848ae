"""One printed number beside what follows from the printed tables and from the records."""

from dataclasses import dataclass
from typing import Final

CLOSE: Final = 0.10
"""Numbers that differ by less agree; the paper prints two or three digits."""

MISSING: Final = float("nan")


@dataclass(frozen=True, kw_only=True)
class AuditItem:
    """One number of the paper.

    Parameters
    ----------
    item : str
        Table, figure, equation or text.
    quantity : str
        What the number is.
    printed : float
        As printed.
    from_tables, from_records : float, optional
        Recomputed from the printed tables, and from ellipses of the records themselves; NaN where that
        cannot be done.
    unit : str, optional
        Unit of all three.
    erratum : str, optional
        What the difference is, where it has a name.
    """

    item: str
    quantity: str
    printed: float
    from_tables: float = MISSING
    from_records: float = MISSING
    unit: str = "1"
    erratum: str = ""

    @property
    def difference(self) -> float:
        """Relative difference of what the records give, or else of what the tables give."""
        found = self.from_tables if self.from_records != self.from_records else self.from_records
        return found / self.printed - 1.0

    @property
    def finding(self) -> str:
        """What to say of the number, in a clause.

        Examples
        --------
        >>> AuditItem(item="Equation (12)", quantity="a", printed=5.3e-5, from_tables=5.29e-5).finding
        'comes back'
        """
        if self.erratum:
            return self.erratum
        if self.difference != self.difference:
            return "cannot be recomputed from tables or ellipses"
        if abs(self.difference) <= CLOSE:
            return "comes back"
        return f"differs by {100.0 * self.difference:+.0f} %, unexplained"
