"""Laws of frequency and damping, one per file; each refuses use outside its validity."""

from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.exponential import Exponential
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.log_linear import LogLinearLaw
from reliab.criterion.laws.power import Power
from reliab.criterion.laws.registry import (
    FITTED,
    OF_MANY_MOTIONS,
    FittedLaw,
    known,
    law_from_dict,
    law_to_dict,
)
from reliab.criterion.laws.table import Table
from reliab.criterion.laws.validity import Validity

__all__ = [
    "FITTED",
    "OF_MANY_MOTIONS",
    "Dimensionless",
    "Exponential",
    "FittedLaw",
    "Law",
    "LogLinearLaw",
    "Power",
    "Table",
    "Validity",
    "known",
    "law_from_dict",
    "law_to_dict",
]
