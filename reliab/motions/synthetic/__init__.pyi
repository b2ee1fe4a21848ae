from .scenario import Mechanism as Mechanism, Scenario as Scenario
from .suite import (
    synthetic_entries as synthetic_entries,
    synthetic_suite as synthetic_suite,
)
