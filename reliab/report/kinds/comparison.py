"""One number of the paper beside what was found."""

from dataclasses import dataclass
from typing import Final

NAN: Final = float("nan")


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One number of the paper, or one thing that has none.

    Parameters
    ----------
    item : str
        Table, figure or equation.
    quantity : str
        What is compared.
    unit : str, optional
        Its unit.
    printed, reproduced : float, optional
        Both numbers in that unit; NaN where there is none.
    remark : str, optional
        What to know.
    """

    item: str
    quantity: str
    unit: str = ""
    printed: float = NAN
    reproduced: float = NAN
    remark: str = ""
