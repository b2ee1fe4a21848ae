"""What messages on a running test say of its error: so far, with intervals, of each displacement."""

from collections.abc import Mapping
from typing import Any

from reliab.assessment.budget.sizes import Size, as_certain_as
from reliab.assessment.coupled_error.coupled_error import CoupledError, DegreeError
from reliab.assessment.coupled_error.monitor import CoupledMonitor
from reliab.assessment.plain_error import plain_errors
from reliab.assessment.rebuilt_error.running_test import RunningTest
from reliab.core.vocabulary import Metric


def degrees_so_far(monitor: RunningTest) -> dict[str, Any]:
    """Errors of each displacement at the last sample, and which governs; nothing of one actuator."""
    if not isinstance(monitor, CoupledMonitor):
        return {}
    return {
        "governing": monitor.governing,
        "degrees_of_freedom": {
            name: {
                "error_m": now.error,
                "rms": now.rms,
                "mte": now.mte,
                "judged": name in monitor.judged,
            }
            for name, now in monitor.displacements.items()
        },
    }


def errors_with_intervals(
    asked: object, monitor: RunningTest, sizes: Mapping[str, Size], threshold: float, metric: Metric
) -> dict[str, Any]:
    """Intervals of the error that was asked for, of several actuators that of each displacement."""
    by_degree: dict[str, Any] = {}
    if isinstance(asked, CoupledError):
        governing = asked.governing(metric)
        by_degree = {
            "governing": None if governing is None else governing.name,
            "degrees_of_freedom": {
                degree.name: _of_degree(degree, sizes, threshold, metric) for degree in asked.displacements
            },
        }
    return {
        **_errors(monitor.result, sizes, threshold, metric),
        "until_s": monitor.now.time,
        "metric": str(metric),
        "threshold": threshold,
        **by_degree,
    }


def _of_degree(
    degree: DegreeError, sizes: Mapping[str, Size], threshold: float, metric: Metric
) -> dict[str, Any]:
    why = {} if degree.judged else {"why_not": degree.why_not_judged}
    errors = _errors(degree if degree.judged else None, sizes, threshold, metric)
    return {"judged": degree.judged, **why, **errors}


def _errors(error: Any, sizes: Mapping[str, Size], threshold: float, metric: Metric) -> dict[str, Any]:  # noqa: ANN401 - of any kind of test
    """RMS^R and MTE^R with their intervals, and the probability of staying below a threshold."""
    probability = None if error is None else as_certain_as(sizes, error.probability(threshold, metric))
    return {**plain_errors(None if error is None else error.estimate), "probability": probability}
