"""The criterion that ships with the package: real ground motions, the recommended method.

RMS^R falls with every quiet second, so that limits grow with the length of a record: the motions are carried
to the length of a test.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import MILLI, CurveName, Metric, Side
from reliab.criterion.carrying import carry_to_length, carry_to_response
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_table import EllipseTable, neighbours
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.criterion.population import Population
from reliab.criterion.response_measures import ResponseMeasures, read_shipped_ellipses, read_shipped_measures
from reliab.criterion.scope import Position, range_of
from reliab.structures.structure import Structure
from reliab.tracking.boundary.finite_errors import predict_ellipse
from reliab.tracking.boundary.first_order import FirstOrderEllipse

SOURCE = "the shipped ellipses of the motions of FEMA P-695"


def default_criterion(
    frequency: float,
    damping_ratio: float,
    threshold: float = 0.05,
    confidence: float = 0.95,
    *,
    metric: str = "rms",
    excluded_event: str | None = None,
    duration: float | None = None,
) -> Criterion:
    """Derive the recommended criterion of one structure from the ellipses that ship with the package.

    Parameters
    ----------
    frequency, damping_ratio : float
        The structure [Hz, -]; beyond the shipped ones the criterion is that of the nearest.
    threshold : float, optional
        Error of the whole test [-]; see
        :meth:`reliab.criterion.ellipse_table.EllipseTable.interpolate_threshold`.
    confidence : float, optional
        Share of the population's ground motions, in (0, 1).
    metric : str, optional
        Which error, "rms" or "mte".
    excluded_event : str, optional
        Earthquake to leave out of the derivation, because its motions are to be judged.
    duration : float, optional
        Length of the tests that are to be judged [s]; by default every length of the population is protected.

    Returns
    -------
    Criterion
        Valid at the structure and between its neighbours among the shipped ones.

    Raises
    ------
    InputError
        If the threshold lies outside of the shipped ones, or the metric is unknown.
    """
    return _derive_criterion(
        frequency, damping_ratio, threshold, confidence, metric, excluded_event, duration
    )


def criterion_of_test(
    frequency: float,
    damping_ratio: float,
    threshold: float,
    confidence: float,
    *,
    metric: str,
    duration: float,
) -> Criterion:
    """Derive the criterion beside which a test is shown, whatever error it may have.

    Where the error is too large for a criterion, its limits are those of the largest possible one, on the
    safe side, and it promises nothing. Arguments are those of :func:`default_criterion`.
    """
    thresholds = sorted(map(float, _read_ellipses().coordinates["threshold"]), reverse=True)
    refusals: list[InputError] = []
    for error in (threshold, *(smaller for smaller in thresholds if smaller < threshold)):
        try:
            criterion = _derive_criterion(frequency, damping_ratio, error, confidence, metric, None, duration)
        except InputError as refusal:
            refusals.append(refusal)
            continue
        return criterion if error == threshold else _drop_promise(criterion, threshold)
    raise refusals[0]


def _drop_promise(criterion: Criterion, threshold: float) -> Criterion:
    """Take the limits of a smaller error for a larger one, of which no share of motions is known."""
    sentence = (
        f"No criterion is possible for an error of {percent(threshold)}: an actuator that does not move "
        f"would pass. Limits and index are those of {percent(criterion.threshold)}."
    )
    provenance = replace(
        criterion.provenance, position=Position.OUTSIDE, warnings=(*criterion.provenance.warnings, sentence)
    )
    return replace(criterion, threshold=threshold, provenance=provenance)


@lru_cache(maxsize=64)  # tests of one structure are judged one after the other
def _derive_criterion(
    frequency: float,
    damping_ratio: float,
    threshold: float,
    confidence: float,
    metric: str,
    excluded_event: str | None,
    duration: float | None,
) -> Criterion:
    if metric not in tuple(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    places = {"f": frequency, "xi": damping_ratio}
    ellipses = _read_ellipses(metric)
    around = ellipses.take(
        **{name: neighbours(ellipses.coordinates[name], value) for name, value in places.items()},
        motion=ellipses.events != excluded_event,
    )
    if duration is not None:
        carried = carry_to_length(around, duration)
        around = carried.stating(window=f"{significant(duration)} s", caution="")
    criterion = derive_criterion(
        around.interpolate_threshold(threshold),
        method=method_of(RECOMMENDED_METHOD),
        joint=True,
        threshold=threshold,
        metric=metric,
        confidence=confidence,
        source=SOURCE,
    )
    response_measures = _measures_of_nearest(frequency, damping_ratio).measure_values
    scope = criterion.provenance.scope | {
        name: range_of(values) for name, values in response_measures.items()
    }
    return replace(criterion, provenance=replace(criterion.provenance, scope=scope))


def criterion_of_response(
    response: FirstOrderEllipse,
    structure: Structure,
    *,
    threshold: float,
    confidence: float,
    excluded_events: Sequence[str] = (),
    tracking: tuple[float, float] | None = None,
) -> Criterion | None:
    """Derive the criterion of RMS^R for motions under which a structure responds as it did in a test.

    `excluded_events` names earthquakes to leave out. `tracking`, A [-] and d [s] of the test: the population
    behind probabilities is then that of boundaries in its direction; otherwise that of whole regions, to the
    safe side for a single test. None for a structure that is partly numerical or lies beyond the shipped
    ones, where responses of the motions are not known.
    """
    ellipses, measures = _read_ellipses(), read_shipped_measures()
    f, xi = structure.frequency, structure.damping_ratio
    grid = (measures.frequencies, f), (measures.damping_ratios, xi)
    is_extrapolated = any(not values.min() <= value <= values.max() for values, value in grid)
    if is_extrapolated or structure.experimental_fraction != 1.0:
        return None
    is_included = ~np.isin(ellipses.events, excluded_events)
    test_measures = ResponseMeasures.from_response(response, structure, "this test")
    threshold_ellipses = ellipses.take(motion=is_included).interpolate_threshold(threshold)
    carried_ellipses = carry_to_response(threshold_ellipses, measures, test_measures)
    criterion = derive_criterion(
        carried_ellipses, joint=True, threshold=threshold, confidence=confidence, source=SOURCE
    )
    if tracking is None:
        return criterion
    angle = _angle(response, structure, threshold, *tracking)
    towards = carry_to_response(threshold_ellipses, read_shipped_measures(angle), test_measures, angle=angle)
    leads = None if criterion.lead_population is None else _population_of(towards, criterion, Side.LEAD)
    return replace(criterion, population=_population_of(towards, criterion, Side.LAG), lead_population=leads)


def _angle(
    response: FirstOrderEllipse, structure: Structure, threshold: float, amplitude: float, delay: float
) -> float:
    """Direction of a test in the angle of the predicted ellipse [rad]."""
    side = Side.LEAD if delay < 0.0 else Side.LAG
    a, b = predict_ellipse(response, structure, threshold, side)
    return float(np.arctan2(MILLI * abs(delay) / np.sqrt(b), (amplitude - 1.0) / np.sqrt(a)))


def _population_of(ellipses: EllipseTable, criterion: Criterion, side: Side) -> Population:
    """Ellipses of one side at the criterion's error."""
    return Population.from_ellipses(
        ellipses,
        threshold=criterion.threshold,
        metric=criterion.metric,
        curve=CurveName.INSCRIBED,
        side=side,
    )


def typical_ellipse(structure: Structure) -> tuple[float, float]:
    """Ellipse parameters a [-] and b [ms²] over the squared error, for the median motion of those that ship.

    Between and beyond the shipped structures a ξ⁻² and b ω₀² ξ⁻² are those of the nearest; both grow with the
    inverse square of the share in the laboratory.
    """
    near = _measures_of_nearest(structure.frequency, structure.damping_ratio)
    damping = structure.damping_ratio / float(near.damping_ratios[0])
    frequency = structure.frequency / float(near.frequencies[0])
    share = structure.experimental_fraction
    a, b = float(np.median(near.a_first)), float(np.median(near.b_first))
    return a * (damping / share) ** 2, b * (damping / frequency / share) ** 2


def ellipses_of_motions(structure: Structure) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return as :func:`typical_ellipse` does, one pair for each motion that ships, shape (motions,) each."""
    near = _measures_of_nearest(structure.frequency, structure.damping_ratio)
    a_ellipse, b_ellipse = typical_ellipse(structure)
    a, b = (values[:, 0, 0].astype(np.float64) for values in (near.a_first, near.b_first))
    return a * a_ellipse / np.median(a), b * b_ellipse / np.median(b)


def ellipses_of_nearest(frequency: float, damping_ratio: float, metric: str) -> EllipseTable:
    """Return the shipped ellipses of the structure that is nearest in proportion."""
    ellipses = _read_ellipses(metric)
    coordinates = {"f": frequency, "xi": damping_ratio}
    return ellipses.take(
        **{
            name: [int(np.abs(np.log(ellipses.coordinates[name].astype(np.float64) / value)).argmin())]
            for name, value in coordinates.items()
        }
    )


def list_frequencies() -> list[float]:
    """Natural frequencies [Hz] of the shipped ellipses, increasing."""
    return [float(frequency) for frequency in np.sort(_read_ellipses().coordinates["f"])]


def _read_ellipses(metric: str = Metric.RMS) -> EllipseTable:
    return read_shipped_ellipses(CurveName.INSCRIBED, "record", metric)


def _measures_of_nearest(frequency: float, damping_ratio: float) -> ResponseMeasures:
    """Measures of the responses of the nearest structure, shape (motions, 1, 1)."""
    measures = read_shipped_measures()
    f, xi = measures.nearest(np.array([frequency]), np.array([damping_ratio]))
    return measures.select_structures(f, xi)
