from .comparison import RigComparison as RigComparison, compare_tables as compare_tables
from .drift import (
    FALSE_ALARMS as FALSE_ALARMS,
    DriftChart as DriftChart,
    drift_chart as drift_chart,
    known_effects as known_effects,
)
from .memory import MEASURED as MEASURED, NextTest as NextTest
from .planning import Plan as Plan, plan_tests as plan_tests
from .prediction import (
    Prediction as Prediction,
    predict_next as predict_next,
    predict_under_motion as predict_under_motion,
    predict_under_suite as predict_under_suite,
)
from .rig_folder import RigFolder as RigFolder
from .rig_table import RigTable as RigTable
from .rig_test import (
    COLUMNS as COLUMNS,
    RigTest as RigTest,
    describe_test as describe_test,
    require_date as require_date,
)
from .watching import watch as watch
