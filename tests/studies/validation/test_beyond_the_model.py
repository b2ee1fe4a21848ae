"""Verdicts through the indices on actuators that are not a constant gain and delay."""

import numpy as np
import pytest
from reliab_studies.validation.beyond_the_model import rigs_of_delay, try_rigs

from reliab.criterion.criterion import Criterion
from reliab.criterion.laws.table import TabulatedLimits
from reliab.criterion.scope import Provenance
from reliab.motions.loading import load_motions
from reliab.structures.structure import Structure


@pytest.fixture(scope="module")
def criterion():
    return Criterion(
        law=TabulatedLimits.fit([1.0], [0.02], [[6e-5]], [[1.2]]),
        threshold=0.05,
        metric="rms",
        confidence=0.95,
        method="quantile",
        joint=False,
        provenance=Provenance(source="round numbers"),
    )


@pytest.fixture(scope="module")
def trials(criterion):
    motions = load_motions("synthetic")[:3]
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    return try_rigs(motions, [structure], lambda _: rigs_of_delay(0.001), criterion, levels=(1.0,), count=6)


@pytest.fixture(scope="module")
def around_the_limits(criterion):
    motions = load_motions("synthetic")[:3]
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    return try_rigs(motions, [structure], lambda delay: rigs_of_delay(delay)[:1], criterion, count=3)


@pytest.mark.slow
@pytest.mark.parametrize(
    "rig",
    ["constant delay", "first-order lag", "second-order dynamics", "inverse compensation, wrong estimate"],
)
def test_linear_actuators_act_as_gain_and_delay(trials, rig):
    rows = trials[trials["rig"] == rig]
    np.testing.assert_allclose(rows["d"], 0.001, rtol=0.02)
    np.testing.assert_allclose(rows["predicted"], rows["error"], rtol=0.01)


@pytest.mark.slow
def test_drifting_delay_is_less_well_described(trials):
    rows = trials[trials["rig"] == "drifting delay"]
    assert np.abs(rows["predicted"] / rows["error"] - 1.0).max() > 0.01
    np.testing.assert_allclose(rows["d"], 0.001, rtol=0.5)


def test_verdict_is_by_the_criterion_and_truth_by_the_error(trials):
    index = (trials["A"] - 1.0) ** 2 / 6e-5 + (1e3 * trials["d"]) ** 2 / 1.2
    np.testing.assert_array_equal(trials["accepted"], index <= 1.0)
    np.testing.assert_array_equal(trials["good"], trials["error"] <= 0.05)


def test_tests_lie_on_both_sides_of_both_limits(around_the_limits):
    assert set(around_the_limits["good"]) == {True, False}
    assert set(around_the_limits["accepted"]) == {True, False}
    limits_of_motion = around_the_limits.groupby("motion").nth([2, 3])
    assert limits_of_motion["good"].tolist() == [True, False] * 3
