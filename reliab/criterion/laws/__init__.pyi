from .dimensionless import Dimensionless as Dimensionless
from .exponential import Exponential as Exponential
from .guo_2017 import (
    Equation12 as Equation12,
    Equation14 as Equation14,
    Equation15 as Equation15,
    Equation15Corrected as Equation15Corrected,
    Equation17 as Equation17,
    Equation17Corrected as Equation17Corrected,
    Equation18 as Equation18,
)
from .law import Law as Law, Validity as Validity
from .log_linear import LogLinearLaw as LogLinearLaw
from .power import Power as Power
from .registry import (
    FITTED as FITTED,
    OF_MANY_MOTIONS as OF_MANY_MOTIONS,
    FittedLaw as FittedLaw,
    known as known,
    law_from_dict as law_from_dict,
    law_to_dict as law_to_dict,
)
from .table import Table as Table
