"""A test is compared with the motions behind its criterion; outside of them nothing is promised."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.assessment.assess import assess
from reliab.assessment.default_criterion import criterion_of_response, default_criterion
from reliab.assessment.placement import compare_test, scope_of_test
from reliab.criterion.derivation import published_criterion
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import FirstOrderEllipse

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)


@pytest.fixture(scope="module")
def criterion():
    return default_criterion(1.0, 0.02)


@pytest.mark.parametrize(
    ("length", "position"), [(40.0, "inside"), (12.0, "at the edge"), (8.0, "outside"), (150.0, "outside")]
)
def test_a_length_is_compared_with_the_lengths_of_the_motions(criterion, length, position):
    assert compare_test(criterion, {"length": length}).position == position


def test_a_response_off_resonance_is_outside(criterion):
    """A pulse of six seconds moves a structure of 1 Hz as its ground moves, whatever its damping."""
    times = np.arange(0.0, 40.0, 1.0 / 256.0)
    pulse = np.exp(-(((times - 15.0) / 2.0) ** 2)) * np.cos(2.0 * np.pi * (times - 15.0) / 6.0)
    recording = Recording(command=pulse, measured=pulse, time_step=1.0 / 256.0, name="a pulse")
    result = scope_of_test(criterion, recording, ONE_HERTZ, pulse)
    assert result.is_outside
    assert any("error's frequency" in sentence for sentence in result.sentences)


def test_criterion_without_motions_is_not_compared():
    result = compare_test(published_criterion("guo_2017_12"), {"length": 1.0})
    assert result.position is None
    assert not result.is_outside


@pytest.mark.slow
def test_outside_no_share_is_stated_and_the_error_decides(simulate):
    test = simulate(noise=0.001)
    is_inside = assess(test, ONE_HERTZ)
    scope = {**is_inside.criterion.provenance.scope, "length": [100.0, 110.0, 190.0, 200.0]}
    elsewhere = replace(is_inside.criterion, provenance=replace(is_inside.criterion.provenance, scope=scope))
    is_outside = assess(test, ONE_HERTZ, criterion=elsewhere)
    summary = is_outside.to_dict()
    assert summary["scope"]["position"] == "outside"
    assert summary["confidence"] is None
    assert summary["population"]["probability"] is None
    assert summary["by_index"]["probability"] is None
    assert summary["by_index"]["verdict"] == "undecided"
    assert any("is outside the range of the motions" in sentence for sentence in summary["warnings"])
    assert is_outside.verdict == is_inside.verdict
    assert is_inside.to_dict()["confidence"] == 0.95


@pytest.mark.slow
def test_its_own_motion_decides_the_index_wherever_the_test_lies(simulate, ground_motions):
    test = simulate(noise=0.001)
    is_inside = assess(test, ONE_HERTZ)
    scope = {"length": [100.0, 110.0, 190.0, 200.0]}
    elsewhere = replace(is_inside.criterion, provenance=replace(is_inside.criterion.provenance, scope=scope))
    result = assess(test, ONE_HERTZ, criterion=elsewhere, motion=ground_motions[0])
    assert result.index_probability is not None
    assert result.to_dict()["confidence"] == 0.95


def test_limits_for_its_own_response_are_near_those_of_small_errors():
    test_values = FirstOrderEllipse(amplitude=0.03, delay=700.0, effective_duration=3.0, duration=40.0)
    carried = criterion_of_response(test_values, ONE_HERTZ, threshold=0.05, confidence=0.5)
    a, b = (float(limit) for limit in carried.limits(1.0, 0.02))
    exact = test_values.parameters(0.05)
    assert (a / exact[0], b / exact[1]) == pytest.approx((1.0, 1.0), abs=0.4)
    larger = replace(test_values, amplitude=0.06, delay=1400.0)
    larger_run = criterion_of_response(larger, ONE_HERTZ, threshold=0.05, confidence=0.5)
    assert np.all(np.array(larger_run.limits(1.0, 0.02)) > [a, b])


@pytest.mark.parametrize(
    "structure",
    [
        Structure(frequency=3.0, damping_ratio=0.02),
        Structure(frequency=1.0, damping_ratio=0.02, experimental_fraction=0.5),
    ],
)
def test_structures_without_known_responses_have_no_such_limits(structure):
    test_values = FirstOrderEllipse(amplitude=0.03, delay=700.0, effective_duration=3.0, duration=40.0)
    assert criterion_of_response(test_values, structure, threshold=0.05, confidence=0.5) is None


def test_a_good_test_is_good_by_its_own_response_too(simulate):
    placement = assess(simulate(noise=0.001), ONE_HERTZ).by_response
    assert placement.index < 1.0
    assert placement.probability > 0.95
