"""Elastoplastic tests: the linear limit, and an independent integration."""

import numpy as np
import pytest
from reliab_studies.ductility.yielding import _fine, _response, summarise, yielding_tests
from scipy.integrate import solve_ivp

from reliab.motions.synthetic.suite import synthetic_suite
from reliab.structures.structure import Structure
from reliab.validation.yielding import HARDENING

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)


@pytest.fixture(scope="module")
def motions():
    return list(synthetic_suite(count=3))


def test_a_specimen_without_yielding_has_the_error_of_the_linear_boundary(motions):
    tests = yielding_tests(motions, [STRUCTURE], reductions=(0.5,))
    assert len(tests) == 3 * 5
    np.testing.assert_allclose(tests["ratio"], 1.0, rtol=1e-3)  # the boundary is traced by another engine


def test_yielding_response_agrees_with_an_independent_integration(motions):
    record, step = _fine(motions[0], STRUCTURE)
    record = record[: int(15.0 / step)]
    linear = _response(record, step, STRUCTURE, 1.0, 0.0, np.inf)
    limit = float(np.abs(linear).max()) / 3.0
    response = _response(record, step, STRUCTURE, 1.0, 0.0, limit)
    w0, times = STRUCTURE.circular_frequency, step * np.arange(record.size)

    def rate(t, state):
        x, v, elastic = state
        slipping = abs(elastic) >= limit and elastic * v > 0.0
        force = HARDENING * x + (1.0 - HARDENING) * np.clip(elastic, -limit, limit)
        ground = np.interp(t, times, record)
        return [v, -ground - 2.0 * 0.05 * w0 * v - w0**2 * force, 0.0 if slipping else v]

    solution = solve_ivp(
        rate, (0.0, times[-1]), [0.0, 0.0, 0.0], t_eval=times[::50], max_step=2e-3, rtol=1e-6
    )
    peak = np.abs(response).max()
    assert np.abs(response - linear).max() > 0.2 * peak
    np.testing.assert_allclose(response[::50], solution.y[0], atol=0.01 * peak)


def test_summary_counts_errors_above_the_threshold(motions):
    tests = yielding_tests(motions, [STRUCTURE], reductions=(2.0, 4.0))
    summary = summarise(tests)
    overall = summary[summary["f"].isna()].set_index("R")
    for reduction, part in tests.groupby("R"):
        row = overall.loc[reduction]
        assert row["exceeding"] == pytest.approx((part["error"] > 0.05).mean())
        assert row["largest_ratio"] == pytest.approx(part["error"].max() / 0.05)
        assert row["low"] <= row["exceeding"] <= row["high"]
    assert len(summary) == 4


def test_each_motion_is_reported(motions):
    reports = []
    yielding_tests(motions, [STRUCTURE], reductions=(), progress=lambda *numbers: reports.append(numbers))
    assert reports == [(1, 3), (2, 3), (3, 3)]
