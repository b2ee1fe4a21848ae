from .describing import describe_test as describe_test
from .memory import NextTest as NextTest
from .prediction import (
    Prediction as Prediction,
    predict_next as predict_next,
    predict_under_motion as predict_under_motion,
    predict_under_suite as predict_under_suite,
)
from .rig_folder import RigFolder as RigFolder
from .rig_table import RigTable as RigTable
from .rig_test import COLUMNS as COLUMNS, RigTest as RigTest, require_date as require_date
