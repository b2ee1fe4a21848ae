from .budget import BudgetItem as BudgetItem, budget_of_error as budget_of_error
from .corrections import (
    CHANNELS as CHANNELS,
    corrected as corrected,
    stated_of_filters as stated_of_filters,
    without_skew as without_skew,
)
from .sizes import (
    Equipment as Equipment,
    Size as Size,
    Source as Source,
    as_certain_as as as_certain_as,
    ordinary_equipment as ordinary_equipment,
    read_equipment as read_equipment,
    sizes_of_structure as sizes_of_structure,
    sizes_of_unknown as sizes_of_unknown,
    tolerances_of as tolerances_of,
)
