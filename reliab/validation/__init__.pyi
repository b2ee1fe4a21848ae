from .beyond_the_model import (
    TEST_COLUMNS as TEST_COLUMNS,
    rigs_of_delay as rigs_of_delay,
    try_rigs as try_rigs,
)
from .distribution_comparison import compare_distributions as compare_distributions
from .earthquakes import earthquakes_among as earthquakes_among
from .law_comparison import compare_laws as compare_laws
from .yielding import HARDENING as HARDENING, measured_yielding as measured_yielding
