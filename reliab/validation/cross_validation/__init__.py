"""Cross-validation grouped by earthquake."""

from reliab.validation.cross_validation.candidates import Candidate, Derived, Printed
from reliab.validation.cross_validation.folds import (
    Fold,
    k_fold,
    leave_one_event_out,
    leave_structures_out,
    random_halves,
    transfer,
)
from reliab.validation.cross_validation.judge import CrossValidation, cross_validate
from reliab.validation.cross_validation.schemes import SCHEMES, folds_of

__all__ = [
    "SCHEMES",
    "Candidate",
    "CrossValidation",
    "Derived",
    "Fold",
    "Printed",
    "cross_validate",
    "folds_of",
    "k_fold",
    "leave_one_event_out",
    "leave_structures_out",
    "random_halves",
    "transfer",
]
