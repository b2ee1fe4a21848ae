"""The criterion that ships with the package: real ground motions, the recommended method.

Its window is chosen for the length of a test: RMS^R falls with every quiet second, so that limits grow with
the window.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reliab.boundary import FirstOrderEllipse, predicted_ellipse
from reliab.criterion import (
    Criterion,
    EllipseTable,
    Population,
    Position,
    ResponseMeasures,
    between_tables,
    carry_to_response,
    compared_by_ellipse,
    derive_criterion,
    neighbours,
    protect_over_lengths,
    range_of,
    shipped_ellipses,
    shipped_measures,
    shipped_windows,
)
from reliab.criterion.methods import RECOMMENDED, method_of
from reliab.errors import InputError
from reliab.significant import percent, significant
from reliab.structures import Structure
from reliab.vocabulary import MILLI, CurveName, Metric, Side

RECORD = "record"
"""Window of ellipses whose errors were computed over whole records."""

_SAME = 0.01  # share of a window's length by which a test may differ from it

SOURCE = "the ellipses that ship with the package, of the motions of FEMA P-695"
_OF_FINITE_ERRORS = 1.03  # ellipses of the smallest shipped error, 1 %, over those of small errors
_FEWEST_ALIKE = 10


@dataclass(frozen=True, kw_only=True)
class CriterionWindow:
    """Two windows between which ellipses are interpolated, ln a and ln b over the logarithm of the length."""

    below: str  # below, above: The windows; the same where one suits
    above: str
    weight: float  # Weight of the second
    label: str  # The choice in words


def window_for(duration: float | None, stored: Iterable[str]) -> CriterionWindow:
    """Choose windows for tests of a length.

    `duration` [s].
    Returns one window, or two between which the length lies. A test longer than the longest is judged by the
    longest, which is on the safe side; one shorter than the shortest by the shortest, which is not.

    >>> window_for(25.0, ["record", "20", "30"]).label
    '25 s, between those of 20 s and 30 s'
    >>> window_for(90.0, ["record", "20", "30"]).label
    '30 s, the longest that ships'
    """
    lengths = sorted(float(label) for label in stored if _is_length(label))
    if duration is None or not lengths:
        return CriterionWindow(below=RECORD, above=RECORD, weight=0.0, label=RECORD)
    above = min((length for length in lengths if length >= duration), default=lengths[-1])
    below = max((length for length in lengths if length <= duration), default=lengths[0])
    near = min((below, above), key=lambda length: abs(np.log(duration / length)))
    if below != above and abs(duration / near - 1.0) > _SAME:
        return CriterionWindow(
            below=f"{below:g}",
            above=f"{above:g}",
            weight=float(np.log(duration / below) / np.log(above / below)),
            label=f"{significant(duration)} s, between those of {below:g} s and {above:g} s",
        )
    note = ""
    if abs(duration / near - 1.0) > _SAME:
        note = ", the longest that ships" if duration > near else ", the shortest that ships"
    return CriterionWindow(below=f"{near:g}", above=f"{near:g}", weight=0.0, label=f"{near:g} s{note}")


def _is_length(label: str) -> bool:
    try:
        return float(label) > 0.0
    except ValueError:
        return False


def default_criterion(
    frequency: float,
    damping_ratio: float,
    threshold: float = 0.05,
    confidence: float = 0.95,
    *,
    metric: str = "rms",
    without: str | None = None,
    duration: float | None = None,
) -> Criterion:
    """Derive the recommended criterion of one structure from the ellipses that ship with the package.

    Parameters
    ----------
    frequency, damping_ratio : float
        The structure [Hz, -]; beyond the shipped ones the criterion is that of the nearest.
    threshold : float, optional
        Error of the whole test [-]; see :meth:`reliab.criterion.EllipseTable.at_threshold`.
    confidence : float, optional
        Share of the population's ground motions, in (0, 1).
    metric : str, optional
        Which error, "rms" or "mte".
    without : str, optional
        Earthquake to leave out of the derivation, because its motions are to be judged.
    duration : float, optional
        Length of the tests that are to be judged [s]; by default errors are those over whole records.

    Returns
    -------
    Criterion
        Valid at the structure and between its neighbours among the shipped ones.

    Raises
    ------
    InputError
        If the threshold lies outside of the shipped ones, or the metric is unknown.
    """
    return _derived(frequency, damping_ratio, threshold, confidence, metric, without, duration)


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
    stored = sorted(map(float, _shipped_ellipses().at["threshold"]), reverse=True)
    refusals: list[InputError] = []
    for error in (threshold, *(smaller for smaller in stored if smaller < threshold)):
        try:
            found = _derived(frequency, damping_ratio, error, confidence, metric, None, duration)
        except InputError as refusal:
            refusals.append(refusal)
            continue
        return found if error == threshold else _without_promise(found, threshold)
    raise refusals[0]


def _without_promise(criterion: Criterion, threshold: float) -> Criterion:
    """Take the limits of a smaller error for a larger one, of which no share of motions is known."""
    said = (
        f"No criterion is possible for an error of {percent(threshold)}: an actuator that does not move "
        f"would pass. Limits and index are those of {percent(criterion.threshold)}."
    )
    provenance = replace(
        criterion.provenance,
        position=Position.OUTSIDE,
        warnings=(*criterion.provenance.warnings, said),
    )
    return replace(criterion, threshold=threshold, provenance=provenance)


@lru_cache(maxsize=64)  # tests of one structure are judged one after the other
def _derived(
    frequency: float,
    damping_ratio: float,
    threshold: float,
    confidence: float,
    metric: str,
    without: str | None,
    duration: float | None,
) -> Criterion:
    window = window_for(duration, shipped_windows())
    if metric not in tuple(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    around = _around(frequency, damping_ratio, _population(window, without, metric, confidence))
    criterion = derive_criterion(
        around.at_threshold(threshold),
        method=method_of(RECOMMENDED),
        joint=True,
        threshold=threshold,
        metric=metric,
        confidence=confidence,
        source=SOURCE,
    )
    if window.label != RECORD:
        of_rms = _population(window, without, Metric.RMS, confidence)
        alike = _are_alike(_around(frequency, damping_ratio, of_rms))
        criterion = replace(
            criterion,
            population=_of_motions(criterion.population, alike),
            lead_population=_of_motions(criterion.lead_population, alike),
        )
    of_responses = _of_nearest(frequency, damping_ratio).compared
    scope = criterion.provenance.scope | {name: range_of(values) for name, values in of_responses.items()}
    return replace(criterion, provenance=replace(criterion.provenance, scope=scope))


def _around(frequency: float, damping_ratio: float, ellipses: EllipseTable) -> EllipseTable:
    """Ellipses of the structures between which one lies."""
    places = {"f": frequency, "xi": damping_ratio}
    return ellipses.take(**{name: neighbours(ellipses.at[name], value) for name, value in places.items()})


def _are_alike(ellipses: EllipseTable) -> NDArray[np.bool_]:
    """Whether responses in a window are like those to whole records, shape (motions, f, ξ).

    By the ellipses of the smallest RMS^R. Motions with hardly any response in the first seconds made the
    probabilities of tests of 10 s a fifth too high. All motions count where fewer than ten would be left.
    """
    smallest = ellipses.take(
        threshold=[int(np.argmin(ellipses.at["threshold"]))],
        side=ellipses.at["side"] == str(Side.LAG),
    )
    unit = float(smallest.at["threshold"][0]) ** 2
    a, b = (values.reshape(values.shape[:3]) / unit for values in (smallest.a, smallest.b))
    f, xi = (smallest.at[name].astype(np.float64) for name in ("f", "xi"))
    measures = shipped_measures()
    whole = measures.at(*measures.nearest(f, xi)).compared
    alike = np.ones(a.shape, dtype=bool)
    for name, values in compared_by_ellipse(a, b, f[:, None], xi[None, :]).items():
        low, high = whole[name].min(axis=0) / _OF_FINITE_ERRORS, whole[name].max(axis=0) * _OF_FINITE_ERRORS
        alike &= (values >= low) & (values <= high)
    return np.asarray(alike | (alike.sum(axis=0) < _FEWEST_ALIKE))


def _of_motions(population: Population | None, chosen: NDArray[np.bool_]) -> Population | None:
    """Take some of the motions at each structure."""
    if population is None:
        return None
    alpha, beta = (
        np.where(chosen, logarithms, np.nan) for logarithms in (population.log_alpha, population.log_beta)
    )
    return replace(population, log_alpha=alpha, log_beta=beta)


def criterion_of_response(
    response: FirstOrderEllipse,
    structure: Structure,
    *,
    threshold: float,
    confidence: float,
    without: Sequence[str] = (),
    tracking: tuple[float, float] | None = None,
) -> Criterion | None:
    """Derive the criterion of RMS^R for motions under which a structure responds as it did in a test.

    `without` names earthquakes to leave out. `tracking`, A [-] and d [s] of the test: the population behind
    probabilities is then that of boundaries in its direction; otherwise that of whole regions, to the safe
    side for a single test. None for a structure that is partly numerical or lies beyond the shipped ones,
    where responses of the motions are not known.
    """
    ellipses, measures = _shipped_ellipses(), shipped_measures()
    f, xi = structure.frequency, structure.damping_ratio
    grid = (measures.frequencies, f), (measures.damping_ratios, xi)
    beyond = any(not values.min() <= value <= values.max() for values, value in grid)
    if beyond or structure.experimental_fraction != 1.0:
        return None
    learned = ~np.isin(ellipses.events, without)
    of_test = ResponseMeasures.of_one(response, structure, "this test")
    of_threshold = ellipses.take(motion=learned).at_threshold(threshold)
    carried = carry_to_response(of_threshold, measures, of_test)
    criterion = derive_criterion(
        carried, joint=True, threshold=threshold, confidence=confidence, source=SOURCE
    )
    if tracking is None:
        return criterion
    angle = _angle(response, structure, threshold, *tracking)
    towards = carry_to_response(of_threshold, shipped_measures(angle), of_test, angle=angle)
    leads = None if criterion.lead_population is None else _population_of(towards, criterion, Side.LEAD)
    return replace(criterion, population=_population_of(towards, criterion, Side.LAG), lead_population=leads)


def _angle(
    response: FirstOrderEllipse, structure: Structure, threshold: float, amplitude: float, delay: float
) -> float:
    """Direction of a test in the angle of the predicted ellipse [rad]."""
    side = Side.LEAD if delay < 0.0 else Side.LAG
    a, b = predicted_ellipse(response, structure, threshold, side)
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
    near = _of_nearest(structure.frequency, structure.damping_ratio)
    damping = structure.damping_ratio / float(near.damping_ratios[0])
    frequency = structure.frequency / float(near.frequencies[0])
    share = structure.experimental_fraction
    a, b = float(np.median(near.a_first)), float(np.median(near.b_first))
    return a * (damping / share) ** 2, b * (damping / frequency / share) ** 2


def ellipses_of_motions(structure: Structure) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return as :func:`typical_ellipse` does, one pair for each motion that ships, shape (motions,) each."""
    near = _of_nearest(structure.frequency, structure.damping_ratio)
    of_a, of_b = typical_ellipse(structure)
    a, b = (values[:, 0, 0].astype(np.float64) for values in (near.a_first, near.b_first))
    return a * of_a / np.median(a), b * of_b / np.median(b)


def shipped_frequencies() -> list[float]:
    """Natural frequencies [Hz] of the shipped ellipses, increasing."""
    return [float(frequency) for frequency in np.sort(_shipped_ellipses().at["f"])]


def _shipped_ellipses(window: str = RECORD, metric: str = Metric.RMS) -> EllipseTable:
    return shipped_ellipses(CurveName.INSCRIBED, window, metric)


@lru_cache(maxsize=8)
def _population(window: CriterionWindow, without: str | None, metric: str, confidence: float) -> EllipseTable:
    """Ellipses of a window, without an earthquake; of whole records as shares of this size are stated."""
    ellipses = _shipped_ellipses(window.below, metric)
    if window.weight > 0.0:
        ellipses = between_tables(ellipses, _shipped_ellipses(window.above, metric), window.weight)
    if without is not None:
        ellipses = ellipses.take(motion=ellipses.events != without)
    return protect_over_lengths(ellipses.stating(window=window.label), metric=metric, confidence=confidence)


def _of_nearest(frequency: float, damping_ratio: float) -> ResponseMeasures:
    """Measures of the responses of the nearest structure, shape (motions, 1, 1)."""
    measures = shipped_measures()
    f, xi = measures.nearest(np.array([frequency]), np.array([damping_ratio]))
    return measures.at(f, xi)
