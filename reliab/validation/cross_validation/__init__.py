"""Cross-validation grouped by earthquake."""

from reliab.validation.cross_validation.candidates import Candidate, Derived, Limits, Printed
from reliab.validation.cross_validation.cell import Cell
from reliab.validation.cross_validation.counts import CrossValidation
from reliab.validation.cross_validation.folds import (
    Fold,
    from_another,
    k_fold,
    leave_one_event_out,
    leave_structures_out,
    random_halves,
    transfer,
)
from reliab.validation.cross_validation.judge import cross_validate
from reliab.validation.cross_validation.schemes import SCHEMES, folds_of
from reliab.validation.cross_validation.truth import EllipseTruth, SimulatedTruth, StoredTruth, Truth

__all__ = [
    "SCHEMES",
    "Candidate",
    "Cell",
    "CrossValidation",
    "Derived",
    "EllipseTruth",
    "Fold",
    "Limits",
    "Printed",
    "SimulatedTruth",
    "StoredTruth",
    "Truth",
    "cross_validate",
    "folds_of",
    "from_another",
    "k_fold",
    "leave_one_event_out",
    "leave_structures_out",
    "random_halves",
    "transfer",
]
