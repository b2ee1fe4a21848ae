"""Physical terms outside the library, which give an unknown effect an expression."""

from reliab.discrepancy.terms.outside_term import OutsideTerm, is_outside
from reliab.discrepancy.terms.outside_terms import outside_terms

__all__ = ["OutsideTerm", "is_outside", "outside_terms"]
