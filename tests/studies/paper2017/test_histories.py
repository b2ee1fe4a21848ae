"""Drawn histories look as they are, and no ground motion can be found in them."""

import numpy as np
import pytest
from reliab_studies.paper2017.pages.displacement_histories import HistoryPanel, as_printed

from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import spectral
from reliab.structures.structure import Structure

STEP = 0.01


@pytest.fixture(scope="module")
def record():
    times = STEP * np.arange(4096)
    noise = np.random.default_rng(1).normal(size=times.size)
    return noise * np.exp(-(((times - 12.0) / 6.0) ** 2))


@pytest.fixture(scope="module")
def panel(record):
    excitation = Excitation(acceleration=record, time_step=STEP)
    displacement, step = spectral.response(excitation, Structure(frequency=1.0, damping_ratio=0.02), 1.0, 0.0)
    return HistoryPanel(title="", times=step * np.arange(displacement.size), ideal=displacement)


def test_it_looks_the_same(panel):
    digitized = as_printed(panel)
    interpolated_history = np.interp(panel.times, digitized.times, digitized.ideal)
    assert np.abs(interpolated_history - panel.ideal).max() < 0.02 * np.abs(panel.ideal).max()


def rebuilt(panel, times):
    """Ground acceleration by the equation of motion, from central differences of the drawn curve."""
    omega, xi, step = 2.0 * np.pi, 0.02, panel.times[1] - panel.times[0]
    velocity = np.gradient(panel.ideal, step)
    acceleration = -(np.gradient(velocity, step) + 2.0 * xi * omega * velocity + omega**2 * panel.ideal)
    return np.interp(times, panel.times, acceleration)


def test_the_record_cannot_be_found_again(panel, record):
    times = STEP * np.arange(record.size)
    fine = np.corrcoef(rebuilt(panel, times), record)[0, 1]
    correlation = np.corrcoef(rebuilt(as_printed(panel), times), record)[0, 1]
    assert fine > 0.8
    assert correlation < 0.5
