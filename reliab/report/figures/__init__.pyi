from .parameters_over_structure import (
    ParameterSeries as ParameterSeries,
    parameters_over_damping_ratio as parameters_over_damping_ratio,
    parameters_over_frequency as parameters_over_frequency,
)
from .posterior_diagnostics import pairs as pairs, ranks as ranks, traces as traces
from .ranked_tests import ranked_tests as ranked_tests
from .tolerable_errors import tolerable_errors_over_frequency as tolerable_errors_over_frequency
