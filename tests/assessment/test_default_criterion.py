"""The criterion that ships with the package."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.app.api.criteria import derive_criteria
from reliab.assessment.default_criterion import default_criterion
from reliab.assessment.design import chart_frequencies, tolerable_errors
from reliab.assessment.placement import place
from reliab.core.errors import InputError
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_table import EllipseTable, interpolate_tables
from reliab.structures.structure import Structure
from reliab.sweep.results import open_results, real_results


def test_between_stored_structures_and_thresholds_limits_lie_between():
    low, middle, high = (float(default_criterion(f, 0.02).limits(f, 0.02)[1]) for f in (0.75, 0.9, 1.0))
    assert low > middle > high
    low, middle, high = (
        float(default_criterion(1.0, 0.02, t).limits(1.0, 0.02)[0]) for t in (0.02, 0.03, 0.05)
    )
    assert low < middle < high
    assert middle == pytest.approx(low * (0.03 / 0.02) ** 2, rel=0.15)


def test_confidence_has_its_price():
    limits = [
        float(default_criterion(1.0, 0.05, confidence=c).limits(1.0, 0.05)[0]) for c in (0.8, 0.95, 0.99)
    ]
    assert np.all(np.diff(limits) < 0.0)


def test_criterion_is_the_recommended_one_and_knows_its_motions():
    result = default_criterion(0.6, 0.03, 0.05, 0.9)
    assert (result.method, result.joint, result.confidence) == ("dirichlet", True, 0.9)
    assert (result.provenance.n_motions, result.provenance.n_events) == (100, 19)
    assert 0.85 < float(result.probability(1.0, np.sqrt(result.limits(0.6, 0.03)[1]) / 1e3, 0.6, 0.03)) < 1.0


@pytest.mark.parametrize("wrong", [{"threshold": 0.5}, {"threshold": 0.0}, {"metric": "peak"}])
def test_missing_ellipses_are_refused(wrong):
    with pytest.raises(InputError):
        default_criterion(1.0, 0.02, **wrong)


def test_tolerable_errors_are_the_roots_of_the_limits():
    result = tolerable_errors([0.5, 1.0], 0.02, confidences=(0.9, 0.95))
    assert [(item.frequency, item.confidence) for item in result] == [
        (0.5, 0.9),
        (0.5, 0.95),
        (1.0, 0.9),
        (1.0, 0.95),
    ]
    a, b = default_criterion(1.0, 0.02).limits(1.0, 0.02)
    assert result[-1].amplitude_error == pytest.approx(float(a) ** 0.5)
    assert result[-1].delay == pytest.approx(1e-3 * float(b) ** 0.5)
    half = result[-1].both
    assert half[0] ** 2 / a + (1e3 * half[1]) ** 2 / b == pytest.approx(1.0)
    assert result[-1].delay < result[-1].critical_delay


def test_chart_covers_the_shipped_frequencies():
    assert chart_frequencies()[0] == 0.25
    assert chart_frequencies(default_criterion(1.0, 0.02)) == [1.0]


def test_ellipses_of_a_window_between_two_are_nearer_to_those_of_the_nearer_one():
    lower, upper = (
        EllipseTable(
            a=np.array([1e-4 * size, 0.0]), b=np.array([size, 2.0]), coordinates={}, motion_values={}
        )
        for size in (1.0, 16.0)
    )
    result = interpolate_tables(lower, upper, 0.25)
    np.testing.assert_allclose(result.a, [2e-4, np.nan])
    np.testing.assert_allclose(result.b, [2.0, np.nan])


@pytest.mark.parametrize("duration", [None, 20.0, 27.0])
@pytest.mark.parametrize("side", ["lag", "lead"])
def test_every_door_gives_the_same_limits(duration, side):
    """Verdict and design, the command, and Python; the page of the explorer is compared by its own tests."""
    result = [default_criterion(1.0, 0.02, duration=duration).limits(1.0, 0.02, side)]
    criterion = derive_criteria(ellipses="real_suite", f=1.0, xi=0.02, duration=duration)
    result.append(criterion.criteria[0].limits(1.0, 0.02, side))
    if duration is None:
        result.append(derive_criterion("real_suite", f=1.0, xi=0.02).limits(1.0, 0.02, side))
        result.append(derive_criterion(results_of_six(), f=1.0, xi=0.02).limits(1.0, 0.02, side))
        if side == "lag":
            (tolerance,) = tolerable_errors([1.0], 0.02, confidences=(0.95,))
            result.append((tolerance.a, tolerance.b))
    for second in result[1:]:
        np.testing.assert_allclose(second, result[0], rtol=5e-3)  # results are stored with 1e-3


def results_of_six():
    """Ellipses traced in stored results, as a run does."""
    return open_results(real_results([1.0], [0.02])).sel(f=[1.0], xi=[0.02]).reliab.ellipses((0.05,))


def test_an_earthquake_is_left_out_of_a_length():
    everything = default_criterion(1.0, 0.05, duration=12.0)
    bare = default_criterion(1.0, 0.05, duration=12.0, excluded_event="NORTHR")
    assert bare.provenance.n_events == everything.provenance.n_events - 1


def test_unconverged_posterior_decides_nothing():
    """Neither before a test nor after it; read from its file it says so, too."""
    sound = default_criterion(1.0, 0.02)
    settings = {**sound.provenance.settings, "converged": False}
    criterion = replace(sound, provenance=replace(sound.provenance, settings=settings))
    for arguments in (criterion, Criterion.from_json(criterion.to_json())):
        with pytest.raises(InputError, match="has not converged"):
            tolerable_errors([1.0], 0.02, criterion=arguments)
        with pytest.raises(InputError, match="has not converged"):
            place(arguments, Structure(frequency=1.0, damping_ratio=0.02), 1.0, 1e-4, np.zeros((2, 4)))
