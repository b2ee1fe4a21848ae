"""What may act beside the library: physical terms that give an unknown effect an expression."""

from reliab.discrepancy.outside.terms import outside_terms

__all__ = ["outside_terms"]
