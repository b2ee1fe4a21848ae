"""Standard errors of identified parameters against repeated tests, and the rules beside them."""

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuilt_error import identification
from reliab.assessment.rebuilt_error.identification import Identification, IdentifiedParameter, identify
from reliab.core.errors import InputError
from reliab.structures.structure import Structure

STEP = 1.0 / 256.0
TIME = STEP * np.arange(4096)
W0, XI, SHARE = 2.0 * np.pi * 1.1, 0.04, 0.6
STATED = Structure(frequency=1.1, damping_ratio=XI, experimental_fraction=SHARE)
NAMES = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")
TRUE = {"frequency": 1.1, "damping_ratio": XI, "experimental_fraction": SHARE, "feedback_lag": 0.0}


def histories(lag=0.0):
    """Smooth histories that obey the equation of motion: command, measured, ground acceleration, force."""
    rng = np.random.default_rng(3)
    frequency, phase = rng.uniform(0.4, 2.0, 12), rng.uniform(0.0, 6.28, 12)
    waves = 2.0 * np.pi * frequency[:, np.newaxis]

    def moved(time, order=0, delay=0.0):
        angle = waves * (time - delay) + phase[:, np.newaxis] + 0.5 * np.pi * order
        return 0.004 * np.sum(waves**order * np.sin(angle), axis=0)

    command, measured_displacement = moved(TIME), 0.97 * moved(TIME, delay=0.004)
    force = SHARE * W0**2 * measured_displacement
    fed_back = SHARE * W0**2 * 0.97 * moved(TIME, delay=0.004 + lag)
    ground = -(moved(TIME, 2) + 2.0 * XI * W0 * moved(TIME, 1) + (1.0 - SHARE) * W0**2 * command + fed_back)
    return command, measured_displacement, ground, force


@pytest.mark.parametrize("force_case", [True, False])
def test_standard_errors_are_the_spread_over_repeated_noise(force_case):
    command, measured_displacement, ground, force = histories()
    rng = np.random.default_rng(4)
    names = NAMES if force_case else NAMES[:2]
    values, deviations = [], []
    for _ in range(60):
        # correlated over a few samples, as an accelerometer behind its own filter
        noise = scipy.signal.lfilter([1.0], [1.0, -0.7], rng.standard_normal((2, TIME.size)))
        result = identify(
            command,
            measured_displacement,
            ground + 0.05 * noise[0],
            STEP,
            STATED,
            force=force + 0.05 * noise[1] if force_case else None,
        )
        values.append([getattr(result, name).value for name in names])
        deviations.append([getattr(result, name).deviation for name in names])
    spread, stated_values = np.std(values, axis=0), np.sqrt(np.mean(np.square(deviations), axis=0))
    # noise of the force moves both terms of ω₀² = k + αω₀², one against the other; their errors are added
    largest = np.array([2.0 if force_case else 1.3, 1.3, 1.3, 1.3])[: len(names)]
    assert (0.7 * spread < stated_values).all()
    assert (stated_values < largest * spread).all()
    off = np.mean(values, axis=0) - [TRUE[name] for name in names]
    assert (np.abs(off) < 4.0 * spread / np.sqrt(60.0) + 1e-4).all()


@pytest.mark.parametrize("lag", [0.0, 0.002])
def test_exact_histories_give_the_parameters_back(lag):
    command, measured_displacement, ground, force = histories(lag)
    outcome = identify(command, measured_displacement, ground, STEP, STATED, force=force)
    assert outcome.feedback_lag.value == pytest.approx(lag, abs=2e-5)
    # the lag that is stated leaves the damping; the lag that is not is taken for −αω₀τ/2 of it
    stated_values = identify(
        command, measured_displacement, ground, STEP, STATED, force=force, feedback_lag=lag
    )
    assert stated_values.damping_ratio.value == pytest.approx(XI, rel=0.01)
    assert stated_values.feedback_lag.value == pytest.approx(lag, abs=2e-5)
    assert outcome.damping_ratio.value == pytest.approx(XI - 0.5 * SHARE * W0 * lag, abs=5e-4)
    bare = identify(command, measured_displacement, ground, STEP, STATED, feedback_lag=lag)
    assert bare.damping_ratio.value == pytest.approx(XI, rel=0.01)
    for result in (outcome, stated_values, bare):
        assert result.frequency.value == pytest.approx(1.1, rel=1e-3)
        assert result.misfit < 1e-3
    assert stated_values.experimental_fraction.value == pytest.approx(SHARE, rel=1e-4)
    assert bare.experimental_fraction is bare.feedback_lag is None


def test_misfit_is_the_unexplained_share_of_an_acceleration():
    """Both are seen through the kernel; a sine at 3.5 Hz is no response to anything here."""
    command, measured_displacement, ground, force = histories()
    strange = 0.5 * np.sin(2.0 * np.pi * 3.5 * TIME)
    result = identify(command, measured_displacement, ground + strange, STEP, STATED, force=force)
    half = 0.5 / 1.1
    gain = [
        scipy.integrate.quad(
            lambda u, f=f: (1.0 - u * u) ** 6 * np.cos(2.0 * np.pi * f * half * u), -1.0, 1.0
        )[0]
        for f in (3.5, 0.0)
    ]
    power = np.mean(
        scipy.signal.fftconvolve(ground, (1.0 - np.linspace(-1, 1, 233) ** 2) ** 6 / 116.0, "valid") ** 2
    )
    expected = np.sqrt(0.5 * (0.5 * gain[0]) ** 2 / (power + 0.5 * (0.5 * gain[0]) ** 2))
    assert result.misfit == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("off", "deviation", "departs"),
    [
        (0.0301, 0.01, True),
        (0.0299, 0.01, False),
        (0.021, 1e-4, True),
        (0.019, 1e-4, False),
        (-0.0301, 0.01, True),
    ],
)
def test_a_stated_value_is_wrong_by_three_standard_errors_and_more_than_matters(off, deviation, departs):
    assert IdentifiedParameter(value=1.0 + off, deviation=deviation, stated=1.0).departs(0.02) is departs


def test_deviations_are_relative_except_for_a_lag():
    """0.5 % of the frequency, 2 % of the damping ratio, 2 % of the share, 0.1 ms of the lag."""

    def identification(factor):
        return Identification(
            frequency=IdentifiedParameter(value=2.0 * (1.0 + 0.005 * factor), deviation=0.0, stated=2.0),
            damping_ratio=IdentifiedParameter(value=0.04 * (1.0 - 0.02 * factor), deviation=0.0, stated=0.04),
            experimental_fraction=IdentifiedParameter(
                value=0.5 * (1.0 + 0.02 * factor), deviation=0.0, stated=0.5
            ),
            feedback_lag=IdentifiedParameter(value=1e-3 - 1e-4 * factor, deviation=0.0, stated=1e-3),
            misfit=0.0,
        )

    assert identification(0.99).disagreements() == ()
    assert identification(1.01).disagreements() == NAMES


def test_four_periods_are_enough_and_histories_have_one_length():
    command, measured_displacement, ground, force = (
        values[: int(4.0 / 1.1 / STEP) + 2] for values in histories()
    )
    assert identify(command, measured_displacement, ground, STEP, STATED, force=force).frequency.value > 0.0
    with pytest.raises(InputError, match="at least 4 periods"):
        identify(command[:-4], measured_displacement[:-4], ground[:-4], STEP, STATED, force=force[:-4])
    with pytest.raises(InputError, match="the same length"):
        identify(command, measured_displacement, ground[:-1], STEP, STATED)
    with pytest.raises(InputError, match="the same length"):
        identify(command, measured_displacement, ground, STEP, STATED, force=force[1:])


def spread_by_draws(formula, means, deviations):
    """Standard deviation of a function of independent normal values."""
    draws = np.random.default_rng(6).normal(means, deviations, (200_000, len(means)))
    return np.std(formula(*draws.T))


@pytest.mark.parametrize("relative", [0.002, 0.03])
def test_errors_of_coefficients_become_errors_of_parameters(relative, monkeypatch):
    """Frequency, ratio and share are functions of c, k and αω₀², whose errors are independent."""
    damping, spring, coverage = 0.5, 20.0, 28.0

    def fit_equation(*_):
        return next(of_equation)

    monkeypatch.setattr(identification, "fit_equation", fit_equation)
    command, measured_displacement, ground, force = histories()
    squares = [
        np.diag((relative * np.array(means)) ** 2) for means in ((damping, spring, 1.0), (coverage, 1.0, 1.0))
    ]
    answers = [
        (np.array([damping, spring, 0.0]), squares[0], np.zeros(9)),
        (np.array([coverage, 0.0, 0.0]), squares[1], np.zeros(9)),
        (np.array([1e-3, 0.0, 0.0]), np.diag([4e-8, 1.0, 1.0]), np.zeros(9)),
    ]
    of_equation = iter(answers)
    result = identify(command, measured_displacement, ground, STEP, STATED, force=force)
    arguments = ((damping, spring, coverage), relative * np.array([damping, spring, coverage]))
    formulas = {
        "frequency": lambda _, k, p: np.sqrt(k + p) / (2.0 * np.pi),
        "damping_ratio": lambda c, k, p: c / (2.0 * np.sqrt(k + p)),
        "experimental_fraction": lambda _, k, p: p / (k + p),
    }
    for name, formula in formulas.items():
        estimate = getattr(result, name)
        assert estimate.value == pytest.approx(formula(damping, spring, coverage)), name
        assert estimate.deviation == pytest.approx(spread_by_draws(formula, *arguments), rel=0.02), name
    assert result.feedback_lag.value == pytest.approx(1e-3)
    assert result.feedback_lag.deviation == pytest.approx(2e-4)
    of_equation = iter([(np.array([damping, spring, 0.0]), squares[0], np.zeros(9))])
    separate = identify(command, measured_displacement, ground, STEP, STATED)
    arguments = ((damping, spring), relative * np.array([damping, spring]))
    for name, formula in (
        ("frequency", lambda _, k: np.sqrt(k) / (2.0 * np.pi)),
        ("damping_ratio", lambda c, k: c / (2.0 * np.sqrt(k))),
    ):
        estimate = getattr(separate, name)
        assert estimate.deviation == pytest.approx(spread_by_draws(formula, *arguments), rel=0.02), name
