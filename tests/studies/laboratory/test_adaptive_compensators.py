"""Compensators that follow the test, against their published laws written out with SciPy and NumPy."""

import numpy as np
import pytest
from reliab_studies.laboratory.compensators.adaptive_inverse import AdaptiveInverse
from reliab_studies.laboratory.compensators.adaptive_model_based import AdaptiveModelBased
from reliab_studies.laboratory.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab_studies.laboratory.compensators.pi_phase_lead import PhaseLeadControl
from scipy import signal

from reliab.tracking.indices.tracking import tracking_indicator

STEP = 1.0 / 1024.0


@pytest.fixture
def target():
    time = STEP * np.arange(1200)
    return 5e-3 * np.sin(2.0 * np.pi * 2.0 * time) * np.minimum(time / 0.3, 1.0) + 1e-3 * np.sin(40.0 * time)


@pytest.fixture
def reading(target):
    """The target 12 steps late and two per cent too small."""
    return 0.98 * np.concatenate([np.zeros(12), target[:-12]])


def step_through(compensator, target, reading):
    """What a compensator sends: displacement, velocity and acceleration, shape (3, n)."""
    coefficients, state = compensator.coefficients(STEP), np.zeros(compensator.kernel.states)
    sent = np.empty((3, target.size))
    for k in range(target.size):
        sent[:, k] = target[k], 0.0, 0.0
        compensator.kernel(sent[:, k], reading[k], STEP, coefficients, state)
    return sent


def differences(history, order):
    """Backward differences over the step, at rest before; shape (order + 1, n)."""
    rows = [history]
    for _ in range(order):
        rows.append(np.diff(rows[-1], prepend=0.0) / STEP)
    return np.stack(rows)


class Filter:
    """Butterworth filter of fourth order, a sample at a time."""

    def __init__(self, cutoff):
        self.sections = signal.butter(4, cutoff, fs=1.0 / STEP, output="sos")
        self.state = np.zeros((2, 2))

    def __call__(self, value):
        (out,), self.state = signal.sosfilt(self.sections, [value], zi=self.state)
        return out


def check_derivatives(sent):
    reference = differences(sent[0], 2)
    assert sent[1] == pytest.approx(reference[1], rel=1e-9, abs=1e-12)
    assert sent[2] == pytest.approx(reference[2], rel=1e-9, abs=1e-9)


def test_adaptive_inverse_compensation_follows_the_tracking_indicator(target, reading):
    compensator = AdaptiveInverse(steps=8.0, proportional=4e5, integral=4e4)
    sent = step_through(compensator, target, reading)
    begin = [0.0]
    indicator = tracking_indicator(*(np.concatenate([begin, history]) for history in (target, reading)))[1:]
    steps = np.maximum(8.0 + 4e5 * indicator + 4e4 * STEP * np.cumsum(indicator), 1.0)
    assert np.ptp(steps) > 3.0
    earlier_samples = np.concatenate([begin, target[:-1]])
    assert sent[0] == pytest.approx(steps * target - (steps - 1.0) * earlier_samples, rel=1e-9, abs=1e-15)
    check_derivatives(sent)


def test_adaptive_inverse_compensation_never_counts_less_than_a_step(target, reading):
    """Command and measurement exchanged: the indicator falls, and the target is sent as it is."""
    compensator = AdaptiveInverse(steps=1.0, proportional=4e7, integral=0.0)
    sent = step_through(compensator, reading, target)
    assert sent[0][300:] == pytest.approx(reading[300:], rel=1e-12)


def test_adaptive_model_based_compensation_follows_the_gradient_law(target, reading):
    rates, factors = np.array([10**8.4, 10**6.2, 10**2.1, 10**0.8]), np.array([1.0, 0.02, 8.4e-5, 2e-7])
    sent = step_through(AdaptiveModelBased(factors=tuple(factors), rates=tuple(rates)), target, reading)
    inputs, command_filter = differences(target, 3), Filter(20.0)
    measurement_filter = Filter(20.0)
    y = differences(np.array([measurement_filter(value) for value in reading]), 3)
    reference = np.empty(target.size)
    first = factors.copy()
    for k in range(target.size):
        reference[k] = factors @ inputs[:, k]
        error = command_filter(reference[k]) - factors @ y[:, k]
        factors = factors + STEP * rates * error * y[:, k] / (1.0 + y[:, k] @ y[:, k])
        factors = np.maximum(factors, 0.0)
    assert (np.abs(factors / first - 1.0) > 1e-3).all()
    assert sent[0] == pytest.approx(reference, rel=1e-7, abs=1e-12)
    check_derivatives(sent)


BOUNDS = {
    "bounded": ((0.9, 0.005, 0.0), (1.1, 0.0125, 2e-4), (1.0, 0.05, 1e-3)),
    "free": ((0.5, -1.0, -1.0), (1.5, 1.0, 1.0), (1e3, 1e3, 1e3)),
}


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("unit", [1.0, 1e-4], ids=["metres", "small"])
@pytest.mark.parametrize(("lowest", "highest", "fastest"), BOUNDS.values(), ids=BOUNDS)
def test_adaptive_time_series_compensation_fits_its_factors_by_least_squares(
    target, reading, lowest, highest, fastest, unit
):
    factors, samples, length = np.array([1.0, 0.012, 7e-5]), 4, 64
    target, reading = unit * target, unit * reading
    compensator = AdaptiveTimeSeries(
        factors=tuple(factors),
        lowest=lowest,
        highest=highest,
        fastest=fastest,
        trigger=unit * 2e-3,
        samples=samples,
        window=length * samples * STEP,
        cutoff=30.0,
    )
    sent = step_through(compensator, target, reading)
    inputs, command_filter, measurement_filter = differences(target, 2), Filter(30.0), Filter(30.0)
    y = differences(np.array([measurement_filter(value) for value in reading]), 2)
    reference, filtered_signals, first = np.empty(target.size), np.empty(target.size), factors.copy()
    for k in range(target.size):
        reference[k] = factors @ inputs[:, k]
        filtered_signals[k] = command_filter(reference[k])
        places = np.arange(k % samples, k + 1, samples)[-length:]
        if k % samples == 0 and np.abs(y[0, places]).max() >= unit * 2e-3:
            fit = np.linalg.lstsq(y[:, places].T * [1.0, 1e-2, 1e-4], filtered_signals[places])[0] * [
                1.0,
                1e-2,
                1e-4,
            ]
            largest_step = np.array(fastest) * samples * STEP
            factors = factors + np.clip(np.clip(fit, lowest, highest) - factors, -largest_step, largest_step)
    assert (np.abs(factors / first - 1.0) > 1e-3).all()
    assert sent[0] == pytest.approx(reference, rel=1e-5, abs=unit * 1e-10)
    assert sent[1] == pytest.approx(differences(sent[0], 1)[1], rel=1e-9, abs=unit * 1e-9)


def test_phase_lead_control_is_a_lead_and_a_regulator_by_tustins_rule(target, reading):
    compensator = PhaseLeadControl(proportional=0.4, integral=90.0, lead=1.5, lead_pole=60.0, quantum=0.0)
    sent = step_through(compensator, target, reading)
    ahead = signal.lfilter(*signal.bilinear([1.5, 60.0], [1.0, 60.0], 1.0 / STEP), target)
    regulator_output = signal.lfilter(*signal.bilinear([0.4, 90.0], [1.0, 0.0], 1.0 / STEP), ahead - reading)
    assert sent[0] == pytest.approx(regulator_output, rel=1e-8, abs=1e-12)
    check_derivatives(sent)


def test_phase_lead_control_behind_converters_sends_whole_steps_within_their_range(target, reading):
    regulator = {"proportional": 0.4, "integral": 20.0, "lead": 1.5, "lead_pole": 60.0}
    exact = PhaseLeadControl(**regulator)
    fine = PhaseLeadControl(**regulator, quantum=1e-5, span=4e-3)
    sent = step_through(fine, target, reading)[0]
    assert sent / 1e-5 == pytest.approx(np.rint(sent / 1e-5), abs=1e-6)
    assert np.abs(sent).max() <= 4e-3 + 1e-12
    small = step_through(fine, 0.1 * target, 0.1 * reading)[0]
    assert small == pytest.approx(step_through(exact, 0.1 * target, 0.1 * reading)[0], abs=3e-5)
