"""Errors of the whole test against the published numbers."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import spectral
from reliab.structures.structure import Structure
from reliab.tracking.indices.response_error import relative_error, response_error
from reliab.tracking.indices.window import Window


@pytest.fixture(scope="module")
def nishi_akashi(real_motions_folder):
    motion = load_motions(real_motions_folder).select(names=["KOBE/NIS000"])[0]
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    return Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.02))


@pytest.mark.parametrize(("metric", "printed_values"), [(Metric.RMS, 0.042), (Metric.MTE, 0.092)])
def test_one_percent_of_amplitude_error_on_nishi_akashi(nishi_akashi, metric, printed_values):
    result = nishi_akashi.deviation(nishi_akashi.cells(gain=0.99, delay=0.0))
    assert relative_error(result, metric)[0] == pytest.approx(printed_values, rel=0.02)


def test_histories_and_sums_give_the_same_error(nishi_akashi):
    structure, excitation = nishi_akashi.structure, nishi_akashi.excitation
    reading, _ = spectral.response(excitation, structure, 1.01, 0.002)
    ideal, _ = spectral.response(excitation, structure, 1.0, 0.0)
    result = nishi_akashi.deviation(nishi_akashi.cells(gain=1.01, delay=0.002))
    for metric in Metric:
        assert response_error(reading, ideal, metric) == pytest.approx(
            relative_error(result, metric)[0], rel=1e-3
        )


def test_maximum_error_is_never_below_the_root_mean_square(nishi_akashi):
    rng = np.random.default_rng(0)
    cells = nishi_akashi.cells(gain=rng.uniform(0.97, 1.03, 64), delay=rng.uniform(0.0, 0.005, 64))
    result = nishi_akashi.deviation(cells)
    assert (relative_error(result, Metric.MTE) >= relative_error(result, Metric.RMS)).all()


def test_still_ground_has_no_relative_error():
    with pytest.raises(InputError, match="zero"):
        response_error(np.zeros(10), np.zeros(10))


@pytest.mark.parametrize("text", ["", "whole", "-3", "0", "nan", "inf"])
def test_invalid_window_is_refused(text):
    with pytest.raises(InputError, match="window"):
        Window.parse(text)


def test_arias_window_holds_nine_tenths_of_the_intensity():
    record = np.sin(np.linspace(0.0, 60.0, 5001)) * np.exp(-(np.linspace(-3.0, 3.0, 5001) ** 2))
    begin, end = Window.parse("arias").bounds(record, 0.01)
    is_inside = slice(int(begin / 0.01), int(end / 0.01))
    assert np.sum(record[is_inside] ** 2) / np.sum(record**2) == pytest.approx(0.9, abs=5e-3)


def test_shorter_record_than_the_window_is_taken_whole():
    assert Window.parse("40").bounds(np.ones(101), 0.1) == (0.0, pytest.approx(10.0))


def test_errors_are_shares_of_the_peak_of_the_exact_response():
    """Deviations of 0, 3 and 0 mm beside a peak of 6 mm; the trapezoidal rule halves the ends."""
    ideal, reading = np.array([0.0, 6e-3, 0.0]), np.array([0.0, 9e-3, 0.0])
    assert response_error(reading, ideal, Metric.MTE) == pytest.approx(0.5)
    assert response_error(reading, ideal) == pytest.approx(0.5 * np.sqrt(0.5))


@pytest.mark.parametrize(("text", "end"), [("record", 10.0), ("2.5", 2.5), ("40", 10.0)])
def test_bounds_and_label_of_a_window(text, end):
    window = Window.parse(text)
    assert window.label == text
    assert window.bounds(np.ones(101), 0.1) == pytest.approx((0.0, end))
