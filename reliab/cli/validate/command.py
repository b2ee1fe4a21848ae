"""`reliab validate`: whether criteria hold on motions that they have not seen."""

import typer

from reliab.cli.options import (
    DampingRatios,
    Ellipses,
    Fractions,
    Frequencies,
    JsonTarget,
    MetricName,
    Motions,
    Results,
    Sets,
    WindowIfGiven,
)
from reliab.cli.validate.options import (
    Calibration,
    Case,
    CompensatorName,
    Confidences,
    IntegratorName,
    Joint,
    Judge,
    Laws,
    Learn,
    LeaveOut,
    Methods,
    RebuiltError,
    Scheme,
    Tests,
    TestsFile,
    Threshold,
)


def validate(
    *,
    context: typer.Context,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    ellipses: Ellipses = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Threshold = None,
    metric: MetricName = "rms",
    window: WindowIfGiven = None,
    alpha: Fractions = None,
    scheme: Scheme = None,
    leave_out: LeaveOut = None,
    learn: Learn = None,
    judge: Judge = None,
    method: Methods = None,
    joint: Joint = None,
    law: Laws = None,
    confidence: Confidences = None,
    trials: Tests = None,
    calibration: Calibration = False,
    case: Case = None,
    integrator: IntegratorName = None,
    compensator: CompensatorName = None,
    rebuilt_error: RebuiltError = False,
    tests: TestsFile = None,
    json_target: JsonTarget = None,
) -> None:
    """Judge criteria on earthquakes that they were not learned from."""
    from reliab.cli.validate.mode import alone

    if rebuilt_error:
        from reliab.cli.validate.rebuilt_error import RebuiltErrors

        alone("--rebuilt-error", RebuiltErrors, context).run()
    elif case is not None:
        from reliab.cli.validate.paper_cases import PaperCases

        alone("--case", PaperCases, context).run()
    elif calibration:
        from reliab.cli.validate.probabilities import Probabilities

        alone("--calibration", Probabilities, context).run()
    else:
        from reliab.cli.validate.criteria import Criteria

        alone("", Criteria, context).run()
