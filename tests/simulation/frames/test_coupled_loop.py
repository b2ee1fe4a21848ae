"""Coupled hybrid tests against an integrator that shares no code, and the two engines against each other."""

import numpy as np
import pytest
import scipy
from coupled_structures import (
    coupled_lags,
    coupled_response,
    described,
    lag,
    node,
    plate,
    responses_over_frequency,
    two_storeys,
)

from reliab.core.errors import InputError
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferFunction

STEP = 1.0 / 256.0


def ground(duration):
    time = np.arange(0.0, duration, STEP)
    return np.sin(5.0 * time) * np.sin(1.3 * time) + 0.4 * np.sin(23.0 * time)


def integrate(partition, actuators, record):
    """Command and measured displacements by Runge-Kutta steps, with each command filtered by itself."""
    size, degrees = partition.size, partition.degrees
    gamma, t_inverse = partition.interface, np.linalg.inv(actuators.kinematics)
    k, c, m = partition.specimen_stiffness, partition.specimen_damping, partition.specimen_mass
    mass = partition.mass - gamma @ m @ gamma.T
    inverse = np.linalg.inv(mass)
    damping = partition.damping - gamma @ c @ gamma.T
    stiffness = partition.stiffness - gamma @ k @ gamma.T
    corners = np.array([np.sqrt(entry.denominator[-1]) for entry in actuators.transfer[0]])
    gains = np.array(
        [[entry.numerator[0] / entry.denominator[-1] for entry in row] for row in actuators.transfer]
    )
    times = STEP * np.arange(record.size)

    def rates(t, state):
        x, v = state[:size], state[size : 2 * size]
        # each command's own second-order filter, whose outputs the gains mix
        q, r = state[2 * size : 2 * size + degrees], state[2 * size + degrees :]
        sent = actuators.kinematics @ (gamma.T @ x)
        s = corners**2 * (sent - q) - 1.4 * corners * r
        mixture = t_inverse @ gains
        force = k @ (mixture @ q) + c @ (mixture @ r) + m @ (mixture @ s)
        load = -partition.mass @ partition.influence * np.interp(t, times, record)
        a = inverse @ (load - damping @ v - stiffness @ x - gamma @ force)
        return np.concatenate([v, a, r, s])

    solution = scipy.integrate.solve_ivp(
        rates,
        (0.0, times[-1]),
        np.zeros(2 * size + 2 * degrees),
        t_eval=times,
        method="DOP853",
        rtol=1e-9,
        atol=1e-14,
        max_step=STEP,
    )
    command = gamma.T @ solution.y[:size]
    return command, t_inverse @ gains @ solution.y[2 * size : 2 * size + degrees]


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("structure", [two_storeys, node, plate])
def test_exact_steps_agree_with_an_integrator(structure):
    partition, actuators = described(structure)
    record = ground(0.4)
    response = coupled_response(partition, actuators, record, STEP)
    command, reading = integrate(partition, actuators, record)
    np.testing.assert_allclose(response.command, command, atol=1e-6 * np.abs(command).max())
    np.testing.assert_allclose(response.measured, reading, atol=1e-6 * np.abs(reading).max())


@pytest.mark.parametrize("structure", [two_storeys, node, plate])
def test_state_and_frequency_give_one_steady_motion(structure):
    partition, actuators = described(structure)
    omega = 9.0
    time = np.arange(0.0, 12.0, STEP)
    response = coupled_response(partition, actuators, np.sin(omega * time), STEP)
    command_part, measured_part = responses_over_frequency(partition, actuators, np.array([1j * omega]))
    late = time > 9.0
    for history, transfer in ((response.command, command_part[0]), (response.measured, measured_part[0])):
        steady = np.imag(np.outer(transfer, np.exp(1j * omega * time)))
        np.testing.assert_allclose(history[:, late], steady[:, late], atol=2e-3 * np.abs(steady).max())


def test_unstable_tests_and_pure_delays_are_refused():
    partition, _ = described(two_storeys)
    slow = ActuatorMatrix(kinematics=np.eye(2), transfer=((lag(1.0, 40.0), None), (None, lag(1.0, 40.0))))
    with pytest.raises(InputError, match="is unstable even without delay"):
        coupled_response(partition, slow, ground(1.0), STEP)
    late = TransferFunction(numerator=(1.0,), denominator=(1.0,), delay=0.01)
    delayed_copy = ActuatorMatrix(kinematics=np.eye(2), transfer=((late, None), (None, late)))
    with pytest.raises(InputError, match="pure delays"):
        coupled_response(partition, delayed_copy, ground(1.0), STEP)


@pytest.mark.parametrize(
    ("kinematics", "sentence"),
    [
        ([[1.0, 0.2], [2.0, 0.4]], "must not be singular"),
        ([[1.0, 0.2], [1.0, -0.2], [0.5, 0.1]], "more actuators than degrees"),
        ([[1.0, 0.2]], "needs an actuator"),
    ],
)
def test_kinematics_unable_to_drive_specimen_are_refused(kinematics, sentence):
    with pytest.raises(InputError, match=sentence):
        ActuatorMatrix(kinematics=np.array(kinematics), transfer=coupled_lags(2, 1))
