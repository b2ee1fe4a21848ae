from .parameter_distributions import (
    ParameterSeries as ParameterSeries,
    ellipses_and_criterion as ellipses_and_criterion,
    parameters_over_damping_ratio as parameters_over_damping_ratio,
    parameters_over_frequency as parameters_over_frequency,
)
from .posterior_diagnostics import pairs as pairs, ranks as ranks, traces as traces
from .tests_by_error import (
    ranked_tests as ranked_tests,
    tolerable_errors_over_frequency as tolerable_errors_over_frequency,
)
