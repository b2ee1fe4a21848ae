from .candidates import Candidate as Candidate, Derived as Derived, Printed as Printed
from .cell import Cell as Cell
from .counts import (
    RATES as RATES,
    CrossValidation as CrossValidation,
    event_bootstrap as event_bootstrap,
    tabulate as tabulate,
)
from .folds import (
    GROUP_SCHEMES as GROUP_SCHEMES,
    Fold as Fold,
    folds_of as folds_of,
    from_another as from_another,
    k_fold as k_fold,
    leave_one_event_out as leave_one_event_out,
    leave_structures_out as leave_structures_out,
    random_halves as random_halves,
    transfer as transfer,
)
from .judge import cross_validate as cross_validate
from .truth import (
    EllipseTruth as EllipseTruth,
    SimulatedTruth as SimulatedTruth,
    StoredTruth as StoredTruth,
    Truth as Truth,
)
