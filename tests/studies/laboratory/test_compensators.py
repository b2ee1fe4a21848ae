"""Compensators advance the command by what they promise."""

import numpy as np
import pytest
from reliab_studies.laboratory.compensators.feedforward import Feedforward
from reliab_studies.laboratory.compensators.inverse import InverseCompensation
from reliab_studies.laboratory.compensators.model_inverse import ModelInverse
from reliab_studies.laboratory.compensators.polynomial_extrapolation import PolynomialExtrapolation

from reliab.core.errors import InputError
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.structure import Structure
from reliab.tracking.indices.tracking import frequency_evaluation

STEP = 1.0 / 1024.0


def kernel_output(compensator, command):
    """Step a compensator over a command given as (3, n)."""
    state = np.zeros(16)
    coefficients = compensator.coefficients(STEP)
    sent = []
    for k in range(command.shape[1]):
        motion = command[:, k].copy()
        compensator.kernel(motion, 0.0, STEP, coefficients, state)
        sent.append(motion[0])
    return np.array(sent)


def polynomial_command(degree):
    t = STEP * np.arange(400)
    x = (t / 0.1) ** degree
    v = degree / 0.1 * (t / 0.1) ** max(degree - 1, 0) * (degree > 0)
    return t, np.stack([x, v, np.zeros_like(x)])


@pytest.mark.parametrize("order", [1, 2, 3])
def test_extrapolation_is_exact_for_polynomials_of_its_order(order):
    t, command = polynomial_command(order)
    sent = kernel_output(PolynomialExtrapolation(steps=4, order=order), command)
    reference = ((t + 4 * STEP) / 0.1) ** order
    np.testing.assert_allclose(sent[50:], reference[50:], rtol=1e-10)


def test_inverse_and_feedforward_are_exact_for_a_constant_velocity():
    t, command = polynomial_command(1)
    inverse = kernel_output(InverseCompensation(steps=4.0), command)
    np.testing.assert_allclose(inverse[5:], (t[5:] + 3 * STEP) / 0.1, rtol=1e-10)
    feedforward = kernel_output(Feedforward(time=0.004), command)
    np.testing.assert_allclose(feedforward[5:], (t[5:] + 0.004) / 0.1, rtol=1e-10)


def differences(history):
    """Backward differences over the step, from rest: the history and its first three; shape (4, n)."""
    rows = [history]
    for _ in range(3):
        rows.append(np.diff(rows[-1], prepend=0.0) / STEP)
    return np.stack(rows)


@pytest.mark.parametrize(
    "compensator",
    [
        InverseCompensation(steps=4.0),
        PolynomialExtrapolation(steps=4, order=2),
        Feedforward(time=0.004),
        ModelInverse(factors=(1.1, 0.02, 2e-4, 1e-6)),
    ],
    ids=lambda compensator: compensator.name,
)
def test_displacement_velocity_and_acceleration_follow_the_definition(compensator):
    """On a command without any order; all factors differ from one and from each other."""
    command = np.random.default_rng(4).standard_normal((3, 60))
    coefficients, state = compensator.coefficients(STEP), np.zeros(compensator.kernel.states)
    sent = command.copy()
    for k in range(sent.shape[1]):
        row = sent[:, k].copy()
        compensator.kernel(row, k * STEP, STEP, coefficients, state)
        sent[:, k] = row
    x, (v, a) = command[0], command[1:]
    earlier_samples = np.pad(command, ((0, 0), (1, 0)))[:, :-1]
    late = [np.pad(x, (lag, 0))[: x.size] for lag in (0, 4, 8)]
    reference = {
        "inverse": 4.0 * command - 3.0 * earlier_samples,
        "feedforward": [x + 0.004 * v, v + 0.004 * a, a],
        "polynomial_extrapolation": differences(3.0 * late[0] - 3.0 * late[1] + late[2])[:3],
        "model_inverse": differences(np.array([1.1, 0.02, 2e-4, 1e-6]) @ differences(x))[:3],
    }[compensator.name]
    np.testing.assert_allclose(sent, reference, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    "compensator",
    [InverseCompensation(steps=5.0), PolynomialExtrapolation(steps=4), Feedforward(time=4 * STEP)],
)
def test_delay_is_compensated_in_the_loop(compensator):
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    ground = np.sin(2 * np.pi * STEP * np.arange(20 * 1024)) * np.exp(-STEP * np.arange(20 * 1024) / 6.0)
    late = HybridTest(structure=structure, actuator=Actuator(delay=4 * STEP))
    delays = []
    for plugged_compensator in (None, compensator):
        outcome = run_closed_loop(late, ground, STEP, compensator=plugged_compensator)
        index = frequency_evaluation(outcome.command.values[0], outcome.measured, STEP)
        delays.append(index.equivalent_delay)
    assert delays[0] == pytest.approx(4 * STEP, abs=2e-5)
    assert abs(delays[1]) < 0.02 * delays[0]


def test_an_inverse_needs_a_positive_first_factor_only():
    assert ModelInverse(factors=(1.0,)).coefficients(0.001).tolist() == [1.0, 0.0, 0.0, 0.0]
    assert ModelInverse(factors=(1.0, -0.004)).coefficients(0.001).tolist() == [1.0, -0.004, 0.0, 0.0]
    for factors in ((0.0, 0.004), (-1.0, 0.004), (), (1.0,) * 5, (1.0, np.inf)):
        with pytest.raises(InputError, match="one to four finite factors"):
            ModelInverse(factors=factors)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: InverseCompensation(steps=0.5),
        lambda: PolynomialExtrapolation(steps=4, order=4),
        lambda: PolynomialExtrapolation(steps=9, order=3),
        lambda: Feedforward(time=-0.1),
    ],
)
def test_senseless_settings_are_refused(wrong):
    with pytest.raises(InputError, match="must"):
        wrong()
