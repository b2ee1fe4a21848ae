"""Cross-validation grouped by earthquake."""

from reliab.validation.cross_validation.candidates import Candidate, Derived, Printed
from reliab.validation.cross_validation.folds import (
    Fold,
    k_fold,
    leave_one_event_out,
    leave_structures_out,
    random_halves,
)
from reliab.validation.cross_validation.judge import CrossValidation, cross_validate

__all__ = [
    "Candidate",
    "CrossValidation",
    "Derived",
    "Fold",
    "Printed",
    "cross_validate",
    "k_fold",
    "leave_one_event_out",
    "leave_structures_out",
    "random_halves",
]
